//! Models with one real bug each, labelled with its cause: a file for each cause.
//! A mutant is a correct built-in model with one of its functions changed.

mod altered;
mod altered_parts;
mod constant_factor;
mod controls;
mod discrete_lobe;
mod energy_compensation;
mod eta_side;
mod frame;
mod fresnel_argument;
mod half_vector_jacobian;
mod implementation_drift;
mod lobe_probability;
mod masking;
mod mutant;
mod ndf_measure;
mod ndf_vndf_mismatch;
mod normalization;
mod numerics;
mod parameter;
mod random_number_reuse;
mod refraction_jacobian;
mod siblings;
mod support;
mod swapped_arguments;
mod table;
mod transport_mode;
mod unnormalized_rejection;
mod weight;
mod wrong_density;
mod wrong_measure;

pub use mutant::{Mutant, STRENGTH, Strength, all, controls, model, of_cause};
