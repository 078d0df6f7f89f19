//! Two reports side by side: what got worse, and what got better.

mod change;
mod compare;
mod pairs;

pub use change::{Change, Comparison, Origin, Place, What};
pub use compare::compare;

#[cfg(test)]
mod tests;
