//! Reports that differ in one thing.

use super::*;
use crate::bsdf::Transport;
use crate::checks::{Effect, Verdict};
use crate::evidence::Figure;
use crate::report::synthetic::{report, result};
use crate::report::{CheckResult, Report};

fn with(results: Vec<CheckResult>) -> Report {
    Report { results, diagnoses: Vec::new(), ..report() }
}

fn efficiency((value, low, high): (f64, f64, f64)) -> CheckResult {
    let effect = Some(Effect::interval("effective draws per draw", (value, low, high), 0.0));
    CheckResult { effect, ..result("a", "efficiency", 30.0, Verdict::Pass) }
}

fn limited(check: &str, limit: f64, statistical: bool) -> CheckResult {
    CheckResult {
        detection_limit: Some(Figure(limit)),
        log10_p: statistical.then_some(Figure(-1.0)),
        ..result("a", check, 30.0, Verdict::Pass)
    }
}

/// What is told of one result that becomes another: (worse, better, less sure).
fn told(before: CheckResult, after: CheckResult) -> (usize, usize, usize) {
    let found = compare(&with(vec![before]), &with(vec![after]));
    (found.worse.len(), found.better.len(), found.less_sure.len())
}

#[test]
fn verdicts_that_get_worse_and_better() {
    use Verdict::*;
    let rows = [
        (Pass, Fail, (1, 0, 0)),
        (Skipped, Fail, (1, 0, 0)),
        (Waived, Fail, (1, 0, 0)),
        (Inconclusive, Error, (1, 0, 0)),
        (Error, Fail, (1, 0, 0)),
        (Fail, Pass, (0, 1, 0)),
        (Inconclusive, Pass, (0, 1, 0)),
        // No longer tested is not mended.
        (Fail, Skipped, (0, 0, 1)),
        (Fail, Waived, (0, 0, 1)),
        (Pass, Skipped, (0, 0, 1)),
        (Pass, Inconclusive, (0, 0, 1)),
        (Skipped, Pass, (0, 0, 0)),
        (Fail, Fail, (0, 0, 0)),
    ];
    for (before, after, expected) in rows {
        let of = |verdict| result("a", "energy", 30.0, verdict);
        assert_eq!(told(of(before), of(after)), expected, "{before:?} {after:?}");
    }
}

#[test]
fn figures_must_change_beyond_noise() {
    let exact = |v| efficiency((v, v, v));
    assert_eq!(told(exact(0.8), exact(0.64)), (1, 0, 0));
    assert_eq!(told(exact(0.64), exact(0.8)), (0, 1, 0));
    // Within both intervals, or too little to matter.
    assert_eq!(told(efficiency((0.8, 0.7, 0.9)), efficiency((0.64, 0.5, 0.75))), (0, 0, 0));
    assert_eq!(told(exact(0.8), exact(0.79)), (0, 0, 0));
    assert_eq!(
        told(limited("goodness-of-fit", 0.02, true), limited("goodness-of-fit", 0.03, true)),
        (1, 0, 0)
    );
    assert_eq!(
        told(limited("goodness-of-fit", 0.02, true), limited("goodness-of-fit", 0.022, true)),
        (0, 0, 0)
    );
    // A share of places is no error that was looked for.
    assert_eq!(told(limited("weight", 0.02, false), limited("weight", 0.2, false)), (0, 0, 0));
}

#[test]
fn what_efficiency_explains_is_told_once() {
    let exact = |v| efficiency((v, v, v));
    let before = with(vec![exact(0.8), limited("albedo", 0.01, true)]);
    let found = compare(&before, &with(vec![exact(0.4), limited("albedo", 0.02, true)]));
    assert_eq!(found.worse.len(), 1);
    let alone = compare(&before, &with(vec![exact(0.8), limited("albedo", 0.02, true)]));
    assert_eq!(alone.worse.len(), 1);
}

#[test]
fn like_changes_of_many_directions_are_one_with_the_largest_first() {
    let all = |value: fn(f64) -> f64| {
        let at = |theta: f64| {
            let v = value(theta);
            CheckResult { wo: result("a", "b", theta, Verdict::Pass).wo, ..efficiency((v, v, v)) }
        };
        with([0.0, 30.0, 60.0].map(at).to_vec())
    };
    let found = compare(&all(|_| 0.8), &all(|theta| if theta == 30.0 { 0.3 } else { 0.6 }));
    assert_eq!(found.worse.len(), 1);
    let change = &found.worse[0];
    assert_eq!(change.places.iter().map(|p| p.wo.unwrap().theta_deg).collect::<Vec<_>>(), [30.0, 0.0, 60.0]);
    assert_eq!(change.what, What::Efficiency { before: Figure(0.8), after: Figure(0.3) });
}

#[test]
fn results_belong_together_by_row_direction_and_mode() {
    let of = |name, verdict| result(name, "energy", 30.0, verdict);
    let importance = CheckResult { transport: Transport::Importance, ..of("a", Verdict::Pass) };
    let labelled = |verdict| {
        let mut row = of("a", verdict);
        row.subject.label = Some("coat".into());
        row
    };
    let before = with(vec![
        of("a", Verdict::Pass),
        importance.clone(),
        labelled(Verdict::Fail),
        of("old", Verdict::Pass),
    ]);
    let after = with(vec![importance, labelled(Verdict::Fail), of("new", Verdict::Fail)]);
    let found = compare(&before, &after);
    assert_eq!(
        (found.added.clone(), found.removed.clone()),
        (vec!["new".to_string()], vec!["old".to_string()])
    );
    assert_eq!((found.removed_results, found.still_failing, found.same), (1, 1, 1));
    // A new subject that fails is worse.
    assert_eq!(found.worse.len(), 1);
    assert!(!found.is_quiet() && compare(&before, &before).is_quiet());
}

#[test]
fn a_comparison_survives_json() {
    let exact = |v| efficiency((v, v, v));
    let found =
        compare(&with(vec![exact(0.8)]), &with(vec![exact(0.5), result("b", "energy", 0.0, Verdict::Fail)]));
    let text = serde_json::to_string(&found).unwrap();
    assert_eq!(serde_json::from_str::<Comparison>(&text).unwrap(), found);
}
