//! How far this machine can keep a program apart.

use super::settings::Sandbox;
use crate::plugins::process::in_path;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

/// How a program is kept apart from this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Isolation {
    /// In namespaces of its own: no network, no files but its own and the system's.
    Bubblewrap {
        /// Of bubblewrap.
        version: String,
        /// The program `bwrap`.
        program: PathBuf,
        /// Why the calls of the system are not watched, so that what it tries and does not
        /// get is not told; `None` if they are.
        unwatched: Option<String>,
    },
    /// With limits only: it can read what whoever runs gonio can read.
    Limits {
        /// Why not better.
        why: String,
    },
}

impl Isolation {
    /// Whether what a program tries is told.
    pub fn is_watched(&self) -> bool {
        matches!(self, Self::Bubblewrap { unwatched: None, .. })
    }
}

impl std::fmt::Display for Isolation {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Bubblewrap { version, unwatched: None, .. } => {
                write!(f, "bubblewrap {version}, with its calls of the system watched")
            }
            Self::Bubblewrap { version, unwatched: Some(why), .. } => {
                write!(f, "bubblewrap {version}; its calls of the system are not watched: {why}")
            }
            Self::Limits { why } => write!(f, "limits only: {why}"),
        }
    }
}

/// The best that this machine has, tried once. `GONIO_SANDBOX=limits` in the environment
/// forbids bubblewrap, `GONIO_SANDBOX=unwatched` the watching.
pub fn isolation() -> &'static Isolation {
    static FOUND: OnceLock<Isolation> = OnceLock::new();
    FOUND.get_or_init(|| match std::env::var("GONIO_SANDBOX").as_deref() {
        Ok("limits") => Isolation::Limits { why: "GONIO_SANDBOX=limits is set".into() },
        Ok("unwatched") => find(Some("GONIO_SANDBOX=unwatched is set".into())),
        _ => find(None),
    })
}

fn find(unwatched: Option<String>) -> Isolation {
    let limits = |why: String| Isolation::Limits { why };
    let Some(program) = in_path("bwrap") else {
        return limits("bubblewrap is not installed (`apt-get install bubblewrap`)".into());
    };
    let version = Command::new(&program).arg("--version").output().unwrap_or_else(|_| empty());
    let version = String::from_utf8_lossy(&version.stdout).trim().replace("bubblewrap ", "");
    let with =
        |unwatched| Isolation::Bubblewrap { version: version.clone(), program: program.clone(), unwatched };
    let tried = |isolation: &Isolation| Sandbox::with("/usr", isolation.clone()).works();
    let mut isolation = with(unwatched.clone());
    let mut works = tried(&isolation);
    if let (None, Err(why)) | (None, Ok(why)) = (&unwatched, &works)
        && !why.is_empty()
    {
        isolation = with(Some(why.clone()));
        works = tried(&isolation);
    }
    match works {
        Ok(_) => isolation,
        Err(why) => limits(format!("bubblewrap {version} does not work here: {why}")),
    }
}

/// What a program that cannot be started has said.
fn empty() -> std::process::Output {
    std::process::Output { status: Default::default(), stdout: Vec::new(), stderr: Vec::new() }
}
