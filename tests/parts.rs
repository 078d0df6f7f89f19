//! Distributions of normals and Fresnel functions, each with one bug at a time:
//! `distribution` and `fresnel` find what breaks their identities, say what it
//! looks like, and leave the right ones alone.

use gonio::bsdf::{
    Description, Direction, FresnelFunction, Interface, NormalDistribution, Normals, Spectrum, Subject,
};
use gonio::checks::Verdict;
use gonio::engine::{Finding, Results};
use gonio::suite::Settings;
use std::f64::consts::PI;
use std::time::Duration;

fn measure<S: Subject>(subject: &S) -> Results<'_> {
    let settings = Settings { samples: 1 << 14, detect: f64::INFINITY, ..Settings::default() };
    gonio::measure(subject, settings, Duration::from_secs(120))
}

fn findings<'a>(results: &'a Results, check: &str) -> Vec<&'a Finding> {
    results.cases.iter().flat_map(|c| &c.findings).filter(|f| f.check == check).collect()
}

/// The messages of a check's failures.
fn failures(results: &Results, check: &str) -> Vec<String> {
    let failed = findings(results, check).into_iter().filter(|f| f.outcome.verdict == Verdict::Fail);
    failed.map(|f| f.outcome.message.clone()).collect()
}

/// What is wrong with a textbook Beckmann.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bug {
    None,
    /// The lecture's first slide of D lacks 1/π.
    NoPi,
    /// D·cos θm given as D.
    Cosine,
    /// The density of normals over cos² θm given as D.
    OverCosine,
    /// D holds below the horizon too.
    NoHorizon,
    /// Roughness squared once too often.
    Alpha,
    /// G1 = 1.
    NoMasking,
    /// G1².
    SquaredMasking,
    /// G1 at the angle of m.
    MaskingOfNormal,
    /// G1 with sin θ for tan θ.
    SineInMasking,
    /// Λ of another roughness than D's.
    Lambda,
    /// pdf() lacks cos θm.
    Density,
    /// visible_pdf() lacks 1/cos θo.
    VisibleDensity,
    /// sample() draws another roughness.
    Sample,
}

/// Beckmann's distribution with Smith's masking, written down from the papers.
struct Beckmann {
    alpha: f64,
    bug: Bug,
}

impl Beckmann {
    /// Λ (Walter et al. 2007, before the rational fit).
    fn smith(&self, w: Direction, alpha: f64) -> f64 {
        let tan = w.x.hypot(w.y) / w.z;
        let a = 1.0 / (alpha * tan);
        if tan < 1e-12 { 0.0 } else { 0.5 * ((-a * a).exp() / (a * PI.sqrt()) - libm::erfc(a)) }
    }
}

impl NormalDistribution for Beckmann {
    fn describe(&self) -> Description {
        Description::new("beckmann").dimensions(2).claims(|c| c.isotropic = true)
    }

    fn density(&self, m: Direction) -> f64 {
        let cos = m.z.abs();
        if m.z <= 0.0 && self.bug != Bug::NoHorizon || cos < 1e-9 {
            return 0.0;
        }
        let alpha2 = if self.bug == Bug::Alpha { self.alpha.powi(4) } else { self.alpha.powi(2) };
        let tan2 = (m.x * m.x + m.y * m.y) / (cos * cos);
        let scale = if self.bug == Bug::Alpha { self.alpha.powi(2) } else { alpha2 };
        let d = (-tan2 / alpha2).exp() / (PI * scale * cos.powi(4));
        match self.bug {
            Bug::NoPi => d * PI,
            Bug::Cosine => d * cos,
            Bug::OverCosine => d / cos,
            _ => d,
        }
    }

    fn g1(&self, w: Direction, m: Direction) -> f64 {
        let g1 = 1.0 / (1.0 + self.smith(w, self.alpha));
        match self.bug {
            Bug::NoMasking => 1.0,
            Bug::SquaredMasking => g1 * g1,
            Bug::MaskingOfNormal => 1.0 / (1.0 + self.smith(m, self.alpha)),
            Bug::SineInMasking => {
                let sin = w.x.hypot(w.y);
                let tilted = Direction::from_angles(sin.atan(), 0.0);
                1.0 / (1.0 + self.smith(tilted, self.alpha))
            }
            _ => g1,
        }
    }

    fn sample(&self, u: &[f64]) -> Direction {
        let alpha = if self.bug == Bug::Sample { 1.05 * self.alpha } else { self.alpha };
        let tan = alpha * (-(1.0 - u[0]).ln()).sqrt();
        Direction::from_angles(tan.atan(), 2.0 * PI * u[1])
    }

    fn pdf(&self, m: Direction) -> f64 {
        let cos = if self.bug == Bug::Density { 1.0 } else { m.z.max(0.0) };
        self.density(m) * cos
    }

    fn draws_visible(&self) -> bool {
        true
    }

    fn visible_pdf(&self, wo: Direction, m: Direction) -> f64 {
        let over = if self.bug == Bug::VisibleDensity { 1.0 } else { wo.z };
        self.g1(wo, m) * wo.dot(m).max(0.0) * self.density(m) / over
    }

    fn lambda(&self, w: Direction) -> Option<f64> {
        let silent = [Bug::NoMasking, Bug::SquaredMasking, Bug::MaskingOfNormal, Bug::SineInMasking];
        let alpha = if self.bug == Bug::Lambda { 0.8 * self.alpha } else { self.alpha };
        (!silent.contains(&self.bug)).then(|| self.smith(w, alpha))
    }
}

fn beckmann(bug: Bug) -> Normals<Beckmann> {
    Normals::all(Beckmann { alpha: 0.5, bug })
}

#[test]
fn a_right_distribution_passes_everything() {
    let subject = beckmann(Bug::None);
    let results = measure(&subject);
    for finding in results.cases.iter().flat_map(|c| &c.findings) {
        let clean = matches!(finding.outcome.verdict, Verdict::Pass | Verdict::Skipped);
        assert!(clean, "{}: {}", finding.check, finding.outcome.message);
    }
    for check in ["goodness-of-fit", "white-furnace", "albedo", "distribution", "jacobian"] {
        assert!(findings(&results, check).iter().all(|f| f.outcome.verdict == Verdict::Pass), "{check}");
    }
    for (check, reason) in [
        ("reciprocity", "a distribution of normals is no BSDF"),
        ("fresnel", "a distribution of normals is no Fresnel function"),
    ] {
        for finding in findings(&results, check) {
            assert_eq!(finding.outcome.reason.as_deref(), Some(reason));
        }
    }
}

/// The lecture prints Beckmann's D twice, with and without 1/π.
#[test]
fn the_two_beckmanns_of_the_lecture_are_told_apart() {
    let told = failures(&measure(&beckmann(Bug::NoPi)), "distribution");
    assert_eq!(told.len(), 6, "at every angle");
    for message in told {
        assert!(
            message.contains(
                "∫D cos θm = 3.14159 where it must be 1, π times too large: D lacks the factor 1/π"
            ),
            "{message}"
        );
    }
}

#[test]
fn distribution_finds_each_bug_and_says_what_it_looks_like() {
    for (bug, words) in [
        (Bug::Cosine, "this is the density D cos θm of normals, not D"),
        (Bug::OverCosine, "D was divided by cos θm once too often"),
        (Bug::NoHorizon, "below the horizon"),
        (Bug::Alpha, "∫D cos θm = 0.25000 where it must be 1, 4 times too small"),
        (Bug::NoMasking, "G1 hides nothing, though facets turned away hide others"),
        (Bug::SquaredMasking, "as where G1 is squared"),
        // Facets are seldom steep enough to be hidden by the formula of a view.
        (Bug::MaskingOfNormal, "G1 hides nothing"),
        (Bug::SineInMasking, "G1 hides too little"),
        (Bug::Lambda, "Λ is not the area of facets turned away"),
        (Bug::Density, "pdf = D cos θm"),
        (Bug::VisibleDensity, "visible_pdf = G1"),
    ] {
        let told = failures(&measure(&beckmann(bug)), "distribution");
        assert!(told.iter().any(|m| m.contains(words)), "{bug:?}: {told:#?}");
    }
}

/// Draws are tested by the statistical checks, in both ways of drawing.
#[test]
fn goodness_of_fit_finds_a_wrong_sampler_of_normals() {
    let told = failures(&measure(&beckmann(Bug::Sample)), "goodness-of-fit");
    assert_eq!(told.len(), 6, "{told:#?}");

    /// Visible normals that are drawn as if all were seen.
    struct Unmasked(Beckmann);
    impl NormalDistribution for Unmasked {
        fn describe(&self) -> Description {
            self.0.describe()
        }
        fn density(&self, m: Direction) -> f64 {
            self.0.density(m)
        }
        fn g1(&self, w: Direction, m: Direction) -> f64 {
            self.0.g1(w, m)
        }
        fn sample(&self, u: &[f64]) -> Direction {
            self.0.sample(u)
        }
        fn draws_visible(&self) -> bool {
            true
        }
        fn sample_visible(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
            let m = self.0.sample(u);
            (wo.dot(m) > 0.0).then_some(m)
        }
    }
    let visible = Normals::visible(Unmasked(Beckmann { alpha: 0.5, bug: Bug::None })).unwrap();
    assert!(!failures(&measure(&visible), "goodness-of-fit").is_empty());
}

#[test]
fn visible_normals_that_cannot_be_drawn_are_refused() {
    struct Opaque;
    impl NormalDistribution for Opaque {
        fn describe(&self) -> Description {
            Description::new("opaque")
        }
        fn density(&self, m: Direction) -> f64 {
            if m.z > 0.0 { 1.0 / PI } else { 0.0 }
        }
        fn g1(&self, _: Direction, _: Direction) -> f64 {
            1.0
        }
        fn sample(&self, u: &[f64]) -> Direction {
            Direction::from_angles(u[0].sqrt().asin(), 2.0 * PI * u[1])
        }
    }
    let refused = Normals::visible(Opaque).err().unwrap();
    assert!(refused.contains("opaque") && refused.contains("sampling=normals"), "{refused}");
}

/// What is wrong with a textbook dielectric.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    None,
    /// Rp is a copy of Rs.
    Copied,
    /// The same where both parts are not told.
    CopiedSilently,
    /// The index is not inverted from inside.
    Inside,
    /// Total reflection is forgotten: 0 in its place.
    Total,
    /// R = Rs Rp.
    Product,
    /// T = (1 − R)².
    Transmittance,
    /// The amplitude in place of the reflectance.
    Amplitude,
    /// η is off by a thousandth.
    Index,
    /// NaN beyond the critical angle.
    NotANumber,
}

struct Glass(Slip);

impl Glass {
    const ETA: f64 = 1.5;

    fn parts(&self, cos: f64) -> [f64; 2] {
        let inverted = cos < 0.0 && self.0 != Slip::Inside;
        let eta = if self.0 == Slip::Index { 1.001 * Self::ETA } else { Self::ETA };
        let eta = if inverted { 1.0 / eta } else { eta };
        let cos_i = cos.abs();
        let sin_t2 = (1.0 - cos_i * cos_i) / (eta * eta);
        if sin_t2 > 1.0 && self.0 != Slip::NotANumber {
            return [if self.0 == Slip::Total { 0.0 } else { 1.0 }; 2];
        }
        let cos_t = (1.0 - sin_t2).sqrt();
        let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        let copied = matches!(self.0, Slip::Copied | Slip::CopiedSilently);
        let power = |r: f64| if self.0 == Slip::Amplitude { r.abs() } else { r * r };
        [power(s), power(if copied { s } else { p })]
    }
}

impl FresnelFunction for Glass {
    fn describe(&self) -> Description {
        Description::new("glass").claims(|c| {
            c.transmissive = true;
            c.lossless = true;
            c.eta = Some(Self::ETA);
        })
    }

    fn reflectance(&self, cos: f64) -> Spectrum {
        let [s, p] = self.parts(cos);
        Spectrum::from(if self.0 == Slip::Product { s * p } else { 0.5 * (s + p) })
    }

    fn transmittance(&self, cos: f64) -> Option<Spectrum> {
        let rest = 1.0 - self.reflectance(cos)[0];
        Some(Spectrum::from(if self.0 == Slip::Transmittance { rest * rest } else { rest }))
    }

    fn polarised(&self, cos: f64) -> Option<[Spectrum; 2]> {
        (self.0 != Slip::CopiedSilently).then(|| self.parts(cos).map(Spectrum::from))
    }
}

#[test]
fn a_right_fresnel_function_passes_and_is_measured_once() {
    let subject = Interface(Glass(Slip::None));
    let results = measure(&subject);
    assert_eq!(results.cases.len(), 1);
    for finding in &results.cases[0].findings {
        let passes = ["sanity", "determinism", "fresnel"].contains(&finding.check);
        let expected = if passes { Verdict::Pass } else { Verdict::Skipped };
        assert_eq!(finding.outcome.verdict, expected, "{}: {}", finding.check, finding.outcome.message);
    }
}

#[test]
fn fresnel_finds_each_slip_by_its_law() {
    for (slip, law) in [
        (Slip::Copied, "Brewster's angle"),
        (Slip::CopiedSilently, "Brewster's angle"),
        (Slip::Inside, "R from outside at θi = R from inside at θt"),
        (Slip::Total, "R = 1 beyond the critical angle"),
        (Slip::Product, "R = (Rs + Rp)/2"),
        (Slip::Transmittance, "R + T = 1"),
        (Slip::Amplitude, "R = ((η − 1)/(η + 1))² at normal incidence"),
        (Slip::Index, "R = ((η − 1)/(η + 1))² at normal incidence"),
        (Slip::NotANumber, "0 ≤ R ≤ 1"),
    ] {
        let told = failures(&measure(&Interface(Glass(slip))), "fresnel");
        assert!(told.len() == 1 && told[0].contains(law), "{slip:?}: {told:#?}");
    }
}

/// An equal subject equals its reference over all angles, another index does not.
#[test]
fn a_reference_sees_what_no_law_does() {
    use gonio::registry::Registry;
    use gonio::suite::{Overrides, load};
    let suite = |reference: &str| {
        format!(
            "[suite]\nname = \"r\"\nsamples = 4096\n[[subject]]\nuse = \"fresnel\"\n\
             kind = \"schlick\"\nreference = \"{reference}\"\n"
        )
    };
    for (reference, verdict) in [
        ("fresnel:kind=schlick", Verdict::Pass),
        ("fresnel:kind=schlick,f0=0.05", Verdict::Fail),
        // η = 1.5 has the same reflectance at normal incidence only.
        ("fresnel", Verdict::Fail),
        ("normals", Verdict::Fail),
    ] {
        let plan = load("s.toml", &suite(reference), &Registry::builtin(), &Overrides::default());
        let plan = plan.unwrap().plan;
        assert_eq!(plan.cases.len(), 1);
        let results = gonio::engine::run(&plan, &Default::default(), &mut |_| {});
        let found = findings(&results, "reference");
        assert_eq!(found[0].outcome.verdict, verdict, "{}", found[0].outcome.message);
    }
}

/// Schlick's approximation with or without a slip; it claims no index.
struct Schlick {
    f0: f64,
    twice: bool,
    power: i32,
}

impl FresnelFunction for Schlick {
    fn describe(&self) -> Description {
        Description::new("schlick")
    }

    fn reflectance(&self, cos: f64) -> Spectrum {
        let rest = if self.twice { (1.0 - self.f0).powi(2) } else { 1.0 - self.f0 };
        Spectrum::from(self.f0 + rest * (1.0 - cos).powi(self.power))
    }
}

/// (1 − F₀) twice does not reach 1 at grazing incidence. Another power does, and
/// no law of reflection tells it from the right one: that takes a reference.
#[test]
fn what_no_law_sees_of_an_approximation() {
    let told = |twice, power| failures(&measure(&Interface(Schlick { f0: 0.04, twice, power })), "fresnel");
    let message = told(true, 5);
    assert!(message.len() == 1 && message[0].contains("R = 1 at grazing incidence"), "{message:#?}");
    assert!(told(false, 5).is_empty());
    assert!(told(false, 4).is_empty());
}
