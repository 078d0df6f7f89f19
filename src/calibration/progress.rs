//! Work that goes on where it was interrupted: `progress.jsonl`, one line a unit.

use crate::report::{FileError, write_whole};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The units that are done, in the folder of the calibration.
const PROGRESS: &str = "progress.jsonl";

/// Where a file goes whose units are of another calibration.
const OTHER: &str = "progress.other.jsonl";

/// Held by the process that is at work.
const LOCK: &str = "progress.lock";

/// Why there is no value.
#[derive(Debug, thiserror::Error)]
pub enum Unfinished {
    /// It was asked to stop; the units that are done are kept.
    #[error("interrupted")]
    Interrupted,
    /// Another process works in the same folder.
    #[error("another calibration is at work in {}", .0.display())]
    Busy(PathBuf),
    /// A file could not be written or read.
    #[error(transparent)]
    File(#[from] FileError),
}

/// What the units of a file belong to. Values of another program are not those that
/// this one would compute, even of the same version.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of gonio.
    pub gonio: String,
    /// BLAKE3 digest of the running program; empty where it cannot be read.
    pub program: String,
    /// Everything else on which values depend.
    pub settings: String,
}

impl Identity {
    /// Of this program under these settings.
    pub fn new(settings: impl Into<String>) -> Self {
        let bytes = std::env::current_exe().and_then(std::fs::read);
        let program = bytes.map_or_else(|_| String::new(), |b| blake3::hash(&b).to_hex().to_string());
        Self { gonio: env!("CARGO_PKG_VERSION").into(), program, settings: settings.into() }
    }
}

/// A line of the file after its first, which is the identity.
#[derive(Serialize, Deserialize)]
struct Line<K, T> {
    unit: K,
    value: T,
}

/// The lines that are whole, and the file to which more are added.
struct Kept {
    lines: HashMap<String, String>,
    file: File,
}

/// Units of work of which each is done once, whatever ends the process in between.
pub struct Progress {
    kept: Mutex<Kept>,
    folder: PathBuf,
    set_aside: Option<PathBuf>,
    stop: Arc<AtomicBool>,
    /// Its lock ends with the process, however that ends.
    lock: File,
}

impl Progress {
    /// Goes on with what `folder` holds of the same identity. What it holds of
    /// another is renamed, see [`Self::set_aside`]. Units that end after `stop` was
    /// set are not kept: they may have been cut short.
    ///
    /// # Errors
    /// [`Unfinished::Busy`] while another process has the folder open; or a file that
    /// cannot be written or read.
    pub fn open(folder: &Path, identity: &Identity, stop: Arc<AtomicBool>) -> Result<Self, Unfinished> {
        let lock = lock(folder)?;
        let path = folder.join(PROGRESS);
        let mut set_aside = None;
        let mut whole = Whole::default();
        match std::fs::read(&path) {
            Ok(bytes) => match Whole::of(&bytes, identity) {
                Some(found) => whole = found,
                None => {
                    let other = folder.join(OTHER);
                    std::fs::rename(&path, &other).map_err(write_error(&other))?;
                    set_aside = Some(other);
                }
            },
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            Err(source) => return Err(FileError::Read { path, source }.into()),
        }
        if whole.bytes == 0 {
            let head = json(identity, &path)? + "\n";
            write_whole(&path, head.as_bytes())?;
            whole.bytes = head.len() as u64;
        }
        let open = || {
            let file = File::options().append(true).open(&path)?;
            // A kill may have torn the last line.
            file.set_len(whole.bytes)?;
            Ok(file)
        };
        let file = open().map_err(write_error(&path))?;
        let kept = Mutex::new(Kept { lines: whole.lines, file });
        Ok(Self { kept, folder: folder.into(), set_aside, stop, lock })
    }

    /// Where the units of another calibration went that were found.
    pub fn set_aside(&self) -> Option<&Path> {
        self.set_aside.as_deref()
    }

    /// Number of units that are done.
    pub fn done(&self) -> usize {
        self.kept().lines.len()
    }

    /// Whether this unit is done.
    pub fn has(&self, key: &str) -> bool {
        self.kept().lines.contains_key(key)
    }

    /// The value of a unit: as it was saved, or as it is computed (`None`: it was cut
    /// short) and saved now. It is read back in both cases, so that they are the same to
    /// the bit.
    ///
    /// # Errors
    /// [`Unfinished::Interrupted`] where it was cut short, or a stop was asked for
    /// before its end; or the file cannot be written, or the value not be read back.
    pub fn unit<T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        compute: impl FnOnce() -> Option<T>,
    ) -> Result<T, Unfinished> {
        let saved = self.kept().lines.get(key).cloned();
        if let Some(line) = saved
            && let Ok(Line::<IgnoredAny, T> { value, .. }) = serde_json::from_str(&line)
        {
            return Ok(value);
        }
        if self.is_stopped() {
            return Err(Unfinished::Interrupted);
        }
        let value = compute().filter(|_| !self.is_stopped()).ok_or(Unfinished::Interrupted)?;
        let path = self.folder.join(PROGRESS);
        let mut line = json(&Line { unit: key, value }, &path)?;
        let read = serde_json::from_str::<Line<IgnoredAny, T>>(&line);
        let value = read.map_err(|source| FileError::NotKept { path: path.clone(), source })?.value;
        line.push('\n');
        let mut kept = self.kept();
        let written = kept.file.write_all(line.as_bytes()).and_then(|()| kept.file.sync_data());
        written.map_err(write_error(&path))?;
        kept.lines.insert(key.into(), line);
        Ok(value)
    }

    /// Set from outside to stop.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Whether a stop was asked for.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Removes the file: all is done, and its result is written.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn finish(self) -> Result<(), FileError> {
        for name in [PROGRESS, LOCK] {
            let path = self.folder.join(name);
            std::fs::remove_file(&path).map_err(write_error(&path))?;
        }
        drop(self.lock);
        Ok(())
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The part of a file that was wholly written.
#[derive(Default)]
struct Whole {
    lines: HashMap<String, String>,
    bytes: u64,
}

impl Whole {
    /// `None` if the file is of another identity.
    fn of(bytes: &[u8], identity: &Identity) -> Option<Self> {
        let mut rows = bytes.split_inclusive(|b| *b == b'\n').take_while(|row| row.ends_with(b"\n"));
        let head = rows.next()?;
        if serde_json::from_slice::<Identity>(head).ok()? != *identity {
            return None;
        }
        let mut whole = Self { bytes: head.len() as u64, ..Self::default() };
        for row in rows {
            let Ok(text) = std::str::from_utf8(row) else { break };
            let Ok(line) = serde_json::from_str::<Line<String, IgnoredAny>>(text) else { break };
            whole.bytes += row.len() as u64;
            whole.lines.insert(line.unit, text.into());
        }
        Some(whole)
    }
}

fn lock(folder: &Path) -> Result<File, Unfinished> {
    let path = folder.join(LOCK);
    std::fs::create_dir_all(folder).map_err(write_error(folder))?;
    loop {
        let file = File::options().create(true).append(true).open(&path).map_err(write_error(&path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(Unfinished::Busy(folder.into())),
            Err(TryLockError::Error(source)) => return Err(FileError::Write { path, source }.into()),
        }
        // One that finished may have removed it after it was opened here.
        if path.exists() {
            return Ok(file);
        }
    }
}

fn json(value: &impl Serialize, path: &Path) -> Result<String, FileError> {
    serde_json::to_string(value).map_err(|source| FileError::NotKept { path: path.into(), source })
}

fn write_error(path: &Path) -> impl FnOnce(io::Error) -> FileError {
    let path = path.to_path_buf();
    |source| FileError::Write { path, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(folder: &Path, settings: &str) -> Result<Progress, Unfinished> {
        Progress::open(folder, &Identity::new(settings), Arc::default())
    }

    fn text(folder: &Path) -> String {
        std::fs::read_to_string(folder.join(PROGRESS)).unwrap()
    }

    fn never() -> Option<f64> {
        panic!("this unit was done before")
    }

    #[test]
    fn units_are_done_once_and_come_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let first = open(folder.path(), "a").unwrap();
        let third = 1.0 / 3.0;
        assert_eq!(first.unit("one", || Some(third)).unwrap(), third);
        assert_eq!(first.unit("one", never).unwrap(), third);
        drop(first);
        let second = open(folder.path(), "a").unwrap();
        assert!(second.has("one") && !second.has("two") && second.set_aside().is_none());
        assert_eq!(second.unit("one", never).unwrap(), third);
        assert_eq!(second.unit("two", || Some(2.0)).unwrap(), 2.0);
        assert_eq!(second.done(), 2);
        second.finish().unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
    }

    #[test]
    fn a_line_torn_anywhere_is_done_again() {
        let folder = tempfile::tempdir().unwrap();
        let progress = open(folder.path(), "a").unwrap();
        progress.unit("one", || Some(1.0)).unwrap();
        let before = text(folder.path()).len();
        progress.unit("θ = 2°", || Some(2.0)).unwrap();
        drop(progress);
        let whole = text(folder.path()).into_bytes();
        for end in before..whole.len() {
            std::fs::write(folder.path().join(PROGRESS), &whole[..end]).unwrap();
            let progress = open(folder.path(), "a").unwrap();
            assert_eq!(progress.done(), 1, "cut at {end}");
            assert_eq!(progress.unit("one", never).unwrap(), 1.0);
            assert_eq!(progress.unit("θ = 2°", || Some(2.0)).unwrap(), 2.0);
            drop(progress);
            assert_eq!(text(folder.path()).into_bytes(), whole);
        }
    }

    #[test]
    fn units_of_other_settings_or_another_program_are_set_aside() {
        let folder = tempfile::tempdir().unwrap();
        let progress = open(folder.path(), "a").unwrap();
        progress.unit("one", || Some(1.0)).unwrap();
        drop(progress);
        let before = text(folder.path());
        let other = open(folder.path(), "b").unwrap();
        assert_eq!(other.done(), 0);
        assert_eq!(std::fs::read_to_string(other.set_aside().unwrap()).unwrap(), before);
        drop(other);
        let program = Identity { program: "another".into(), ..Identity::new("b") };
        let third = Progress::open(folder.path(), &program, Arc::default()).unwrap();
        assert!(third.set_aside().is_some());
        drop(third);
        std::fs::write(folder.path().join(PROGRESS), "{\"gon").unwrap();
        assert!(open(folder.path(), "b").unwrap().set_aside().is_some(), "a torn head");
    }

    #[test]
    fn a_second_one_is_told_that_the_folder_is_busy() {
        let folder = tempfile::tempdir().unwrap();
        let first = open(folder.path(), "a").unwrap();
        let error = open(folder.path(), "a").err().unwrap();
        assert!(error.to_string().contains("at work in"), "{error}");
        drop(first);
        assert!(open(folder.path(), "a").is_ok());
    }

    #[test]
    fn what_was_cut_short_is_not_kept() {
        let folder = tempfile::tempdir().unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let progress = Progress::open(folder.path(), &Identity::new("a"), stop.clone()).unwrap();
        let cut = progress.unit("one", || {
            stop.store(true, Ordering::Relaxed);
            Some(1.0)
        });
        assert!(matches!(cut, Err(Unfinished::Interrupted)));
        assert!(matches!(progress.unit("two", never), Err(Unfinished::Interrupted)));
        stop.store(false, Ordering::Relaxed);
        assert!(matches!(progress.unit("two", || None::<f64>), Err(Unfinished::Interrupted)));
        assert_eq!(progress.done(), 0);
    }

    #[test]
    fn a_value_that_json_does_not_hold_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let progress = open(folder.path(), "a").unwrap();
        let refused = progress.unit("one", || Some(f64::NAN));
        assert!(matches!(refused, Err(Unfinished::File(FileError::NotKept { .. }))));
        assert_eq!(progress.done(), 0);
    }
}
