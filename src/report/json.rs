//! report.json: the one source of every other output.

use crate::bsdf::{Claims, Transport};
use crate::checks::{self, Effect, Verdict};
use crate::comparison::Comparison;
use crate::diagnosis::Profile;
use crate::evidence::{Evaluations, Figure, Place};
use crate::registry::Parameters;
use crate::suite::Source;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The version of this format; readers refuse a larger one.
pub const SCHEMA_VERSION: u32 = 1;

/// A report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "gonio report")]
pub struct Report {
    /// Version of this format.
    pub schema_version: u32,
    /// Version of gonio.
    pub gonio: String,
    /// Name of the suite.
    pub suite: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Probability that a run of correct subjects shows any failure.
    pub false_alarm: f64,
    /// When the run began, in UTC (RFC 3339).
    pub started: String,
    /// How long it took.
    pub duration_s: f64,
    /// Where it ran.
    pub machine: Machine,
    /// Why not every case was run to its end; absent in a complete report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub partial: Option<String>,
    /// Counts of verdicts.
    pub summary: Summary,
    /// What was measured, in the suite's order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subjects: Vec<SubjectEntry>,
    /// Failures that the suite accepts, and what became of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waivers: Vec<WaiverRow>,
    /// How a budget of time was spent, if the run had one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub allocation: Option<Allocation>,
    /// What changed since the baseline, if the run had one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
    /// One entry a case and check.
    pub results: Vec<CheckResult>,
    /// What is wrong with failing subjects.
    pub diagnoses: Vec<Diagnosis>,
}

impl Report {
    /// The checks that it has results of, in the order of reports, unknown ones last.
    pub fn checks(&self) -> Vec<&str> {
        let met: BTreeSet<&str> = self.results.iter().map(|r| r.check.as_str()).collect();
        let known = checks::all().iter().map(|c| c.id()).filter(|id| met.contains(id));
        let unknown = met.iter().copied().filter(|id| checks::find(id).is_none());
        known.chain(unknown).collect()
    }
}

/// Where a run took place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Machine {
    /// Operating system.
    pub os: String,
    /// Processor architecture.
    pub arch: String,
    /// Processors available.
    pub cores: usize,
}

/// Counts of verdicts over all results.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Summary {
    /// pass
    pub passed: usize,
    /// fail
    pub failed: usize,
    /// warn
    pub warned: usize,
    /// inconclusive
    pub inconclusive: usize,
    /// skipped
    pub skipped: usize,
    /// error
    pub errors: usize,
    /// waived
    pub waived: usize,
}

/// A check's result on one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckResult {
    /// What was measured.
    pub subject: SubjectId,
    /// Id of the check.
    pub check: String,
    /// The given direction.
    pub wo: Option<WoAngles>,
    /// The mode of transport; absent where it is radiance.
    #[serde(default, skip_serializing_if = "is_radiance")]
    pub transport: Transport,
    /// The verdict.
    pub verdict: Verdict,
    /// How large the error is.
    pub effect: Option<Effect>,
    /// Probability of what was seen were the error within tolerance.
    pub p_value: Option<Figure>,
    /// Its decimal logarithm, which does not underflow.
    pub log10_p: Option<Figure>,
    /// The check fails below this probability.
    pub threshold: Option<Figure>,
    /// Looks: the first, and its confirmation.
    pub attempts: Vec<AttemptRow>,
    /// Name of the channel where the error is largest.
    pub channel: Option<String>,
    /// Draws.
    pub samples: u64,
    /// Directions evaluated for the whole case.
    pub evaluations: Evaluations,
    /// Smallest error that would have been found with probability 0.999.
    pub detection_limit: Option<Figure>,
    /// One sentence.
    pub message: String,
    /// Why it was skipped or could not decide.
    pub reason: Option<String>,
    /// Where it is worst.
    pub worst: Option<Place>,
    /// What to type to get this case again.
    pub command: String,
    /// File of the case's evidence, from the report's folder.
    pub evidence: Option<String>,
    /// File of the case's picture, from the report's folder.
    pub plot: Option<String>,
    /// Why the suite accepts the failure.
    pub waived_because: Option<String>,
}

/// A subject in a report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubjectId {
    /// How it is written: NAME:KEY=VALUE,…
    pub name: String,
    /// What the suite calls its row, if it has a name of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// All its parameters.
    pub parameters: Parameters,
    /// The claims in force.
    pub claims: Claims,
}

impl SubjectId {
    /// Its row: the suite's label, or the name without parameters.
    pub fn group(&self) -> &str {
        let base = || self.name.split(':').next().unwrap_or(&self.name);
        self.label.as_deref().unwrap_or_else(base)
    }
}

fn is_radiance(transport: &Transport) -> bool {
    *transport == Transport::Radiance
}

/// A subject of the run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SubjectEntry {
    /// How it is written.
    pub name: String,
    /// What the suite calls its row, if it has a name of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Names everything that its results depend on: what it says of itself, the bytes of
    /// its program or file (of gonio itself for what is built in), and how it was measured.
    pub digest: String,
    /// The line that asks for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
    /// Whether its results were taken over from an earlier report, as its digest is the same.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub carried: bool,
}

/// What became of a waiver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WaiverRow {
    /// Which check.
    pub check: String,
    /// The suite's entry that it belongs to, or the one subject of it that it names.
    pub subject: String,
    /// Why a failure is meant.
    pub because: String,
    /// The last day on which it holds (YYYY-MM-DD).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// The largest effect that it covers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
    /// What became of it.
    pub state: WaiverState,
    /// Failures that it covers.
    pub covered: usize,
}

/// Whether a waiver is still needed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum WaiverState {
    /// It covers a failure, and none of its check is left uncovered.
    Used,
    /// Nothing failed that it could cover: delete it.
    Unused,
    /// Its day is over; failures count again.
    Expired,
    /// A failure is larger than it covers.
    Exceeded,
}

/// How a budget of time was spent. A run with the same samples is the same bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Allocation {
    /// The budget in seconds; absent in a run that followed the allocation of another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Draws at most of each case, in the plan's order; 0 where it was not begun.
    pub samples: Vec<u64>,
}

/// A direction in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WoAngles {
    /// From the normal, over 90 on the back side.
    pub theta_deg: f64,
    /// From the tangent.
    pub phi_deg: f64,
}

/// A look at draws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AttemptRow {
    /// Names the random numbers.
    pub seed: String,
    /// Draws.
    pub samples: u64,
    /// Decimal logarithm of the probability of what was seen.
    pub log10_p: Figure,
}

/// What is wrong with a subject.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Diagnosis {
    /// Which subject.
    pub subject: String,
    /// Slug of the cause; `null` where none of the explanations fits.
    pub cause: Option<String>,
    /// Whether the cause is named with confidence.
    pub confident: bool,
    /// One sentence: what is wrong, or where it is wrong if nothing fits.
    pub statement: String,
    /// What mends it.
    pub repair: Option<String>,
    /// Probability of what was counted after the repair, where that was computed.
    pub p_after_repair: Option<Figure>,
    /// The next explanation, with its slug, and by how many nats it is behind.
    pub runner_up: Option<String>,
    /// What speaks for it.
    pub evidence: Vec<String>,
    /// The published model that the subject was recognised as.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub textbook: Option<String>,
    /// The counts over pdf() along the plane of incidence, with what the cause predicts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// Its picture, from the report's folder: the counts over pdf().
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plot: Option<String>,
    /// The manual's page on the cause.
    pub page: Option<String>,
}
