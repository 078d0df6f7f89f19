//! Built-in BSDFs and their parts, one file each.

use crate::registry::Model;

mod ashikhmin_shirley;
mod blend;
#[cfg(test)]
mod brute_force;
mod clipped_cosine;
pub(crate) mod coated_base;
mod conductor;
mod cosine_lobe;
mod dielectric;
mod disney;
pub mod factored;
pub mod fresnel;
mod gauss_legendre;
mod interface;
mod lafortune;
pub(crate) mod lambert;
mod largest_albedo;
mod memo;
mod metal;
pub mod microfacet;
pub(crate) mod mixture;
mod oren_nayar;
mod oren_nayar_eon;
mod phong;
mod plastic;
mod sheen;
mod ward;

pub use ashikhmin_shirley::AshikhminShirley;
pub use blend::Blend;
pub use conductor::{Conductor, ConductorFresnel};
pub use dielectric::Dielectric;
pub use disney::{Disney, DisneyParameters};
pub use lafortune::{GeneralisedCosine, Lafortune};
pub use lambert::{HemisphereSampling, Lambert};
pub use metal::Metal;
pub use oren_nayar::OrenNayar;
pub use oren_nayar_eon::{EonSampling, OrenNayarEon};
pub use phong::Phong;
pub use plastic::Plastic;
pub use sheen::Sheen;
pub use ward::Ward;

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
        phong::model(),
        ward::model(),
        ashikhmin_shirley::model(),
        lafortune::model(),
        disney::model(),
        sheen::model(),
        microfacet::rough_dielectric::model(),
        plastic::model(),
        microfacet::rough_plastic::model(),
        blend::model(),
        factored::model(),
        crate::measured::model(),
        microfacet::masked::model(),
        interface::model(),
    ]
}
