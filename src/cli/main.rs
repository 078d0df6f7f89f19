//! Arguments to exit code.

use super::args::{Args, Command};
use super::error::CliError;
use super::execute::execute;
use super::exit::Exit;
use super::output::tell;
use super::{calibrate, completions, diff, explain, figures, grade, list, new, report, schema, worker};
use crate::plugins::set_gonio;
use crate::registry::Registry;
use clap::Parser;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

/// The command line over these models: all of `main` that a program of one's
/// own needs.
///
/// ```no_run
/// fn main() -> std::process::ExitCode {
///     gonio::main(gonio::registry::Registry::builtin())
/// }
/// ```
pub fn main(registry: Registry) -> ExitCode {
    keep_memory();
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(e) => {
            let _ = e.print();
            return if e.exit_code() == 0 { Exit::Passed.into() } else { Exit::Usage.into() };
        }
    };
    let voice = args.voice;
    if let Ok(path) = std::env::current_exe() {
        set_gonio(path);
    }
    let done = catch_unwind(AssertUnwindSafe(|| obey(args, &registry)));
    let done = done.unwrap_or_else(|_| Err(CliError::Internal("a panic, as told above".into())));
    match done {
        Ok(exit) => exit.into(),
        Err(e) => {
            tell(voice.error_page(&e).trim_end());
            e.exit().into()
        }
    }
}

/// Each case asks for the same large buffers again: they are kept, where glibc would give
/// them back to the system, and take a fault for each page. That is a twentieth of a short
/// process.
fn keep_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        const MIB: i32 = 1 << 20;
        // The most that it takes for the second is half of a thread's heap.
        let wishes = [
            (libc::M_TRIM_THRESHOLD, 1024 * MIB),
            (libc::M_MMAP_THRESHOLD, 32 * MIB),
            (libc::M_TOP_PAD, MIB),
        ];
        for (parameter, value) in wishes {
            // SAFETY: it takes any two numbers, and refuses what it does not know.
            #[expect(unsafe_code, reason = "libc has no safe form of it")]
            unsafe {
                libc::mallopt(parameter, value)
            };
        }
    }
}

fn obey(args: Args, registry: &Registry) -> Result<Exit, CliError> {
    let voice = args.voice;
    match args.command {
        Command::Run(args) => execute(&args.request(registry)?, voice),
        Command::Check(args) => execute(&args.request(registry)?, voice),
        Command::List(args) => list::list(&args, registry),
        Command::Explain(args) => explain::explain(&args),
        Command::Report(args) => report::report(&args, voice),
        Command::Diff(args) => diff::diff(&args, voice),
        Command::Grade(args) => grade::grade(&args, registry, voice),
        Command::Figures(args) => figures::figures(&args, voice),
        Command::New(args) => new::new(&args, voice),
        Command::Calibrate(args) => calibrate::calibrate(&args, voice),
        Command::Schema(args) => schema::schema(&args),
        Command::Completions(args) => completions::completions(&args),
        Command::Worker(args) => worker::work(&args),
    }
}
