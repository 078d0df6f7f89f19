//! Results of a run to a report.

use super::carry::{Carried, label};
use super::json::{
    Allocation, AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectEntry, SubjectId,
    Summary, WaiverRow, WaiverState, WoAngles,
};
use crate::checks::Verdict;
use crate::comparison::Comparison;
use crate::engine::{CaseResult, Finding, Results};
use crate::evidence::{Figure, Meter};
use crate::suite::{Case, Plan, digests};
use std::collections::BTreeMap;
use std::f64::consts::LN_10;
use std::sync::Arc;

/// Where the parts of a report lie, and how its cases are reproduced.
pub struct Files<'a> {
    /// For a case and a check, what to type.
    pub command: &'a dyn Fn(&CaseResult, &str) -> String,
    /// The file of a case's evidence, from the report's folder.
    pub evidence: &'a dyn Fn(&CaseResult) -> Option<String>,
    /// The file of a case's picture.
    pub plot: &'a dyn Fn(&CaseResult) -> Option<String>,
    /// The budget of time in seconds, if the run had one.
    pub time_s: Option<f64>,
}

impl Summary {
    fn count(results: &[CheckResult]) -> Self {
        let count = |verdict| results.iter().filter(|r| r.verdict == verdict).count();
        Self {
            passed: count(Verdict::Pass),
            failed: count(Verdict::Fail),
            warned: count(Verdict::Warn),
            inconclusive: count(Verdict::Inconclusive),
            skipped: count(Verdict::Skipped),
            errors: count(Verdict::Error),
            waived: count(Verdict::Waived),
        }
    }
}

impl Machine {
    /// The one that this runs on.
    pub fn this() -> Self {
        Self {
            os: std::env::consts::OS.into(),
            arch: std::env::consts::ARCH.into(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

impl Report {
    /// The report of a run that began at `started` (RFC 3339, UTC).
    pub fn new(plan: &Plan, results: &Results, started: String, files: &Files, mut carried: Carried) -> Self {
        let mut of_case = std::mem::take(&mut carried.rows);
        for case in &results.cases {
            of_case.insert(case.index, case.findings.iter().map(|f| row(case, f, files)).collect());
        }
        let waivers = waivers(plan, &of_case);
        let rows: Vec<CheckResult> = of_case.into_values().flatten().collect();
        let allocation =
            results.allocation.clone().map(|samples| Allocation { time_s: files.time_s, samples });
        Self {
            schema_version: SCHEMA_VERSION,
            gonio: env!("CARGO_PKG_VERSION").into(),
            suite: plan.suite.clone(),
            seed: plan.seed,
            false_alarm: plan.false_alarm,
            started,
            duration_s: results.seconds,
            machine: Machine::this(),
            partial: results.partial.clone(),
            summary: Summary::count(&rows),
            subjects: subjects(plan, allocation.is_none(), &carried),
            waivers,
            allocation,
            comparison: None,
            results: rows,
            diagnoses: carried.diagnoses,
        }
    }

    /// The same with what is wrong with failing subjects.
    pub fn diagnosed(mut self, diagnoses: Vec<Diagnosis>) -> Self {
        self.diagnoses.extend(diagnoses);
        self
    }

    /// The same with what changed since a baseline.
    pub fn compared(self, comparison: Option<Comparison>) -> Self {
        Self { comparison, ..self }
    }

    /// The same without what differs from run to run: times, and the machine.
    pub fn timeless(mut self) -> Self {
        self.started = String::new();
        self.duration_s = 0.0;
        self.machine = Machine { os: String::new(), arch: String::new(), cores: 0 };
        self
    }
}

/// The subjects of a plan, in its order.
fn subjects(plan: &Plan, samples: bool, carried: &Carried) -> Vec<SubjectEntry> {
    let mut digests = digests(plan, samples);
    let entry = |case: &Arc<Case>| {
        let digest = digests.remove(&(case.group.clone(), case.spelling.clone()))?;
        let (name, source) = (case.spelling.clone(), case.source.clone());
        let label = label(&case.group, &case.spelling).map(str::to_string);
        let carried = carried.holds(&case.group, &case.spelling);
        Some(SubjectEntry { name, label, digest, source, carried })
    };
    plan.cases.iter().filter_map(entry).collect()
}

/// What became of the waivers of a plan, by the results of its cases. Those of checks that
/// were not run are left out: nothing can be said of them.
fn waivers(plan: &Plan, of_case: &BTreeMap<usize, Vec<CheckResult>>) -> Vec<WaiverRow> {
    let mut rows: Vec<(WaiverRow, bool)> = Vec::new();
    for (index, results) in of_case {
        let case = &plan.cases[*index];
        for waiver in &case.waivers {
            let subject = waiver.subject.as_ref().unwrap_or(&case.group);
            let until = waiver.until.map(|day| day.to_string());
            let same = |(row, _): &(WaiverRow, bool)| {
                (&row.check, &row.subject, &row.because, &row.until, row.at_most)
                    == (&waiver.check, subject, &waiver.because, &until, waiver.at_most)
            };
            let at = rows.iter().position(same).unwrap_or_else(|| {
                let row = WaiverRow {
                    check: waiver.check.clone(),
                    subject: subject.clone(),
                    because: waiver.because.clone(),
                    until,
                    at_most: waiver.at_most,
                    state: if waiver.expired { WaiverState::Expired } else { WaiverState::Unused },
                    covered: 0,
                };
                rows.push((row, false));
                rows.len() - 1
            });
            let (row, judged) = &mut rows[at];
            for result in results.iter().filter(|r| waiver.is_about(&case.spelling, &r.check)) {
                *judged |= result.verdict != Verdict::Skipped;
                row.covered += usize::from(result.verdict == Verdict::Waived);
                row.state = match (row.state, result.verdict) {
                    (WaiverState::Unused, Verdict::Waived) => WaiverState::Used,
                    (WaiverState::Unused | WaiverState::Used, Verdict::Fail) => WaiverState::Exceeded,
                    (state, _) => state,
                };
            }
        }
    }
    // One that names no subject of the plan covers nothing whatever is run.
    let named =
        |row: &WaiverRow| plan.cases.iter().any(|c| c.group == row.subject || c.spelling == row.subject);
    rows.retain(|(row, judged)| *judged || !named(row));
    rows.into_iter().map(|(row, _)| row).collect()
}

fn row(case: &CaseResult, finding: &Finding, files: &Files) -> CheckResult {
    let outcome = &finding.outcome;
    let figure = |v: f64| Figure(v);
    let description = case.evidence.as_ref().map(|e| &e.description);
    // The claims of a case that was not run, or was given up, are in force too.
    let asked = || Meter::describe(&*case.case.subject).ok();
    let kind = description.map(|d| d.kind).or_else(|| Some(asked()?.kind)).unwrap_or_default();
    CheckResult {
        subject: SubjectId {
            label: label(&case.case.group, &case.case.spelling).map(str::to_string),
            name: case.case.spelling.clone(),
            parameters: case.case.parameters.clone(),
            claims: description.map_or_else(
                || case.case.claims.over(asked().map(|d| d.claims).unwrap_or_default()),
                |d| d.claims,
            ),
        },
        check: finding.check.into(),
        wo: kind
            .has_directions()
            .then_some(WoAngles { theta_deg: case.case.theta_deg, phi_deg: case.case.phi_deg }),
        transport: case.case.transport,
        verdict: outcome.verdict,
        effect: outcome.effect.clone(),
        p_value: outcome.ln_p.map(|p| figure(p.exp())),
        log10_p: outcome.ln_p.map(|p| figure(p / LN_10)),
        threshold: outcome.ln_threshold.map(|p| figure(p.exp())),
        attempts: finding
            .attempts
            .iter()
            .map(|a| AttemptRow { seed: a.seed.clone(), samples: a.samples, log10_p: figure(a.ln_p / LN_10) })
            .collect(),
        channel: outcome.channel.and_then(|c| description.and_then(|d| d.channels.get(c).cloned())),
        samples: outcome.samples,
        evaluations: case.evidence.as_ref().map(|e| e.evaluations).unwrap_or_default(),
        detection_limit: outcome.detection_limit.map(figure),
        message: outcome.message.clone(),
        reason: outcome.reason.clone(),
        worst: outcome.worst.clone(),
        command: (files.command)(case, finding.check),
        evidence: (files.evidence)(case),
        plot: (files.plot)(case),
        waived_because: finding.waived_because.clone(),
    }
}
