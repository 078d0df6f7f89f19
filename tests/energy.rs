//! Models that give back what one bounce loses pass the white furnace at every
//! angle and roughness, and the bugs that such models have are found by the checks
//! whose identity they break.

use gonio::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Subject, Transport};
use gonio::checks::Verdict;
use gonio::engine::{Options, Results, run};
use gonio::models::microfacet::{
    Distribution, Fresnel, GgxLoss, Masking, NormalSampling, Roughness, TorranceSparrow,
};
use gonio::registry::Registry;
use gonio::suite::{Case, Plan, Settings};
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Duration;

/// Measures white-furnace alone, and returns the flux farthest from 1 and where.
fn worst_furnace(spellings: impl Iterator<Item = String>, thetas: &[f64]) -> (f64, String) {
    let registry = Registry::builtin();
    let mut cases = Vec::new();
    for spelling in spellings {
        let resolved = registry.resolve(&spelling.parse().unwrap()).unwrap();
        for theta in thetas {
            cases.push(Arc::new(Case {
                group: spelling.clone(),
                spelling: spelling.clone(),
                source: None,
                subject: resolved.subject.clone(),
                parameters: resolved.parameters.clone(),
                theta_deg: *theta,
                phi_deg: 137.0,
                transport: Transport::Radiance,
                claims: Default::default(),
                waivers: Vec::new(),
                company: Default::default(),
                reference: None,
                checks: vec!["white-furnace".into()],
                settings: Settings { samples: 1 << 12, ..Settings::default() },
            }));
        }
    }
    let plan = Plan { suite: "furnace".into(), seed: 1, false_alarm: 1e-6, share: None, cases };
    let results = run(&plan, &Options::default(), &mut |_| {});
    let mut worst = (0.0, String::new());
    for (case, finding) in results.cases.iter().flat_map(|r| r.findings.iter().map(move |f| (r, f))) {
        let outcome = &finding.outcome;
        assert_eq!(outcome.verdict, Verdict::Pass, "{}: {}", case.case.label(), outcome.message);
        let off = outcome.effect.as_ref().unwrap().value.0;
        if f64::abs(off) > f64::abs(worst.0) {
            worst = (off, case.case.label());
        }
    }
    worst
}

/// The angles of the default suite. The models' own tests go on to 89.99°, by a
/// quadrature that knows where f is steep.
const ANGLES: [f64; 6] = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0];

#[test]
fn ggx_multiscatter_passes_the_white_furnace_everywhere() {
    let alphas = [0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0];
    let spellings = alphas.iter().map(|a| format!("ggx-multiscatter:alpha={a}"));
    let (off, place) = worst_furnace(spellings, &ANGLES);
    println!("ggx-multiscatter: flux − 1 is {off:.1e} at worst, {place}");
    assert!(off.abs() < 1e-4, "{off:e} at {place}");
}

#[test]
fn oren_nayar_eon_passes_the_white_furnace_everywhere() {
    let roughness = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
    let spellings = roughness.iter().map(|r| format!("oren-nayar-eon:reflectance=1,roughness={r}"));
    let (off, place) = worst_furnace(spellings, &ANGLES);
    println!("oren-nayar-eon: flux − 1 is {off:.1e} at worst, {place}");
    assert!(off.abs() < 1e-4, "{off:e} at {place}");
}

/// What is wrong with [`Compensated`].
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// E is looked up at the angle to the half vector.
    WrongAngle,
    /// 1/(1 − E_avg) is missing.
    NoAverage,
    /// There is no lobe of many bounces, and the model is still said to be lossless.
    SingleOnly,
    /// The densities of both lobes are added without the probability of the lobe.
    ShareNotFolded,
}

/// GGX with Kulla and Conty's compensation, put together anew from its parts.
struct Compensated {
    single: TorranceSparrow,
    loss: Arc<GgxLoss>,
    fault: Fault,
}

impl Compensated {
    fn new(alpha: f64, fault: Fault) -> Self {
        let single = TorranceSparrow::new(
            Distribution::ggx(Roughness::isotropic(alpha)),
            Masking::Smith,
            Fresnel::None,
            NormalSampling::Visible,
        );
        Self { single: single.unwrap(), loss: GgxLoss::of(alpha), fault }
    }
}

impl Bsdf for Compensated {
    fn describe(&self) -> Description {
        Description::new("compensated").claims(|c| {
            c.isotropic = true;
            c.lossless = true;
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        let single = Bsdf::eval(&self.single, wo, wi, transport)[0];
        if wo.z <= 0.0 || wi.z <= 0.0 || self.fault == Fault::SingleOnly {
            return Spectrum::from(single);
        }
        let half = 0.5 * (wo + wi).length();
        let (o, i) = if self.fault == Fault::WrongAngle { (half, half) } else { (wo.z, wi.z) };
        let average = if self.fault == Fault::NoAverage { 1.0 } else { self.loss.average() };
        let multiple = self.loss.at(o.min(1.0)) * self.loss.at(i.min(1.0)) / (PI * average);
        Spectrum::from(single + multiple)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let share = self.loss.at(wo.z);
        let (p, q) = if self.fault == Fault::ShareNotFolded { (1.0, 1.0) } else { (1.0 - share, share) };
        p * Bsdf::pdf(&self.single, wo, wi, transport) + q * wi.z / PI
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (wi, lobe) = if u[2] < self.loss.at(wo.z) {
            let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
            let r = u[0].sqrt();
            (Direction::new(r * cos, r * sin, (1.0 - u[0]).sqrt()), Lobe::DIFFUSE_REFLECTION)
        } else {
            (Bsdf::sample(&self.single, wo, u, transport)?.wi, Lobe::GLOSSY_REFLECTION)
        };
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe })
    }
}

/// Oren and Nayar's qualitative form, with the sum of both azimuths for their
/// difference.
struct SumOfAzimuths(bool);

impl Bsdf for SumOfAzimuths {
    fn describe(&self) -> Description {
        Description::new("azimuths").dimensions(2).claims(|c| c.isotropic = true)
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let sign = if self.0 { -1.0 } else { 1.0 };
        let facing = (wo.x * wi.x + sign * wo.y * wi.y).max(0.0) / wo.z.max(wi.z);
        Spectrum::from(0.8 / PI * (0.7 + 0.4 * facing))
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 { 0.0 } else { wi.z / PI }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        let r = u[0].sqrt();
        let wi = Direction::new(r * cos, r * sin, (1.0 - u[0]).sqrt());
        let weight = Bsdf::eval(self, wo, wi, transport) * PI;
        Some(Sample { wi, weight, pdf: wi.z / PI, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

fn failed(results: &Results) -> BTreeSet<&'static str> {
    let findings = results.cases.iter().flat_map(|c| &c.findings);
    for f in findings.clone() {
        assert_ne!(f.outcome.verdict, Verdict::Error, "{}: {}", f.check, f.outcome.message);
    }
    findings.filter(|f| f.outcome.verdict == Verdict::Fail).map(|f| f.check).collect()
}

/// Every check of `must` fails on `subject`, and none beyond `may`.
fn assert_found(name: &str, subject: &impl Subject, must: &[&str], may: &[&str]) {
    let settings = Settings { samples: 1 << 17, detect: 0.1, ..Settings::default() };
    let failed = failed(&gonio::measure(subject, settings, Duration::from_secs(60)));
    println!("{name}: {failed:?}");
    for check in must {
        assert!(failed.contains(check), "{name} slips through {check}; failed: {failed:?}");
    }
    let wrong: Vec<_> = failed.iter().filter(|c| !must.contains(c) && !may.contains(c)).collect();
    assert!(wrong.is_empty(), "{name} fails {wrong:?}");
}

#[test]
fn each_bug_of_compensation_is_found_by_the_checks_whose_identity_it_breaks_and_by_no_other() {
    let rows: [(Fault, &[&str], &[&str]); 5] = [
        (Fault::None, &[], &[]),
        // It gives too much back where it does not give too little.
        (Fault::WrongAngle, &["white-furnace"], &["energy"]),
        (Fault::NoAverage, &["white-furnace"], &[]),
        (Fault::SingleOnly, &["white-furnace"], &[]),
        (Fault::ShareNotFolded, &["goodness-of-fit", "normalization", "albedo", "mis"], &["jacobian"]),
    ];
    for alpha in [0.4, 0.9] {
        for (fault, must, may) in rows {
            assert_found(&format!("{fault:?} at {alpha}"), &Compensated::new(alpha, fault), must, may);
        }
    }
}

#[test]
fn the_sum_of_azimuths_is_not_isotropic_and_nothing_else() {
    assert_found("difference", &SumOfAzimuths(false), &[], &[]);
    assert_found("sum", &SumOfAzimuths(true), &["isotropy"], &[]);
}
