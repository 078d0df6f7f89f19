//! The instrument measured on itself, and beside what others use.

pub mod fixed_grid;
pub mod simpson;
