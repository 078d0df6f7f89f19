//! Built-in BSDFs and their parts, one file each.

use crate::registry::Model;

mod blend;
mod conductor;
mod dielectric;
pub mod fresnel;
mod interface;
mod lambert;
mod metal;
pub mod microfacet;
mod oren_nayar;

pub use blend::Blend;
pub use conductor::{Conductor, ConductorFresnel};
pub use dielectric::Dielectric;
pub use lambert::{HemisphereSampling, Lambert};
pub use metal::Metal;
pub use oren_nayar::OrenNayar;

/// Every built-in model, in the order in which `gonio list` shows them.
pub fn all() -> Vec<Model> {
    vec![
        lambert::model(),
        oren_nayar::model(),
        dielectric::model(),
        conductor::model(),
        microfacet::torrance_sparrow::model(),
        blend::model(),
        microfacet::masked::model(),
        interface::model(),
    ]
}
