//! What a person wants to read first.

mod blocks;
mod comparison;
mod look;
mod matrix;
mod summary;
#[cfg(test)]
mod tests;

pub use blocks::diagnoses;
pub use comparison::comparison;
pub use look::{Look, symbol};
pub(super) use matrix::short;
pub use summary::summary;
