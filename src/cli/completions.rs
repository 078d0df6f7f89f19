//! `gonio completions`.

use super::args::Args;
use super::error::CliError;
use super::exit::Exit;
use super::output::emit;
use clap::CommandFactory;

/// Arguments of `gonio completions`.
#[derive(Debug, clap::Args)]
pub struct CompletionsArgs {
    /// For which shell.
    pub shell: clap_complete::Shell,
}

/// Prints the completions.
pub fn completions(args: &CompletionsArgs) -> Result<Exit, CliError> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Args::command(), "gonio", &mut text);
    emit(&String::from_utf8_lossy(&text))?;
    Ok(Exit::Passed)
}
