//! One submission, from where it was found to its grade.

use super::building::Prepared;
use super::grade::{Broken, GRADE_VERSION, Grade};
use super::kept::{Kept, State};
use super::plan::{Measurement, SOLUTION};
use super::rubric::{Item, Rubric};
use super::score::{Measured, score, total};
use super::submissions::Submission;
use crate::diagnosis::Explanation;
use crate::engine::{Draws, Options};
use crate::registry::Registry;
use crate::report::{Carried, Diagnosis, FileError, Recording, Report, record, write_report};
use crate::suite::{Case, Plan};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Of a submission and an item.
pub type Command = dyn Fn(&str, &str) -> String + Send + Sync;

/// What is asked for besides the rubric.
#[derive(Clone)]
pub struct Wishes {
    /// Explanations of failures besides those that come with gonio.
    pub explanations: Arc<Vec<Box<dyn Explanation>>>,
    /// Set to stop.
    pub stop: Arc<AtomicBool>,
    /// What to type to have an item of a submission measured again: both by their ids.
    pub command: Arc<Command>,
    /// Where submissions are unpacked and built while they are measured; it must be there.
    pub scratch: PathBuf,
    /// Whether what is kept is measured again.
    pub again: bool,
    /// Whether a student grades, who may lack the solution.
    pub own: bool,
}

/// Grades submissions, each by the same terms.
pub struct Grader {
    /// What earns points.
    pub rubric: Rubric,
    /// What is measured.
    pub measurement: Measurement,
    /// What references name besides the solution.
    registry: Registry,
    /// The teacher's own submission, where there is one.
    solution: Option<(Prepared, Registry)>,
    wishes: Wishes,
    /// Names all that results depend on besides the submission.
    terms: String,
}

/// A submission that was graded.
pub struct Graded {
    /// Its grade.
    pub grade: Grade,
    /// What was measured, unless it is broken.
    pub report: Option<Report>,
    /// What it took now: nothing where all was kept.
    pub took: Took,
}

/// Wall time in seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Took {
    /// To build and open it.
    pub build_s: f64,
    /// To measure and diagnose it.
    pub measure_s: f64,
}

/// What stands in the way of a grade and is not the submission's fault.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The machine, or the rubric.
    #[error("{0}")]
    System(String),
    /// It was stopped.
    #[error("stopped before it was done")]
    Stopped,
}

impl Grader {
    /// A grader by these terms; the solution is built and opened.
    ///
    /// # Errors
    /// Where that fails.
    pub fn new(mut rubric: Rubric, registry: Registry, wishes: Wishes) -> Result<Self, Failure> {
        let mut measurement = Measurement::of(&rubric);
        let path = rubric.solution.clone();
        let solution = match path.filter(|path| path.exists() || !wishes.own) {
            Some(path) => {
                let submission = Submission { id: SOLUTION.into(), names: Default::default(), path };
                let wrong = |b: Broken| {
                    Failure::System(format!("the solution: {}\n{}", b.why, b.said).trim_end().into())
                };
                let prepared = Prepared::new(&rubric, &submission, &wishes.scratch)?.map_err(wrong)?;
                let opened = prepared.open(&rubric).map_err(wrong)?;
                Some((prepared, opened))
            }
            None => {
                // Students lack it: what compares with it is left out, and the rest is held
                // to the same thresholds.
                let share = measurement.share;
                rubric.items.retain(|item| item.reference.as_deref() != Some(SOLUTION));
                measurement = Measurement { share, ..Measurement::of(&rubric) };
                None
            }
        };
        let reference = solution.as_ref().map(|(prepared, _)| prepared.digest.as_str());
        let measured = (&measurement.cases, measurement.share, reference, rubric.seed, rubric.precision);
        let terms =
            format!("{} {measured:?} {:?} {:?}", env!("CARGO_PKG_VERSION"), rubric.models, rubric.limit);
        let terms = blake3::hash(terms.as_bytes()).to_hex().to_string();
        Ok(Self { rubric, measurement, registry, solution, wishes, terms })
    }

    /// The grade of a submission. What `folder` holds of it is kept as far as it is still
    /// true, and measured again where it is not.
    ///
    /// # Errors
    /// What is not the submission's fault.
    pub fn grade(&self, submission: &Submission, folder: &Path) -> Result<Graded, Failure> {
        let prepared = match Prepared::new(&self.rubric, submission, &self.wishes.scratch)? {
            Ok(prepared) => prepared,
            Err(why) => {
                // It has no digest, and is looked at again the next time.
                let state = State { submission: String::new(), terms: self.terms.clone() };
                let grade = self.grade_of(submission, &Measured::nothing());
                return finish(folder, state, Grade { broken: Some(why), ..grade }, None, Took::default());
            }
        };
        let state = State { submission: prepared.digest.clone(), terms: self.terms.clone() };
        let kept =
            Kept::read(folder).filter(|kept| !self.wishes.again && kept.state.submission == state.submission);
        // Why something is broken may lie in the machine, where a compiler was missing.
        if let Some(kept) = kept.as_ref().filter(|kept| kept.state == state && kept.grade.broken.is_none())
            && let Some(Ok(grade)) =
                kept.report.as_ref().map(|report| self.rescored(submission, kept, report))
        {
            return finish(folder, state, grade, kept.report.clone(), Took::default());
        }
        self.measure(submission, folder, &prepared, state, kept)
    }

    fn measure(
        &self,
        submission: &Submission,
        folder: &Path,
        prepared: &Prepared,
        state: State,
        kept: Option<Kept>,
    ) -> Result<Graded, Failure> {
        let begun = Instant::now();
        let planned = self.planned(prepared);
        let mut took = Took { build_s: begun.elapsed().as_secs_f64(), measure_s: 0.0 };
        let plan = match planned {
            Ok(plan) => plan,
            Err(why) => {
                Kept::forget(folder)?;
                let grade = Grade {
                    broken: Some(why),
                    ..self.of_prepared(submission, prepared, &Measured::nothing())
                };
                return finish(folder, state, grade, None, took);
            }
        };
        let earlier = kept.and_then(|kept| kept.report);
        let carried = earlier.map_or_else(Carried::default, |r| Carried::of(&r, folder, &plan, true));
        Kept::forget(folder)?;
        let recording = Recording {
            options: Options {
                // Submissions are graded side by side.
                threads: Some(1),
                stop: self.wishes.stop.clone(),
                deadline: Some(self.rubric.limit),
                cases: None,
                draws: Draws::Planned,
            },
            explanations: &self.wishes.explanations,
            folder: Some(folder),
            pictures: None,
            command: &|case, _, check| self.command(submission, case.index, check),
            time_s: None,
        };
        let (report, files) = record(&plan, recording, carried, &mut |_| {});
        if self.wishes.stop.load(Ordering::Relaxed) {
            return Err(Failure::Stopped);
        }
        files?;
        took.measure_s = begun.elapsed().as_secs_f64() - took.build_s;
        // What it does at its end is told too.
        drop(plan);
        write_report(folder, &report)?;
        let measured = Measured::of(&self.measurement, &report).map_err(Failure::System)?;
        let diagnoses = report.diagnoses.iter().map(|d| Diagnosis { profile: None, ..d.clone() }).collect();
        let mut grade = Grade { diagnoses, ..self.of_prepared(submission, prepared, &measured) };
        grade.review.extend(report.partial.clone());
        finish(folder, state, grade, Some(report), took)
    }

    /// Measures the cases of one item again, by its checks alone; nothing is written. `Err`
    /// within is the submission's fault.
    ///
    /// # Errors
    /// What is not.
    pub fn examine(&self, submission: &Submission, item: &str) -> Result<Result<Report, Broken>, Failure> {
        let items = self.rubric.items.iter().zip(&self.measurement.of_item);
        let own: Vec<(&Item, &Vec<usize>)> = items.filter(|(i, _)| i.id == item).collect();
        let prepared = match Prepared::new(&self.rubric, submission, &self.wishes.scratch)? {
            Ok(prepared) => prepared,
            Err(why) => return Ok(Err(why)),
        };
        let mut plan = match self.planned(&prepared) {
            Ok(plan) => plan,
            Err(why) => return Ok(Err(why)),
        };
        let cases = plan.cases.iter().enumerate().filter_map(|(index, case)| {
            let (item, _) = own.iter().find(|(_, cases)| cases.contains(&index))?;
            Some(Arc::new(Case { checks: item.checks.clone(), ..(**case).clone() }))
        });
        plan.cases = cases.collect();
        let recording = Recording {
            options: Options { stop: self.wishes.stop.clone(), ..Options::default() },
            explanations: &self.wishes.explanations,
            folder: None,
            pictures: None,
            command: &|_, _, _| (self.wishes.command)(&submission.id, item),
            time_s: None,
        };
        Ok(Ok(record(&plan, recording, Carried::default(), &mut |_| {}).0))
    }

    /// Builds and opens a submission, and plans what is measured of it.
    fn planned(&self, prepared: &Prepared) -> Result<Plan<'static>, Broken> {
        let solution = self.solution.as_ref().map(|(_, registry)| registry);
        let registry = prepared.open(&self.rubric)?;
        let plan = self.measurement.plan(&self.rubric, &registry, solution, &self.registry);
        plan.map_err(|why| Broken { why, said: String::new() })
    }

    /// A grade from what was measured before.
    fn rescored(&self, submission: &Submission, kept: &Kept, report: &Report) -> Result<Grade, String> {
        let old = kept.grade.clone();
        let mut grade = self.grade_of(submission, &Measured::of(&self.measurement, report)?);
        grade.review.extend(report.partial.clone());
        Ok(Grade {
            language: old.language,
            isolation: old.isolation,
            diagnoses: old.diagnoses,
            incidents: old.incidents,
            ..grade
        })
    }

    fn of_prepared(&self, submission: &Submission, prepared: &Prepared, measured: &Measured) -> Grade {
        Grade {
            language: Some(prepared.language.name.clone()),
            isolation: prepared.isolation(),
            incidents: prepared.incidents(),
            ..self.grade_of(submission, measured)
        }
    }

    fn grade_of(&self, submission: &Submission, measured: &Measured) -> Grade {
        let (items, review) = score(&self.rubric, &self.measurement, measured);
        Grade {
            grade_version: GRADE_VERSION,
            gonio: env!("CARGO_PKG_VERSION").into(),
            rubric: self.rubric.title.clone(),
            id: submission.id.clone(),
            names: submission.names.clone(),
            language: None,
            isolation: String::new(),
            seed: self.rubric.seed,
            hidden: self.rubric.hidden,
            broken: None,
            score: total(&items),
            max: self.rubric.max(),
            items,
            diagnoses: Vec::new(),
            incidents: Vec::new(),
            review,
        }
    }

    /// What to type to have the item that a check of a case belongs to measured again.
    fn command(&self, submission: &Submission, case: usize, check: &str) -> String {
        let items = self.rubric.items.iter().zip(&self.measurement.of_item);
        let mut of_it =
            items.filter(|(item, cases)| cases.contains(&case) && item.checks.iter().any(|c| c == check));
        (self.wishes.command)(&submission.id, of_it.next().map_or("", |(item, _)| &item.id))
    }

    /// The teacher's own submission, if there is one.
    pub fn solution(&self) -> Option<Submission> {
        let path = self.rubric.solution.clone().filter(|_| self.solution.is_some())?;
        Some(Submission { id: SOLUTION.into(), names: Default::default(), path })
    }
}

fn finish(
    folder: &Path,
    state: State,
    grade: Grade,
    report: Option<Report>,
    took: Took,
) -> Result<Graded, Failure> {
    let kept = Kept { state, grade, report };
    kept.keep(folder)?;
    Ok(Graded { grade: kept.grade, report: kept.report, took })
}
