//! Suite files, and the plan of cases that they expand to.

mod combination;
mod digest;
mod embedded;
mod expand;
mod file;
mod mistake;
mod pairs;
mod plan;
mod program;
mod promises;
mod reader;
mod reproduce;
mod variants;

#[cfg(test)]
pub(crate) mod tests;

pub use digest::digests;
pub use embedded::{EMBEDDED, Embedded, embedded};
pub use expand::{Expanded, expand, load};
pub use file::{Cover, Entry, FALSE_ALARM, Overrides, PHI, SEED, SuiteFile, THETA, mebibytes, time_limit};
pub use mistake::{Mistake, SuiteError};
pub use plan::{Case, Plan, Settings, Source, Waiver};
pub use promises::set_claim;
pub use reader::{azimuth, count, fraction, polar, positive};
pub use reproduce::reproduce;

/// Typed reading of TOML with its places, for the other files that people write.
pub(crate) mod toml_reader {
    pub(crate) use super::file::{check_id, set};
    pub(crate) use super::promises::claims;
    pub(crate) use super::reader::{Node, Reader, entries};
}
pub(crate) use variants::variants;
