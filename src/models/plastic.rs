//! A smooth dielectric coat over a diffuse base.

use super::coated_base::{CoatedBase, Lobes};
use super::lambert::sample_cosine;
use super::{fresnel, gauss_legendre};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use std::f64::consts::PI;

/// Mirror reflection F(θo) of the coat and, through it, a Lambertian base:
/// f = (1 − F(θo)) (1 − F(θi)) ρ/(π η² (1 − ρ r)), r the coat's diffuse reflectance
/// from inside (J. L. Saunderson, JOSA 1942; as the smooth plastic of W. Jakob's
/// Mitsuba). Each lobe is drawn with its share of the albedo at wo. Where ρ = 1, all
/// light leaves.
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    reflectance: f64,
    eta: f64,
    base: CoatedBase,
}

/// The registered model `plastic`.
pub(super) fn model() -> Model {
    Model::new("plastic", "smooth dielectric coat over a diffuse base (Saunderson 1942)", Plastic::declared)
        .number("reflectance", 0.5, 0.0..=1.0, "reflectance of the base")
        .number("eta", 1.5, 1.0..=4.0, "index of refraction of the coat")
}

impl Plastic {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self::new(p.number("reflectance"), p.number("eta")))
    }

    /// With a base of `reflectance` in [0, 1] under a coat of index `eta` ≥ 1.
    pub fn new(reflectance: f64, eta: f64) -> Self {
        Self { reflectance, eta, base: CoatedBase::new(reflectance, eta, mean_transmittance(eta)) }
    }

    /// What passes the coat at the angle of this cosine > 0.
    #[inline]
    fn passing(&self, cos: f64) -> f64 {
        passing(cos, self.eta)
    }

    fn lobes(&self, cos_o: f64) -> Lobes {
        Lobes::by_albedo(fresnel::dielectric(cos_o, self.eta), self.base.albedo(self.passing(cos_o)))
    }
}

/// What a smooth interface lets in, `eta` ≥ 1.
#[inline]
fn passing(cos: f64, eta: f64) -> f64 {
    fresnel::refracted_cosine(cos, eta).map_or(0.0, |inside| fresnel::transmitted(cos, inside, eta))
}

/// ∫ T cos θ/π over the hemisphere: 2 ∫ T(μ) μ dμ. Of μ = x³, where the rule has
/// 12 digits for every eta ≥ 1 (T rises from 0 within μ ~ √(η² − 1)).
fn mean_transmittance(eta: f64) -> f64 {
    let sum = gauss_legendre::rule(64).into_iter().map(|(x, w)| {
        let mu = x * x * x;
        w * 3.0 * x * x * mu * passing(mu, eta)
    });
    2.0 * sum.sum::<f64>()
}

impl Bsdf for Plastic {
    fn describe(&self) -> Description {
        Description::new("plastic").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.lossless = self.reflectance == 1.0;
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let lit = wo.z > 0.0 && wi.z > 0.0;
        let f = if lit { self.base.value(self.passing(wo.z), self.passing(wi.z)) } else { 0.0 };
        Spectrum::from(f)
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z > 0.0 && wi.z > 0.0 { self.lobes(wo.z).second * wi.z / PI } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let lobes = self.lobes(wo.z);
        let (mirror, rest) = lobes.choose(u[0]);
        if mirror {
            return Some(Sample {
                wi: wo.mirrored(),
                weight: Spectrum::from(fresnel::dielectric(wo.z, self.eta) / lobes.first),
                pdf: lobes.first,
                lobe: Lobe::DISCRETE_REFLECTION,
            });
        }
        let wi = sample_cosine(&[rest, u[1]]);
        let pdf = lobes.second * wi.z / PI;
        let weight = Bsdf::eval(self, wo, wi, transport) * (PI / lobes.second);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: Transport = Transport::Radiance;
    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;

    /// The closed form of the diffuse reflectance of an interface from the thinner
    /// side (J. W. T. Walsh 1926; S. Q. Duntley, JOSA 1942; Egan and Hilgeman,
    /// *Optical Properties of Inhomogeneous Materials*, 1979).
    fn diffuse_reflectance(n: f64) -> f64 {
        let (n2, n4) = (n * n, n.powi(4));
        0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
            + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
            - 2.0 * n2 * n * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
            + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
    }

    #[test]
    fn mean_transmittance_equals_the_closed_form() {
        // 9.18 % from outside and 59.6 % from inside, as printed for n = 1.5.
        assert!((diffuse_reflectance(1.5) - 0.0918).abs() < 5e-5);
        assert!((1.0 - mean_transmittance(1.5) / 2.25 - 0.596).abs() < 5e-4);
        for eta in [1.05, 1.1, 1.33, 1.5, 2.4, 4.0] {
            let error = mean_transmittance(eta) + diffuse_reflectance(eta) - 1.0;
            assert!(error.abs() < 1e-11, "{eta}: {error:e}");
        }
        assert!((mean_transmittance(1.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_white_base_is_lossless_and_a_black_one_a_mirror() {
        let n = 4000;
        for (eta, theta) in [(1.0, 0.3), (1.5, 0.0), (1.5, 1.5), (2.4, 1.0)] {
            let wo = Direction::from_angles(theta, 1.0);
            let albedo = |model: &Plastic| {
                let diffuse: f64 = (0..n)
                    .map(|k| {
                        let mu = ((f64::from(k) + 0.5) / f64::from(n)).powi(2);
                        let wi = Direction::from_angles(mu.acos(), 0.0);
                        model.eval(wo, wi, R)[0] * wi.z * 2.0 * PI * 2.0 * mu.sqrt()
                    })
                    .sum();
                diffuse / f64::from(n) + fresnel::dielectric(wo.z, eta)
            };
            let white = albedo(&Plastic::new(1.0, eta));
            assert!((white - 1.0).abs() < 1e-6, "{eta} {theta}: {white}");
            assert!(albedo(&Plastic::new(0.5, eta)) < 0.5 + 0.5 * fresnel::dielectric(wo.z, eta) + 1e-9);
            let black = Plastic::new(0.0, 1.5).sample(wo, &[LAST, 0.5], R).unwrap();
            assert_eq!((black.lobe, black.pdf), (Lobe::DISCRETE_REFLECTION, 1.0));
        }
    }

    #[test]
    fn edges() {
        let horizon = Direction::new(1.0, 0.0, 0.0);
        for model in [Plastic::new(0.0, 1.5), Plastic::new(1.0, 1.0), Plastic::new(0.5, 4.0)] {
            assert!(model.sample(horizon, &[0.5, 0.5], R).is_none());
            assert!(model.sample(-Direction::NORMAL, &[0.5, 0.5], R).is_none());
            for wo in [Direction::NORMAL, Direction::new(1.0, 0.0, 1e-300)] {
                for u in [[0.0, 0.0], [LAST, LAST], [LAST, 0.0]] {
                    let Some(s) = model.sample(wo, &u, R) else { continue };
                    assert!(s.pdf > 0.0 && s.weight[0].is_finite(), "{model:?} {wo:?} {u:?}: {s:?}");
                }
                assert_eq!(model.eval(wo, horizon, R)[0], 0.0);
                assert_eq!(model.eval(wo, -Direction::NORMAL, R)[0], 0.0);
            }
        }
    }
}
