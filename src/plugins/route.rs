//! How a plugin is reached, by what it is.

use super::instance::{Fault, Instance};
use super::library::Loaded;
use super::limits::Limits;
use super::process::{Child, Launch, Program};
use super::sandbox::Sandbox;
use super::wasm::Module;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How a plugin is reached.
#[derive(Clone)]
pub enum Route {
    /// A process.
    Process(Launch),
    /// A library in this process.
    InProcess(Loaded),
    /// A WebAssembly module, in its sandbox.
    Wasm(Module),
}

/// What a text names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Named {
    /// A program with its arguments.
    Command(Vec<OsString>),
    /// A shared library.
    Library(PathBuf),
    /// A WebAssembly module.
    Wasm(PathBuf),
}

impl Named {
    /// What `text` names: a file by its name's ending or its permissions, or
    /// a command with arguments. `None` if it is none of these.
    pub fn of(text: &str) -> Option<Self> {
        let path = Path::new(text);
        if path.is_file() {
            let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            return match ending.as_str() {
                "so" | "dylib" | "dll" => Some(Self::Library(path.into())),
                // A version may follow: libbrdf.so.1
                _ if name.contains(".so.") => Some(Self::Library(path.into())),
                "wasm" => Some(Self::Wasm(path.into())),
                "py" => Some(Self::Command(vec!["python3".into(), path.into()])),
                _ => is_program(path).then(|| {
                    // A bare name would be looked for in PATH.
                    let here = path.components().count() == 1;
                    Self::Command(vec![if here { Path::new(".").join(path).into() } else { path.into() }])
                }),
            };
        }
        if !text.contains(char::is_whitespace) {
            return None;
        }
        let words = shell_words::split(text).ok()?;
        (!words.is_empty()).then(|| Self::Command(words.into_iter().map(OsString::from).collect()))
    }

    /// The files that it is made of, as far as they are named: of a command, its words that
    /// are files, and the program.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Library(path) | Self::Wasm(path) => vec![path.clone()],
            Self::Command(words) => words.iter().map(PathBuf::from).filter(|path| path.is_file()).collect(),
        }
    }

    /// The way there, into a sandbox if there is one. WebAssembly has its own.
    pub fn route(&self, limits: &Limits, sandbox: Option<&Arc<Sandbox>>) -> Result<Route, Fault> {
        let process = |program| Route::Process(Launch { program, sandbox: sandbox.cloned() });
        Ok(match self {
            Self::Command(words) => process(Program::Command(words.clone())),
            Self::Library(path) if limits.in_process && sandbox.is_none() => {
                Route::InProcess(Loaded::open(path)?)
            }
            Self::Library(path) => process(Program::Library(path.clone())),
            Self::Wasm(path) => {
                Route::Wasm(Module::open(path, limits).map_err(|e| Fault::Ended(e.to_string()))?)
            }
        })
    }
}

/// Whether a file may be run.
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    path.metadata().is_ok_and(|m| m.permissions().mode() & 0o111 != 0)
}

impl Route {
    /// Starts an instance.
    pub fn start(&self, limits: &Limits) -> Result<Box<dyn Instance>, Fault> {
        Ok(match self {
            Self::Process(launch) => Box::new(Child::start(launch, limits)?),
            Self::InProcess(loaded) => Box::new(loaded.clone()),
            Self::Wasm(module) => module.start()?,
        })
    }
}
