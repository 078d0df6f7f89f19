//! `gonio schema`.

use super::error::CliError;
use super::exit::Exit;
use super::output::emit;
use crate::{grading, report};
use clap::ValueEnum;

/// Arguments of `gonio schema`.
#[derive(Debug, clap::Args)]
pub struct SchemaArgs {
    /// Of which file.
    #[arg(value_enum, default_value_t)]
    pub of: Of,
}

/// A file that there is a schema of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Of {
    /// report.json.
    #[default]
    Report,
    /// grade.json.
    Grade,
}

/// Prints the JSON Schema of report.json, or of grade.json.
pub fn schema(args: &SchemaArgs) -> Result<Exit, CliError> {
    emit(&match args.of {
        Of::Report => report::schema_text(),
        Of::Grade => grading::schema_text(),
    })?;
    Ok(Exit::Passed)
}
