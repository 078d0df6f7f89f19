//! Events and results to terminal, JSON and SVG.

mod build;
mod json;

pub use build::Files;
pub use json::{
    AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectId, Summary, WoAngles,
};
