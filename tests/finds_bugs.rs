//! Each check is seen to fail on a bug that breaks its identity, and to leave
//! alone a bug that does not.

mod common;

use common::measuring::{case, measure, told, verdicts};
use common::{Bug, Ggx};
use gonio::bsdf::{Direction, Transport};
use gonio::checks::{self, Verdict};
use gonio::evidence::{Company, Variant};
use gonio::suite::Waiver;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

/// A bug, the checks that must find it, and those that may.
type Row = (Bug, &'static [&'static str], &'static [&'static str]);

const ROWS: &[Row] = &[
    (Bug::None, &[], &[]),
    (Bug::CosineInD, &[], &[]),
    (Bug::PdfAlpha(0.05), &["goodness-of-fit", "jacobian"], &["normalization", "albedo", "mis"]),
    (Bug::PdfJacobian, &["goodness-of-fit", "normalization", "jacobian", "mis", "albedo"], &[]),
    (Bug::PdfFactor(1.05), &["goodness-of-fit", "normalization", "jacobian", "mis", "albedo"], &[]),
    (Bug::Redraw, &["goodness-of-fit", "normalization"], &["albedo", "mis"]),
    (Bug::HalfVector, &["goodness-of-fit", "jacobian"], &["normalization", "albedo", "mis", "support"]),
    (Bug::MirroredShare(0.05), &["goodness-of-fit"], &["albedo", "mis"]),
    (Bug::WeightCosine, &["weight", "albedo"], &["mis"]),
    (Bug::ReturnedPdf(1.1), &["returned-pdf"], &["mis"]),
    (Bug::FresnelAtNormal, &["reciprocity"], &[]),
    (
        Bug::Shifted(0.05),
        &["reciprocity", "goodness-of-fit", "jacobian"],
        &["albedo", "mis", "normalization"],
    ),
    (Bug::Bright(60.0), &["energy"], &[]),
    (Bug::NoHorizon, &["support"], &["albedo", "mis", "reciprocity"]),
    (Bug::Stray(1e-4), &["support"], &[]),
    (Bug::PhantomBack, &["support", "normalization", "goodness-of-fit"], &[]),
    (Bug::Counting, &["determinism"], &["jacobian"]),
    // Repeated samples are not independent, which every count presumes.
    (Bug::Repeating, &["determinism"], &["goodness-of-fit", "normalization"]),
    (
        Bug::NanPdf,
        &["sanity"],
        &[
            "goodness-of-fit",
            "normalization",
            "mis",
            "albedo",
            "support",
            "returned-pdf",
            "weight",
            "jacobian",
        ],
    ),
    (Bug::Length(1.01), &["sanity"], &["goodness-of-fit", "normalization", "albedo", "mis", "support"]),
    // The sign depends on the azimuth, which isotropy sees.
    (Bug::Negative, &["sanity"], &["weight", "albedo", "mis", "reciprocity", "isotropy"]),
    (Bug::Infinite, &["sanity"], &["weight", "albedo", "mis", "reciprocity"]),
    (Bug::NotImplemented, &["sanity"], &[]),
    (
        Bug::FlaggedDiscrete,
        &["discrete-lobes"],
        &["goodness-of-fit", "normalization", "support", "energy", "reciprocity", "albedo", "mis"],
    ),
    (
        Bug::UnflaggedMirror,
        &["discrete-lobes"],
        &["goodness-of-fit", "normalization", "support", "albedo", "mis", "determinism"],
    ),
];

#[test]
fn each_bug_is_found_by_the_checks_whose_identity_it_breaks_and_by_no_other() {
    for (bug, must, may) in ROWS {
        let cases = [30.0, 60.0, 80.0]
            .map(|theta| case(&format!("{bug:?}"), Arc::new(Ggx::new(0.3, *bug)), theta, 1 << 18));
        let results = measure(cases.into());
        let verdicts = verdicts(&results);
        let failed = verdicts.get(&Verdict::Fail).cloned().unwrap_or_default();
        for check in *must {
            assert!(failed.contains(check), "{bug:?} slips through {check}; failed: {failed:?}");
        }
        let wrong: Vec<_> = failed.iter().filter(|c| !must.contains(c) && !may.contains(c)).collect();
        assert!(wrong.is_empty(), "{bug:?} fails {wrong:?}: {:#?}", told(&results, Verdict::Fail));
        assert!(!verdicts.contains_key(&Verdict::Error), "{bug:?}: {:#?}", told(&results, Verdict::Error));
    }
}

/// The figures of METHOD: a roughness off by 1 % is found at any roughness
/// within 2²⁰ draws (and their confirmation).
#[test]
fn one_percent_of_roughness_is_found_from_0_5_to_0_001() {
    for alpha in [0.5, 0.1, 0.01, 0.001] {
        let cases = [0.0, 45.0, 75.0].map(|theta| {
            let name = format!("alpha {alpha}");
            let mut case = case(&name, Arc::new(Ggx::new(alpha, Bug::PdfAlpha(0.01))), theta, 1 << 20);
            case.checks = vec!["goodness-of-fit".into()];
            case
        });
        for result in measure(cases.into()) {
            let finding = &result.findings[0];
            assert_eq!(
                finding.outcome.verdict,
                Verdict::Fail,
                "{}: {}",
                result.case.label(),
                finding.outcome.message
            );
            assert_eq!(finding.attempts.len(), 2, "a failure is confirmed");
            assert!(finding.attempts[0].samples <= 1 << 20);
        }
    }
}

/// A width is told as one, by less of an error than cells need.
#[test]
fn a_wrong_width_is_seen_along_the_density() {
    for (error, word) in [(0.015, "narrower"), (-0.015, "wider")] {
        let mut case = case(word, Arc::new(Ggx::new(0.3, Bug::PdfAlpha(error))), 45.0, 1 << 18);
        case.checks = vec!["goodness-of-fit".into()];
        let results = measure(vec![case]);
        let outcome = &results[0].findings[0].outcome;
        let told = format!("the lobe is {word} than pdf says");
        assert_eq!(outcome.verdict, Verdict::Fail, "{}", outcome.message);
        assert!(outcome.message.contains("along the density"), "{}", outcome.message);
        assert!(outcome.message.contains(&told), "{}", outcome.message);
    }
}

#[test]
fn a_cosine_in_eval_is_a_convention_and_told_as_one() {
    let cases = [0.0, 30.0, 60.0, 85.0]
        .map(|theta| case("cosine", Arc::new(Ggx::new(0.3, Bug::UndeclaredCosine)), theta, 1 << 16));
    let results = measure(cases.into());
    let verdicts = verdicts(&results);
    assert_eq!(verdicts[&Verdict::Warn], BTreeSet::from(["weight"]));
    assert!(!verdicts.contains_key(&Verdict::Fail), "{:#?}", told(&results, Verdict::Fail));
}

#[test]
fn a_claim_that_does_not_hold_fails() {
    // Single scattering loses energy; a rotated frame is not isotropic.
    let mut lossless = case("lossless", Arc::new(Ggx::new(0.5, Bug::None)), 30.0, 1 << 16);
    lossless.claims.lossless = Some(true);
    let results = measure(vec![lossless]);
    assert_eq!(verdicts(&results)[&Verdict::Fail], BTreeSet::from(["white-furnace"]));

    let mut two_sided = case("two-sided", Arc::new(Ggx::new(0.5, Bug::None)), 30.0, 1 << 16);
    two_sided.claims.two_sided = Some(true);
    let results = measure(vec![two_sided]);
    assert_eq!(verdicts(&results)[&Verdict::Fail], BTreeSet::from(["sensitivity"]));
}

#[test]
fn a_waived_failure_is_waived_in_sight() {
    let mut waived = case("waived", Arc::new(Ggx::new(0.5, Bug::FresnelAtNormal)), 60.0, 1 << 16);
    waived.waivers =
        vec![Waiver { check: "reciprocity".into(), because: "a coat".into(), ..Waiver::default() }];
    let results = measure(vec![waived]);
    assert_eq!(verdicts(&results)[&Verdict::Waived], BTreeSet::from(["reciprocity"]));
    let finding = results[0].findings.iter().find(|f| f.check == "reciprocity").unwrap();
    assert_eq!(finding.waived_because.as_deref(), Some("a coat"));
}

#[test]
fn reference_and_sensitivity_see_what_they_are_for() {
    let run = |reference: f64, variant: f64| {
        let mut case = case("compared", Arc::new(Ggx::new(0.3, Bug::CosineInD)), 45.0, 1 << 16);
        let bug = if reference < 0.0 { Bug::CosineInD } else { Bug::None };
        case.company = Company {
            variants: vec![Variant {
                parameter: "alpha".into(),
                from: "0.3".into(),
                to: variant.to_string(),
                limit: None,
                build: Arc::new(move || Some(Arc::new(Ggx::new(variant, Bug::CosineInD)))),
            }],
            reference: Some(("other".into(), Arc::new(Ggx::new(reference.abs(), bug)))),
            within: None,
        };
        measure(vec![case])
    };
    let same = run(-0.3, 0.4);
    assert!(!verdicts(&same).contains_key(&Verdict::Fail), "{:#?}", told(&same, Verdict::Fail));
    // D·cosθh passes everything but a comparison with the right D.
    let other = run(0.3, 0.4);
    assert_eq!(verdicts(&other)[&Verdict::Fail], BTreeSet::from(["reference"]));
    let inert = run(-0.3, 0.3);
    assert_eq!(verdicts(&inert)[&Verdict::Fail], BTreeSet::from(["sensitivity"]));
}

#[test]
fn panics_and_hangs_are_errors_of_their_case_alone() {
    let mut hanging = case("hangs", Arc::new(Ggx::new(0.3, Bug::Hangs)), 45.0, 1 << 14);
    hanging.settings.time_limit = Duration::from_millis(300);
    let results = measure(vec![
        case("panics", Arc::new(Ggx::new(0.3, Bug::Panics)), 45.0, 1 << 14),
        hanging,
        case("fine", Arc::new(Ggx::new(0.3, Bug::None)), 45.0, 1 << 14),
    ]);
    assert_eq!(results.len(), 3);
    let panicked = told(&results[..1], Verdict::Error);
    assert!(
        panicked.iter().all(|m| m.contains("index out of bounds in the test's sampler")),
        "{panicked:#?}"
    );
    // What does not need the sampler was measured all the same.
    assert!(verdicts(&results[..1])[&Verdict::Pass].contains("reciprocity"));
    let hung = told(&results[1..2], Verdict::Error);
    assert!(!hung.is_empty() && hung.iter().all(|m| m.contains("time limit of 0.3 s")), "{hung:#?}");
    let fine = verdicts(&results[2..]);
    assert!(!fine.contains_key(&Verdict::Error) && !fine.contains_key(&Verdict::Fail));
}

#[test]
fn every_check_can_fail() {
    let mut seen: BTreeSet<&str> = ROWS.iter().flat_map(|(_, must, _)| must.iter().copied()).collect();
    // By the other tests of this file; efficiency is a figure and never fails.
    seen.extend(["white-furnace", "sensitivity", "reference", "isotropy", "efficiency"]);
    // By tests/parts.rs.
    seen.extend(["distribution", "fresnel"]);
    let all: BTreeSet<&str> = checks::all().iter().map(|c| c.id()).collect();
    assert_eq!(seen, all);
}

#[test]
fn isotropy_fails_where_the_azimuth_matters() {
    struct Brushed(Ggx);
    impl gonio::bsdf::Bsdf for Brushed {
        fn describe(&self) -> gonio::bsdf::Description {
            gonio::bsdf::Bsdf::describe(&self.0)
        }
        fn eval(&self, wo: Direction, wi: Direction, t: Transport) -> gonio::bsdf::Spectrum {
            let x = (wo + wi).x;
            gonio::bsdf::Bsdf::eval(&self.0, wo, wi, t) * (1.0 + x * x)
        }
        fn pdf(&self, wo: Direction, wi: Direction, t: Transport) -> f64 {
            gonio::bsdf::Bsdf::pdf(&self.0, wo, wi, t)
        }
        fn sample(&self, wo: Direction, u: &[f64], t: Transport) -> Option<gonio::bsdf::Sample> {
            let mut s = gonio::bsdf::Bsdf::sample(&self.0, wo, u, t)?;
            let x = (wo + s.wi).x;
            s.weight = s.weight * (1.0 + x * x);
            Some(s)
        }
    }
    let results = measure(vec![case("brushed", Arc::new(Brushed(Ggx::new(0.3, Bug::None))), 45.0, 1 << 16)]);
    assert_eq!(verdicts(&results)[&Verdict::Fail], BTreeSet::from(["isotropy"]));
}

/// Rounding is allowed for beside the largest value, and no more than that: a base
/// that is darker than the lobe's peak by ten orders is still seen to be asymmetric.
#[test]
fn a_dark_asymmetry_beside_a_bright_lobe_is_found() {
    struct OverBase(Ggx);
    fn base(wo: Direction, wi: Direction) -> f64 {
        if wo.z > 0.0 && wi.z > 0.0 { 1e-5 * wo.z } else { 0.0 }
    }
    impl gonio::bsdf::Bsdf for OverBase {
        fn describe(&self) -> gonio::bsdf::Description {
            gonio::bsdf::Bsdf::describe(&self.0)
        }
        fn eval(&self, wo: Direction, wi: Direction, t: Transport) -> gonio::bsdf::Spectrum {
            gonio::bsdf::Bsdf::eval(&self.0, wo, wi, t).map(|f| f + base(wo, wi))
        }
        fn pdf(&self, wo: Direction, wi: Direction, t: Transport) -> f64 {
            gonio::bsdf::Bsdf::pdf(&self.0, wo, wi, t)
        }
        fn sample(&self, wo: Direction, u: &[f64], t: Transport) -> Option<gonio::bsdf::Sample> {
            let mut s = gonio::bsdf::Bsdf::sample(&self.0, wo, u, t)?;
            s.weight = s.weight.map(|w| w + base(wo, s.wi) * s.wi.z / s.pdf);
            Some(s)
        }
    }
    let results = measure(vec![case("base", Arc::new(OverBase(Ggx::new(0.001, Bug::None))), 30.0, 1 << 16)]);
    assert_eq!(verdicts(&results)[&Verdict::Fail], BTreeSet::from(["reciprocity"]));
}
