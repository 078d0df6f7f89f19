//! From two reports to what changed.

use super::change::{Change, Comparison, Origin, What};
use super::pairs::{pairs, place};
use crate::checks::{Effect, Verdict};
use crate::evidence::Figure;
use crate::report::{CheckResult, Report};
use std::collections::BTreeSet;

/// A figure of efficiency must change by more than this part besides being outside of
/// both intervals: a share of effective draws that moves by less changes no picture.
const EFFICIENCY: f64 = 0.02;

/// A detection limit must change by more than this factor. It goes with 1/√N, so half
/// as many draws show (1.41), and another number of tests to share the budget with does not.
const LIMIT: f64 = 1.25;

/// Which list a change belongs to.
enum Direction {
    Worse,
    Better,
    LessSure,
}

/// Checks whose limit goes with the spread of weights, which efficiency tells.
const OF_WEIGHTS: [&str; 2] = ["albedo", "mis"];

/// What `after` says that `before` did not.
pub fn compare(before: &Report, after: &Report) -> Comparison {
    let (paired, left) = pairs(before, after);
    let mut found = Comparison { before: Origin::of(before), ..Comparison::default() };
    let mut changes = Vec::new();
    for (old, new) in paired {
        match change(old, new) {
            Some((direction, what)) => changes.push((old, new, direction, what)),
            None if is_bad(new.verdict) => found.still_failing += 1,
            None => found.same += 1,
        }
    }
    // One change is told once: what efficiency explains is not told of limits again.
    let of = |r: &CheckResult| (r.subject.name.clone(), r.subject.label.clone(), place(r));
    let efficiencies: Vec<_> = changes
        .iter()
        .filter(|(.., what)| matches!(what, What::Efficiency { .. }))
        .map(|(_, new, ..)| of(new))
        .collect();
    for (old, new, direction, what) in changes {
        let explained = matches!(what, What::DetectionLimit { .. })
            && OF_WEIGHTS.contains(&new.check.as_str())
            && efficiencies.contains(&of(new));
        if explained {
            found.same += 1;
            continue;
        }
        let (list, report, told) = match direction {
            Direction::Worse => (&mut found.worse, after, new),
            Direction::Better => (&mut found.better, before, old.unwrap_or(new)),
            Direction::LessSure => (&mut found.less_sure, after, new),
        };
        add(list, new, what, cause(report, &new.subject.name), &told.message);
    }
    let names = |report: &'_ Report| -> BTreeSet<String> {
        report.results.iter().map(|r| r.subject.name.clone()).collect()
    };
    let (old, new) = (names(before), names(after));
    found.added = new.difference(&old).cloned().collect();
    found.removed = old.difference(&new).cloned().collect();
    found.removed_results = left.iter().filter(|r| new.contains(&r.subject.name)).count();
    found
}

/// Adds a change to the like changes of the same check and subject.
fn add(list: &mut Vec<Change>, of: &CheckResult, what: What, cause: Option<String>, message: &str) {
    let same = |c: &&mut Change| {
        c.subject == of.subject.name
            && c.label == of.subject.label
            && c.check == of.check
            && alike(&c.what, &what)
    };
    match list.iter_mut().find(same) {
        Some(known) if size(&what) > size(&known.what) => {
            known.what = what;
            known.message = message.into();
            known.places.insert(0, place(of));
        }
        Some(known) => known.places.push(place(of)),
        None => list.push(Change {
            subject: of.subject.name.clone(),
            label: of.subject.label.clone(),
            check: of.check.clone(),
            what,
            places: vec![place(of)],
            cause,
            message: message.into(),
        }),
    }
}

/// Whether both tell the same kind of change, so that one line says it for both.
fn alike(a: &What, b: &What) -> bool {
    match (a, b) {
        (What::Verdict { .. }, What::Verdict { .. }) => a == b,
        _ => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// How large a change of a figure is, by its ratio.
fn size(what: &What) -> f64 {
    match what {
        What::Verdict { .. } => 0.0,
        What::Efficiency { before, after } | What::DetectionLimit { before, after } => {
            (after.0 / before.0).ln().abs()
        }
    }
}

fn cause(report: &Report, subject: &str) -> Option<String> {
    let found = report.diagnoses.iter().find(|d| d.subject == subject)?;
    found.cause.clone().filter(|_| found.confident)
}

fn is_bad(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Fail | Verdict::Error)
}

fn change(old: Option<&CheckResult>, new: &CheckResult) -> Option<(Direction, What)> {
    use Verdict::{Inconclusive, Pass, Skipped, Waived, Warn};
    let (before, after) = (old.map(|o| o.verdict), new.verdict);
    if before != Some(after) {
        let direction = match (before, after) {
            (_, after) if is_bad(after) => Direction::Worse,
            (Some(before), Pass) if is_bad(before) => Direction::Better,
            (Some(Inconclusive | Warn), Pass) => Direction::Better,
            // Not known to be right, only no longer known to be wrong.
            (Some(before), _) if is_bad(before) => Direction::LessSure,
            (Some(Pass), Inconclusive | Skipped | Warn | Waived) => Direction::LessSure,
            _ => return None,
        };
        return Some((direction, What::Verdict { before, after }));
    }
    let old = old?;
    if after != Pass {
        return None;
    }
    efficiency(old, new).or_else(|| limit(old, new))
}

fn efficiency(old: &CheckResult, new: &CheckResult) -> Option<(Direction, What)> {
    if new.check != "efficiency" {
        return None;
    }
    let (a, b) = (old.effect.as_ref()?, new.effect.as_ref()?);
    // Reports of before intervals were told have none: their values stand for them.
    let interval = |e: &Effect| (e.low.0.min(e.value.0), e.high.0.max(e.value.0));
    let ((a_low, a_high), (b_low, b_high)) = (interval(a), interval(b));
    let what = What::Efficiency { before: a.value, after: b.value };
    if b_high < a_low && b.value.0 < a.value.0 * (1.0 - EFFICIENCY) {
        Some((Direction::Worse, what))
    } else if b_low > a_high && b.value.0 > a.value.0 * (1.0 + EFFICIENCY) {
        Some((Direction::Better, what))
    } else {
        None
    }
}

/// Of statistical checks: what exact ones say is a share of places, which goes with
/// how many were looked at.
fn limit(old: &CheckResult, new: &CheckResult) -> Option<(Direction, What)> {
    let limit = |r: &CheckResult| r.detection_limit.filter(|_| r.log10_p.is_some()).map(|l| l.0);
    let (a, b) = (limit(old)?, limit(new)?);
    let what = What::DetectionLimit { before: Figure(a), after: Figure(b) };
    if b > a * LIMIT {
        Some((Direction::Worse, what))
    } else if b < a / LIMIT {
        Some((Direction::Better, what))
    } else {
        None
    }
}
