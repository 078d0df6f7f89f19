//! @NAME@: a BSDF, and gonio's command line for it. It is Lambert's reflector,
//! f = reflectance / π; put your own in its place.
//!
//! Directions are unit vectors that point away from the surface, whose normal is
//! +z: cos θ is the z of a direction. wo is given, wi is sampled.

use gonio::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use gonio::registry::{Model, Registry};
use std::f64::consts::PI;
use std::process::ExitCode;

/// All that gonio can do, with this model beside its own.
fn main() -> ExitCode {
    gonio::main(Registry::builtin().register(model()))
}

/// How suites and the command line know it; gonio keeps parameters in their range.
fn model() -> Model {
    Model::new("@NAME@", "ideally diffuse reflection", |p| {
        Ok(Lambert { reflectance: p.number("reflectance") })
    })
    .number("reflectance", 0.5, 0.0..=1.0, "share of the light that is reflected")
}

struct Lambert {
    reflectance: f64,
}

impl Bsdf for Lambert {
    /// Claims are what the model is held to: one that is not made is not tested.
    fn describe(&self) -> Description {
        Description::new("@NAME@").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.reciprocal = true;
            c.energy_conserving = true;
        })
    }

    /// The value of the BSDF in sr⁻¹, without the cosine.
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let lit = wo.z > 0.0 && wi.z > 0.0;
        Spectrum::from(if lit { self.reflectance / PI } else { 0.0 })
    }

    /// The density of `sample` per steradian.
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z > 0.0 && wi.z > 0.0 { wi.z / PI } else { 0.0 }
    }

    /// A draw from `u`, two numbers in [0, 1): wi, weight = f cos θi/pdf, pdf, and
    /// what kind of lobe it came from; `None` where nothing is drawn.
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        // A point of the unit disc, lifted to the hemisphere: density cos θ/π.
        let (r, phi) = (u[0].sqrt(), 2.0 * PI * u[1]);
        let wi = Direction::new(r * phi.cos(), r * phi.sin(), (1.0 - u[0]).sqrt());
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        Some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

/// `cargo test` measures it too, and tells what is wrong.
#[test]
fn lambert_is_valid() {
    gonio::assert_valid(&Lambert { reflectance: 0.5 });
}
