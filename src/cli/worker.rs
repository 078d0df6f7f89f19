//! `gonio worker`: the processes that plugins run in.

use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use crate::plugins::{self, Rules};
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
    /// Run a command in a sandbox, count what it takes and tell what it tries.
    Guard {
        /// What holds in it (JSON).
        #[arg(long, value_parser = rules)]
        rules: Rules,
        /// The file that incidents are appended to.
        #[arg(long)]
        log: Option<PathBuf>,
        /// The program of bubblewrap, if it is used.
        #[arg(long)]
        bubblewrap: Option<PathBuf>,
        /// The arguments of bubblewrap, `--`, and the command.
        #[arg(last = true, required = true)]
        words: Vec<OsString>,
    },
    /// Confine this process and become a command.
    Confine {
        /// What holds in its sandbox (JSON).
        #[arg(long, value_parser = rules)]
        rules: Rules,
        /// The command.
        #[arg(last = true, required = true)]
        words: Vec<OsString>,
    },
    /// Answer for a shared library on standard input and output.
    Library {
        /// The library.
        path: PathBuf,
    },
}

fn rules(text: &str) -> Result<Rules, String> {
    serde_json::from_str(text).map_err(|e| e.to_string())
}

/// Does the work. Supervision ends this process as its command ended.
pub fn work(args: &WorkerArgs) -> Result<Exit, CliError> {
    match &args.work {
        Work::Supervise { memory, command } => std::process::exit(plugins::supervise(command, *memory)),
        Work::Guard { rules, log, bubblewrap, words } => {
            std::process::exit(plugins::guard(rules, log.as_deref(), bubblewrap.as_deref(), words))
        }
        Work::Confine { rules, words } => std::process::exit(plugins::confine(rules, words)),
        Work::Library { path } => {
            // The last words of a plugin, which gonio shows.
            let Err(e) = plugins::work(path) else { return Ok(Exit::Passed) };
            tell(&e.to_string());
            Ok(Exit::Subject)
        }
    }
}
