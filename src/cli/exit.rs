//! Exit codes: an API for scripts.

use crate::checks::Verdict;
use crate::comparison::Comparison;
use crate::report::Report;
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

    /// What a report means. `strict` turns inconclusive, warned and unfinished runs
    /// into failures. With a baseline only what got worse counts.
    pub fn of(report: &Report, strict: bool) -> Self {
        let any = |wanted| report.results.iter().any(|r| r.verdict == wanted);
        let unclear = any(Verdict::Inconclusive) || any(Verdict::Warn) || report.partial.is_some();
        if report.results.iter().all(|r| matches!(r.verdict, Verdict::Skipped)) {
            Self::Nothing
        } else if let Some(comparison) = &report.comparison {
            let unfinished = if strict && report.partial.is_some() { Self::Failed } else { Self::Passed };
            unfinished.and(Self::of_comparison(comparison, strict))
        } else if any(Verdict::Error) {
            Self::Subject
        } else if any(Verdict::Fail) || strict && unclear {
            Self::Failed
        } else {
            Self::Passed
        }
    }

    /// What a comparison means. `strict` lets what is less sure count as worse.
    pub fn of_comparison(comparison: &Comparison, strict: bool) -> Self {
        if comparison.has_new_errors() {
            Self::Subject
        } else if !comparison.worse.is_empty() || strict && !comparison.less_sure.is_empty() {
            Self::Failed
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
    use crate::comparison::compare;
    use crate::report::synthetic::{report, result};

    fn reported(verdicts: &[Verdict]) -> Report {
        let row = |v: &Verdict| result("lambert", "mis", 30.0, *v);
        Report { results: verdicts.iter().map(row).collect(), ..report() }
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
            assert_eq!(Exit::of(&reported(verdicts), false), code, "{verdicts:?}");
            assert_eq!(Exit::of(&reported(verdicts), true), strict, "{verdicts:?} strict");
        }
        let partial = Report { partial: Some("time".into()), ..reported(&[Pass]) };
        assert_eq!(Exit::of(&partial, true), Exit::Failed);
    }

    #[test]
    fn with_a_baseline_only_what_got_worse_counts() {
        use Verdict::*;
        for (before, after, code, strict) in [
            (Fail, Fail, Exit::Passed, Exit::Passed),
            (Error, Error, Exit::Passed, Exit::Passed),
            (Pass, Fail, Exit::Failed, Exit::Failed),
            (Fail, Error, Exit::Subject, Exit::Subject),
            (Fail, Pass, Exit::Passed, Exit::Passed),
            (Pass, Inconclusive, Exit::Passed, Exit::Failed),
            (Inconclusive, Inconclusive, Exit::Passed, Exit::Passed),
            (Pass, Skipped, Exit::Nothing, Exit::Nothing),
        ] {
            let (old, new) = (reported(&[before]), reported(&[after]));
            let new = Report { comparison: Some(compare(&old, &new)), ..new };
            assert_eq!(Exit::of(&new, false), code, "{before:?} {after:?}");
            assert_eq!(Exit::of(&new, true), strict, "{before:?} {after:?} strict");
        }
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
