//! Models with one real bug each, labelled with its cause: a file for each cause.
//! A mutant is a correct built-in model with one of its functions changed.

mod altered;
mod altered_parts;
mod constant_factor;
mod controls;
mod half_vector_jacobian;
mod masking;
mod mutant;
mod ndf_measure;
mod ndf_vndf_mismatch;
mod swapped_arguments;
mod unnormalized_rejection;
mod wrong_measure;

pub use mutant::{Mutant, STRENGTH, Strength, all, controls, of_cause};
