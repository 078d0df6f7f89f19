//! What is measured of one case: counts, integrals, pointwise identities.
//! Gathered once, judged by every check, saved, and drawn.

mod draws;
mod exact;
mod facets;
mod fresnel;
mod gathered;
mod integrals;
mod jacobian;
mod meter;
mod pairs;
mod parts;
mod probes;
mod samples;
mod setup;
mod slopes;
mod tally;
mod variations;

pub use crate::bsdf::Figure;
pub use draws::{BLOCK, DiscreteLobe, Draws, SERIAL, Sums};
pub use exact::Repeats;
pub use facets::{Estimate, Facets};
pub use fresnel::{FresnelLaw, FresnelLaws};
pub use gathered::{Company, Evidence, Gatherer, Measurement};
pub use integrals::{Integrals, SMALLEST_PEAK, refracted};
pub use jacobian::Jacobian;
pub(crate) use meter::guarded;
pub use meter::{Evaluations, Halt, Meter, Sanity, Watch};
pub use pairs::Pairs;
pub use samples::{Pilot, SampleIdentities};
pub use setup::Setup;
pub use tally::{Place, Tally, relative_error};
pub use variations::{Build, CHANGE, Comparison, Limit, Resemblance, Variant, Variation};
