//! All submissions, side by side.

use super::grade::Grade;
use super::grader::{Failure, Graded, Grader};
use super::kept::read_grade;
use super::submissions::Submission;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Where a submission's own files are in the folder of grades.
pub fn folder_of(out: &Path, id: &str) -> PathBuf {
    out.join("submissions").join(id)
}

/// Grades submissions with so many at a time; what `each` makes of every one, in their
/// order, on the thread that graded it. None of them stops the others.
pub fn grade_all<T: Send>(
    grader: &Grader,
    submissions: &[Submission],
    out: &Path,
    workers: usize,
    each: &(dyn Fn(&Submission, &Result<Graded, Failure>) -> T + Sync),
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<T>>> = submissions.iter().map(|_| Mutex::default()).collect();
    let work = || {
        while let Some(k) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|k| *k < submissions.len()) {
            let submission = &submissions[k];
            let one = || grader.grade(submission, &folder_of(out, &submission.id));
            let graded = catch_unwind(AssertUnwindSafe(one)).unwrap_or_else(|_| {
                Err(Failure::System("gonio itself failed, as told above: please report it".into()))
            });
            *done[k].lock().unwrap_or_else(PoisonError::into_inner) = Some(each(submission, &graded));
            if matches!(graded, Err(Failure::Stopped)) {
                return;
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers.clamp(1, submissions.len().max(1)) {
            scope.spawn(work);
        }
    });
    done.into_iter().filter_map(|one| one.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

/// The grades that are kept of submissions, as they are.
pub fn kept<'s>(out: &Path, submissions: impl Iterator<Item = &'s Submission>) -> Vec<Option<Grade>> {
    submissions.map(|submission| read_grade(&folder_of(out, &submission.id))).collect()
}
