//! Subjects in other languages, behind one contract (docs/plugins.md).

pub mod instance;
mod limits;
pub mod wasm;

pub use limits::Limits;
