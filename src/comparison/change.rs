//! What changed from one report to another.

use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::evidence::Figure;
use crate::report::{CheckResult, Report, WoAngles};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a later report says that an earlier one did not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Comparison {
    /// The earlier report.
    pub before: Origin,
    /// New failures and errors, and figures that dropped beyond noise.
    pub worse: Vec<Change>,
    /// What passes now, and figures that rose beyond noise.
    pub better: Vec<Change>,
    /// What was decided and is no longer: inconclusive, skipped, warned or waived now.
    pub less_sure: Vec<Change>,
    /// Results that fail or err in both.
    pub still_failing: usize,
    /// Results without a change worth telling.
    pub same: usize,
    /// Subjects that only the later report has.
    pub added: Vec<String>,
    /// Subjects that only the earlier report has.
    pub removed: Vec<String>,
    /// Results that only the earlier report has, of subjects that both have.
    pub removed_results: usize,
}

/// Where the earlier results come from.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Origin {
    /// Its suite.
    pub suite: String,
    /// The version of gonio that made it.
    pub gonio: String,
    /// When it was made, in UTC (RFC 3339).
    pub started: String,
    /// Its seed.
    pub seed: u64,
}

impl Origin {
    /// Of a report.
    pub fn of(report: &Report) -> Self {
        Self {
            suite: report.suite.clone(),
            gonio: report.gonio.clone(),
            started: report.started.clone(),
            seed: report.seed,
        }
    }
}

/// The same change of one check of one subject, at every direction where it is met.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Change {
    /// How the subject is written.
    pub subject: String,
    /// What the suite calls its row, if it has a name of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Which check.
    pub check: String,
    /// What changed, where it changed most.
    pub what: What,
    /// Where: the direction of the largest change first.
    pub places: Vec<Place>,
    /// The named bug of the subject: in the later report where it got worse, in the
    /// earlier one where it got better.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// One sentence of the report that is worse.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub message: String,
}

/// A direction, and the mode of transport.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Place {
    /// The given direction; none of what is measured once.
    pub wo: Option<WoAngles>,
    /// The mode of transport.
    pub transport: Transport,
}

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum What {
    /// The verdict; none where the check was not there.
    Verdict {
        /// Earlier.
        before: Option<Verdict>,
        /// Later.
        after: Verdict,
    },
    /// Effective draws per draw.
    Efficiency {
        /// Earlier.
        before: Figure,
        /// Later.
        after: Figure,
    },
    /// The smallest error that would have been found.
    DetectionLimit {
        /// Earlier.
        before: Figure,
        /// Later.
        after: Figure,
    },
}

impl Comparison {
    /// Whether nothing is worth telling.
    pub fn is_quiet(&self) -> bool {
        self.worse.is_empty()
            && self.better.is_empty()
            && self.less_sure.is_empty()
            && self.added.is_empty()
            && self.removed.is_empty()
            && self.removed_results == 0
    }

    /// Whether the baseline fails there too: a known failure fails no gate.
    pub fn knows(&self, result: &CheckResult) -> bool {
        let place = Place { wo: result.wo, transport: result.transport };
        let new = |c: &Change| {
            c.subject == result.subject.name
                && c.label == result.subject.label
                && c.check == result.check
                && c.places.contains(&place)
        };
        matches!(result.verdict, Verdict::Fail | Verdict::Error) && !self.worse.iter().any(new)
    }

    /// Whether a subject errs that did not.
    pub fn has_new_errors(&self) -> bool {
        self.worse.iter().any(|c| matches!(c.what, What::Verdict { after: Verdict::Error, .. }))
    }
}
