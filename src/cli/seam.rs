//! Stand-ins for the engine and the report. To be deleted: each item here has
//! the signature that `cli/run.rs` and `cli/report.rs` expect of the real one.

use super::args::Plots;
use super::error::CliError;
use crate::engine::{Event, Results};
use crate::report::Report;
use crate::suite::Plan;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// `engine::Options`.
#[expect(dead_code, reason = "read by the engine")]
pub struct Options {
    pub threads: Option<usize>,
    pub stop: Arc<AtomicBool>,
    pub deadline: Option<Duration>,
}

/// `engine::run`.
pub fn run(_: &Plan, _: &Options, _: &(dyn Fn(&Event) + Sync)) -> Results {
    let partial = Some("this build has no engine".into());
    Results { cases: Vec::new(), share: 0.0, tests: 0, partial, seconds: 0.0 }
}

/// What a report says besides its results.
#[expect(dead_code, reason = "read by the report")]
pub struct Header {
    /// For commands that reproduce a case.
    pub program: String,
    /// RFC 3339.
    pub started: String,
}

/// The report of results (commands by `suite::reproduce`).
pub fn report(_: &Results, _: &Plan, _: &Header) -> Result<Report, CliError> {
    Err(CliError::Internal("this build has no engine and no report".into()))
}

/// Writes report.json, evidence and pictures into a folder.
pub fn write(_: &Report, _: &Results, _: &Plan, _: &Path, _: Plots) -> Result<(), CliError> {
    Err(CliError::Internal("this build writes no report".into()))
}

/// Draws the pictures of a saved report again; the number drawn.
pub fn redraw(_: &Report, _: &Path, _: Plots) -> Result<usize, CliError> {
    Err(CliError::Internal("this build draws no pictures".into()))
}

/// The page for people, on stderr.
pub fn tell(_: &Report, _colored: bool, _verbose: bool) {}
