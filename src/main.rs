//! The `gonio` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    gonio::main(gonio::registry::Registry::builtin())
}
