//! Estevez and Kulla's sheen of cloth.

use super::lambert::HemisphereSampling;
use super::microfacet::torrance_sparrow::half_vector;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::Model;
use std::f64::consts::TAU;

/// Coefficients a to e of L(x) = a/(1 + b xᶜ) + d x + e, fitted to Smith's ln Λ at
/// r = 0 and r = 1 (table 1 of the notes).
const FIT: [[f64; 5]; 2] =
    [[25.3245, 3.32435, 0.16801, -1.27393, -4.85967], [21.5473, 3.82987, 0.19823, -1.97760, -4.32054]];

/// f = ρ D G/(4 cos θo cos θi) on the front side, with D = (2 + 1/r) sin^(1/r)θ/2π
/// and G = 1/(1 + Λ(θo) + Λ(θi)) from their fit of Λ (A. C. Estevez and C. Kulla,
/// *Production friendly microfacet sheen BRDF*, SIGGRAPH 2017 course notes). The
/// coefficients are interpolated by (1 − r)².
///
/// With the softened terminator, Λ(θi) of the light is raised to 1 + 2 (1 − cos
/// θi)⁸, and of wo is not: reciprocity is given up, and not claimed. Energy
/// conservation is not claimed either: the fit of Λ is finite at the horizon,
/// e^(a+e), where Smith's is not, so the albedo grows without bound as θo → 90°
/// (beyond 1 within some 10⁻⁸ of it).
#[derive(Clone, Copy, Debug)]
pub struct Sheen {
    reflectance: f64,
    /// 1/r.
    exponent: f64,
    fit: [f64; 5],
    /// L(½).
    half: f64,
    softened: bool,
    sampling: HemisphereSampling,
}

/// The registered model `sheen`.
pub(super) fn model() -> Model {
    Model::new("sheen", "microfacet sheen of cloth (Estevez and Kulla 2017)", |p| {
        Ok(Sheen::new(
            p.number("reflectance"),
            p.number("roughness"),
            p.text("terminator") == "softened",
            HemisphereSampling::named(p.text("sampling")),
        ))
    })
    .number("reflectance", 1.0, 0.0..=1.0, "factor of the whole")
    .number("roughness", 0.3, 0.05..=1.0, "r: the smaller, the more the fibres stand upright")
    .choice("terminator", &["plain", "softened"], "softened gives up reciprocity for a soft edge of light")
    .choice("sampling", &["uniform", "cosine"], "density of sampled directions")
}

impl Sheen {
    /// `reflectance` in [0, 1], `roughness` r in (0, 1].
    pub fn new(reflectance: f64, roughness: f64, softened: bool, sampling: HemisphereSampling) -> Self {
        let s = (1.0 - roughness) * (1.0 - roughness);
        let fit = std::array::from_fn(|k| s * FIT[0][k] + (1.0 - s) * FIT[1][k]);
        let half = ln_lambda_fit(&fit, 0.5);
        Self { reflectance, exponent: 1.0 / roughness, fit, half, softened, sampling }
    }

    /// Smith's Λ by the fit, which is mirrored beyond 60°.
    #[inline]
    fn lambda(&self, cos: f64) -> f64 {
        if cos < 0.5 {
            ln_lambda_fit(&self.fit, cos).exp()
        } else {
            (2.0 * self.half - ln_lambda_fit(&self.fit, (1.0 - cos).max(0.0))).exp()
        }
    }

    /// D(m) per steradian; ∫D cos θ = 1.
    #[inline]
    fn density(&self, m: Direction) -> f64 {
        (2.0 + self.exponent) / TAU * (m.x * m.x + m.y * m.y).powf(0.5 * self.exponent)
    }
}

/// L(x).
#[inline]
fn ln_lambda_fit([a, b, c, d, e]: &[f64; 5], x: f64) -> f64 {
    a / (1.0 + b * x.powf(*c)) + d * x + e
}

impl Bsdf for Sheen {
    fn describe(&self) -> Description {
        Description::new("sheen").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.reciprocal = !self.softened;
            c.energy_conserving = false;
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let Some((m, _)) = half_vector(wo, wi) else {
            return Spectrum::zero(1);
        };
        let d = self.density(m);
        if d == 0.0 {
            return Spectrum::zero(1);
        }
        let mut shadowing = self.lambda(wi.z);
        if self.softened {
            shadowing = shadowing.powf(1.0 + 2.0 * (1.0 - wi.z).max(0.0).powi(8));
        }
        let g = 1.0 / (1.0 + self.lambda(wo.z) + shadowing);
        Spectrum::from(self.reflectance * d * g / (4.0 * wo.z * wi.z))
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 { 0.0 } else { self.sampling.density(wi) }
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = self.sampling.draw(u);
        let pdf = self.sampling.density(wi);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        let valid = pdf > 0.0 && weight[0].is_finite();
        valid.then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}
