//! `gonio run`.

use super::args::Measuring;
use super::error::CliError;
use super::request::{Request, file_name};
use crate::registry::{Registry, nearest};
use crate::suite::{EMBEDDED, Expanded, Plan, embedded, load};
use std::path::Path;

/// Arguments of `gonio run`.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// Suite files, or names of suites that come with gonio: seed, quick, deep.
    #[arg(value_name = "SUITE", default_value = EMBEDDED[0].name)]
    pub suites: Vec<String>,
    /// How to measure.
    #[command(flatten)]
    pub measuring: Measuring,
}

impl RunArgs {
    /// Reads and expands all suites before anything is run.
    pub fn request(&self, registry: &Registry) -> Result<Request, CliError> {
        let overrides = self.measuring.overrides();
        let (mut plans, mut refused): (Vec<Plan<'static>>, _) = (Vec::new(), 0);
        for suite in &self.suites {
            let (name, text) = read_suite(suite)?;
            let Expanded { plan, refused: left_out } = load(&name, &text, registry, &overrides)?;
            refused += left_out;
            if plans.iter().any(|p| file_name(&p.suite) == file_name(&plan.suite)) {
                return Err(CliError::Usage {
                    message: format!("two suites are called `{}`", plan.suite),
                    help: "run them one by one, or give one of them another name = \"…\" in [suite]".into(),
                });
            }
            plans.push(plan);
        }
        Ok(Request { refused, keep: true, ..Request::new(plans, &self.measuring, registry)? })
    }
}

/// The text of a suite: a file, or one that comes with gonio.
fn read_suite(suite: &str) -> Result<(String, String), CliError> {
    match (std::fs::read_to_string(suite), embedded(suite)) {
        (Ok(text), _) => Ok((suite.into(), text)),
        (Err(_), Some(found)) => Ok((found.name.into(), found.text.into())),
        (Err(e), None) => {
            let names = EMBEDDED.iter().map(|e| e.name);
            let help = match nearest(suite, names.clone()) {
                _ if Path::new(suite).exists() => format!("the file cannot be read: {e}"),
                Some(n) => format!("did you mean `{n}`?"),
                None => {
                    let names = names.collect::<Vec<_>>().join(", ");
                    format!("name a file that exists, or one of the suites that come with gonio: {names}")
                }
            };
            Err(CliError::NoSuite { name: suite.into(), help })
        }
    }
}
