//! Building in a sandbox: a copy of the sources, a shell, and one file that comes out.

use super::fold::folded;
use super::guard::{ENDED, VOICE};
use super::incident::Phase;
use super::isolation::Isolation;
use super::mounts::SOURCE;
use super::settings::{Sandbox, words};
use std::ffi::OsStr;
use std::io::Read;
use std::os::unix::process::ExitStatusExt;
use std::path::{Component, Path};
use std::process::{ChildStdout, ExitStatus, Stdio};

/// Copies, builds, and hands out what was made. It must be a file: a link could name
/// anything, and a device has no end.
const SCRIPT: &str = r#"
cp -R "$1"/. "$2" || exit 212
cd "$2" || exit 212
sh -c "$3" >&2 || exit $?
[ -e "$4" ] || [ -L "$4" ] || exit 213
[ -f "$4" ] && [ ! -L "$4" ] || exit 214
exec cat -- "$4"
"#;
const NOT_COPIED: i32 = 212;
const NOT_MADE: i32 = 213;
const NO_FILE: i32 = 214;

/// Bytes of what is told of a failure.
const SAID: usize = 8000;

/// Why something was not built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{why}")]
pub struct BuildFailure {
    /// In one sentence.
    pub why: String,
    /// What the compiler said: its beginning and its end.
    pub said: String,
}

impl Sandbox {
    /// Builds a copy of the folder with the shell line `script`, and gives the file
    /// `makes`, a path from the folder.
    ///
    /// # Errors
    /// Where that fails, takes too much, or makes no file.
    pub fn build(&self, script: &str, makes: &str) -> Result<Vec<u8>, BuildFailure> {
        let failed = |why: String| BuildFailure { why, said: String::new() };
        let inside = Path::new(makes).components().all(|part| matches!(part, Component::Normal(_)));
        if !inside || makes.is_empty() {
            return Err(failed(format!("`{makes}` is no path from the folder that is built")));
        }
        // Without bubblewrap the copy is on the disk, for as long as this takes.
        let (source, copy, sandbox);
        let (from, to, within) = match &self.isolation {
            Isolation::Bubblewrap { .. } => (OsStr::new(SOURCE), OsStr::new(self.work()), self),
            Isolation::Limits { .. } => {
                copy = tempfile::tempdir().map_err(|e| failed(format!("no temporary folder: {e}")))?;
                source = self
                    .folder
                    .canonicalize()
                    .map_err(|e| failed(format!("`{}` cannot be read: {e}", self.folder.display())))?;
                sandbox = Self { folder: copy.path().into(), ..self.clone() };
                (source.as_os_str(), copy.path().as_os_str(), &sandbox)
            }
        };
        let shell = ["/bin/sh", "-c", SCRIPT, "build"].map(OsStr::new);
        let shell = shell.into_iter().chain([from, to, OsStr::new(script), OsStr::new(makes)]);
        let mut command = within.shell(&words(shell)).map_err(failed)?;
        let mut child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|e| failed(format!("the sandbox cannot be started: {e}")))?;
        let (output, errors) = (child.stdout.take(), child.stderr.take());
        let most = self.allowance;
        let (made, said) = std::thread::scope(|scope| {
            let made = scope.spawn(|| output.map_or(Ok(Vec::new()), |pipe| made(pipe, most.disk)));
            let mut said = Vec::new();
            if let Some(pipe) = errors {
                // Where nobody reads the rest, the guard ends it.
                let _ = pipe.take(most.output + 1).read_to_end(&mut said);
            }
            (made.join().unwrap_or_else(|_| Ok(Vec::new())), said)
        });
        let status = child.wait().map_err(|e| failed(format!("the sandbox is lost: {e}")))?;
        let why = if said.len() as u64 > most.output {
            let why = format!("more than {} MiB of messages", most.output >> 20);
            self.note(Phase::Build, &format!("was ended for {why}"));
            format!("it was ended for {why}")
        } else {
            match (status.success(), made) {
                (true, Ok(made)) if !made.is_empty() => return Ok(made),
                (true, Ok(_)) => format!("`{makes}` was made, and is empty"),
                (true, Err(why)) => why,
                (false, _) => ended(status, makes, &said),
            }
        };
        Err(BuildFailure { why, said: folded(&told(&said), SAID) })
    }
}

/// What it made, if that is not too large.
fn made(pipe: ChildStdout, most: u64) -> Result<Vec<u8>, String> {
    let mut made = Vec::new();
    match pipe.take(most + 1).read_to_end(&mut made) {
        Ok(_) if made.len() as u64 > most => Err(format!("what it made has more than {} MiB", most >> 20)),
        Ok(_) => Ok(made),
        Err(e) => Err(format!("what it made cannot be read: {e}")),
    }
}

/// Why it ended.
fn ended(status: ExitStatus, makes: &str, said: &[u8]) -> String {
    match (status.code(), status.signal()) {
        (Some(NOT_COPIED), _) => "its files could not be copied into the sandbox".into(),
        (Some(NOT_MADE), _) => format!("the build ended without a mistake, and made no `{makes}`"),
        (Some(NO_FILE), _) => {
            format!("`{makes}` is no file but a link, a folder or a device: it is not taken")
        }
        (Some(ENDED), _) => {
            let said = String::from_utf8_lossy(said);
            let why = said.lines().rev().find_map(|line| line.strip_prefix(VOICE));
            format!("it was ended for {}", why.unwrap_or("taking too much"))
        }
        (Some(127), _) => {
            "the build ended with exit code 127: a program of it is not there (those outside of /usr need \
             their folder in `read`)"
                .into()
        }
        (Some(code), _) => format!("the build ended with exit code {code}"),
        (None, Some(9)) => "the build was killed, perhaps for want of memory".into(),
        (None, signal) => format!("the build was killed by signal {}", signal.unwrap_or(0)),
    }
}

/// What was said, without what the guard says last.
fn told(said: &[u8]) -> Vec<u8> {
    let text = String::from_utf8_lossy(said);
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with(VOICE)).collect();
    lines.join("\n").into_bytes()
}
