//! Tabulated BSDFs and their file formats.
//!
//! [`open`] looks at what a file contains, never at its name, validates all of
//! it, and gives a subject. MERL tables have no sampler of their own and get
//! one ([`IsotropicSampler`]); RGL files bring theirs, and tables of WINDOW are
//! drawn from exactly ([`lbnl`]).

mod bytes;
mod formats;
#[cfg(test)]
mod fuzz;
mod half_difference;
pub mod lbnl;
mod merl;
mod merl_file;
mod open;
mod per_wo;
mod rgl;
mod rgl_bake;
mod rgl_file;
mod sampler;
pub mod tensor_file;
pub mod warp;

pub use bytes::FormatError;
pub use formats::Format;
pub use half_difference::HalfDifference;
pub use merl::{Interpolation, Merl, MerlTable};
pub use open::{ContentError, OpenError, Reading, open, read};
pub use per_wo::{PerWo, Reflector};
pub use rgl::Rgl;
pub use rgl_bake::Resolution;
pub use sampler::{GivenLobe, IsotropicSampler};

pub(crate) use open::model;
