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
/// person; what was skipped was not shown to hold, and other conventions than those of the
/// course (a warning elsewhere) are a mistake.
fn is_passed(verdict: Verdict) -> bool {
    match verdict {
        Verdict::Pass | Verdict::Waived | Verdict::Inconclusive => true,
        Verdict::Fail | Verdict::Warn | Verdict::Error | Verdict::Skipped => false,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grading::load;
    use crate::report::synthetic::{report, result};

    const RUBRIC: &str = r#"
[rubric]
theta = [10, 20, 30, 40]
[[language]]
when = "x"
wasm = "x.wasm"
[model.a]
[[item]]
id = "builds"
points = 1
[[item]]
id = "part"
points = 1
subject = "a"
checks = ["sanity", "weight"]
[[item]]
id = "whole"
points = 7
kind = "bonus"
credit = "whole"
needs = "part"
subject = "a"
checks = "weight"
[[item]]
id = "taken"
points = 2
kind = "penalty"
subject = "a"
checks = "energy"
[[item]]
id = "after"
points = 3
needs = ["builds", "whole"]
subject = "a"
checks = "sanity"
"#;

    /// The grades where four directions have these verdicts of sanity, weight and energy.
    fn graded(verdicts: [[Verdict; 3]; 4]) -> (Vec<ItemGrade>, Vec<String>, f64) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rubric.toml");
        std::fs::write(&path, RUBRIC).unwrap();
        let rubric = load(&path, true).unwrap();
        let measurement = Measurement::of(&rubric);
        let mut results = Vec::new();
        for (case, verdicts) in measurement.cases.iter().zip(verdicts) {
            for (check, verdict) in ["sanity", "weight", "energy"].into_iter().zip(verdicts) {
                let mut row = result("a", check, case.theta, verdict);
                row.wo.as_mut().unwrap().phi_deg = case.phi;
                results.push(row);
            }
        }
        let report = Report { results, ..report() };
        let measured = Measured::of(&measurement, &report).unwrap();
        let (items, review) = score(&rubric, &measurement, &measured);
        let total = total(&items);
        (items, review, total)
    }

    fn earned(items: &[ItemGrade]) -> Vec<f64> {
        items.iter().map(|item| item.earned).collect()
    }

    use Verdict::*;
    const RIGHT: [Verdict; 3] = [Pass, Pass, Pass];

    #[test]
    fn points_go_by_the_fraction_of_cases() {
        let (items, review, total) = graded([RIGHT; 4]);
        assert_eq!((earned(&items), total), (vec![1.0, 1.0, 7.0, 0.0, 3.0], 12.0));
        assert!(review.is_empty() && items.iter().all(|item| item.lost.is_empty() && !item.is_lost()));
        let (items, _, total) = graded([RIGHT, RIGHT, RIGHT, [Fail, Pass, Fail]]);
        assert_eq!((earned(&items), total), (vec![1.0, 0.75, 7.0, -0.5, 2.25], 10.5));
        assert_eq!((items[1].cases, items[1].passed, items[1].lost.len()), (4, 3, 1));
        assert_eq!(items[1].lost[0].wo.unwrap().theta_deg, 40.0);
    }

    #[test]
    fn what_was_not_shown_is_lost_and_what_cannot_be_decided_is_not() {
        for verdict in [Fail, Error, Skipped, Warn] {
            let (items, _, total) = graded([[Pass, verdict, Pass]; 4]);
            assert_eq!(earned(&items), [1.0, 0.0, 0.0, 0.0, 0.0], "{verdict:?}");
            assert_eq!(items[2].unmet.as_deref(), Some("part"));
            assert_eq!(items[4].unmet.as_deref(), Some("whole"), "what was not scored earned nothing");
            assert_eq!(total, 1.0);
        }
        for verdict in [Waived, Inconclusive] {
            let (items, review, total) = graded([[Pass, verdict, Pass]; 4]);
            assert_eq!((earned(&items)[2], total), (7.0, 12.0), "{verdict:?}");
            assert_eq!(review.is_empty(), verdict == Waived, "{review:?}");
        }
    }

    #[test]
    fn a_penalty_takes_no_more_than_there_is() {
        let (items, _, total) = graded([[Fail, Fail, Fail]; 4]);
        assert_eq!((earned(&items), total), (vec![1.0, 0.0, 0.0, -2.0, 0.0], 0.0));
    }

    #[test]
    fn results_of_another_measurement_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rubric.toml");
        std::fs::write(&path, RUBRIC).unwrap();
        let measurement = Measurement::of(&load(&path, true).unwrap());
        let of = |results| Measured::of(&measurement, &Report { results, ..report() }).err();
        assert_eq!(of(Vec::new()).as_deref(), Some("its report is shorter"));
        let rows = |check: &str| (0..12).map(|_| result("a", check, 10.0, Pass)).collect();
        assert_eq!(of(rows("mis")).as_deref(), Some("its report is of another measurement"));
    }
}
