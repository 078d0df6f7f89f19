//! Plugins in processes of their own.

mod child;
mod last_words;
mod launch;
mod supervise;

pub use child::Child;
pub use launch::{Launch, in_path, set_gonio};
pub use supervise::supervise;
