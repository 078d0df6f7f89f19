//! Numerics on the sphere: equal-area and projected maps, adaptive cubature, partitions
//! into cells of near-equal mass. Usable alone.

mod along;
mod breaks;
mod chart;
mod cubature;
mod genz_malik;
mod partition;

pub use breaks::Breaks;
pub use chart::{Chart, Point, STERADIANS, Shape, octants};
pub use cubature::{Goal, LeafIntegrals, Marker, integrate, integrate_within};
pub use genz_malik::{NODES, Rule};
pub use partition::{Cell, Partition};
