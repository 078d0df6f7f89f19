//! `gonio schema`.

use super::error::CliError;
use super::exit::Exit;
use super::output::emit;
use crate::report::Report;

/// Arguments of `gonio schema`.
#[derive(Debug, clap::Args)]
pub struct SchemaArgs {}

/// Prints the JSON Schema of report.json.
pub fn schema(_: &SchemaArgs) -> Result<Exit, CliError> {
    let schema = schemars::schema_for!(Report);
    let text = serde_json::to_string_pretty(&schema).map_err(|e| CliError::Internal(e.to_string()))?;
    emit(&format!("{text}\n"))?;
    Ok(Exit::Passed)
}
