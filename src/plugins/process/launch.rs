//! How a plugin's process is started.

use crate::plugins::limits::Limits;
use crate::plugins::sandbox::Sandbox;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, OnceLock};

static GONIO: OnceLock<PathBuf> = OnceLock::new();

/// Says that this very program answers `gonio worker`: whoever calls
/// [`gonio::main`](crate::main) does.
pub fn set_gonio(path: PathBuf) {
    let _ = GONIO.set(path);
}

/// The program that supervises plugins and loads libraries: this one, or the
/// `gonio` that is installed.
pub fn gonio() -> Result<PathBuf, String> {
    if let Some(path) = GONIO.get() {
        return Ok(path.clone());
    }
    in_path("gonio").ok_or_else(|| {
        "a plugin runs under the `gonio` command, which is not in PATH; `cargo install gonio` puts it there"
            .into()
    })
}

/// Where PATH has this program.
pub fn in_path(program: &str) -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths).map(|folder| folder.join(program)).find(|path| path.is_file())
}

/// What is started.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Program {
    /// A command.
    Command(Vec<OsString>),
    /// gonio's own worker for this shared library.
    Library(PathBuf),
}

/// How a plugin's process is started.
#[derive(Clone, Debug)]
pub struct Launch {
    /// What is started.
    pub program: Program,
    /// In which sandbox, if in one.
    pub sandbox: Option<Arc<Sandbox>>,
}

impl Launch {
    /// Starts it under supervision, with pipes for all three streams.
    pub fn start(&self, limits: &Limits) -> Result<Child, String> {
        let mut command = match &self.sandbox {
            Some(sandbox) => sandbox.command(&self.program, limits)?,
            None => self.supervised(limits)?,
        };
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| format!("`{}` cannot be started: {e}", command.get_program().to_string_lossy()))
    }

    fn supervised(&self, limits: &Limits) -> Result<Command, String> {
        let gonio = gonio()?;
        let mut command = Command::new(&gonio);
        command.args(["worker", "supervise", "--memory", &limits.memory.to_string(), "--"]);
        match &self.program {
            Program::Command(words) => command.args(words),
            Program::Library(path) => command.arg(&gonio).args(["worker", "library"]).arg(path),
        };
        Ok(command)
    }
}
