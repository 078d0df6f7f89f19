//! `gonio report`.

use super::args::{Plots, Voice};
use super::earlier::read;
use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use crate::comparison::compare;
use crate::report::{diagnoses, html, redraw};
use std::path::PathBuf;

/// Arguments of `gonio report`.
#[derive(Debug, clap::Args)]
pub struct ReportArgs {
    /// The folder of a report, or its report.json.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Which cases get a picture.
    #[arg(long, value_enum, default_value_t = Plots::All, value_name = "WHICH")]
    pub plots: Plots,
    /// An earlier report: the page tells what changed since.
    #[arg(long, value_name = "DIR")]
    pub baseline: Option<PathBuf>,
}

/// Draws the pictures of a saved report again, makes its page, and tells its diagnoses:
/// they were made with the subject at hand, which evidence is not.
pub fn report(args: &ReportArgs, voice: Voice) -> Result<Exit, CliError> {
    let (folder, mut report) = read(&args.folder)?;
    if let Some(before) = &args.baseline {
        let (_, before) = read(before)?;
        report.comparison = Some(compare(&before, &report));
    }
    let drawn = match args.plots.which() {
        Some(which) => redraw(&folder, &report, which)?,
        None => 0,
    };
    let page = html::write(&folder, &report)?;
    if !voice.quiet {
        tell(&format!("pictures of {drawn} cases drawn in {}", folder.display()));
        tell(&format!("page: {}", page.display()));
        if !report.diagnoses.is_empty() {
            tell(diagnoses(&report, voice.look()).trim_end());
        }
    }
    Ok(Exit::Passed)
}
