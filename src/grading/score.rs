//! From results to points.

use super::grade::{ItemGrade, ItemKind, Lost};
use super::plan::Measurement;
use super::rubric::{Credit, Item, Rubric};
use crate::checks::Verdict;
use crate::report::{CheckResult, Report};
use std::collections::BTreeMap;

/// What was measured of a submission: the rows of each case, or nothing where it is broken.
pub struct Measured<'a> {
    rows: Option<Vec<&'a [CheckResult]>>,
}

impl<'a> Measured<'a> {
    /// The results of a report of this measurement.
    ///
    /// # Errors
    /// In a sentence, where the report is of another one.
    pub fn of(measurement: &Measurement, report: &'a Report) -> Result<Self, String> {
        let mut rest = &report.results[..];
        let mut rows = Vec::new();
        for case in &measurement.cases {
            let (own, others) = rest.split_at_checked(case.checks.len()).ok_or("its report is shorter")?;
            let fits = |(row, check): (&CheckResult, &String)| {
                let at = row.wo.map(|wo| (wo.theta_deg, wo.phi_deg));
                row.check == *check && row.subject.name == case.spelling && at == Some((case.theta, case.phi))
            };
            if !own.iter().zip(&case.checks).all(fits) {
                return Err("its report is of another measurement".into());
            }
            rows.push(own);
            rest = others;
        }
        if rest.is_empty() { Ok(Self { rows: Some(rows) }) } else { Err("its report is longer".into()) }
    }

    /// Nothing: it could not be measured.
    pub fn nothing() -> Self {
        Self { rows: None }
    }
}

/// The items of a rubric with what was earned, and what a teacher should look at.
pub fn score(
    rubric: &Rubric,
    measurement: &Measurement,
    measured: &Measured,
) -> (Vec<ItemGrade>, Vec<String>) {
    let mut earned_any: BTreeMap<&str, bool> = BTreeMap::new();
    let mut grades = Vec::new();
    let mut review = Vec::new();
    for (item, cases) in rubric.items.iter().zip(&measurement.of_item) {
        let unmet = item.needs.iter().find(|need| earned_any.get(need.as_str()) == Some(&false));
        let mut grade = ItemGrade {
            id: item.id.clone(),
            title: item.title.clone(),
            kind: item.kind,
            hidden: item.hidden,
            points: item.points,
            earned: 0.0,
            cases: cases.len(),
            passed: 0,
            unmet: unmet.cloned(),
            loss: item.loss.clone(),
            hints: item.hints,
            lost: Vec::new(),
        };
        let fraction = match &measured.rows {
            None => 0.0,
            Some(_) if cases.is_empty() => 1.0,
            Some(rows) => {
                let mut undecided = 0;
                for case in cases {
                    let rows: Vec<&CheckResult> =
                        rows[*case].iter().filter(|row| item.checks.contains(&row.check)).collect();
                    grade.passed += usize::from(rows.iter().all(|row| is_passed(row.verdict)));
                    grade.lost.extend(rows.iter().filter(|r| !is_passed(r.verdict)).map(|row| lost(row)));
                    undecided += usize::from(rows.iter().any(|r| r.verdict == Verdict::Inconclusive));
                }
                if undecided > 0 {
                    review.push(format!(
                        "{}: {undecided} of {} cases could not be decided",
                        item.id,
                        cases.len()
                    ));
                }
                match item.credit {
                    Credit::Fraction => grade.passed as f64 / cases.len() as f64,
                    Credit::Whole => f64::from(u8::from(grade.passed == cases.len())),
                }
            }
        };
        let counts = unmet.is_none() && measured.rows.is_some();
        grade.earned = match item.kind {
            _ if !counts => 0.0,
            // Hundredths are what tables of grades take.
            ItemKind::Regular | ItemKind::Bonus => hundredths(item.points * fraction),
            ItemKind::Penalty => 0.0 - hundredths(item.points * (1.0 - fraction)),
        };
        earned_any.insert(&item.id, counts && earns(item, fraction));
        grades.push(grade);
    }
    (grades, review)
}

fn earns(item: &Item, fraction: f64) -> bool {
    match item.kind {
        ItemKind::Regular | ItemKind::Bonus => fraction > 0.0,
        ItemKind::Penalty => fraction == 1.0,
    }
}

/// A verdict that takes nothing. What cannot be decided is no loss, and is looked at by a
/// person; what was skipped was not shown to hold.
fn is_passed(verdict: Verdict) -> bool {
    match verdict {
        Verdict::Pass | Verdict::Warn | Verdict::Waived | Verdict::Inconclusive => true,
        Verdict::Fail | Verdict::Error | Verdict::Skipped => false,
    }
}

fn lost(row: &CheckResult) -> Lost {
    Lost {
        subject: row.subject.name.clone(),
        check: row.check.clone(),
        wo: row.wo,
        transport: row.transport,
        verdict: row.verdict,
        message: row.message.clone(),
        effect: row.effect.clone(),
        worst: row.worst.clone(),
        evidence: row.evidence.clone(),
    }
}

fn hundredths(points: f64) -> f64 {
    (100.0 * points).round() / 100.0
}

/// The sum of what was earned, at least 0.
pub fn total(items: &[ItemGrade]) -> f64 {
    hundredths(items.iter().map(|item| item.earned).sum::<f64>().max(0.0))
}
