//! Events and results to terminal, JSON and SVG.

mod json;

pub use json::{
    AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectId, Summary, WoAngles,
};
