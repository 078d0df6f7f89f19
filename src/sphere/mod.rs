//! Numerics on the sphere: equal-area and projected maps, adaptive cubature, partitions
//! into cells of near-equal mass. Usable alone.

mod along;
mod breaks;
mod chart;
mod cubature;
mod genz_malik;
mod octants;
mod partition;

pub use breaks::Breaks;
pub use chart::{Chart, Point, STERADIANS, Shape};
pub use cubature::{Goal, LeafIntegrals, Marker, Patches, integrate, integrate_on};
pub use genz_malik::{NODES, Rule};
pub use octants::{octants, sin_cos_turns};
pub use partition::{Cell, Partition};
