//! Exit codes: an API for scripts.

use crate::checks::Verdict;
use crate::engine::Results;
use std::process::ExitCode;

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// All passed.
    Passed = 0,
    /// A check failed.
    Failed = 1,
    /// Wrong usage or suite.
    Usage = 2,
    /// A subject crashed, hung or broke the protocol.
    Subject = 3,
    /// Nothing was run.
    Nothing = 4,
    /// Internal or I/O error.
    Internal = 5,
    /// Interrupted.
    Interrupted = 130,
}

/// The first that applies is told.
const PRECEDENCE: [Exit; 7] = [
    Exit::Interrupted,
    Exit::Internal,
    Exit::Usage,
    Exit::Subject,
    Exit::Failed,
    Exit::Nothing,
    Exit::Passed,
];

impl Exit {
    /// The one of the two that is told.
    pub fn and(self, other: Self) -> Self {
        PRECEDENCE.into_iter().find(|e| *e == self || *e == other).unwrap_or(Self::Internal)
    }

    /// What results mean. `strict` turns inconclusive, warned and unfinished runs
    /// into failures.
    pub fn of(results: &Results, strict: bool) -> Self {
        let verdicts = || results.cases.iter().flat_map(|c| &c.findings).map(|f| f.outcome.verdict);
        let any = |wanted| verdicts().any(|v| v == wanted);
        let unclear = any(Verdict::Inconclusive) || any(Verdict::Warn) || results.partial.is_some();
        if any(Verdict::Error) {
            Self::Subject
        } else if any(Verdict::Fail) || strict && unclear {
            Self::Failed
        } else if verdicts().all(|v| v == Verdict::Skipped) {
            Self::Nothing
        } else {
            Self::Passed
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checks::Outcome;
    use crate::engine::{CaseResult, Finding};
    use crate::registry::Registry;
    use crate::suite::{Overrides, load};

    fn results(verdicts: &[Verdict]) -> Results<'static> {
        let text = "[suite]\ntheta = 30\nphi = 17\n[[subject]]\nuse = 'lambert'";
        let plan = load("t", text, &Registry::builtin(), &Overrides::default()).ok().unwrap().plan;
        let finding = |v: &Verdict| Finding {
            check: "mis",
            outcome: Outcome::new(*v, ""),
            attempts: Vec::new(),
            waived_because: None,
        };
        let case = CaseResult {
            index: 0,
            case: plan.cases[0].clone(),
            findings: verdicts.iter().map(finding).collect(),
            evidence: None,
            seconds: 0.0,
        };
        Results { cases: vec![case], share: 1e-9, tests: 1, allocation: None, partial: None, seconds: 0.0 }
    }

    #[test]
    fn results_map_to_codes() {
        use Verdict::*;
        for (verdicts, code, strict) in [
            (&[Pass, Skipped][..], Exit::Passed, Exit::Passed),
            (&[Pass, Waived], Exit::Passed, Exit::Passed),
            (&[Pass, Warn], Exit::Passed, Exit::Failed),
            (&[Pass, Inconclusive], Exit::Passed, Exit::Failed),
            (&[Pass, Fail], Exit::Failed, Exit::Failed),
            (&[Fail, Error], Exit::Subject, Exit::Subject),
            (&[Skipped], Exit::Nothing, Exit::Nothing),
            (&[], Exit::Nothing, Exit::Nothing),
        ] {
            assert_eq!(Exit::of(&results(verdicts), false), code, "{verdicts:?}");
            assert_eq!(Exit::of(&results(verdicts), true), strict, "{verdicts:?} strict");
        }
        let none = Results { cases: Vec::new(), ..results(&[]) };
        assert_eq!(Exit::of(&none, true), Exit::Nothing);
        let partial = Results { partial: Some("time".into()), ..results(&[Pass]) };
        assert_eq!(Exit::of(&partial, true), Exit::Failed);
    }

    #[test]
    fn the_first_that_applies_of_several_suites_is_told() {
        assert_eq!(Exit::Passed.and(Exit::Nothing), Exit::Nothing);
        assert_eq!(Exit::Nothing.and(Exit::Failed), Exit::Failed);
        assert_eq!(Exit::Failed.and(Exit::Subject), Exit::Subject);
        assert_eq!(Exit::Subject.and(Exit::Internal), Exit::Internal);
        assert_eq!(Exit::Interrupted.and(Exit::Internal), Exit::Interrupted);
    }
}
