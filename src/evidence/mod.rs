//! What is measured of one case: counts, integrals, pointwise identities.
//! Gathered once, judged by every check, saved, and drawn.

mod densities;
mod draws;
mod exact;
mod facets;
mod flux;
mod fresnel;
mod gathered;
mod integrals;
mod jacobian;
mod log_weights;
mod meter;
mod pairs;
mod parts;
mod plane;
mod probes;
mod samples;
mod setup;
mod slopes;
mod stretch;
mod strips;
mod tally;
mod variations;

pub use crate::bsdf::Figure;
pub use densities::{Densities, azimuth_densities, plane_densities};
pub use draws::{BLOCK, DiscreteLobe, Draws, SERIAL, Sums};
pub use exact::Repeats;
pub use facets::{Estimate, Facets};
pub use flux::Flux;
pub use fresnel::{FresnelLaw, FresnelLaws};
pub use gathered::{Company, Evidence, Gatherer, Measurement};
pub use integrals::{Integrals, SMALLEST_PEAK, refracted};
pub use jacobian::Jacobian;
pub use log_weights::LogWeights;
pub(crate) use meter::guarded;
pub use meter::{Evaluations, Halt, Meter, Sanity, Watch};
pub use pairs::Pairs;
pub use plane::{Plane, azimuths, forward_azimuth};
pub use samples::{Pilot, SampleIdentities};
pub use setup::Setup;
pub use stretch::Stretch;
pub use strips::Strip;
pub use tally::{Place, Tally, relative_error};
pub use variations::{Build, CHANGE, Comparison, Limit, Resemblance, Variant, Variation};
