//! All submissions, side by side.

use super::grade::Grade;
use super::grader::{Failure, Graded, Grader};
use super::kept::read_grade;
use super::submissions::Submission;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Where a submission's own files are in the folder of grades.
pub fn folder_of(out: &Path, id: &str) -> PathBuf {
    out.join("submissions").join(id)
}

/// Grades submissions with so many at a time; one result for each, in their order. `each`
/// is told of each as it is done, on the thread that did it. None of them stops the others.
pub fn grade_all(
    grader: &Grader,
    submissions: &[Submission],
    out: &Path,
    workers: usize,
    each: &(dyn Fn(&Submission, &Result<Graded, Failure>) + Sync),
) -> Vec<Result<Grade, Failure>> {
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<Result<Grade, Failure>>>> =
        submissions.iter().map(|_| Mutex::default()).collect();
    let work = || {
        while let Some(k) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|k| *k < submissions.len()) {
            let submission = &submissions[k];
            let one = || grader.grade(submission, &folder_of(out, &submission.id));
            let graded = catch_unwind(AssertUnwindSafe(one)).unwrap_or_else(|_| {
                Err(Failure::System("gonio itself failed, as told above: please report it".into()))
            });
            each(submission, &graded);
            let stopped = matches!(graded, Err(Failure::Stopped));
            *done[k].lock().expect("nobody panics with it") = Some(graded.map(|graded| graded.grade));
            if stopped {
                return;
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..workers.clamp(1, submissions.len().max(1)) {
            scope.spawn(work);
        }
    });
    let taken = |one: Mutex<Option<Result<Grade, Failure>>>| one.into_inner().ok().flatten();
    done.into_iter().map(|one| taken(one).unwrap_or(Err(Failure::Stopped))).collect()
}

/// The grades that are kept of submissions, as they are.
pub fn kept<'s>(out: &Path, submissions: impl Iterator<Item = &'s Submission>) -> Vec<Option<Grade>> {
    submissions.map(|submission| read_grade(&folder_of(out, &submission.id))).collect()
}

/// The chance that a correct submission loses a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fairness {
    /// For one submission: at most this.
    pub budget: f64,
    /// Submissions.
    pub students: usize,
}

impl Fairness {
    /// The chance that any of them does, were all of them correct: at most this, by the union
    /// bound, whatever they have in common. Equal code on equal seeds fares alike, so that a
    /// class of copies has the chance of one.
    pub fn chance(&self) -> f64 {
        (self.budget * self.students as f64).min(1.0)
    }
}
