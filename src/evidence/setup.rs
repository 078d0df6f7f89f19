//! What a measurement needs to know of its case.

use super::draws::BLOCK;
use crate::bsdf::{Claims, Direction, Precision, Transport};
use crate::statistics::streams::StreamKey;

/// Leaves of a partition: for fewer draws fewer, since what costs by the leaf would cost
/// more than the draws, and a leaf of 512 is told to 4 % at best. 256 leaves still see
/// where on a lobe samples are off.
const FEWEST_LEAVES: u64 = 256;
const MOST_LEAVES: u64 = 1024;
const DRAWS_PER_LEAF: u64 = 512;

/// Points of the pilot for each of them: the median of two leaves is off by an eighth of one.
const PILOT_PER_LEAF: u64 = 32;

/// The place, conventions and random numbers of a case.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The given direction.
    pub wo: Direction,
    /// The mode of transport.
    pub transport: Transport,
    /// The precision that the subject declares.
    pub precision: Precision,
    /// The claims in force.
    pub claims: Claims,
    /// Random numbers are keyed by this and the stage of the measurement.
    pub key: StreamKey,
    /// Draws that will be compared with pdf at most, before what they suggest is confirmed.
    pub draws: u64,
    /// Whether eval is called: some check of the case reads its values.
    pub eval: bool,
    /// Whether multiple importance sampling is tried along with the draws.
    pub mis: bool,
}

impl Setup {
    /// Leaves that a partition for these draws has, about.
    pub fn leaves(&self) -> usize {
        (self.draws / DRAWS_PER_LEAF).clamp(FEWEST_LEAVES, MOST_LEAVES) as usize
    }

    /// Blocks of pilot draws.
    pub fn pilot_blocks(&self) -> u64 {
        (self.leaves() as u64 * PILOT_PER_LEAF).div_ceil(BLOCK)
    }

    /// How far two values may be apart that an identity makes equal: rounding,
    /// magnified by the narrowest lobes in use (1/α ≤ 10⁴ in f64).
    pub fn tolerance(&self) -> f64 {
        match self.precision {
            Precision::F64 => 1e-6,
            Precision::F32 => 1e-2,
        }
    }

    /// Values below this count as zero where they are compared.
    pub fn floor(&self) -> f64 {
        match self.precision {
            Precision::F64 => 1e-12,
            Precision::F32 => 1e-6,
        }
    }
}
