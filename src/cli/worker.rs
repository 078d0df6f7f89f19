//! `gonio worker`: the processes that plugins run in.

use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use crate::plugins;
use clap::Subcommand;
use std::ffi::OsString;
use std::path::PathBuf;

/// Arguments of `gonio worker`.
#[derive(Debug, clap::Args)]
pub struct WorkerArgs {
    #[command(subcommand)]
    work: Work,
}

#[derive(Debug, Subcommand)]
enum Work {
    /// Run a command, and see to it that nothing of it is left behind.
    Supervise {
        /// Bytes of address space.
        #[arg(long)]
        memory: u64,
        /// The command.
        #[arg(last = true, required = true)]
        command: Vec<OsString>,
    },
    /// Answer for a shared library on standard input and output.
    Library {
        /// The library.
        path: PathBuf,
    },
}

/// Does the work. Supervision ends this process as its command ended.
pub fn work(args: &WorkerArgs) -> Result<Exit, CliError> {
    match &args.work {
        Work::Supervise { memory, command } => std::process::exit(plugins::supervise(command, *memory)),
        Work::Library { path } => {
            // The last words of a plugin, which gonio shows.
            let Err(e) = plugins::work(path) else { return Ok(Exit::Passed) };
            tell(&e.to_string());
            Ok(Exit::Subject)
        }
    }
}
