//! Built-in BSDFs, one file each.

use crate::registry::Model;

mod lambert;

pub use lambert::Lambert;

/// Every built-in model, in the order in which `gonio list` shows them.
pub fn all() -> Vec<Model> {
    vec![lambert::model()]
}
