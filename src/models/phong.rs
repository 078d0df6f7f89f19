//! Phong's model, modified to conserve energy and to be reciprocal.

use super::lambert::sample_cosine;
use super::{cosine_lobe, mixture};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::Model;
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
    kd: f64,
    ks: f64,
    exponent: f64,
    shares: [f64; 2],
}

/// The registered model `phong`.
pub(super) fn model() -> Model {
    Model::new("phong", "diffuse and a cosⁿ lobe about the mirror (Lafortune and Willems 1994)", |p| {
        Phong::new(p.number("kd"), p.number("ks"), p.number("exponent"))
    })
    .number("kd", 0.4, 0.0..=1.0, "share of the light that is reflected diffusely")
    .number("ks", 0.5, 0.0..=1.0, "share that goes to the lobe, at normal incidence; kd + ks ≤ 1")
    .number("exponent", 30.0, 0.0..=1e5, "n: the larger, the narrower the lobe")
    .only_if("ks > 0", |p| p.number("ks") > 0.0)
}

impl Phong {
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
