//! gonio over BSDFs that others published on the Rust registry: every model of
//! `bsdf` 0.1.1 and of `rs_pbrt` 0.9.12 beside the built-in ones.
//!
//! ```text
//! cargo run --release -- list pbrt-hair
//! cargo run --release -- check bsdf-conductive:roughness=0.3
//! cargo run --release -- run suite.toml
//! ```
//!
//! An adapter translates conventions and nothing else: what it returns is what
//! the crate computed.

use gonio::registry::Registry;
use std::process::ExitCode;

mod bsdf_crate;
mod rs_pbrt_crate;

fn main() -> ExitCode {
    let models = bsdf_crate::models().into_iter().chain(rs_pbrt_crate::models());
    gonio::main(models.fold(Registry::builtin(), Registry::register))
}
