//! A goniophotometer for material code.

pub mod bsdf;
pub mod checks;
pub mod cli;
pub mod engine;
pub mod evidence;
pub mod models;
pub mod registry;
pub mod report;
pub mod sphere;
pub mod statistics;
pub mod suite;

pub use cli::main;
