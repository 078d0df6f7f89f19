//! A GGX reflector written for the tests, with one bug at a time.
#![allow(dead_code)]

pub mod desk;
pub mod glass;
pub mod languages;
pub mod measuring;
pub mod plastic;
pub mod tools;

use gonio::bsdf::{Bsdf, Description, Direction, Lobe, RandomNumbers, Sample, Spectrum, Transport};
use std::f64::consts::PI;

/// What is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bug {
    None,
    /// pdf() uses α(1 + ε).
    PdfAlpha(f64),
    /// pdf() lacks 1/(4 wo·h).
    PdfJacobian,
    /// sample() redraws until the direction is above the horizon.
    Redraw,
    /// The weight lacks cos θi.
    WeightCosine,
    /// Fresnel at n·wo in place of h·wo.
    FresnelAtNormal,
    /// eval() has D·cosθh in place of D.
    CosineInD,
    /// eval() contains cos θi, as some codebases have it, without telling.
    UndeclaredCosine,
    /// pdf() is this much too large.
    PdfFactor(f64),
    /// sample().pdf is this much too large, pdf() is right.
    ReturnedPdf(f64),
    /// The half vector is returned as wi.
    HalfVector,
    /// eval() is too large by this factor.
    Bright(f64),
    /// eval() ignores the horizon of wi.
    NoHorizon,
    /// This share of the samples is mirrored to azimuth −φ.
    MirroredShare(f64),
    /// pdf() is NaN near the mirror direction.
    NanPdf,
    /// sample() returns wi of this length.
    Length(f64),
    /// eval() is negative far off the lobe.
    Negative,
    /// Azimuth of wi shifted in eval() and pdf().
    Shifted(f64),
    /// sample() ignores every second u.
    Counting,
    /// sample() panics now and then.
    Panics,
    /// eval() never returns.
    Hangs,
    /// Every draw is no sample, pdf is 0.
    NotImplemented,
    /// sample() flags its rough lobe discrete.
    FlaggedDiscrete,
    /// sample() always returns the mirror direction, unflagged.
    UnflaggedMirror,
    /// eval() is infinite at the mirror direction.
    Infinite,
    /// pdf() has mass on the back side too.
    PhantomBack,
    /// sample() returns the flipped direction for this share of draws.
    Stray(f64),
    /// It draws its own random numbers, and every second sample repeats the last.
    Repeating,
}

/// Isotropic GGX with visible-normal sampling (Heitz 2018), height-correlated
/// Smith masking and Schlick's Fresnel term.
pub struct Ggx {
    pub alpha: f64,
    pub bug: Bug,
    pub calls: std::sync::atomic::AtomicU64,
    last: std::sync::Mutex<Vec<f64>>,
}

impl Ggx {
    pub fn new(alpha: f64, bug: Bug) -> Self {
        Self { alpha, bug, calls: Default::default(), last: Default::default() }
    }

    pub fn d(&self, h: Direction, alpha: f64) -> f64 {
        let s = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
        1.0 / (PI * alpha * alpha * s * s)
    }

    pub fn lambda(&self, w: Direction, alpha: f64) -> f64 {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
    }

    pub fn value(&self, wo: Direction, wi: Direction) -> f64 {
        let above = wi.z > 0.0 || (self.bug == Bug::NoHorizon && wi.z < 0.0);
        if wo.z <= 0.0 || !above {
            return 0.0;
        }
        let sum = wo + wi;
        let h = sum.normalized();
        if !(sum.length() > 0.0) {
            return 0.0;
        }
        let cosine = if self.bug == Bug::FresnelAtNormal { wo.z } else { wo.dot(h).abs() };
        let fresnel = 0.04 + 0.96 * (1.0 - cosine).powi(5);
        let mut d = self.d(h, self.alpha);
        if self.bug == Bug::CosineInD {
            d *= h.z;
        }
        let g = 1.0 / (1.0 + self.lambda(wo, self.alpha) + self.lambda(wi, self.alpha));
        fresnel * d * g / (4.0 * wo.z * wi.z.abs())
    }

    pub fn visible_normal(&self, wo: Direction, u: &[f64]) -> Direction {
        let v = Direction::new(self.alpha * wo.x, self.alpha * wo.y, wo.z).normalized();
        let planar = v.x * v.x + v.y * v.y;
        let t1 = if planar > 0.0 {
            Direction::new(-v.y, v.x, 0.0) * (1.0 / planar.sqrt())
        } else {
            Direction::new(1.0, 0.0, 0.0)
        };
        let t2 = v.cross(t1);
        let r = u[0].sqrt();
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        let (a, mut b) = (r * cos, r * sin);
        let s = 0.5 * (1.0 + v.z);
        b = (1.0 - s) * (1.0 - a * a).sqrt() + s * b;
        let n = t1 * a + t2 * b + v * (1.0 - a * a - b * b).max(0.0).sqrt();
        Direction::new(self.alpha * n.x, self.alpha * n.y, n.z).normalized()
    }
}

impl Bsdf for Ggx {
    fn describe(&self) -> Description {
        let dimensions = if self.bug == Bug::Redraw { 12 } else { 3 };
        Description::new("ad-hoc-ggx").dimensions(dimensions).claims(|c| {
            c.isotropic = true;
            if self.bug == Bug::Repeating {
                c.rng = RandomNumbers::Internal;
            }
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if self.bug == Bug::Hangs {
            loop {
                std::thread::sleep(std::time::Duration::from_millis(100));
            }
        }
        let wi = if let Bug::Shifted(angle) = self.bug { wi.rotated(angle) } else { wi };
        let f = self.value(wo, wi);
        Spectrum::from(match self.bug {
            Bug::UndeclaredCosine => f * wi.z.abs(),
            Bug::Bright(factor) => f * factor,
            Bug::Negative if f > 0.0 && wi.x > 0.9 => -f,
            Bug::Infinite if wi.angle(wo.mirrored()) < 1e-3 => f64::INFINITY,
            _ => f,
        })
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let wi = if let Bug::Shifted(angle) = self.bug { wi.rotated(angle) } else { wi };
        if self.bug == Bug::NotImplemented || wo.z <= 0.0 {
            return 0.0;
        }
        if wi.z <= 0.0 {
            return if self.bug == Bug::PhantomBack && wi.z < 0.0 { 0.02 } else { 0.0 };
        }
        let h = (wo + wi).normalized();
        let alpha = if let Bug::PdfAlpha(e) = self.bug { self.alpha * (1.0 + e) } else { self.alpha };
        let g1 = 1.0 / (1.0 + self.lambda(wo, alpha));
        let visible = g1 * wo.dot(h).max(0.0) * self.d(h, alpha) / wo.z;
        let jacobian = if self.bug == Bug::PdfJacobian { 1.0 } else { 4.0 * wo.dot(h) };
        let p = visible / jacobian;
        match self.bug {
            Bug::PdfFactor(factor) => p * factor,
            Bug::NanPdf if wi.angle(wo.mirrored()) < 0.2 * self.alpha => f64::NAN,
            _ => p,
        }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 || self.bug == Bug::NotImplemented {
            return None;
        }
        let calls = self.calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if self.bug == Bug::Panics && u[0] > 0.9999 {
            panic!("index out of bounds in the test's sampler");
        }
        let draw = |u: &[f64]| {
            let h = self.visible_normal(wo, u);
            if self.bug == Bug::HalfVector { h } else { wo.reflected(h) }
        };
        let mut own = u.to_vec();
        if self.bug == Bug::Repeating {
            let mut last = self.last.lock().unwrap();
            if calls % 2 == 1 && last.len() == u.len() {
                own = last.clone();
            }
            *last = own.clone();
        }
        let u = &own[..];
        let mut wi = draw(u);
        if self.bug == Bug::Redraw {
            for k in 1..6 {
                if wi.z <= 0.0 {
                    wi = draw(&u[2 * k..]);
                }
            }
        }
        match self.bug {
            Bug::MirroredShare(share) if u[2] < share => {
                let across = Direction::new(-wo.y, wo.x, 0.0);
                let length = across.length();
                let across =
                    if length > 0.0 { across * (1.0 / length) } else { Direction::new(0.0, 1.0, 0.0) };
                let off = wi.dot(across).abs();
                wi = wi - across * (wi.dot(across)) + across * off;
            }
            Bug::Length(length) => wi = wi * length,
            Bug::Counting if calls % 2 == 1 => wi = draw(&[u[1], u[0]]),
            Bug::UnflaggedMirror => wi = wo.mirrored(),
            Bug::Stray(share) if u[2] < share => {
                let pdf = self.pdf(wo, wi, transport);
                return (wi.z > 0.0).then(|| Sample {
                    wi: wi.flipped(),
                    weight: Spectrum::from(0.0),
                    pdf,
                    lobe: Lobe::GLOSSY_REFLECTION,
                });
            }
            _ => {}
        }
        if wi.z <= 0.0 {
            return None;
        }
        let pdf = match self.bug {
            // The others' weights do not come from the broken pdf.
            Bug::NanPdf => Ggx::new(self.alpha, Bug::None).pdf(wo, wi, transport),
            _ => self.pdf(wo, wi, transport),
        };
        let cosine = match self.bug {
            Bug::WeightCosine => 1.0,
            _ => wi.z,
        };
        let f = match self.bug {
            Bug::UndeclaredCosine | Bug::Hangs => self.value(wo, wi),
            _ => Bsdf::eval(self, wo, wi, transport)[0],
        };
        let weight = Spectrum::from(f * cosine / pdf);
        let pdf = if let Bug::ReturnedPdf(factor) = self.bug { pdf * factor } else { pdf };
        let lobe = match self.bug {
            Bug::FlaggedDiscrete => Lobe::DISCRETE_REFLECTION,
            _ => Lobe::GLOSSY_REFLECTION,
        };
        Some(Sample { wi, weight, pdf, lobe })
    }
}
