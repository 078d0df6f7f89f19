//! How a plugin's process is started.

use crate::plugins::limits::Limits;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

static GONIO: OnceLock<PathBuf> = OnceLock::new();

/// Says that this very program answers `gonio worker`: whoever calls
/// [`gonio::main`](crate::main) does.
pub fn set_gonio(path: PathBuf) {
    let _ = GONIO.set(path);
}

/// The program that supervises plugins and loads libraries: this one, or the
/// `gonio` that is installed.
fn gonio() -> Result<PathBuf, String> {
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
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Launch {
    /// A command.
    Command(Vec<OsString>),
    /// gonio's own worker for this shared library.
    Library(PathBuf),
}

impl Launch {
    /// Starts it under supervision, with pipes for all three streams.
    pub fn start(&self, limits: &Limits) -> Result<Child, String> {
        let gonio = gonio()?;
        let mut command = Command::new(&gonio);
        command.args(["worker", "supervise", "--memory", &limits.memory.to_string(), "--"]);
        match self {
            Self::Command(words) => command.args(words),
            Self::Library(path) => command.arg(&gonio).args(["worker", "library"]).arg(path),
        };
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| format!("`{}` cannot be started: {e}", gonio.display()))
    }
}
