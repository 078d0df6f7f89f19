//! The instrument measured on itself.

pub mod kill_matrix;
