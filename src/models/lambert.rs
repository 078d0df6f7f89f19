//! Lambert's ideally diffuse reflector.

use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use crate::sphere::sin_cos_turns;
use std::f64::consts::PI;

/// A density of directions over the upper hemisphere, whatever the material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HemisphereSampling {
    /// p = cos θi / π.
    Cosine,
    /// p = 1 / 2π.
    Uniform,
}

impl HemisphereSampling {
    /// The density named `name`; cosine where it is not `uniform`.
    pub(super) fn named(name: &str) -> Self {
        if name == "uniform" { Self::Uniform } else { Self::Cosine }
    }

    /// Density of a direction above the horizon per steradian.
    #[inline]
    pub(super) fn density(self, wi: Direction) -> f64 {
        match self {
            Self::Cosine => wi.z / PI,
            Self::Uniform => 0.5 / PI,
        }
    }

    /// A direction above the horizon with this density.
    #[inline]
    pub(super) fn draw(self, u: &[f64]) -> Direction {
        match self {
            Self::Cosine => sample_cosine(u),
            Self::Uniform => sample_uniform(u),
        }
    }
}

/// Ideally diffuse reflection, f = ρ/π on the front side (J. H. Lambert,
/// *Photometria*, 1760).
#[derive(Clone, Copy, Debug)]
pub struct Lambert {
    /// Reflectance ρ in [0, 1].
    pub reflectance: f64,
    /// How directions are drawn.
    pub sampling: HemisphereSampling,
}

/// The registered model `lambert`.
pub(super) fn model() -> Model {
    Model::new("lambert", "ideally diffuse reflection, f = ρ/π (Lambert 1760)", Lambert::declared)
        .number("reflectance", 0.8, 0.0..=1.0, "share of the light that is reflected")
        .choice("sampling", &["cosine", "uniform"], "density of sampled directions")
}

impl Lambert {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self {
            reflectance: p.number("reflectance"),
            sampling: HemisphereSampling::named(p.text("sampling")),
        })
    }
}

/// A direction of the upper hemisphere with density cos θ/π, by Malley's
/// method over the polar map of the disc.
pub(crate) fn sample_cosine(u: &[f64]) -> Direction {
    let r = u[0].sqrt();
    let (sin, cos) = sin_cos_turns(u[1]);
    Direction::new(r * cos, r * sin, (1.0 - u[0]).sqrt())
}

/// A direction of the upper hemisphere with density 1/2π.
pub(crate) fn sample_uniform(u: &[f64]) -> Direction {
    // z in (0, 1], so that u = 0 does not touch the horizon.
    let z = 1.0 - u[0];
    let r = (u[0] * (1.0 + z)).sqrt();
    let (sin, cos) = sin_cos_turns(u[1]);
    Direction::new(r * cos, r * sin, z)
}

impl Bsdf for Lambert {
    fn describe(&self) -> Description {
        Description::new("lambert").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.lossless = self.reflectance == 1.0;
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let lit = wo.z > 0.0 && wi.z > 0.0;
        Spectrum::from(if lit { self.reflectance / PI } else { 0.0 })
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        self.sampling.density(wi)
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = self.sampling.draw(u);
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}
