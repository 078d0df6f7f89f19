//! A goniophotometer for material code.
//!
//! A renderer's material is three functions that must agree: `eval` (the BSDF
//! value), `sample` (draw a direction) and `pdf` (the density of that draw).
//! gonio measures them and says whether they do, and how sure that is.
//!
//! Implement [`Bsdf`](bsdf::Bsdf) and call [`assert_valid`] in a unit test, or
//! list it in a [`Registry`](registry::Registry) and hand that to [`main`] for
//! the whole command line.

pub mod bsdf;
pub mod calibration;
pub mod cause;
pub mod checks;
pub mod cli;
pub mod comparison;
pub mod diagnosis;
pub mod engine;
pub mod evidence;
pub mod grading;
pub mod lecture;
mod measure;
pub mod measured;
pub mod models;
pub mod mutants;
pub mod plugins;
pub mod registry;
pub mod report;
pub mod sphere;
pub mod statistics;
pub mod suite;

pub use cli::main;
pub use measure::{assert_valid, measure};
