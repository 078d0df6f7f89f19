//! Phong's model, modified to conserve energy and to be reciprocal.

use super::lambert::sample_cosine;
use super::{cosine_lobe, mixture};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use std::f64::consts::{PI, TAU};

/// f = kd/π + ks (n + 2)/2π cosⁿα on the front side, α the angle between wi and
/// the mirror direction of wo (E. P. Lafortune and Y. D. Willems, *Using the
/// modified Phong reflectance model for physically based rendering*, report CW
/// 197, K.U. Leuven, 1994, eq. 4). Each lobe is drawn with a share of its
/// reflectance at normal incidence; draws below the horizon are no sample.
///
/// The albedo is at most kd + ks, reached at normal incidence: of two functions
/// that fall off from an axis each, the integral of the product is largest where
/// the axes meet (Hardy and Littlewood's rearrangement inequality), and there
/// (n + 2)/2π ∫cosⁿ⁺¹θ = 1.
#[derive(Clone, Copy, Debug)]
pub struct Phong {
    pub(crate) kd: f64,
    pub(crate) ks: f64,
    pub(crate) exponent: f64,
    pub(crate) shares: [f64; 2],
}

/// The registered model `phong`.
pub(super) fn model() -> Model {
    Model::new(
        "phong",
        "diffuse and a cosⁿ lobe about the mirror (Lafortune and Willems 1994)",
        Phong::declared,
    )
    .number("kd", 0.4, 0.0..=1.0, "share of the light that is reflected diffusely")
    .number("ks", 0.5, 0.0..=1.0, "share that goes to the lobe, at normal incidence; kd + ks ≤ 1")
    .number("exponent", 30.0, 0.0..=1e5, "n: the larger, the narrower the lobe")
    .only_if("ks > 0", |p| p.number("ks") > 0.0)
}

impl Phong {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Phong::new(p.number("kd"), p.number("ks"), p.number("exponent"))
    }

    /// `kd` and `ks` in [0, 1] with kd + ks ≤ 1; `exponent` n ≥ 0.
    pub fn new(kd: f64, ks: f64, exponent: f64) -> Result<Self, String> {
        // What people type, such as 0.9 + 0.1, may round to more than 1.
        if kd + ks > 1.0 + f64::EPSILON {
            return Err(format!(
                "kd + ks = {} reflects more than arrives; choose them to add up to at most 1",
                kd + ks
            ));
        }
        Ok(Self { kd, ks, exponent, shares: mixture::shares([kd, ks]) })
    }
}

impl Bsdf for Phong {
    fn describe(&self) -> Description {
        Description::new("phong").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.lossless = self.kd == 1.0;
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let lobe = cosine_lobe::power(wo.mirrored().dot(wi), self.exponent);
        Spectrum::from(self.kd / PI + self.ks * (self.exponent + 2.0) / TAU * lobe)
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let lobe = cosine_lobe::density(wo.mirrored().dot(wi), self.exponent);
        self.shares[0] * wi.z / PI + self.shares[1] * lobe
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (chosen, first) = mixture::choose(self.shares, u[0]);
        let (wi, lobe) = if chosen == 0 {
            (sample_cosine(&[first, u[1]]), Lobe::DIFFUSE_REFLECTION)
        } else {
            (cosine_lobe::sample(wo.mirrored(), self.exponent, &[first, u[1]]), Lobe::GLOSSY_REFLECTION)
        };
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe })
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        vec![wo.mirrored()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::brute_force::{albedo, assert_sound};

    /// At normal incidence (n + 2)/2π ∫cosⁿ⁺¹ = 1. For n = 0 the lobe is Lambert's on
    /// the lune that the mirror direction sees; for n = 1, ∫ of both cosines over
    /// that lune is 2/3 (sin θo + (π − θo) cos θo).
    #[test]
    fn albedo_is_as_in_closed_form() {
        for n in [0.0, 1.0, 7.5, 60.0] {
            let a = albedo(&Phong::new(0.25, 0.5, n).unwrap(), Direction::NORMAL, 0);
            assert!((a - 0.75).abs() < 2e-5, "{n}: {a}");
        }
        for theta in [0.4f64, 1.0, 1.5] {
            let wo = Direction::from_angles(theta, 0.3);
            let lune = 0.5 * (1.0 + theta.cos());
            let both = (theta.sin() + (PI - theta) * theta.cos()) / PI;
            let [a, b] = [0.0, 1.0].map(|n| albedo(&Phong::new(0.0, 1.0, n).unwrap(), wo, 0));
            assert!((a - lune).abs() < 1e-3 && (b - both).abs() < 2e-5, "{theta}: {a} {lune} {b} {both}");
        }
    }

    #[test]
    fn without_a_lobe_it_is_lambert() {
        let model = Phong::new(1.0, 0.0, 30.0).unwrap();
        assert!(model.describe().claims.lossless);
        let (wo, wi) = (Direction::from_angles(0.3, 1.0), Direction::from_angles(1.2, 0.0));
        assert_eq!(model.eval(wo, wi, Transport::Radiance)[0], 1.0 / PI);
        assert!(Phong::new(0.7, 0.4, 1.0).unwrap_err().contains("kd + ks = 1.1"));
        assert!(Phong::new(0.9, 0.1, 1.0).is_ok());
    }

    /// What does nothing goes back to its default, and `sensitivity` leaves it alone.
    #[test]
    fn exponent_matters_with_a_lobe_only() {
        let spelled = |text: &str| {
            crate::registry::Registry::builtin().resolve(&text.parse().unwrap()).unwrap().spelling
        };
        assert_eq!(spelled("phong:ks=0,exponent=50"), "phong:ks=0");
        assert_eq!(spelled("phong:ks=0.1,exponent=50"), "phong:ks=0.1,exponent=50");
    }

    #[test]
    fn edges_are_sound() {
        for (kd, ks, n) in [(0.5, 0.5, 0.0), (0.0, 1.0, 20.0), (0.4, 0.1, 1e5), (0.0, 0.0, 1.0)] {
            assert_sound(&Phong::new(kd, ks, n).unwrap());
        }
    }
}
