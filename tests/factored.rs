//! Factored sampling: right on subjects of all kinds, each way to get it wrong is
//! found by the checks whose identity it breaks, and what cannot be factored is
//! refused.

use gonio::bsdf::{Description, Direction, Has, Lobe, Samples, Spectrum, Subject, SubjectError, Transport};
use gonio::checks::Verdict;
use gonio::models::factored::{Factored, Grid, Options, Parameterisation};
use gonio::registry::Registry;
use gonio::suite::Settings;
use std::collections::BTreeSet;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;
use std::time::Duration;

fn subject(text: &str) -> Arc<dyn Subject> {
    let spelling = text.parse().unwrap();
    Registry::builtin().resolve(&spelling).unwrap().subject
}

/// The checks that fail, with what they say.
fn failures(subject: &impl Subject, samples: u64) -> (BTreeSet<&'static str>, String) {
    let settings = Settings { samples, detect: f64::INFINITY, ..Settings::default() };
    let results = gonio::measure(subject, settings, Duration::from_secs(300));
    let findings = results.cases.iter().flat_map(|c| c.findings.iter().map(move |f| (c, f)));
    let mut failed = BTreeSet::new();
    let mut told = String::new();
    for (case, finding) in findings {
        let verdict = finding.outcome.verdict;
        if !matches!(verdict, Verdict::Pass | Verdict::Skipped) {
            told += &format!("{} {}: {}\n", case.case.label(), finding.check, finding.outcome.message);
        }
        if matches!(verdict, Verdict::Fail | Verdict::Error) {
            failed.insert(finding.check);
        }
    }
    (failed, told)
}

#[test]
fn every_check_passes_on_subjects_of_all_kinds() {
    for (text, over) in [
        ("torrance-sparrow:alpha=0.1", Parameterisation::HalfAngle),
        ("torrance-sparrow:alpha=0.4,alpha_y=0.2,distribution=beckmann", Parameterisation::HalfAngle),
        ("torrance-sparrow:fresnel=conductor,alpha=0.3", Parameterisation::HalfAngle),
        ("oren-nayar", Parameterisation::HalfAngle),
        ("oren-nayar", Parameterisation::Incident),
        ("lambert", Parameterisation::Incident),
        ("blend", Parameterisation::HalfAngle),
    ] {
        let factored = Factored::new(subject(text), Options { over, ..small() }).unwrap();
        let (_, told) = failures(&factored, 1 << 16);
        assert!(told.is_empty(), "{text} {over:?}: {told}");
    }
}

/// A coarser grid than the default, for the time it takes.
fn small() -> Options {
    Options { theta: 32, phi: 24, theta_o: 10, ..Options::default() }
}

/// A subject of which only eval is known, on both sides if asked for.
struct EvalOnly {
    inner: Arc<dyn Subject>,
    two_sided: bool,
}

impl Subject for EvalOnly {
    fn describe(&self) -> Description {
        let has = Has { eval: true, pdf: false, sample: false };
        self.inner.describe().has(has).claims(|c| c.two_sided = self.two_sided)
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        let over = |w: Direction| if self.two_sided && wo.z < 0.0 { w.flipped() } else { w };
        let wi: Vec<Direction> = wi.iter().map(|w| over(*w)).collect();
        self.inner.eval(over(wo), &wi, transport, out)
    }

    fn pdf(&self, _: Direction, _: &[Direction], _: Transport, _: &mut [f64]) -> Result<(), SubjectError> {
        unreachable!("it has no pdf")
    }

    fn sample(&self, _: Direction, _: &[f64], _: Transport, _: &mut Samples) -> Result<(), SubjectError> {
        unreachable!("it has no sampler")
    }
}

#[test]
fn a_subject_that_cannot_sample_now_can_on_both_its_sides() {
    for two_sided in [false, true] {
        let eval_only = EvalOnly { inner: subject("torrance-sparrow:alpha=0.2"), two_sided };
        let factored = Factored::new(Arc::new(eval_only), small()).unwrap();
        assert_eq!(Subject::describe(&factored).has, Has::default());
        let (_, told) = failures(&factored, 1 << 15);
        assert!(told.is_empty(), "{told}");
    }
}

#[test]
fn what_cannot_be_factored_is_refused() {
    let registry = Registry::builtin();
    for (text, part) in [
        ("factored:subject=conductor", "discrete lobe"),
        ("factored:subject=dielectric", "transmits"),
        ("factored:subject=(torrance-sparrow:alpha=2e-4)", "narrower than the grid of 48 × 32 cells"),
        ("factored:theta=8,subject=(torrance-sparrow:alpha=0.01)", "more theta and phi"),
        ("factored:outer=2.5", "write outer=3"),
    ] {
        let error = registry.resolve(&text.parse().unwrap()).err().expect(text).to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
    let mut description = subject("lambert").describe();
    description.has.eval = false;
    struct Blind(Description);
    impl Subject for Blind {
        fn describe(&self) -> Description {
            self.0.clone()
        }
        fn eval(
            &self,
            _: Direction,
            _: &[Direction],
            _: Transport,
            out: &mut [f64],
        ) -> Result<(), SubjectError> {
            out.fill(f64::INFINITY);
            Ok(())
        }
        fn pdf(
            &self,
            _: Direction,
            _: &[Direction],
            _: Transport,
            _: &mut [f64],
        ) -> Result<(), SubjectError> {
            Ok(())
        }
        fn sample(&self, _: Direction, _: &[f64], _: Transport, _: &mut Samples) -> Result<(), SubjectError> {
            Ok(())
        }
    }
    let refused = |d: Description| Factored::new(Arc::new(Blind(d)), small()).err().unwrap();
    assert!(refused(description.clone()).contains("no eval"));
    description.has = Has { eval: true, pdf: false, sample: false };
    assert!(refused(description.clone()).contains("its eval is [inf]"), "{}", refused(description.clone()));
    assert!(refused(description.claims(|c| c.stochastic = true)).contains("random"));
}

/// What is wrong with a factored sampler.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bug {
    None,
    /// The density lacks the half vector's 1/(4 wo·h).
    NoJacobian,
    /// φ is drawn from another term than θ.
    LooseAzimuth,
    /// The density lacks the cosine's share, which is drawn.
    NoFloor,
    /// The density's F_j are those of the table, which add up to the albedo at wo.
    RawWeights,
}

/// The factored sampler once more, from its parts, with a bug.
struct Broken {
    factored: Factored,
    bug: Bug,
}

const FLOOR: f64 = 0.05;

impl Broken {
    fn new(text: &str, bug: Bug) -> Self {
        let mut options = small();
        options.factorisation.floor = FLOOR;
        Self { factored: Factored::new(subject(text), options).unwrap(), bug }
    }

    fn density(&self, wo: Direction, wi: Direction) -> f64 {
        let right = self.factored.density().given(wo).pdf(wi);
        if right == 0.0 {
            return 0.0;
        }
        let floor = FLOOR * FRAC_1_PI * wi.z;
        match self.bug {
            Bug::None | Bug::LooseAzimuth => right,
            Bug::NoJacobian => floor + (right - floor) * 2.0 * (wo + wi).length(),
            Bug::NoFloor => (right - floor) / (1.0 - FLOOR),
            Bug::RawWeights => floor + (right - floor) * (0.7 + 0.3 * wo.z),
        }
    }

    fn draw(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        let density = self.factored.density();
        let draw = |chosen| density.given(wo).sample([chosen, u[1], u[2]]);
        if self.bug != Bug::LooseAzimuth || u[0] < FLOOR {
            return draw(u[0]);
        }
        let other = FLOOR + (1.0 - FLOOR) * u[3];
        let half = |wi: Direction| (wo + wi).normalized();
        let (theta, phi) = (half(draw(u[0])?).theta(), half(draw(other)?).phi());
        let h = Grid::direction(1.0 - theta.cos(), phi);
        Some(wo.reflected(h)).filter(|wi| wi.z > 0.0)
    }
}

impl Subject for Broken {
    fn describe(&self) -> Description {
        let extra = usize::from(self.bug == Bug::LooseAzimuth);
        Description { name: "broken".into(), dimensions: 3 + extra, ..Subject::describe(&self.factored) }
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.factored.eval(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        wi.iter().zip(out).for_each(|(wi, p)| *p = self.density(wo, *wi));
        Ok(())
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        let mut value = [0.0];
        for u in u.chunks_exact(self.describe().dimensions) {
            let wi = self.draw(wo, u);
            if let Some(wi) = wi {
                self.factored.eval(wo, &[wi], transport, &mut value)?;
            }
            let sample = wi.map(|wi| {
                let pdf = self.density(wo, wi);
                let weight = Spectrum::from(if pdf > 0.0 { value[0] * wi.z / pdf } else { 0.0 });
                gonio::bsdf::Sample { wi, weight, pdf, lobe: Lobe::GLOSSY_REFLECTION }
            });
            out.push(sample.as_ref());
        }
        Ok(())
    }
}

#[test]
fn each_bug_is_found_by_the_checks_whose_identity_it_breaks() {
    for (bug, found, may) in [
        (Bug::None, &[][..], &[][..]),
        (Bug::NoJacobian, &["goodness-of-fit", "normalization", "jacobian", "albedo", "mis"], &["support"]),
        (Bug::LooseAzimuth, &["goodness-of-fit"], &["albedo", "mis", "normalization", "support"]),
        (Bug::NoFloor, &["goodness-of-fit"], &["normalization", "jacobian", "albedo", "mis", "support"]),
        (Bug::RawWeights, &["goodness-of-fit", "normalization", "albedo", "mis"], &["jacobian"]),
    ] {
        let (failed, told) = failures(&Broken::new("torrance-sparrow:alpha=0.4", bug), 1 << 16);
        let must: BTreeSet<_> = found.iter().copied().collect();
        let allowed: BTreeSet<_> = found.iter().chain(may).copied().collect();
        assert!(failed.is_superset(&must) && failed.is_subset(&allowed), "{bug:?}: {failed:?}\n{told}");
    }
}
