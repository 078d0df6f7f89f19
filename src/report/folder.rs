//! A report as a folder: report.json, evidence and pictures.

use super::json::{CheckResult, Diagnosis, Report};
use super::plots::{Pictured, Which, diagnosis_picture, draw, file_name};
use super::saved::{FileError, evidence_path, read_evidence, write_whole};
use crate::checks::{Verdict, level_p_values};
use crate::diagnosis::Profile;
use crate::engine::Results;
use crate::evidence::Evidence;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The file of the report itself.
pub const REPORT: &str = "report.json";

/// Writes report.json.
pub fn write_report(folder: &Path, report: &Report) -> Result<(), FileError> {
    let mut text = serde_json::to_string_pretty(report).unwrap_or_default();
    text.push('\n');
    write_whole(&folder.join(REPORT), text.as_bytes())
}

/// What was counted and predicted for the diagnosis of a subject.
fn profile_of<'a>(diagnoses: &'a [Diagnosis], subject: &str) -> Option<&'a Profile> {
    diagnoses.iter().find(|d| d.subject == subject)?.profile.as_ref()
}

/// Draws the pictures of results, with what diagnoses predict; the path of each pictured
/// case by its number.
pub fn draw_results(
    folder: &Path,
    results: &Results,
    diagnoses: &[Diagnosis],
    which: Which,
) -> Result<BTreeMap<usize, String>, FileError> {
    let mut cases = Vec::new();
    let mut p_values = Vec::new();
    for case in &results.cases {
        let Some(evidence) = &case.evidence else { continue };
        p_values.extend(level_p_values(evidence));
        let fit = case.findings.iter().find(|f| f.check == "goodness-of-fit");
        let root_d = fit.and_then(|f| f.outcome.effect.as_ref()).map(|e| e.value.0);
        let suspicious = case.findings.iter().any(|f| is_suspicious(f.outcome.verdict));
        let (group, diagnosed) = (&case.case.group, profile_of(diagnoses, &case.case.spelling));
        cases.push(Pictured { index: case.index, group, evidence, suspicious, root_d, diagnosed });
    }
    draw(folder, &cases, &p_values, which)
}

/// Draws the pictures of diagnoses, and tells each its path.
pub fn draw_diagnoses(folder: &Path, diagnoses: &mut [Diagnosis]) -> Result<(), FileError> {
    let mut names = BTreeSet::new();
    for found in diagnoses {
        let Some(profile) = &found.profile else { continue };
        let path = format!("plots/diagnosis-{}.svg", file_name(&found.subject, &mut names));
        write_whole(&folder.join(&path), diagnosis_picture(&found.subject, profile).as_bytes())?;
        found.plot = Some(path);
    }
    Ok(())
}

/// Draws the pictures of a saved report again from its evidence, and tells each result
/// its own; how many cases have one.
pub fn redraw(folder: &Path, report: &mut Report, which: Which) -> Result<usize, FileError> {
    draw_diagnoses(folder, &mut report.diagnoses)?;
    let drawn = draw_saved(folder, report, which)?;
    for row in &mut report.results {
        row.plot = row.evidence.as_deref().and_then(number).and_then(|index| drawn.get(&index).cloned());
    }
    Ok(drawn.len())
}

/// The number of a case by the path of its evidence.
fn number(path: &str) -> Option<usize> {
    let digits: String = path.chars().filter(char::is_ascii_digit).collect();
    digits.parse().ok()
}

fn draw_saved(folder: &Path, report: &Report, which: Which) -> Result<BTreeMap<usize, String>, FileError> {
    let mut rows: BTreeMap<&str, Vec<&CheckResult>> = BTreeMap::new();
    for row in &report.results {
        if let Some(path) = &row.evidence {
            rows.entry(path).or_default().push(row);
        }
    }
    let mut all: Vec<(usize, Evidence, &[&CheckResult])> = Vec::new();
    let mut p_values = Vec::new();
    for (path, rows) in &rows {
        let evidence = read_evidence(&folder.join(path))?;
        p_values.extend(level_p_values(&evidence));
        all.push((number(path).unwrap_or(all.len()), evidence, rows));
    }
    let cases: Vec<Pictured> = all
        .iter()
        .map(|(index, evidence, rows)| {
            let fit = rows.iter().find(|r| r.check == "goodness-of-fit");
            Pictured {
                index: *index,
                group: rows[0].subject.group(),
                evidence,
                suspicious: rows.iter().any(|r| is_suspicious(r.verdict)),
                root_d: fit.and_then(|r| r.effect.as_ref()).map(|e| e.value.0),
                diagnosed: profile_of(&report.diagnoses, &rows[0].subject.name),
            }
        })
        .collect();
    draw(folder, &cases, &p_values, which)
}

/// The path of a case's evidence, if it has any.
pub fn evidence_of(case: &crate::engine::CaseResult) -> Option<String> {
    case.evidence.as_ref().map(|_| evidence_path(case.index))
}

fn is_suspicious(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Fail | Verdict::Inconclusive | Verdict::Warn | Verdict::Waived)
}
