//! How to test a BSDF of your own from `cargo test`: implement [`Bsdf`], call
//! [`gonio::assert_valid`]. Run by this repository's tests, and by
//! `cargo run --example unit_test`.

use gonio::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use std::f64::consts::PI;

/// A reflector that is brighter towards grazing light in a reciprocal way:
/// Minnaert's law (1941), f = ρ (k+1)/(2π) (cos θo cos θi)^(k−1).
pub struct Minnaert {
    /// Reflectance at k = 1, where the law is Lambert's.
    pub reflectance: f64,
    /// Darkening exponent, at least 1.
    pub k: f64,
}

impl Bsdf for Minnaert {
    fn describe(&self) -> Description {
        Description::new("minnaert").dimensions(2).claims(|c| c.isotropic = true)
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        Spectrum::from(self.reflectance * (self.k + 1.0) / (2.0 * PI) * (wo.z * wi.z).powf(self.k - 1.0))
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        // The density of cos^k θi, which eval·cos θi is proportional to.
        if wo.z <= 0.0 || wi.z <= 0.0 { 0.0 } else { (self.k + 1.0) / (2.0 * PI) * wi.z.powf(self.k) }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let cos_theta = (1.0 - u[0]).powf(1.0 / (self.k + 1.0));
        let theta = cos_theta.acos();
        let wi = Direction::from_angles(theta, 2.0 * PI * u[1]);
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

#[test]
fn minnaert_is_valid() {
    gonio::assert_valid(&Minnaert { reflectance: 0.6, k: 1.7 });
}

fn main() {
    gonio::assert_valid(&Minnaert { reflectance: 0.6, k: 1.7 });
    println!("Minnaert's law passes every check that it claims");
}
