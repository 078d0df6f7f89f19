//! Numerics on the sphere: equal-area maps, adaptive cubature, partitions
//! into cells of near-equal mass. Usable alone.

mod chart;
mod cubature;
mod genz_malik;
mod partition;

pub use chart::{Chart, Point, STERADIANS, octants};
pub use cubature::{Goal, LeafIntegrals, Marker, integrate};
pub use genz_malik::{NODES, Rule};
pub use partition::{Cell, Partition};
