//! Correct code of every convention that a subject may declare passes, and is
//! not taken for wrong.

use gonio::bsdf::{
    Bsdf, Cosine, Description, Direction, Has, Lobe, OffSupport, Precision, RandomNumbers, Sample, Spectrum,
    Transport, TransportModes,
};
use gonio::checks::Verdict;
use gonio::suite::Settings;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Diffuse reflection and transmission, in one of the conventions.
struct Sheet {
    reflect: f64,
    transmit: f64,
    /// Index of the back over the front.
    eta: f64,
    channels: usize,
    cosine: Cosine,
    precision: Precision,
    /// Draws cover the whole sphere; those on the dark side come back with weight 0.
    wasteful: bool,
    own_numbers: Option<AtomicU64>,
    has: Has,
}

impl Default for Sheet {
    fn default() -> Self {
        Self {
            reflect: 0.7,
            transmit: 0.0,
            eta: 1.0,
            channels: 1,
            cosine: Cosine::Excluded,
            precision: Precision::F64,
            wasteful: false,
            own_numbers: None,
            has: Has::default(),
        }
    }
}

impl Sheet {
    /// f towards wi; radiance is (η_o/η_i)² brighter where it is transmitted.
    fn value(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wo.z == 0.0 || wi.z == 0.0 {
            return 0.0;
        }
        if wo.same_side(wi) {
            return self.reflect / PI;
        }
        let index = |w: Direction| if w.z > 0.0 { 1.0 } else { self.eta };
        // What leaves by the denser side is spread over more directions there.
        let factor = match transport {
            Transport::Radiance => index(wo).powi(2),
            Transport::Importance => index(wi).powi(2),
        };
        self.transmit / PI * factor / self.eta.powi(2).max(1.0)
    }

    fn share_reflected(&self) -> f64 {
        if self.transmit == 0.0 { 1.0 } else { 0.5 }
    }
}

impl Bsdf for Sheet {
    fn describe(&self) -> Description {
        let names = (0..self.channels).map(|c| format!("band {c}"));
        let mut description =
            Description::new("sheet").channels(names).precision(self.precision).claims(|c| {
                c.isotropic = true;
                c.two_sided = self.eta == 1.0;
                c.transmissive = self.transmit > 0.0;
                c.eta = (self.eta != 1.0).then_some(self.eta);
                c.cosine = self.cosine;
                if self.eta != 1.0 {
                    c.transport = TransportModes::Both;
                }
                if self.wasteful {
                    c.off_support = OffSupport::ZeroWeight;
                }
                if self.own_numbers.is_some() {
                    c.rng = RandomNumbers::Internal;
                }
            });
        description.has = self.has;
        description
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        assert!(self.has.eval, "there is no eval");
        let f = self.value(wo, wi, transport);
        let f = if self.cosine == Cosine::Included { f * wi.z.abs() } else { f };
        let f = if self.precision == Precision::F32 { f64::from(f as f32) } else { f };
        Spectrum::from_fn(self.channels, |c| f / (c + 1) as f64)
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        assert!(self.has.pdf, "there is no pdf");
        let share = if self.wasteful {
            0.5
        } else if wo.same_side(wi) {
            self.share_reflected()
        } else {
            1.0 - self.share_reflected()
        };
        let p = if wo.z == 0.0 { 0.0 } else { share * wi.z.abs() / PI };
        if self.precision == Precision::F32 { f64::from(p as f32) } else { p }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        assert!(self.has.sample, "there is no sample");
        let mut own = [u[0], u[1], u[2]];
        if let Some(counter) = &self.own_numbers {
            for v in &mut own {
                // SplitMix64 (Steele, Lea and Flood 2014).
                let x = counter.fetch_add(0x9e37_79b9_7f4a_7c15, Ordering::Relaxed);
                let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                *v = ((x ^ (x >> 31)) >> 11) as f64 * (-53f64).exp2();
            }
        }
        let [a, b, c] = own;
        let share = if self.wasteful { 0.5 } else { self.share_reflected() };
        let side = if c < share { wo.z } else { -wo.z };
        let (sin, cos) = (2.0 * PI * b).sin_cos();
        let z = (1.0 - a).sqrt();
        if z <= 0.0 || wo.z == 0.0 {
            return None;
        }
        let mut wi = Direction::new(a.sqrt() * cos, a.sqrt() * sin, z.copysign(side));
        if self.precision == Precision::F32 {
            let rounded = |v: f64| f64::from(v as f32);
            wi = Direction::new(rounded(wi.x), rounded(wi.y), rounded(wi.z));
        }
        let pdf = share_of(wo, wi, share) * wi.z.abs() / PI;
        let f = self.value(wo, wi, transport);
        let weight = Spectrum::from_fn(self.channels, |k| f * wi.z.abs() / pdf / (k + 1) as f64);
        let lobe = if wo.same_side(wi) { Lobe::DIFFUSE_REFLECTION } else { Lobe(2 | 4) };
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe })
    }
}

fn share_of(wo: Direction, wi: Direction, reflected: f64) -> f64 {
    if wo.same_side(wi) { reflected } else { 1.0 - reflected }
}

/// Nothing fails, errs, warns or stays undecided, and much passes.
fn assert_clean(name: &str, sheet: &Sheet) {
    let settings = Settings { samples: 1 << 16, detect: 0.1, ..Settings::default() };
    let results = gonio::measure(sheet, settings, Duration::from_secs(60));
    let mut passed = 0;
    for (case, finding) in results.cases.iter().flat_map(|r| r.findings.iter().map(move |f| (r, f))) {
        let outcome = &finding.outcome;
        let clean = matches!(outcome.verdict, Verdict::Pass | Verdict::Skipped);
        assert!(clean, "{name}: {} {}: {}", case.case.label(), finding.check, outcome.message);
        passed += usize::from(outcome.verdict == Verdict::Pass);
    }
    assert!(passed > 12, "{name}: {passed} passed");
}

#[test]
fn every_declared_convention_passes() {
    let none = Has { eval: false, pdf: false, sample: false };
    for (name, sheet) in [
        ("reflecting on both sides", Sheet::default()),
        ("transmitting", Sheet { reflect: 0.3, transmit: 0.6, ..Sheet::default() }),
        (
            "into a denser medium, in both modes",
            Sheet { reflect: 0.3, transmit: 0.6, eta: 1.5, ..Sheet::default() },
        ),
        ("sixteen channels", Sheet { channels: 16, ..Sheet::default() }),
        ("cosine in eval", Sheet { cosine: Cosine::Included, ..Sheet::default() }),
        ("single precision", Sheet { precision: Precision::F32, ..Sheet::default() }),
        ("zero weights off the support", Sheet { wasteful: true, ..Sheet::default() }),
        ("its own random numbers", Sheet { own_numbers: Some(AtomicU64::new(7)), ..Sheet::default() }),
        ("black", Sheet { reflect: 0.0, ..Sheet::default() }),
        ("eval alone", Sheet { has: Has { eval: true, ..none }, ..Sheet::default() }),
        ("no pdf", Sheet { has: Has { pdf: false, ..Has::default() }, ..Sheet::default() }),
        ("no eval", Sheet { has: Has { eval: false, ..Has::default() }, ..Sheet::default() }),
    ] {
        assert_clean(name, &sheet);
    }
}

#[test]
fn a_cosine_declared_and_not_there_is_a_warning() {
    struct Liar(Sheet);
    impl Bsdf for Liar {
        fn describe(&self) -> Description {
            Bsdf::describe(&self.0).claims(|c| c.cosine = Cosine::Included)
        }
        fn eval(&self, wo: Direction, wi: Direction, t: Transport) -> Spectrum {
            Bsdf::eval(&self.0, wo, wi, t)
        }
        fn pdf(&self, wo: Direction, wi: Direction, t: Transport) -> f64 {
            Bsdf::pdf(&self.0, wo, wi, t)
        }
        fn sample(&self, wo: Direction, u: &[f64], t: Transport) -> Option<Sample> {
            Bsdf::sample(&self.0, wo, u, t)
        }
    }
    let settings = Settings { samples: 1 << 14, detect: 1.0, ..Settings::default() };
    let liar = Liar(Sheet::default());
    let results = gonio::measure(&liar, settings, Duration::from_secs(60));
    for finding in results.cases.iter().flat_map(|c| &c.findings) {
        let expected = finding.check == "weight";
        assert_eq!(finding.outcome.verdict == Verdict::Warn, expected, "{}", finding.outcome.message);
        assert_ne!(finding.outcome.verdict, Verdict::Fail, "{}", finding.outcome.message);
    }
}
