//! What running a plan gives, and what is told on the way.

use crate::checks::{Outcome, Verdict};
use crate::evidence::Evidence;
use crate::registry::Parameters;
use crate::suite::Case;
use std::sync::Arc;

/// One look of a check at draws: the last of the first attempt, or of its
/// confirmation.
#[derive(Clone, Debug, PartialEq)]
pub struct Attempt {
    /// Names the random numbers: the suite's seed, and the stage.
    pub seed: String,
    /// Draws.
    pub samples: u64,
    /// ln of the probability of what was seen, were the error within tolerance.
    pub ln_p: f64,
}

/// A check's last word on a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The check's id.
    pub check: &'static str,
    /// What it said; its verdict is `Waived` where a waiver turned a failure.
    pub outcome: Outcome,
    /// Looks of statistical checks: one, or two where a suspicion was followed.
    pub attempts: Vec<Attempt>,
    /// The reason of the waiver.
    pub waived_because: Option<String>,
}

/// Everything about one case.
#[derive(Clone)]
pub struct CaseResult<'a> {
    /// Number of the case in the plan.
    pub index: usize,
    /// The case.
    pub case: Arc<Case<'a>>,
    /// One finding a check, in the order of [`checks::all`](crate::checks::all).
    pub findings: Vec<Finding>,
    /// What was measured; `None` where the case was not begun or did not return.
    pub evidence: Option<Evidence>,
    /// Wall time in seconds; never part of what must be reproducible.
    pub seconds: f64,
}

impl CaseResult<'_> {
    /// The worst verdict (error, fail, inconclusive, warn, waived, pass, skipped).
    pub fn worst(&self) -> Verdict {
        self.findings.iter().map(|f| f.outcome.verdict).max().unwrap_or(Verdict::Skipped)
    }

    /// The subject's parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.case.parameters
    }
}

/// What an engine tells while it runs.
pub enum Event<'e, 'a> {
    /// The run begins with so many cases on so many threads.
    Started {
        /// Cases.
        cases: usize,
        /// Threads.
        threads: usize,
    },
    /// A case begins.
    CaseStarted(&'e Case<'a>),
    /// A case is done.
    CaseDone(&'e CaseResult<'a>),
}

/// The results of a plan, in the plan's order.
pub struct Results<'a> {
    /// One result a case.
    pub cases: Vec<CaseResult<'a>>,
    /// The false-alarm share of each statistical test.
    pub share: f64,
    /// Number of statistical tests that shares were dealt to.
    pub tests: usize,
    /// Draws at most by case of the plan, where a budget of time decided them; 0 where a
    /// case was not begun.
    pub allocation: Option<Vec<u64>>,
    /// Why not every case was run to its end, if so.
    pub partial: Option<String>,
    /// Wall time in seconds.
    pub seconds: f64,
}
