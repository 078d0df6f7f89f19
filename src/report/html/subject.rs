//! Results put together by subject, as a page shows them.

use super::super::json::{CheckResult, Diagnosis, Report, SubjectId, WoAngles};
use super::names;
use crate::bsdf::Transport;
use crate::checks::Verdict;
use std::collections::{HashMap, HashSet};

/// A subject with everything that was found of it.
pub struct Subject<'a> {
    /// Of its section.
    pub anchor: String,
    /// What it is.
    pub id: &'a SubjectId,
    /// The most serious verdict.
    pub verdict: Verdict,
    /// In the order of columns.
    pub checks: Vec<Check<'a>>,
    /// In the suite's order.
    pub cases: Vec<Case<'a>>,
    /// What is wrong with it.
    pub found: Option<&'a Diagnosis>,
    /// Whether its results are those of an earlier report.
    pub carried: bool,
}

/// A check of a subject, over all its cases.
pub struct Check<'a> {
    /// Which.
    pub id: &'a str,
    /// The most serious verdict.
    pub verdict: Verdict,
    /// The clearest of the most serious first.
    pub results: Vec<&'a CheckResult>,
}

/// A subject at a direction.
pub struct Case<'a> {
    /// File of its evidence, from the report's folder.
    pub evidence: Option<&'a str>,
    /// Its picture.
    pub plot: Option<&'a str>,
    /// The given direction.
    pub wo: Option<WoAngles>,
    /// The mode of transport.
    pub transport: Transport,
    /// The most serious verdict.
    pub verdict: Verdict,
    /// √D of goodness-of-fit.
    pub root_d: Option<f64>,
    /// Its verdicts by check.
    pub verdicts: HashMap<&'a str, Verdict>,
    /// How far the most serious result is beyond what is tolerated.
    size: f64,
}

/// Whether a person should look at it.
pub fn is_telling(verdict: Verdict) -> bool {
    !matches!(verdict, Verdict::Pass | Verdict::Skipped)
}

/// Whether it is wrong, or could not be measured.
pub fn is_wrong(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Fail | Verdict::Error)
}

impl Subject<'_> {
    /// The number of the case to show first: the clearest of the most serious, else the
    /// one nearest to grazing.
    pub fn first_case(&self) -> Option<usize> {
        let grazing = |case: &Case| case.wo.map_or(0.0, |wo| wo.theta_deg.to_radians().sin());
        (0..self.cases.len()).reduce(|best, k| {
            let (a, b) = (&self.cases[best], &self.cases[k]);
            let order = (a.verdict.cmp(&b.verdict))
                .then(if is_telling(a.verdict) {
                    a.size.total_cmp(&b.size)
                } else {
                    std::cmp::Ordering::Equal
                })
                .then(grazing(a).total_cmp(&grazing(b)));
            if order.is_lt() { k } else { best }
        })
    }
}

/// How far a result is beyond what is tolerated.
fn size(result: &CheckResult) -> f64 {
    result.effect.as_ref().map_or(0.0, |e| (e.value.0 / e.tolerance.0).abs()).max(0.0)
}

/// The subjects of a report in its order.
pub fn subjects<'a>(report: &'a Report, columns: &[&'a str]) -> Vec<Subject<'a>> {
    let mut numbers: HashMap<(&str, Option<&str>), usize> = HashMap::new();
    let mut rows: Vec<Vec<&CheckResult>> = Vec::new();
    for result in &report.results {
        let key = (result.subject.name.as_str(), result.subject.label.as_deref());
        let number = *numbers.entry(key).or_insert(rows.len());
        if number == rows.len() {
            rows.push(Vec::new());
        }
        rows[number].push(result);
    }
    let found: HashMap<&str, &Diagnosis> = report.diagnoses.iter().map(|d| (d.subject.as_str(), d)).collect();
    let carried: HashSet<(&str, Option<&str>)> =
        report.subjects.iter().filter(|s| s.carried).map(|s| (s.name.as_str(), s.label.as_deref())).collect();
    let made = rows.iter().map(|results| subject(results, columns, &found));
    made.map(|s| Subject { carried: carried.contains(&(&s.id.name, s.id.label.as_deref())), ..s }).collect()
}

fn subject<'a>(
    results: &[&'a CheckResult],
    columns: &[&'a str],
    found: &HashMap<&str, &'a Diagnosis>,
) -> Subject<'a> {
    let id = &results[0].subject;
    let mut by_check: HashMap<&str, Vec<&CheckResult>> = HashMap::new();
    for result in results {
        by_check.entry(&result.check).or_default().push(result);
    }
    let checks: Vec<Check> = columns
        .iter()
        .filter_map(|id| {
            let mut results = by_check.remove(id)?;
            results.sort_by(|a, b| b.verdict.cmp(&a.verdict).then(size(b).total_cmp(&size(a))));
            Some(Check { id, verdict: results[0].verdict, results })
        })
        .collect();
    let verdict = checks.iter().map(|c| c.verdict).max().unwrap_or(Verdict::Skipped);
    let found = found.get(id.name.as_str()).copied().filter(|_| is_wrong(verdict));
    Subject { anchor: names::anchor(id), id, verdict, checks, cases: cases(results), found, carried: false }
}

fn cases<'a>(results: &[&'a CheckResult]) -> Vec<Case<'a>> {
    let mut cases: Vec<Case> = Vec::new();
    let mut numbers = HashMap::new();
    for result in results {
        let wo = result.wo.map(|wo| [wo.theta_deg.to_bits(), wo.phi_deg.to_bits()]);
        let importance = result.transport == Transport::Importance;
        let number = *numbers.entry((result.evidence.as_deref(), wo, importance)).or_insert(cases.len());
        if number == cases.len() {
            cases.push(Case {
                evidence: result.evidence.as_deref(),
                plot: result.plot.as_deref(),
                wo: result.wo,
                transport: result.transport,
                verdict: Verdict::Skipped,
                root_d: None,
                verdicts: HashMap::new(),
                size: 0.0,
            });
        }
        let case = &mut cases[number];
        case.verdicts.insert(&result.check, result.verdict);
        if result.verdict > case.verdict {
            (case.verdict, case.size) = (result.verdict, size(result));
        } else if result.verdict == case.verdict {
            case.size = case.size.max(size(result));
        }
        if result.check == "goodness-of-fit" {
            case.root_d = result.effect.as_ref().map(|e| e.value.0);
        }
    }
    cases
}
