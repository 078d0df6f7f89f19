//! Rubrics: what a submission must be, and what earns how many points.

mod read;
mod read_item;
mod terms;
#[cfg(test)]
mod tests;

pub use read::load;
pub use terms::{Credit, Item, Language, Route, Rubric, SandboxTerms};
