//! The built programs in a folder of their own, as people and scripts use them.

use assert_cmd::Command;
use gonio::report::read_evidence;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::sync::OnceLock;
use std::time::Duration;
use tempfile::TempDir;

pub const GONIO: &str = env!("CARGO_BIN_EXE_gonio");

/// The example: cargo builds examples for `cargo test`, but not for
/// `cargo test --test command_line`.
pub fn own_command() -> &'static str {
    static PATH: OnceLock<String> = OnceLock::new();
    PATH.get_or_init(|| {
        let mut cargo = std::process::Command::new(env!("CARGO"));
        cargo.args(["build", "--quiet", "--example", "own_command", "--message-format=json"]);
        if !cfg!(debug_assertions) {
            cargo.arg("--release");
        }
        let built = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("cargo runs");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let lines = String::from_utf8(built.stdout).unwrap();
        let mut artifacts = lines.lines().filter_map(|l| serde_json::from_str::<Value>(l).ok());
        let example = artifacts.rfind(|a| a["target"]["name"] == "own_command");
        example.expect("an artifact")["executable"].as_str().expect("a path").to_string()
    })
}

/// What a program did.
pub struct Done {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Done {
    pub fn says(&self, part: &str) -> &Self {
        let (out, err) = (&self.out, &self.err);
        assert!(err.contains(part), "no `{part}` in stderr:\n{err}\nstdout:\n{out}");
        self
    }

    pub fn ends(&self, code: i32) -> &Self {
        assert_eq!(self.code, code, "stderr:\n{}\nstdout:\n{}", self.err, self.out);
        self
    }
}

/// A folder of its own for each test, in which programs run.
pub struct Desk(TempDir);

impl Desk {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) -> &Self {
        std::fs::write(self.path(name), text).unwrap();
        self
    }

    pub fn command(&self, program: &str, line: &str) -> Command {
        let mut command = Command::new(program);
        command.current_dir(self.0.path()).args(line.split_whitespace());
        command.env_remove("NO_COLOR").env_remove("RAYON_NUM_THREADS").env_remove("COLUMNS");
        command.timeout(Duration::from_secs(120));
        command
    }

    pub fn gonio(&self, line: &str) -> Done {
        done(&mut self.command(GONIO, line))
    }

    pub fn own(&self, line: &str) -> Done {
        done(&mut self.command(own_command(), line))
    }

    pub fn spawn(&self, program: &str, line: &str) -> Child {
        let mut command = std::process::Command::new(program);
        command.current_dir(self.0.path()).args(line.split_whitespace());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    pub fn report(&self, folder: &str) -> Value {
        let text = std::fs::read_to_string(self.path(folder).join("report.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    }

    /// The files below a folder, by their path from there. What a running
    /// program removes or renames meanwhile is not among them.
    pub fn files(&self, folder: &str) -> BTreeMap<String, Vec<u8>> {
        let mut found = BTreeMap::new();
        let Ok(entries) = std::fs::read_dir(self.path(folder)) else { return found };
        for entry in entries {
            let entry = entry.unwrap();
            let name = entry.file_name().to_str().unwrap().to_string();
            if entry.path().is_dir() {
                let below = self.files(&format!("{folder}/{name}"));
                found.extend(below.into_iter().map(|(k, v)| (format!("{name}/{k}"), v)));
            } else {
                match std::fs::read(entry.path()) {
                    Ok(bytes) => _ = found.insert(name, bytes),
                    Err(gone) if gone.kind() == std::io::ErrorKind::NotFound => {}
                    Err(wrong) => panic!("{}: {wrong}", entry.path().display()),
                }
            }
        }
        found
    }

    /// How many whole files of evidence there are; a torn one fails the test.
    pub fn whole_evidence(&self, folder: &str) -> usize {
        let names = self.files(folder).into_keys().filter(|n| n.starts_with("case-"));
        let all: Vec<_> =
            names.map(|n| read_evidence(&self.path(folder).join(n)).expect("whole evidence")).collect();
        all.len()
    }
}

pub fn done(command: &mut Command) -> Done {
    finished(command.output().unwrap())
}

pub fn finished(output: std::process::Output) -> Done {
    Done {
        code: output.status.code().unwrap_or(-1),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}
