//! `gonio report`.

use super::args::{Plots, Voice};
use super::earlier::read;
use super::error::CliError;
use super::exit::Exit;
use super::formats::{Destination, Outputs};
use super::output::tell;
use crate::comparison::compare;
use crate::report::{diagnoses, redraw};
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
    /// An earlier report: what changed since is told.
    #[arg(long, value_name = "REPORT")]
    pub baseline: Option<PathBuf>,
    /// What to write, in place of pictures and diagnoses.
    #[command(flatten)]
    pub outputs: Outputs,
    /// Where to write that; beside the report if left out.
    #[arg(short, long, value_name = "DIR", requires = "to")]
    pub out: Option<PathBuf>,
}

/// Draws the pictures of a saved report again, and tells its diagnoses: they were made
/// with the subject at hand, which evidence is not. Or writes formats.
pub fn report(args: &ReportArgs, voice: Voice) -> Result<Exit, CliError> {
    let (folder, mut report) = read(&args.folder)?;
    if let Some(before) = &args.baseline {
        let (_, before) = read(before)?;
        report.comparison = Some(compare(&before, &report));
    }
    if !args.outputs.to.is_empty() {
        let out = args.out.as_deref().unwrap_or(&folder);
        let to = Destination { report: &folder, out, stdout_is_taken: false };
        for path in args.outputs.write(&report, to)?.iter().filter(|_| !voice.quiet) {
            tell(&format!("written: {}", path.display()));
        }
        return Ok(Exit::Passed);
    }
    let drawn = match args.plots.which() {
        Some(which) => redraw(&folder, &mut report, which)?,
        None => 0,
    };
    if !voice.quiet {
        tell(&format!("pictures of {drawn} cases drawn in {}", folder.display()));
        if !report.diagnoses.is_empty() {
            tell(diagnoses(&report, voice.look()).trim_end());
        }
    }
    Ok(Exit::Passed)
}
