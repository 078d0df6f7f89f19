//! Rough surfaces as many small facets: distributions of normals and the
//! models made of them, one concept a file.

mod albedo;
mod area;
mod beckmann;
mod chebyshev;
mod distribution;
mod gaussian;
mod ggx;
mod ggx_loss;
pub(super) mod ggx_multiscatter;
mod gtr1;
pub(crate) mod half_vector;
pub(super) mod masked;
pub(super) mod rough_dielectric;
pub(super) mod rough_plastic;
mod roughness;
mod smith;
pub(super) mod torrance_sparrow;
mod v_cavity;
mod visible_ggx;

pub use beckmann::Beckmann;
pub use distribution::Distribution;
pub use gaussian::Gaussian;
pub use ggx::Ggx;
pub use ggx_loss::GgxLoss;
pub use ggx_multiscatter::GgxMultiscatter;
pub use gtr1::Gtr1;
pub use masked::MaskedDistribution;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use roughness::Roughness;
pub use torrance_sparrow::{Fresnel, Masking, NormalSampling, TorranceSparrow};
