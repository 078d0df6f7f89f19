//! Plastic with one bug at a time: a smooth coat around gonio's own model, a rough
//! one written for the tests.

use super::{Bug, Ggx};
use gonio::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use gonio::models::Plastic;
use std::f64::consts::PI;

/// What is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlasticBug {
    None,
    /// The number that chose the lobe is handed on as it is.
    NotRescaled,
    /// pdf() has other probabilities of the lobes than sample().
    OtherProbability,
    /// pdf() lacks the probabilities of the lobes.
    NotFolded,
    /// Weight and pdf of a sample are those of its lobe alone.
    OneLobe,
    /// No lobe lets the other's light in: f of the base has no transmittance at wi.
    OneWay,
}

fn cosine(u: f64, v: f64) -> Direction {
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    Direction::new(u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt())
}

/// A GGX lobe with Schlick's reflectance, and what it does not reflect, diffusely:
/// not of any physics, but consistent.
pub struct RoughCoat {
    pub coat: Ggx,
    pub bug: PlasticBug,
}

impl RoughCoat {
    pub fn new(alpha: f64, bug: PlasticBug) -> Self {
        Self { coat: Ggx::new(alpha, Bug::None), bug }
    }

    /// Probability of the coat's lobe.
    fn probability(wo: Direction) -> f64 {
        0.3 + 0.4 * (1.0 - wo.z)
    }

    fn passes(w: Direction) -> f64 {
        0.7 - 0.5 * (1.0 - w.z)
    }

    fn densities(&self, wo: Direction, wi: Direction, transport: Transport) -> (f64, f64) {
        (Bsdf::pdf(&self.coat, wo, wi, transport), wi.z / PI)
    }
}

impl Bsdf for RoughCoat {
    fn describe(&self) -> Description {
        Description::new("ad-hoc-plastic").dimensions(2).claims(|c| c.isotropic = true)
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let inwards = if self.bug == PlasticBug::OneWay { 0.5 } else { Self::passes(wi) };
        Spectrum::from(self.coat.value(wo, wi) + 0.8 / PI * Self::passes(wo) * inwards)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let (coat, base) = self.densities(wo, wi, transport);
        match self.bug {
            PlasticBug::NotFolded => coat + base,
            PlasticBug::OtherProbability => 0.5 * coat + 0.5 * base,
            _ => {
                let p = Self::probability(wo);
                p * coat + (1.0 - p) * base
            }
        }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let p = Self::probability(wo);
        let glossy = u[0] < p;
        let rest = match (self.bug, glossy) {
            (PlasticBug::NotRescaled, _) => u[0],
            (_, true) => u[0] / p,
            (_, false) => (u[0] - p) / (1.0 - p),
        };
        let (wi, lobe) = if glossy {
            (wo.reflected(self.coat.visible_normal(wo, &[rest, u[1]])), Lobe::GLOSSY_REFLECTION)
        } else {
            (cosine(rest, u[1]), Lobe::DIFFUSE_REFLECTION)
        };
        if wi.z <= 0.0 {
            return None;
        }
        let (mut f, mut pdf) = (Bsdf::eval(self, wo, wi, transport)[0], Bsdf::pdf(self, wo, wi, transport));
        if self.bug == PlasticBug::OneLobe {
            let (coat, base) = self.densities(wo, wi, transport);
            let lobe = self.coat.value(wo, wi);
            (f, pdf) = if glossy { (lobe, p * coat) } else { (f - lobe, (1.0 - p) * base) };
        }
        Some(Sample { wi, weight: Spectrum::from(f * wi.z / pdf), pdf, lobe })
    }
}

/// Gonio's smooth plastic with a bug in `sample`.
pub struct SmoothCoat {
    pub right: Plastic,
    pub bug: PlasticBug,
}

impl Bsdf for SmoothCoat {
    fn describe(&self) -> Description {
        Bsdf::describe(&self.right)
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        Bsdf::eval(&self.right, wo, wi, transport)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        Bsdf::pdf(&self.right, wo, wi, transport)
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let mut s = Bsdf::sample(&self.right, wo, u, transport)?;
        match self.bug {
            PlasticBug::NotRescaled if s.lobe.is_continuous() => {
                s.wi = cosine(u[0], u[1]);
                s.pdf = Bsdf::pdf(&self.right, wo, s.wi, transport);
                s.weight = Bsdf::eval(&self.right, wo, s.wi, transport) * (s.wi.z / s.pdf);
            }
            // Told as if both lobes were as probable.
            PlasticBug::OtherProbability if s.lobe.is_discrete() => {
                s.weight = s.weight * (s.pdf / 0.5);
                s.pdf = 0.5;
            }
            _ => {}
        }
        Some(s)
    }
}
