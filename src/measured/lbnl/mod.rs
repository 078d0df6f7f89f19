//! BSDFs in the XML of LBNL's WINDOW and of Radiance: matrices over the Klems
//! bases, and tensor trees of rank 3 (isotropic) and 4.
//!
//! What the files mean is told by Radiance's `bsdf_m.c` and `bsdf_t.c`
//! (github.com/LBNL-ETA/Radiance, `src/common`) and by the schema
//! windows.lbl.gov/BSDF-v1.4.xsd, in short:
//! - Values are f in sr⁻¹, the cosine excluded; each incident direction's flux is
//!   Σ f Λ over outgoing patches of projected solid angle Λ.
//! - The frame here is Radiance's: +z is its front, the side that faces the room.
//!   WINDOW names the sides the other way: its *Front* blocks hold light that
//!   arrives from z < 0.
//! - A patch of outgoing light is found by (x, y) of its direction, on either
//!   side; one of incident light by (−x, −y) of the direction towards its source.
//!   So light that goes straight on, or is mirrored, keeps its patch number.
//! - Tables are looked up with light arriving along wo and leaving along wi:
//!   importance transport, in which the flux of a wo is that of an incident patch.

mod distribution;
mod error;
mod klems;
mod numbers;
mod read;
mod subject;
mod survey;
mod table;
mod tree;
mod xml;

pub use error::ReadError;
pub use read::{read, read_wavelength};
pub use subject::Measured;
pub use survey::{Asymmetry, IncidentFlux};
pub use table::{Side, Table};

#[cfg(test)]
mod planted_bugs;
#[cfg(test)]
mod reader_tests;
