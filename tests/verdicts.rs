//! Verdicts that were wrong once: false alarms, and errors that passed for something
//! else.

mod common;

use common::measuring::{case, measure, told, verdicts};
use gonio::bsdf::{
    Bsdf, Description, Direction, Lobe, NormalDistribution, Normals, RandomNumbers, Sample, Spectrum,
    Subject, Transport,
};
use gonio::checks::Verdict;
use gonio::engine::{CaseResult, Finding};
use gonio::models::Dielectric;
use gonio::registry::Registry;
use gonio::suite::Case;
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A case of a registered subject, with one check.
fn registered(spelling: &str, theta: f64, samples: u64, check: &str) -> Case<'static> {
    let resolved = Registry::builtin().resolve(&spelling.parse().unwrap()).unwrap();
    Case { checks: vec![check.into()], ..case(spelling, resolved.subject, theta, samples) }
}

fn found<'a>(result: &'a CaseResult, check: &str) -> &'a Finding {
    result.findings.iter().find(|f| f.check == check).unwrap()
}

/// pdf has a step there, of which the cubature is off by as much as what it leaves for
/// draws without a sample, of which there are none.
#[test]
fn a_step_in_pdf_is_no_surplus_of_samples() {
    let cases = [75.0, 80.0, 85.0, 89.0].map(|theta| {
        let control = "control-off-support-returned";
        Case { phi_deg: 17.0, ..registered(control, theta, 1 << 20, "goodness-of-fit") }
    });
    for result in measure(cases.into()) {
        let outcome = &found(&result, "goodness-of-fit").outcome;
        assert_eq!(outcome.verdict, Verdict::Pass, "{}: {}", result.case.label(), outcome.message);
    }
}

/// Its reverse is not met, by whatever scale light is transmitted.
#[test]
fn a_wrong_angle_of_refraction_is_no_scale_of_transport() {
    let mut cases = Vec::new();
    for eta in [1.1, 1.3, 1.5, 1.8, 2.0, 2.2, 2.5] {
        for theta in [30.0, 75.0, 87.0, 88.0, 88.5, 89.0, 89.5, 105.0, 150.0] {
            let mutant = format!("mutant-snell-by-tangents:eta={eta}");
            cases.push(registered(&mutant, theta, 1 << 14, "white-furnace"));
        }
    }
    let failed = told(&measure(cases), Verdict::Fail);
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Cosine-weighted white.
fn lambert(u: &[f64]) -> (Direction, f64) {
    let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
    let (r, z) = (u[0].sqrt(), (1.0 - u[0]).sqrt());
    (Direction::new(r * cos, r * sin, z), z / PI)
}

/// What is planted in white Lambert.
enum Planted {
    /// sample() and pdf() are NaN.
    NotANumber,
    /// eval() is this much brighter, on the white fields of a board of many.
    Board(f64),
    /// eval() panics.
    Mute,
    /// From the start to this draw samples go to x > 0 much too often, then this share.
    Leaning { until: u64, share: f64, drawn: AtomicU64 },
}

impl Bsdf for Planted {
    fn describe(&self) -> Description {
        Description::new("planted").dimensions(3).claims(|c| {
            if matches!(self, Self::Leaning { .. }) {
                c.rng = RandomNumbers::Internal;
            }
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let above = wo.z > 0.0 && wi.z > 0.0;
        let f = match self {
            Self::Board(factor) => factor * 2.0 * white_field(wi) / PI,
            Self::Mute => panic!("nobody reads this"),
            _ => 0.5 / PI,
        };
        Spectrum::from(if above { f } else { 0.0 })
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        match self {
            Self::NotANumber => f64::NAN,
            _ if wo.z > 0.0 => wi.z.max(0.0) / PI,
            _ => 0.0,
        }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let (mut wi, mut pdf) = lambert(u);
        match self {
            Self::NotANumber => pdf = f64::NAN,
            Self::Board(_) => {}
            Self::Mute => {
                let weight = Spectrum::from(0.5);
                return (wo.z > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION });
            }
            Self::Leaning { until, share, drawn } => {
                let early = drawn.fetch_add(1, Ordering::Relaxed) < *until;
                if u[2] < if early { 0.3 } else { *share } {
                    wi.x = wi.x.abs();
                }
            }
        }
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (wo.z > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

/// 1 on half of the fields of a board, whose edges the cubature does not resolve, else 0.
fn white_field(w: Direction) -> f64 {
    let fields = (3.0 * w.x).floor() + (3.0 * w.y).floor();
    if fields.rem_euclid(2.0) == 0.0 { 1.0 } else { 0.0 }
}

#[test]
fn what_returns_no_number_is_broken_and_not_missing() {
    let results = measure(vec![case("nan", Arc::new(Planted::NotANumber), 30.0, 1 << 14)]);
    let sanity = &found(&results[0], "sanity").outcome;
    assert_eq!(sanity.verdict, Verdict::Fail);
    assert!(sanity.message.contains("pdf() is finite"), "{}", sanity.message);
    let skipped = told(&results, Verdict::Skipped);
    assert!(skipped.iter().all(|m| !m.contains("not implemented")), "{skipped:#?}");
}

#[test]
fn eval_is_called_only_where_a_check_reads_it() {
    let judged = |checks: &[&str]| {
        let mut mute = case("mute", Arc::new(Planted::Mute), 30.0, 1 << 18);
        mute.checks = checks.iter().map(|check| (*check).into()).collect();
        measure(vec![mute]).remove(0)
    };
    let spared = judged(&["goodness-of-fit", "normalization", "jacobian"]);
    assert_eq!(told(&[spared], Verdict::Pass).len(), 3);
    let called = judged(&["normalization", "energy"]);
    assert_eq!(found(&called, "normalization").outcome.verdict, Verdict::Pass);
    let energy = &found(&called, "energy").outcome;
    assert_eq!(energy.verdict, Verdict::Error);
    assert!(energy.message.contains("nobody reads this"), "{}", energy.message);
}

/// Judged alone, without eval, a check says what it says beside all others; and a failure
/// leaves the evidence of one that eval was called for.
#[test]
fn sparing_eval_changes_no_number() {
    for subject in ["mutant-no-jacobian", "torrance-sparrow:alpha=0.1"] {
        let alone = registered(subject, 60.0, 1 << 16, "goodness-of-fit");
        let all = Case { checks: Vec::new(), ..alone.clone() };
        let results = measure(vec![alone, all]);
        let [alone, all] = &results[..] else { panic!("two cases") };
        let [one, other] = [alone, all].map(|r| &found(r, "goodness-of-fit").outcome);
        assert_eq!((one.verdict, one.ln_p, &one.message), (other.verdict, other.ln_p, &other.message));
        let [one, other] = [alone, all].map(|r| r.evidence.as_ref().unwrap());
        assert_eq!(one.partition, other.partition);
        if subject.starts_with("mutant") {
            assert_eq!(found(alone, "goodness-of-fit").outcome.verdict, Verdict::Fail);
            assert_eq!((&one.integrals, &one.samples), (&other.integrals, &other.samples));
        } else {
            let [one, other] = [one, other].map(|evidence| evidence.integrals.as_ref().unwrap());
            assert_eq!((&one.pdf, one.cross_check), (&other.pdf, other.cross_check));
            assert!(one.value.is_empty() && !other.value.is_empty());
        }
    }
}

/// A suspicion at the first look, of an error that only all draws confirm.
#[test]
fn a_suspicion_is_followed_to_the_cap() {
    // The pilot and the first look.
    let until = (1 << 15) + (1 << 14);
    let planted = Planted::Leaning { until, share: 0.011, drawn: AtomicU64::new(0) };
    let mut leaning = case("leaning", Arc::new(planted), 30.0, 1 << 20);
    leaning.checks = vec!["goodness-of-fit".into()];
    let results = measure(vec![leaning]);
    let finding = found(&results[0], "goodness-of-fit");
    let drawn: Vec<u64> = finding.attempts.iter().map(|a| a.samples).collect();
    assert_eq!(finding.outcome.verdict, Verdict::Fail, "{}", finding.outcome.message);
    assert_eq!(drawn, [1 << 14, 1 << 20]);
}

#[test]
fn large_errors_of_what_jumps_are_told() {
    let told = [Verdict::Inconclusive, Verdict::Fail];
    for (factor, energy, furnace) in
        [(0.8, told[0], told[1]), (1.0, told[0], told[0]), (1.3, told[1], told[1])]
    {
        let mut board = case("board", Arc::new(Planted::Board(factor)), 30.0, 1 << 14);
        board.claims.lossless = Some(true);
        let results = measure(vec![board]);
        for (check, verdict) in [("energy", energy), ("white-furnace", furnace)] {
            let outcome = &found(&results[0], check).outcome;
            assert_eq!(outcome.verdict, verdict, "{check} of {factor}: {}", outcome.message);
        }
        let outcome = &found(&results[0], "albedo").outcome;
        assert!(outcome.message.contains("unreliable"), "the cubature resolves it: {}", outcome.message);
        // It is eval that jumps, and not pdf.
        let outcome = &found(&results[0], "goodness-of-fit").outcome;
        assert!(!outcome.message.contains("unreliable"), "{}", outcome.message);
    }
    for (factor, verdict) in [(1.0, told[0]), (1.3, told[1])] {
        let subject = Arc::new(Normals::all(Facets(factor)));
        let mut facets = case("facets", subject, 0.0, 1 << 14);
        facets.checks = vec!["distribution".into()];
        let results = measure(vec![facets]);
        let outcome = &found(&results[0], "distribution").outcome;
        assert_eq!(outcome.verdict, verdict, "{factor}: {}", outcome.message);
    }
}

/// D is this factor's share of what it must be, on the white fields of a board.
struct Facets(f64);

impl NormalDistribution for Facets {
    fn describe(&self) -> Description {
        Description::new("board").dimensions(3)
    }

    fn density(&self, m: Direction) -> f64 {
        if m.z > 0.0 { 2.0 * self.0 * white_field(m) / PI } else { 0.0 }
    }

    fn g1(&self, _: Direction, _: Direction) -> f64 {
        1.0
    }

    fn sample(&self, u: &[f64]) -> Direction {
        lambert(u).0
    }
}

#[test]
fn discrete_lobes_are_compared_with_the_reference() {
    let compared = |subject: f64, reference: f64, theta: f64| {
        let mut case = case("glass", Arc::new(Dielectric { eta: subject }), theta, 1 << 14);
        case.checks = vec!["reference".into()];
        let reference: Arc<dyn Subject> = Arc::new(Dielectric { eta: reference });
        case.company.reference = Some(("other".into(), reference));
        measure(vec![case])
    };
    // At the normal both refract the same way, in different parts.
    for theta in [0.0, 60.0, 150.0] {
        let same = compared(1.5, 1.5, theta);
        let verdicts = verdicts(&same);
        assert_eq!(
            verdicts.keys().collect::<Vec<_>>(),
            [&Verdict::Pass],
            "{:#?}",
            told(&same, Verdict::Fail)
        );
        let passed = &told(&same, Verdict::Pass)[0];
        assert!(passed.contains("in its discrete lobes"), "{passed}");
        let failed = told(&compared(1.5, 1.6, theta), Verdict::Fail);
        assert!(failed.len() == 1 && failed[0].contains("discrete lobes of other"), "{failed:#?}");
    }
}
