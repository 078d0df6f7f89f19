//! Built-in BSDFs, one file each.

use crate::registry::Model;

mod blend;
mod clipped_cosine;
mod conductor;
mod dielectric;
pub mod factored;
pub mod fresnel;
mod lambert;
mod metal;
pub mod microfacet;
mod oren_nayar;
mod oren_nayar_eon;

pub use blend::Blend;
pub use conductor::{Conductor, ConductorFresnel};
pub use dielectric::Dielectric;
pub use lambert::{HemisphereSampling, Lambert};
pub use metal::Metal;
pub use oren_nayar::OrenNayar;
pub use oren_nayar_eon::{EonSampling, OrenNayarEon};

/// Every built-in model, in the order in which `gonio list` shows them.
pub fn all() -> Vec<Model> {
    vec![
        lambert::model(),
        oren_nayar::model(),
        oren_nayar_eon::model(),
        dielectric::model(),
        conductor::model(),
        microfacet::torrance_sparrow::model(),
        microfacet::ggx_multiscatter::model(),
        blend::model(),
        factored::model(),
    ]
}
