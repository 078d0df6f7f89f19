//! Writes everything that is made of grades.

use super::super::Grade;
use super::export::Export;
use super::fairness::Fairness;
use super::feedback::Feedback;
use super::files::{feedback_page, feedback_text, file_name};
use super::gradebook::{GRADEBOOK, gradebook};
use super::pictures::{Desk, drawn};
use super::{appeals, class_page, gradescope, markdown, page, prairielearn};
use crate::report::{FileError, Report, write_whole};
use std::path::{Path, PathBuf};

/// A learning system that reads a file for each submission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum System {
    /// results.json of Gradescope.
    Gradescope,
    /// results.json of PrairieLearn.
    #[value(name = "prairielearn")]
    PrairieLearn,
}

/// What is written of a submission, and what is said in it.
pub struct Told<'a> {
    /// The folder of its report.json and evidence.
    pub measured: &'a Path,
    /// The systems that it is written for.
    pub to: &'a [System],
    /// What a student types to see the same: `gonio grade --self rubric.toml .`
    pub again: &'a str,
    /// For the id of an item, what a teacher types to measure it again.
    pub command: &'a (dyn Fn(&str) -> String + Sync),
}

/// A class.
pub struct Class<'a> {
    /// Title of the rubric.
    pub title: &'a str,
    /// Every grade, in any order.
    pub grades: &'a [Grade],
    /// By how much chance decides.
    pub fairness: Fairness,
    /// Tables for learning systems.
    pub exports: &'a [Export],
    /// What a student types to see the same.
    pub again: &'a str,
}

/// Writes what a student gets, the files for learning systems, and what lies behind each
/// lost point, into the folder of all grades.
pub fn write_student(
    folder: &Path,
    grade: &Grade,
    report: Option<&Report>,
    told: &Told,
) -> Result<(), FileError> {
    let feedback = Feedback::of(grade, told.again);
    let mut desk = Desk::new(told.measured);
    let drawn = drawn(&mut desk, report, &feedback);
    let text = page::page(&feedback, &drawn, &nonce(grade));
    write_whole(&folder.join(feedback_page(&grade.id)), text.as_bytes())?;
    write_whole(&folder.join(feedback_text(&grade.id)), markdown::markdown(&feedback).as_bytes())?;
    let file = format!("{}.json", file_name(&grade.id));
    for system in told.to {
        let (name, text) = match system {
            System::Gradescope => ("gradescope", gradescope::results(&feedback)),
            System::PrairieLearn => ("prairielearn", prairielearn::results(grade, &feedback, &drawn)),
        };
        write_whole(&folder.join(name).join(&file), text.as_bytes())?;
    }
    appeals::write(folder, grade, report, told, &mut desk)
}

/// Names the page's own style for its policy: nobody who writes a part of the grade can
/// know it before the grade is whole.
fn nonce(grade: &Grade) -> String {
    let bytes = serde_json::to_vec(grade).unwrap_or_default();
    blake3::hash(&bytes).to_hex()[..32].to_string()
}

/// Writes what is of the whole class into the folder of all grades; the files.
pub fn write_class(folder: &Path, class: &Class) -> Result<Vec<PathBuf>, FileError> {
    let exports = class.exports.iter().map(|export| (export.file(), export.csv(class.grades, class.again)));
    let own = [
        (class_page::INDEX, class_page::class_page(class).into_bytes()),
        (GRADEBOOK, gradebook(class.grades)),
    ];
    let mut written = Vec::new();
    for (file, bytes) in own.into_iter().chain(exports) {
        let path = folder.join(file);
        write_whole(&path, &bytes)?;
        written.push(path);
    }
    Ok(written)
}
