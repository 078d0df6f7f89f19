//! Plugins in processes of their own.

mod child;
mod descendants;
mod last_words;
mod launch;
mod supervise;

pub use child::Child;
pub use descendants::{descendants, end_as, end_descendants};
pub use launch::{Launch, Program, gonio, in_path, set_gonio};
pub use supervise::supervise;
