//! `gonio figures`.

use super::args::Voice;
use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use crate::lecture;
use crate::registry::nearest;
use crate::report::write_whole;
use std::path::PathBuf;

/// Arguments of `gonio figures`.
#[derive(Debug, clap::Args)]
#[command(after_help = after_help())]
pub struct FiguresArgs {
    /// Only these; all where none is named.
    #[arg(value_name = "NAME", value_parser = name)]
    pub names: Vec<String>,
    /// Where to.
    #[arg(short, long, value_name = "DIR", default_value = "figures")]
    pub out: PathBuf,
}

fn after_help() -> String {
    let rows = lecture::all().map(|f| format!("  {:30}{}", f.name, f.doc));
    format!("Figures:\n{}", rows.join("\n"))
}

fn name(text: &str) -> Result<String, String> {
    let all = lecture::all();
    if all.iter().any(|f| f.name == text) {
        return Ok(text.into());
    }
    let names = all.iter().map(|f| f.name);
    Err(match nearest(text, names.clone()) {
        Some(n) => format!("no figure is called so; did you mean `{n}`?"),
        None => format!("no figure is called so; there are {}", names.collect::<Vec<_>>().join(", ")),
    })
}

/// Draws the lecture's figures.
pub fn figures(args: &FiguresArgs, voice: Voice) -> Result<Exit, CliError> {
    for figure in lecture::all() {
        if !args.names.is_empty() && !args.names.iter().any(|n| n == figure.name) {
            continue;
        }
        let path = args.out.join(format!("{}.svg", figure.name));
        write_whole(&path, (figure.plot)().svg().as_bytes())?;
        if !voice.quiet {
            tell(&format!("{}  {}", path.display(), figure.doc));
        }
    }
    Ok(Exit::Passed)
}
