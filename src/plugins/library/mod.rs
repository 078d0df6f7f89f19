//! Shared libraries with the functions of `include/gonio.h`.

mod abi;
mod worker;

pub use abi::Loaded;
pub use worker::work;
