//! What a failure looks like: GGX whose pdf lacks the Jacobian 1/(4 wo·h) of
//! reflection about the half vector, a mistake of many first microfacet models.
//!
//! `cargo run --release --example failing -- check no-jacobian --theta 60 --phi 17`

use gonio::bsdf::{Bsdf, Description, Direction, Sample, Spectrum, Transport};
use gonio::models::microfacet::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use gonio::registry::{Model, Registry};
use std::process::ExitCode;

struct NoJacobian(TorranceSparrow);

impl Bsdf for NoJacobian {
    fn describe(&self) -> Description {
        Bsdf::describe(&self.0)
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        Bsdf::eval(&self.0, wo, wi, transport)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        // The density of the half vector, returned as that of wi.
        let pdf = Bsdf::pdf(&self.0, wo, wi, transport);
        if pdf > 0.0 { pdf * 4.0 * wo.dot((wo + wi).normalized()) } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let sample = Bsdf::sample(&self.0, wo, u, transport)?;
        let pdf = self.pdf(wo, sample.wi, transport);
        let weight = self.eval(wo, sample.wi, transport) * (sample.wi.z / pdf);
        Some(Sample { pdf, weight, ..sample })
    }
}

fn main() -> ExitCode {
    gonio::main(
        Registry::builtin().register(
            Model::new("no-jacobian", "GGX whose pdf lacks 1/(4 wo·h)", |p| {
                let distribution = Distribution::ggx(Roughness::isotropic(p.number("alpha")));
                let masking = Masking::Smith;
                TorranceSparrow::new(distribution, masking, Fresnel::None, NormalSampling::Visible)
                    .map(NoJacobian)
            })
            .number("alpha", 0.2, 1e-3..=1.0, "roughness"),
        ),
    )
}
