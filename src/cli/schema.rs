//! `gonio schema`.

use super::error::CliError;
use super::exit::Exit;
use super::output::emit;
use crate::report::schema_text;

/// Arguments of `gonio schema`.
#[derive(Debug, clap::Args)]
pub struct SchemaArgs {}

/// Prints the JSON Schema of report.json.
pub fn schema(_: &SchemaArgs) -> Result<Exit, CliError> {
    emit(&schema_text())?;
    Ok(Exit::Passed)
}
