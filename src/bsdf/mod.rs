//! The contract: what a BSDF is to gonio. Conventions: local shading frame,
//! +z the normal, directions point away from the surface, `wo` is given and
//! `wi` is sampled, `eval` is f in sr⁻¹ without the cosine, `pdf` is per
//! steradian. The parts that BSDFs are made of, distributions of normals and
//! Fresnel functions, have contracts of their own and are measured too.

mod cells;
mod claims;
mod claims_patch;
mod description;
mod direction;
mod figure;
mod fresnel;
mod normals;
mod sample;
mod spectrum;
mod subject;

pub use cells::{NativeCells, Projection, Rectangle};
pub use claims::{Claims, Cosine, OffSupport, RandomNumbers, Transport, TransportModes};
pub use claims_patch::ClaimsPatch;
pub use description::{ByConstruction, Description, Has, Precision, SubjectKind, Table};
pub use direction::Direction;
pub use figure::Figure;
pub use fresnel::{FresnelFunction, Interface};
pub use normals::{NormalDistribution, Normals};
pub use sample::{Lobe, Sample, Samples};
pub use spectrum::{MAX_CHANNELS, Spectrum};
pub use subject::{Bsdf, Subject, SubjectError};
pub(crate) use subject::{each_density, each_value, one_by_one};
