//! Models with one real bug each, labelled with its cause: a file for each cause.
//! A mutant is a correct built-in model with one of its functions changed.

mod altered;
mod altered_parts;
mod constant_factor;
mod controls;
mod frame;
mod half_vector_jacobian;
mod implementation_drift;
mod lobe_probability;
mod mutant;
mod random_number_reuse;
mod siblings;
mod weight;
mod wrong_density;

pub use mutant::{Mutant, STRENGTH, Strength, all, controls, of_cause};
