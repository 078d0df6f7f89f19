//! Published renderers as clients: their known verdicts (docs/field-notes.md) still hold.
//! What they need is installed by the tests; if it cannot be, they fail.

mod common;

use common::tools::tools;
use std::path::Path;
use std::process::Command;

fn clients() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/clients")
}

fn holds(command: &mut Command) {
    let done = command.env("CARGO_TARGET_DIR", &tools().target).output().unwrap();
    let told = [&done.stdout[..], &done.stderr].map(String::from_utf8_lossy).concat();
    assert!(done.status.success(), "{command:?}: {}\n{told}", done.status);
}

#[test]
fn mitsuba_and_radiance() {
    holds(Command::new(clients().join("run")).args(["--test", "--gonio", env!("CARGO_BIN_EXE_gonio")]));
}

#[test]
fn crates_of_the_registry() {
    let cargo = option_env!("CARGO").unwrap_or("cargo");
    let known = ["test", "--release", "--locked", "--test", "known"];
    holds(Command::new(cargo).args(known).current_dir(clients().join("crates")));
}
