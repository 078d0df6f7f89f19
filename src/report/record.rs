//! From a plan to a report, with what it leaves in a folder: where the engine, the diagnosis
//! and the report meet.

use super::build::Files;
use super::carry::Carried;
use super::folder::{draw_diagnoses, draw_results, evidence_of};
use super::json::{Diagnosis, Report};
use super::plots::Which;
use super::saved::{FileError, write_evidence};
use crate::diagnosis::{Explanation, diagnose_all};
use crate::engine::{self, CaseResult, Event, Options};
use crate::suite::Plan;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// How a run is recorded.
pub struct Recording<'a> {
    /// How it is run; its cases are those that are not taken over.
    pub options: Options,
    /// Explanations of failures besides those that come with gonio.
    pub explanations: &'a Arc<Vec<Box<dyn Explanation>>>,
    /// Where evidence and pictures go.
    pub folder: Option<&'a Path>,
    /// Which pictures are drawn.
    pub pictures: Option<Which>,
    /// What to type to have a case judged by a check again; the share of one test is given.
    pub command: &'a dyn Fn(&CaseResult, f64, &str) -> String,
    /// The budget of time in seconds, if the run has one.
    pub time_s: Option<f64>,
}

/// Runs a plan but for what is taken over. Evidence is written case by case, so that a run
/// that is killed leaves what it had. With the report the first file that could not be
/// written, which must not lose it.
pub fn record(
    plan: &Plan<'static>,
    recording: Recording,
    carried: Carried,
    observe: &mut dyn FnMut(&Event),
) -> (Report, Result<(), FileError>) {
    let Recording { mut options, explanations, folder, pictures, command, time_s } = recording;
    if !carried.rows.is_empty() {
        options.cases = Some(carried.left(plan));
    }
    let started = jiff::Timestamp::now().to_string();
    let mut files = Ok(());
    let mut note = |result: Result<(), FileError>| {
        if files.is_ok() {
            files = result;
        }
    };
    let results = engine::run(plan, &options, &mut |event| {
        observe(event);
        if let (Event::CaseDone(case), Some(folder)) = (event, folder)
            && let Some(evidence) = &case.evidence
        {
            note(write_evidence(folder, case.index, evidence).map(drop));
        }
    });
    let diagnosed = diagnose_all(&results, explanations, &options);
    let mut diagnoses = Diagnosis::all(&results, diagnosed);
    let mut plots = BTreeMap::new();
    if let Some(folder) = folder {
        // Beside results that are taken over everything is drawn from evidence, once.
        if let Some(which) = pictures.filter(|_| carried.rows.is_empty()) {
            note(draw_results(folder, &results, &diagnoses, which).map(|drawn| plots = drawn));
            note(draw_diagnoses(folder, &mut diagnoses));
        }
        note(carried.write_evidence(folder));
    }
    let about = Files {
        command: &|case, check| command(case, results.share, check),
        evidence: &|case| folder.and_then(|_| evidence_of(case)),
        plot: &|case| plots.get(&case.index).cloned(),
        time_s,
    };
    let report = Report::new(plan, &results, started, &about, carried).diagnosed(diagnoses);
    (report, files)
}
