//! What is kept of a submission between runs.

use super::grade::{GRADE_VERSION, Grade};
use crate::report::{FileError, REPORT, Report, write_whole};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// The file of a grade.
pub const GRADE: &str = "grade.json";
/// The file that says of what the others are; it is written last.
const STATE: &str = "state.json";

/// What results are of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct State {
    /// Digest of the submission's files, the course's, and how it is built.
    pub submission: String,
    /// Digest of what is measured, and how.
    pub terms: String,
}

/// What is kept of a submission.
pub struct Kept {
    /// Of what the rest is.
    pub state: State,
    /// The grade, as it was.
    pub grade: Grade,
    /// What was measured, unless it was broken.
    pub report: Option<Report>,
}

impl Kept {
    /// What a folder holds, if it was finished.
    pub fn read(folder: &Path) -> Option<Self> {
        let state = read(&folder.join(STATE))?;
        let grade = read_grade(folder)?;
        let report = if grade.broken.is_some() { None } else { Some(read(&folder.join(REPORT))?) };
        Some(Self { state, grade, report })
    }

    /// Removes what a folder holds, all of which is gonio's own.
    pub fn forget(folder: &Path) -> Result<(), FileError> {
        match fs::remove_dir_all(folder) {
            Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                Err(FileError::Write { path: folder.into(), source })
            }
            _ => Ok(()),
        }
    }

    /// Writes the grade, and of what it is; the report is there already.
    pub fn keep(&self, folder: &Path) -> Result<(), FileError> {
        write(&folder.join(GRADE), &self.grade)?;
        write(&folder.join(STATE), &self.state)
    }
}

/// The grade that a folder holds, whether or not it is still true.
pub fn read_grade(folder: &Path) -> Option<Grade> {
    read(&folder.join(GRADE)).filter(|grade: &Grade| grade.grade_version == GRADE_VERSION)
}

fn read<T: DeserializeOwned>(path: &Path) -> Option<T> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}

fn write<T: Serialize>(path: &Path, what: &T) -> Result<(), FileError> {
    let mut text = serde_json::to_string_pretty(what)
        .map_err(|source| FileError::NotKept { path: path.into(), source })?;
    text.push('\n');
    // What did not change keeps its time.
    if fs::read(path).is_ok_and(|old| old == text.as_bytes()) {
        return Ok(());
    }
    write_whole(path, text.as_bytes())
}
