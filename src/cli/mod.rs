//! The command line: one file per subcommand. Nothing else in gonio knows of it.

mod args;
mod calibrate;
mod check;
mod completions;
mod diff;
mod earlier;
mod error;
mod execute;
mod exit;
mod explain;
mod figures;
mod formats;
mod grade;
mod interrupt;
mod list;
mod main;
mod new;
mod output;
mod progress;
mod report;
mod request;
mod run;
mod schema;
mod worker;

pub use args::Args;
pub use exit::Exit;
pub use main::main;
