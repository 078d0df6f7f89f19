//! `gonio diff`.

use super::args::{Format, Voice};
use super::earlier::read;
use super::error::CliError;
use super::exit::Exit;
use super::output::{emit, tell};
use crate::comparison::compare;
use crate::report::comparison;
use std::path::PathBuf;

/// Arguments of `gonio diff`.
#[derive(Debug, clap::Args)]
pub struct DiffArgs {
    /// The earlier report: its folder or its report.json.
    #[arg(value_name = "BEFORE")]
    pub before: PathBuf,
    /// The later report.
    #[arg(value_name = "AFTER")]
    pub after: PathBuf,
    /// What comes out.
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// Let what is less sure count as worse.
    #[arg(long)]
    pub strict: bool,
}

/// Tells what changed from one report to another; 1 if something got worse.
pub fn diff(args: &DiffArgs, voice: Voice) -> Result<Exit, CliError> {
    let ((_, before), (_, after)) = (read(&args.before)?, read(&args.after)?);
    let found = compare(&before, &after);
    if !voice.quiet {
        tell(comparison(&found, voice.look()).trim());
    }
    if args.format == Format::Json {
        let text = serde_json::to_string(&found).map_err(|e| CliError::Internal(e.to_string()))?;
        emit(&(text + "\n"))?;
    }
    Ok(Exit::of_comparison(&found, args.strict))
}
