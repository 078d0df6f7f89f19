//! Oren and Nayar's rough diffuse reflector.

use super::lambert::sample_cosine;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use std::f64::consts::PI;

/// Diffuse reflection of V-grooves with Lambertian walls, in the qualitative
/// form f = ρ/π (A + B max(0, cos Δφ) sin α tan β), α and β the larger and the
/// smaller polar angle (M. Oren and S. K. Nayar, *Generalization of Lambert's
/// reflectance model*, SIGGRAPH 1994, eq. 30). Drawn as Lambert's.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayar {
    reflectance: f64,
    a: f64,
    b: f64,
}

/// The registered model `oren-nayar`.
pub(super) fn model() -> Model {
    Model::new(
        "oren-nayar",
        "rough diffuse reflection (Oren and Nayar 1994, qualitative form)",
        OrenNayar::declared,
    )
    .number("reflectance", 0.8, 0.0..=1.0, "share of the light that a facet reflects")
    .number("sigma", 20.0, 0.0..=90.0, "standard deviation of the facets' slope angle, degrees")
}

impl OrenNayar {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self::new(p.number("reflectance"), p.number("sigma").to_radians()))
    }

    /// With facets of `reflectance` in [0, 1] whose slope angle has the
    /// standard deviation `sigma` in radians.
    pub fn new(reflectance: f64, sigma: f64) -> Self {
        let variance = sigma * sigma;
        Self {
            reflectance,
            a: 1.0 - 0.5 * variance / (variance + 0.33),
            b: 0.45 * variance / (variance + 0.09),
        }
    }

    /// The directional albedo's supremum over θo, ρ (A + B/2), approached at
    /// grazing view.
    ///
    /// The albedo is ρ (A + 2B/π J(θo)) with J = sin θo (θo − sin θo cos θo)/2 +
    /// tan θo (1 − sin³θo)/3: the integral over Δφ is 2, and the one over θi is
    /// elementary on both sides of θi = θo. J' = cos θo (θo − sin θo cos θo)/2 +
    /// (1 − sin³θo)/(3 cos²θo) > 0, so J is largest at θo = π/2, where it is π/4.
    pub fn largest_albedo(&self) -> f64 {
        self.reflectance * (self.a + 0.5 * self.b)
    }
}

impl Bsdf for OrenNayar {
    fn describe(&self) -> Description {
        Description::new("oren-nayar").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.energy_conserving = self.largest_albedo() <= 1.0;
            c.lossless = self.reflectance == 1.0 && self.b == 0.0;
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        // sin α tan β cos Δφ = (sin θo sin θi cos Δφ) / max(cos θo, cos θi).
        let facing = (wo.x * wi.x + wo.y * wi.y).max(0.0) / wo.z.max(wi.z);
        Spectrum::from(self.reflectance / PI * (self.a + self.b * facing))
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 { 0.0 } else { wi.z / PI }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = sample_cosine(u);
        let weight = Bsdf::eval(self, wo, wi, transport) * PI;
        Some(Sample { wi, weight, pdf: wi.z / PI, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Midpoint rule over the hemisphere of wi.
    fn albedo(model: &OrenNayar, wo: Direction) -> f64 {
        let (n, m) = (2000, 400);
        let mut sum = 0.0;
        for i in 0..n {
            let theta = (f64::from(i) + 0.5) / f64::from(n) * PI / 2.0;
            for j in 0..m {
                let wi = Direction::from_angles(theta, (f64::from(j) + 0.5) / f64::from(m) * 2.0 * PI);
                sum += model.eval(wo, wi, Transport::Radiance)[0] * wi.z * theta.sin();
            }
        }
        sum * PI * PI / f64::from(n * m)
    }

    #[test]
    fn gains_energy_as_known() {
        let model = OrenNayar::new(1.0, 0.2);
        let at = |degrees: f64| albedo(&model, Direction::from_angles(degrees.to_radians(), 0.4));
        assert!((at(89.0) - 1.0144).abs() < 1e-4, "{}", at(89.0));
        assert!((at(89.99) - model.largest_albedo()).abs() < 2e-4);
        assert!(at(60.0) < at(80.0) && at(80.0) < at(89.0) && at(89.0) < model.largest_albedo());
        assert!(!model.describe().claims.energy_conserving);
        assert!(OrenNayar::new(0.8, 0.2).describe().claims.energy_conserving);
        assert!(OrenNayar::new(1.0, 0.0).describe().claims.lossless);
    }

    #[test]
    fn equals_the_form_in_angles() {
        let model = OrenNayar::new(0.7, 0.6);
        let (a, b) = (1.0 - 0.5 * 0.36 / 0.69, 0.45 * 0.36 / 0.45);
        for (to, ti, phi) in [(0.3f64, 1.1f64, 0.4f64), (1.5, 0.2, 1.0), (0.9, 0.9, 2.0), (1.2, 1.3, 3.0)] {
            let f = 0.7 / PI * (a + b * phi.cos().max(0.0) * to.max(ti).sin() * to.min(ti).tan());
            let (wo, wi) = (Direction::from_angles(to, 0.5), Direction::from_angles(ti, 0.5 + phi));
            let value = model.eval(wo, wi, Transport::Radiance)[0];
            assert!((value - f).abs() < 1e-14);
            assert_eq!(value, model.eval(wi, wo, Transport::Radiance)[0]);
        }
    }

    #[test]
    fn edges() {
        let model = OrenNayar::new(1.0, 1.5);
        let horizon = Direction::new(1.0, 0.0, 0.0);
        let last = 1.0 - f64::EPSILON / 2.0;
        assert_eq!(model.eval(horizon, horizon, Transport::Radiance)[0], 0.0);
        assert!(model.sample(horizon, &[0.5, 0.5], Transport::Radiance).is_none());
        for wo in [Direction::NORMAL, Direction::new(1.0, 0.0, 1e-100)] {
            for u in [[0.0, 0.0], [last, last], [last, 0.0]] {
                let s = model.sample(wo, &u, Transport::Radiance).unwrap();
                assert!(s.weight[0].is_finite() && s.pdf > 0.0 && (s.wi.length() - 1.0).abs() < 1e-15);
                let f = model.eval(wo, s.wi, Transport::Radiance)[0];
                assert!((s.weight[0] * s.pdf - f * s.wi.z).abs() <= 1e-14 * f * s.wi.z);
            }
        }
    }
}
