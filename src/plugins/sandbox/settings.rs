//! A sandbox as it is asked for.

use super::incident::{Log, Phase};
use super::isolation::{Isolation, isolation};
use super::rules::Rules;
use super::{fold, mounts, programs};
use crate::plugins::limits::Limits;
use crate::plugins::process::{Program, gonio};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// What all processes of a sandbox may take together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Of processor time while it is built; `None` for as much as it likes.
    pub processor: Option<Duration>,
    /// Of the clock while it is built.
    pub clock: Option<Duration>,
    /// Of processor time of one instance while it runs. gonio limits each of its calls
    /// anyway; this is for what goes on between them.
    pub run: Option<Duration>,
    /// Bytes of memory while it is built; while it runs, those of [`Limits`].
    pub memory: u64,
    /// Processes at a time.
    pub processes: u64,
    /// Bytes of files, which are in memory.
    pub disk: u64,
    /// Bytes of messages while it is built.
    pub output: u64,
}

impl Default for Allowance {
    /// As docs/grading.md says.
    fn default() -> Self {
        let minute = Some(Duration::from_secs(60));
        Self {
            processor: minute,
            clock: minute,
            run: None,
            memory: Limits::default().memory,
            processes: 64,
            disk: 256 << 20,
            output: 1 << 20,
        }
    }
}

/// Where an untrusted program is built, or runs: it sees a folder at /work, /usr, and an
/// empty /tmp.
#[derive(Clone, Debug)]
pub struct Sandbox {
    /// What is at /work: read-only where it runs, a copy where it is built.
    pub folder: PathBuf,
    /// Folders that it may read beside /usr; `~` is the home folder. Missing ones are left
    /// out.
    pub read: Vec<PathBuf>,
    /// Files and folders that it must not see, wherever they are.
    pub hidden: Vec<PathBuf>,
    /// What it may take.
    pub allowance: Allowance,
    /// A file that incidents are appended to.
    pub log: Option<PathBuf>,
    /// How it is kept apart.
    pub isolation: Isolation,
}

impl Sandbox {
    /// For this folder, with the usual allowance, as well apart as this machine can.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self::with(folder, isolation().clone())
    }

    pub(super) fn with(folder: impl Into<PathBuf>, isolation: Isolation) -> Self {
        Self {
            folder: folder.into(),
            read: Vec::new(),
            hidden: Vec::new(),
            allowance: Allowance::default(),
            log: None,
            isolation,
        }
    }

    /// gonio's command that starts `program` inside.
    pub fn command(&self, program: &Program, limits: &Limits) -> Result<Command, String> {
        let (words, library, mounts) = match program {
            Program::Command(words) => {
                let found = programs::find(words, &self.readable())?;
                (found.words, false, found.mounts)
            }
            Program::Library(path) => (vec![self.inside(path)?.into()], true, Vec::new()),
        };
        self.guarded(Phase::Run, limits.memory, library, &words, mounts)
    }

    /// The same for the shell that builds.
    pub(super) fn shell(&self, words: &[OsString]) -> Result<Command, String> {
        self.guarded(Phase::Build, self.allowance.memory, false, words, Vec::new())
    }

    fn guarded(
        &self,
        phase: Phase,
        memory: u64,
        library: bool,
        words: &[OsString],
        mounts: Vec<PathBuf>,
    ) -> Result<Command, String> {
        let gonio = gonio()?;
        let folder = self.folder.canonicalize().map_err(|e| {
            format!("the folder `{}` of the sandbox cannot be read: {e}", self.folder.display())
        })?;
        let open: Vec<PathBuf> = self.readable().into_iter().chain(mounts).collect();
        let (processor, clock) = match phase {
            Phase::Build => (self.allowance.processor, self.allowance.clock),
            Phase::Run => (self.allowance.run, None),
        };
        let rules = Rules {
            phase,
            library,
            watched: self.isolation.is_watched(),
            memory,
            processor: processor.map(|t| t.as_secs().max(1)),
            clock: clock.map(|t| t.as_secs_f64()),
            processes: self.allowance.processes,
            disk: self.allowance.disk,
            work: mounts::work(&open).into(),
            open: open.iter().map(|path| path.to_string_lossy().into_owned()).collect(),
            named: open.iter().flat_map(|folder| programs::named_by(folder)).collect(),
        };
        let rules = serde_json::to_string(&rules).map_err(|e| e.to_string())?;
        let mut command = Command::new(&gonio);
        command.args(["worker", "guard", "--rules", &rules]);
        if let Some(log) = &self.log {
            command.arg("--log").arg(log);
        }
        let mut confined: Vec<OsString> =
            ["worker", "confine", "--rules", &rules, "--"].iter().map(OsString::from).collect();
        confined.extend_from_slice(words);
        match &self.isolation {
            Isolation::Bubblewrap { program, .. } => {
                let arguments = mounts::arguments(&mounts::Wanted {
                    folder: &folder,
                    build: phase == Phase::Build,
                    open: &open,
                    path: &programs::path(&self.readable()),
                    hidden: &self.hidden,
                    disk: self.allowance.disk,
                    gonio: &gonio,
                });
                command.arg("--bubblewrap").arg(program).arg("--");
                command.args(arguments).arg("--").arg(mounts::GONIO).args(confined);
            }
            Isolation::Limits { .. } => {
                command.arg("--").arg("--").arg(&gonio).args(confined);
                command.current_dir(&folder);
            }
        }
        Ok(command)
    }

    /// Where the sandbox has this file of its folder.
    fn inside(&self, path: &Path) -> Result<PathBuf, String> {
        let real = |path: &Path| {
            path.canonicalize().map_err(|e| format!("`{}` cannot be read: {e}", path.display()))
        };
        let (path, folder) = (real(path)?, real(&self.folder)?);
        if let Isolation::Limits { .. } = self.isolation {
            return Ok(path);
        }
        match path.strip_prefix(&folder) {
            Ok(rest) => Ok(Path::new(self.work()).join(rest)),
            Err(_) => Err(format!(
                "`{}` is not in the folder `{}` that the sandbox shows",
                path.display(),
                folder.display()
            )),
        }
    }

    /// The folders of `read` that exist.
    fn readable(&self) -> Vec<PathBuf> {
        let home = std::env::home_dir();
        let expanded = self.read.iter().map(|path| match (path.strip_prefix("~"), &home) {
            (Ok(rest), Some(home)) => home.join(rest),
            _ => path.clone(),
        });
        expanded.filter_map(|path| path.canonicalize().ok()).collect()
    }

    /// Where it has its folder while it is built.
    pub(super) fn work(&self) -> &'static str {
        mounts::work(&self.readable())
    }

    /// Writes down that something was tried, seen from outside.
    pub(super) fn note(&self, phase: Phase, what: &str) {
        let mut log = Log::new(self.log.as_deref(), phase);
        log.note(what);
        log.flush();
    }

    /// Whether `true` runs in it, and what it says if not.
    pub(super) fn works(&self) -> Result<String, String> {
        let started = self.guarded(Phase::Run, 1 << 30, false, &[OsString::from("true")], Vec::new());
        let done = started?
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .output()
            .map_err(|e| format!("it cannot be started: {e}"))?;
        let said = fold::folded(&done.stderr, 500);
        if done.status.success() { Ok(said) } else { Err(said) }
    }
}

/// Words as they are.
pub(super) fn words<'a>(all: impl IntoIterator<Item = &'a OsStr>) -> Vec<OsString> {
    all.into_iter().map(OsStr::to_os_string).collect()
}
