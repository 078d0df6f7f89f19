//! Estevez and Kulla's sheen of cloth.

use super::lambert::HemisphereSampling;
use super::microfacet::half_vector;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
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
/// e^(a+e), where Smith's is not, so the albedo grows without bound as θo → 90°. Up to
/// 89.9° it is at most 0.93 for r ≥ 0.1, and 1.09 for r = 0.05.
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
    Model::new("sheen", "microfacet sheen of cloth (Estevez and Kulla 2017)", Sheen::declared)
        .number("reflectance", 1.0, 0.0..=1.0, "factor of the whole")
        .number("roughness", 0.3, 0.05..=1.0, "r: the smaller, the more the fibres stand upright")
        .choice(
            "terminator",
            &["plain", "softened"],
            "softened gives up reciprocity for a soft edge of light",
        )
        .choice("sampling", &["uniform", "cosine"], "density of sampled directions")
}

impl Sheen {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self::new(
            p.number("reflectance"),
            p.number("roughness"),
            p.text("terminator") == "softened",
            HemisphereSampling::named(p.text("sampling")),
        ))
    }

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
        let Some((m, _)) = half_vector::of_reflection(wo, wi) else {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::brute_force::{albedo, assert_sound, hemisphere};

    const R: Transport = Transport::Radiance;

    fn sheen(roughness: f64, softened: bool) -> Sheen {
        Sheen::new(1.0, roughness, softened, HemisphereSampling::Uniform)
    }

    #[test]
    fn density_is_normalised() {
        for r in [0.05, 0.3, 1.0] {
            let model = sheen(r, false);
            let mass = hemisphere(|m| model.density(m) * m.z);
            assert!((mass - 1.0).abs() < 1e-5, "{r}: {mass}");
        }
    }

    /// The fit follows Smith's Λ = ∫D max(0, −w·m)/cos θ, which it was made for: a digit
    /// of the table that is wrong shows.
    #[test]
    fn fit_follows_the_integral() {
        for r in [0.1, 0.5, 1.0] {
            let model = sheen(r, false);
            for theta in [0.3f64, 0.7, 1.0, 1.3, 1.5] {
                let w = Direction::from_angles(theta, 0.4);
                let exact = hemisphere(|m| model.density(m) * (-w.dot(m)).max(0.0)) / w.z;
                let ratio = model.lambda(w.z) / exact;
                assert!((ratio - 1.0).abs() < 0.15, "{r} {theta}: {ratio}");
            }
        }
    }

    #[test]
    fn softening_darkens_and_breaks_reciprocity() {
        let (plain, soft) = (sheen(0.3, false), sheen(0.3, true));
        let (wo, wi) = (Direction::from_angles(0.5, 0.1), Direction::from_angles(1.4, 1.0));
        let f = |model: &Sheen, a, b| model.eval(a, b, R)[0];
        assert!((f(&plain, wo, wi) / f(&plain, wi, wo) - 1.0).abs() < 1e-13);
        assert!(f(&soft, wo, wi) < 0.9 * f(&plain, wo, wi));
        assert!(f(&soft, wi, wo) / f(&soft, wo, wi) > 1.1);
        assert!(plain.describe().claims.reciprocal && !soft.describe().claims.reciprocal);
    }

    #[test]
    fn gains_energy_near_the_horizon() {
        let at = |r: f64, degrees: f64| {
            albedo(&sheen(r, false), Direction::from_angles(degrees.to_radians(), 0.4), 0)
        };
        assert!(at(0.05, 89.9) > 1.05 && at(0.3, 89.0) < 0.8);
        assert!(at(1.0, 90.0 - 1e-8) > 1.0);
        assert!(!sheen(0.3, false).describe().claims.energy_conserving);
    }

    #[test]
    fn edges_are_sound() {
        for model in [sheen(0.05, true), sheen(1.0, false)] {
            assert_sound(&model);
        }
    }
}
