//! `gonio report`.

use super::args::{Plots, Voice};
use super::earlier::read;
use super::error::CliError;
use super::exit::Exit;
use super::formats::{Destination, Outputs};
use super::output::tell;
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
    /// What to write, in place of pictures and diagnoses.
    #[command(flatten)]
    pub outputs: Outputs,
    /// Where to write that; beside the report if left out.
    #[arg(short, long, value_name = "DIR", requires = "to")]
    pub out: Option<PathBuf>,
}

/// Draws the pictures of a saved report again, and tells its diagnoses: they were
/// made with the subject at hand, which evidence is not. Or writes other formats.
pub fn report(args: &ReportArgs, voice: Voice) -> Result<Exit, CliError> {
    let (folder, mut report) = read(&args.folder)?;
    if !args.outputs.to.is_empty() {
        let out = args.out.as_deref().unwrap_or(&folder);
        let to = Destination { report: &folder, out, stdout_is_taken: false, quiet: voice.quiet };
        args.outputs.write(&report, to)?;
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
