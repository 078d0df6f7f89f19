//! Runs a plan: parallel over cases, deterministic, bounded in time, and able
//! to stop at any moment with what it has.

mod results;

pub use results::{Attempt, CaseResult, Event, Finding, Results};
