//! `gonio explain`.

use super::args::unknown;
use super::error::CliError;
use super::exit::Exit;
use super::list::table;
use super::output::emit;
use crate::cause::Cause;

/// Arguments of `gonio explain`.
#[derive(Debug, clap::Args)]
pub struct ExplainArgs {
    /// A cause, as mutants and diagnoses name it; all are listed if left out.
    #[arg(value_name = "SLUG", value_parser = cause)]
    pub cause: Option<Cause>,
}

/// Prints the page of a cause, or what each cause is.
pub fn explain(args: &ExplainArgs) -> Result<Exit, CliError> {
    match args.cause {
        Some(cause) => emit(cause.page())?,
        None => emit(&statements())?,
    }
    Ok(Exit::Passed)
}

fn statements() -> String {
    let rows = Cause::ALL.map(|c| vec![c.slug().to_string(), c.statement().to_string()]);
    table(&["cause", "what is wrong"], rows.to_vec())
}

fn cause(text: &str) -> Result<Cause, String> {
    let found = Cause::ALL.into_iter().find(|c| c.slug() == text);
    found.ok_or_else(|| unknown("cause", text, Cause::ALL.iter().map(|c| c.slug())))
}
