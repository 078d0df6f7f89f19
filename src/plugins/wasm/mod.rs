//! WebAssembly modules, run by an interpreter that gives them nothing but
//! mathematics, and stops them at limits of fuel, time, memory and depth.

mod assemblyscript;
mod budget;
mod doing;
mod exports;
mod host;
mod imports;
mod math;
mod module;
mod probe;
mod problem;
mod running;
mod sections;
#[cfg(test)]
mod tests;
mod trap;
mod wasi;

pub use module::Module;
#[cfg(test)]
use problem::ModuleError;
