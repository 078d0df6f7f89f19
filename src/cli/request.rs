//! What to run, on which terms, and where it goes.

use super::args::{Format, Measuring, Plots};
use super::earlier::read;
use super::error::CliError;
use super::formats::Outputs;
use crate::diagnosis::Explanation;
use crate::engine::Draws;
use crate::registry::Registry;
use crate::suite::Plan;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What to run and where it goes.
pub struct Request {
    /// One for each suite.
    pub plans: Vec<Plan<'static>>,
    /// The folder of the report.
    pub out: Option<PathBuf>,
    /// Whether a report is kept where no folder is named.
    pub keep: bool,
    /// Threads.
    pub threads: Option<usize>,
    /// What comes out.
    pub format: Format,
    /// Which cases get a picture.
    pub plots: Plots,
    /// Whether unclear results fail.
    pub strict: bool,
    /// The report that the results are compared with.
    pub baseline: Option<PathBuf>,
    /// The report whose results stand for subjects that are the same.
    pub changed_since: Option<PathBuf>,
    /// How many draws cases get.
    pub draws: Draws,
    /// The budget of time in seconds.
    pub time_s: Option<f64>,
    /// Whether every finding is told in full, however many there are.
    pub full: bool,
    /// What else is written into the folder.
    pub outputs: Outputs,
    /// Combinations of parameters that were left out since their model refuses them.
    pub refused: usize,
    /// Explanations of failures besides those that come with gonio.
    pub explanations: Arc<Vec<Box<dyn Explanation>>>,
}

impl Request {
    /// These plans, with what was typed.
    pub fn new(
        plans: Vec<Plan<'static>>,
        measuring: &Measuring,
        registry: &Registry,
    ) -> Result<Self, CliError> {
        let draws = match (&measuring.time, &measuring.allocation) {
            (Some(time), _) => Draws::Within(time.mul_f64(MEASURING)),
            (None, Some(path)) => Draws::Given(allocation(path, &plans)?),
            (None, None) => Draws::Planned,
        };
        Ok(Self {
            plans,
            out: measuring.out.clone(),
            keep: false,
            threads: measuring.threads.map(usize::from),
            format: measuring.format,
            plots: measuring.plots,
            strict: measuring.strict,
            baseline: measuring.baseline.clone(),
            changed_since: measuring.changed_since.clone(),
            draws,
            time_s: measuring.time.map(|time| time.as_secs_f64()),
            full: false,
            outputs: measuring.outputs.clone().with_page(),
            refused: 0,
            explanations: Arc::new(registry.explanations()),
        })
    }

    /// The folder of a plan's report: its own where there are several.
    pub fn folder(&self, plan: &Plan) -> Option<PathBuf> {
        match &self.out {
            Some(out) => Some(self.of_plan(out, plan)),
            None => self.keep.then(|| Path::new("reports").join(file_name(&plan.suite))),
        }
    }

    /// What belongs to a plan of a folder that was typed: it has one for each suite where
    /// there are several.
    pub fn of_plan(&self, typed: &Path, plan: &Plan) -> PathBuf {
        if self.plans.len() == 1 { typed.into() } else { typed.join(file_name(&plan.suite)) }
    }
}

/// The part of a budget of time that is for measuring; pictures and files take the rest.
const MEASURING: f64 = 0.9;

/// The draws of each case in an earlier run.
fn allocation(path: &Path, plans: &[Plan]) -> Result<Vec<u64>, CliError> {
    let (_, report) = read(path)?;
    let wrong = |message: &str, help: &str| CliError::Usage {
        message: format!("--allocation {}: {message}", path.display()),
        help: help.into(),
    };
    let cases: usize = plans.iter().map(|p| p.cases.len()).sum();
    match report.allocation {
        None => Err(wrong("that run had no budget of time", "name the report of a run with --time")),
        Some(_) if plans.len() > 1 => Err(wrong("it is of one suite", "run the suites one by one")),
        Some(allocation) if allocation.samples.len() != cases => Err(wrong(
            &format!("it has {} cases, and this plan {cases}", allocation.samples.len()),
            "run the same suite with the same options",
        )),
        Some(allocation) => Ok(allocation.samples),
    }
}

/// A suite's name as one part of a path.
pub fn file_name(suite: &str) -> String {
    suite.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { '-' }).collect()
}
