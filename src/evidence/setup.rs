//! What a measurement needs to know of its case.

use crate::bsdf::{Claims, Direction, Precision, Transport};
use crate::statistics::streams::StreamKey;

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
    /// Whether eval is called: some check of the case reads its values.
    pub eval: bool,
    /// Whether multiple importance sampling is tried along with the draws.
    pub mis: bool,
}

impl Setup {
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
