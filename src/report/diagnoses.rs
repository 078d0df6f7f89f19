//! Verdicts of contests in words.

use super::json::Diagnosis;
use crate::bsdf::Direction;
use crate::cause::Cause;
use crate::checks::Verdict;
use crate::diagnosis::{self, Claim, Diagnosed, MARGIN};
use crate::engine::{CaseResult, Finding, Results};
use crate::evidence::{Figure, Place};
use std::collections::BTreeSet;

/// Degrees from the mirror or the refracted direction that count as near.
const NEAR: f64 = 15.0;

/// Degrees from the normal that count as near the horizon.
const GRAZING: f64 = 75.0;

impl Diagnosis {
    /// The verdicts on the subjects of a run.
    pub fn all(results: &Results, diagnosed: Vec<Diagnosed>) -> Vec<Self> {
        let of = |(subject, verdict): Diagnosed| {
            let cases: Vec<&CaseResult> =
                results.cases.iter().filter(|c| c.case.spelling == subject).collect();
            Self::new(subject, verdict, &cases)
        };
        diagnosed.into_iter().map(of).collect()
    }

    fn new(subject: String, verdict: diagnosis::Verdict, cases: &[&CaseResult]) -> Self {
        let diagnosis::Verdict { ranked, confident, unexplained, another, textbook, profile } = verdict;
        let Some((score, first)) = ranked.first() else {
            return Self {
                subject,
                cause: None,
                confident: false,
                statement: format!("none of the explanations fits: {}", region(cases)),
                repair: None,
                p_after_repair: None,
                runner_up: None,
                evidence: Vec::new(),
                textbook,
                profile,
                plot: None,
                page: None,
            };
        };
        let second = ranked.get(1).map(|(other, claim)| (score - other, claim));
        let rival = second.filter(|(behind, _)| *behind < MARGIN).map(|(_, claim)| claim);
        let (statement, repair) = match (confident, rival) {
            (true, _) => (first.statement.clone(), first.repair.clone()),
            (false, Some(other)) => (
                format!("one of these two: {}; or {}", named(first), named(other)),
                format!("{}; or {}", first.repair, other.repair),
            ),
            (false, None) => (format!("not certain: {}", first.statement), first.repair.clone()),
        };
        let mut evidence = first.evidence.clone();
        if !unexplained.is_empty() {
            let checks = listed(&unexplained);
            evidence.push(match &another {
                Some(other) => format!("{checks} must have another cause, as: {}", named(other)),
                None => format!("{checks} must have another cause, which none of the explanations names"),
            });
        }
        if !confident {
            evidence.push(region(cases));
        }
        Self {
            subject,
            cause: Some(first.cause.slug().into()),
            confident,
            statement,
            repair: Some(repair),
            p_after_repair: first.ln_p.map(|ln_p| Figure(ln_p.exp())),
            runner_up: second.map(|(behind, claim)| runner_up(behind, claim)),
            evidence,
            textbook,
            profile,
            plot: None,
            page: Some(page(first.cause)),
        }
    }
}

fn page(cause: Cause) -> String {
    format!("docs/causes/{}.md", cause.slug())
}

/// With its slug.
fn named(claim: &Claim) -> String {
    format!("{} [{}]", claim.statement, claim.cause.slug())
}

fn runner_up(behind: f64, claim: &Claim) -> String {
    format!("{}, {behind:.1} nats behind", named(claim))
}

fn fails(finding: &Finding) -> bool {
    finding.outcome.verdict == Verdict::Fail
}

/// Which checks fail, and where: θ of wo, its side, and where wi is at the worst places.
fn region(cases: &[&CaseResult]) -> String {
    let failing: Vec<&CaseResult> = cases.iter().copied().filter(|c| c.findings.iter().any(fails)).collect();
    let findings = || failing.iter().flat_map(|c| c.findings.iter().filter(|f| fails(f)));
    let mut checks: Vec<&str> = Vec::new();
    for finding in findings() {
        if !checks.contains(&finding.check) {
            checks.push(finding.check);
        }
    }
    let verb = if checks.len() == 1 { "fails" } else { "fail" };
    let words = format!("{} {verb}", listed(&checks));
    let description = failing.iter().find_map(|c| Some(&c.evidence.as_ref()?.description));
    match description {
        Some(d) if d.kind.has_directions() => {
            let places = findings().filter_map(|f| f.outcome.worst.as_ref());
            format!("{words} {}{}", of_wo(cases, &failing), of_wi(places, d.claims.eta))
        }
        _ => words,
    }
}

/// `a, b and c`.
fn listed(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).into(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

/// Where wo is in failing cases, by θ from the normal of its side.
fn of_wo(cases: &[&CaseResult], failing: &[&CaseResult]) -> String {
    let back = |c: &CaseResult| c.case.theta_deg > 90.0;
    // In thousandths, so that they can be compared.
    let theta = |c: &CaseResult| (c.case.theta_deg.min(180.0 - c.case.theta_deg) * 1e3).round() as i64;
    let all: BTreeSet<i64> = cases.iter().map(|c| theta(c)).collect();
    let some: BTreeSet<i64> = failing.iter().map(|c| theta(c)).collect();
    let degrees = |t: &i64| format!("{}°", *t as f64 / 1e3);
    let at = match (some.first(), some.last()) {
        _ if some == all && all.len() > 1 => "at every θ of wo".to_string(),
        (Some(least), Some(most)) => {
            let within = all.range(*least..=*most).count();
            if some.len() > 2 && within == some.len() {
                format!("at θ of wo from {} to {}", degrees(least), degrees(most))
            } else {
                let each: Vec<String> = some.iter().map(degrees).collect();
                format!("at θ of wo {}", listed(&each.iter().map(String::as_str).collect::<Vec<_>>()))
            }
        }
        _ => String::new(),
    };
    let both = cases.iter().any(|c| back(c)) && cases.iter().any(|c| !back(c));
    let sides: BTreeSet<bool> = failing.iter().map(|c| back(c)).collect();
    match (both, sides.len(), sides.contains(&true)) {
        (true, 1, true) => format!("{at}, only on the back"),
        (true, 1, false) => format!("{at}, only on the front"),
        _ => at,
    }
}

/// Where wi is, in most of these places.
fn of_wi<'a>(places: impl Iterator<Item = &'a Place>, eta: Option<f64>) -> String {
    let mut counts: Vec<(String, usize)> = Vec::new();
    let mut all = 0;
    for (wo, wi) in places.filter_map(|p| Some((p.wo, p.wi?))).filter(|(_, wi)| wi.is_finite()) {
        let words = where_is(wo, wi, eta);
        all += 1;
        match counts.iter_mut().find(|(w, _)| *w == words) {
            Some((_, n)) => *n += 1,
            None => counts.push((words, 1)),
        }
    }
    counts.sort_by_key(|(_, n)| usize::MAX - n);
    match counts.first() {
        None => String::new(),
        Some((words, n)) if *n == all => format!(", {words}"),
        Some((words, n)) if 2 * n > all => format!(", worst {words} ({n} of {all} places)"),
        Some(_) => ", in all kinds of places".into(),
    }
}

fn where_is(wo: Direction, wi: Direction, eta: Option<f64>) -> String {
    let near = |d: Direction| wi.angle(d).to_degrees() < NEAR;
    let mut found = Vec::new();
    if wo.same_side(wi) {
        if near(wo.mirrored()) {
            found.push("near the mirror direction");
        }
    } else if eta.and_then(|eta| refracted(wo, eta)).is_some_and(near) {
        found.push("near the refracted direction");
    }
    if wi.abs_cos_theta() < GRAZING.to_radians().cos() {
        found.push("near the horizon");
    }
    let side = if wo.same_side(wi) { "in reflection" } else { "in transmission" };
    match &found[..] {
        [] => format!("{side}, away from the mirror and the horizon"),
        found => format!("{side} {}", listed(found)),
    }
}

/// Where a smooth surface refracts wo to, with the index `eta` of the back over the front.
fn refracted(wo: Direction, eta: f64) -> Option<Direction> {
    let ratio = if wo.z > 0.0 { 1.0 / eta } else { eta };
    let (x, y) = (-wo.x * ratio, -wo.y * ratio);
    let cos2 = 1.0 - x * x - y * y;
    (cos2 > 0.0).then(|| Direction::new(x, y, -cos2.sqrt() * wo.z.signum()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::Outcome;
    use crate::engine::{Options, run};
    use crate::registry::Registry;
    use crate::suite::{Overrides, load};

    /// Cases of `subject`, of which those that `at` picks fail: (θ of wo, wi) of the worst.
    fn failing(subject: &str, theta: &str, at: impl Fn(f64, Direction) -> Option<Direction>) -> String {
        let text = format!(
            "[suite]\nname = \"s\"\nsamples = 4096\nphi = 17\ntheta = {theta}\n[[subject]]\nuse = \"{subject}\""
        );
        let only = Overrides { checks: vec!["sanity".into()], ..Overrides::default() };
        let plan = load("s", &text, &Registry::builtin(), &only).unwrap().plan;
        let mut results = run(&plan, &Options::default(), &mut |_| {});
        for case in &mut results.cases {
            let wo = case.case.wo();
            if let Some(wi) = at(case.case.theta_deg, wo) {
                let worst = Some(Place::pair(wo, wi));
                case.findings[0].outcome = Outcome { worst, ..Outcome::new(Verdict::Fail, "wrong") };
            }
        }
        region(&results.cases.iter().collect::<Vec<_>>())
    }

    #[test]
    fn places_are_told_in_words() {
        let grazing = Direction::from_angles(1.5, 2.0);
        let five = "[0, 30, 60, 75, 85]";
        for (subject, theta, at, words) in [
            ("lambert", five, (|_, wo: Direction| Some(wo.mirrored())) as fn(f64, Direction) -> _, "worst"),
            (
                "lambert",
                five,
                |t, _| (t > 59.0).then_some(Direction::from_angles(1.5, 2.0)),
                "from 60° to 85°",
            ),
            (
                "lambert",
                five,
                |t, wo| (t == 30.0).then_some(wo.mirrored()),
                "at θ of wo 30°, in reflection near",
            ),
            (
                "dielectric",
                "[30, 75, 105, 150]",
                |t, wo| (t > 90.0).then_some(wo.mirrored()),
                "only on the back",
            ),
            ("dielectric", "[30, 60]", |_, wo| Some(-wo), "in transmission"),
        ] {
            let told = failing(subject, theta, at);
            assert!(told.starts_with("sanity fails at ") && told.contains(words), "{told}");
        }
        assert_eq!(where_is(grazing, grazing, None), "in reflection near the horizon");
        assert_eq!(
            where_is(grazing, grazing.mirrored(), None),
            "in reflection near the mirror direction and near the horizon"
        );
        assert_eq!(
            where_is(Direction::NORMAL, -Direction::NORMAL, Some(1.5)),
            "in transmission near the refracted direction"
        );
        assert!(refracted(Direction::from_angles(2.0, 0.0), 1.5).is_none(), "total reflection");
    }

    fn said(ranked: Vec<(f64, Claim)>, confident: bool) -> Diagnosis {
        let verdict = diagnosis::Verdict {
            ranked,
            confident,
            unexplained: Vec::new(),
            another: None,
            textbook: None,
            profile: None,
        };
        Diagnosis::new("s".into(), verdict, &[])
    }

    #[test]
    fn doubt_is_told_as_doubt() {
        let claim = |cause, what: &str| Claim::new(cause, what, format!("mend {what}"));
        let (a, b) = (claim(Cause::Masking, "A").because("C"), claim(Cause::Frame, "B"));
        let sure = said(vec![(-1.0, a.clone()), (-9.0, b.clone())], true);
        assert_eq!((sure.statement.as_str(), sure.cause.as_deref()), ("A", Some("masking")));
        assert_eq!(sure.runner_up.as_deref(), Some("B [frame], 8.0 nats behind"));
        assert_eq!((sure.evidence.len(), sure.page.as_deref()), (1, Some("docs/causes/masking.md")));
        let two = said(vec![(-1.0, a.clone()), (-2.0, b)], false);
        assert_eq!(two.statement, "one of these two: A [masking]; or B [frame]");
        assert_eq!(two.repair.as_deref(), Some("mend A; or mend B"));
        assert_eq!((two.confident, two.evidence.len()), (false, 2));
        let vague = said(vec![(-18.0, a)], false);
        assert_eq!((vague.statement.as_str(), vague.runner_up), ("not certain: A", None));
        let none = said(Vec::new(), false);
        assert!(none.statement.starts_with("none of the explanations fits"));
        assert_eq!((none.cause, none.repair, none.page), (None, None, None));
    }
}
