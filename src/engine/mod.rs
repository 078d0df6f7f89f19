//! Runs a plan: parallel over cases, deterministic, bounded in time, and able
//! to stop at any moment with what it has.

mod allotment;
mod case;
mod cost;
mod results;
mod run;

pub use allotment::Draws;
pub use results::{Attempt, CaseResult, Event, Finding, Results};
pub use run::{Options, run, run_here, shares};
