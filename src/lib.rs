//! A goniophotometer for material code.

pub mod bsdf;
pub mod models;
pub mod registry;
pub mod statistics;
