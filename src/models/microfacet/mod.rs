//! Rough surfaces as many small facets: distributions of normals and the
//! models made of them, one concept a file.

mod area;
mod beckmann;
mod chebyshev;
mod distribution;
mod gaussian;
mod ggx;
pub(super) mod masked;
mod roughness;
pub(super) mod torrance_sparrow;
mod v_cavity;

pub use beckmann::Beckmann;
pub use distribution::Distribution;
pub use gaussian::Gaussian;
pub use ggx::Ggx;
pub use masked::MaskedDistribution;
pub use roughness::Roughness;
pub use torrance_sparrow::{Fresnel, Masking, NormalSampling, TorranceSparrow};
