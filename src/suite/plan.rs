//! A plan: the list of cases to run, with the terms on which they are judged.

use crate::bsdf::{ClaimsPatch, Direction, Subject, Transport};
use crate::evidence::Company;
use crate::plugins::Limits;
use crate::registry::Parameters;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Duration;

/// A line that people can go to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Source {
    /// The path of a file, as it was typed.
    pub file: String,
    /// From 1.
    pub line: usize,
}

/// A check whose failure the suite accepts, with the reason.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waiver {
    /// Which check.
    pub check: String,
    /// Why its failure is meant.
    pub because: String,
    /// Of which subject, as it is written; all of the entry where `None`.
    pub subject: Option<String>,
    /// The last day on which it holds.
    pub until: Option<jiff::civil::Date>,
    /// The largest effect that it covers.
    pub at_most: Option<f64>,
    /// Whether that day was over when the suite was read.
    pub expired: bool,
}

impl Waiver {
    /// Whether it is about a check of the subject that is written so.
    pub fn is_about(&self, spelling: &str, check: &str) -> bool {
        self.check == check && self.subject.as_ref().is_none_or(|s| s == spelling)
    }

    /// Whether it covers a failure of this size, where one is known.
    pub fn covers(&self, effect: Option<f64>) -> bool {
        // Not `>`: an effect that is NaN is not within any limit.
        !self.expired && self.at_most.is_none_or(|most| effect.is_some_and(|e| e.abs() <= most))
    }
}

/// What is judged, and how sharply.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Draws at most, per subject and wo (rounded up to whole blocks of 4096).
    pub samples: u64,
    /// RMS relative cell error that counts as wrong; by precision if `None`.
    pub tolerance: Option<f64>,
    /// A pass must have been able to see this much.
    pub detect: f64,
    /// What a case may spend in its subject.
    pub time_limit: Duration,
    /// What a plugin may take.
    pub limits: Limits,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            samples: 1 << 18,
            tolerance: None,
            detect: 0.03,
            time_limit: Duration::from_secs(60),
            limits: Limits::default(),
        }
    }
}

/// One subject at one direction.
#[derive(Clone)]
pub struct Case<'a> {
    /// The suite's entry that it belongs to: a row of the matrix.
    pub group: String,
    /// How the subject is written; with seed and wo it names the random numbers.
    pub spelling: String,
    /// The line that asks for it.
    pub source: Option<Source>,
    /// The subject.
    pub subject: Arc<dyn Subject + 'a>,
    /// Its parameters.
    pub parameters: Parameters,
    /// Polar angle of wo in degrees, over 90 on the back side.
    pub theta_deg: f64,
    /// Azimuth of wo in degrees.
    pub phi_deg: f64,
    /// The mode of transport.
    pub transport: Transport,
    /// Claims in place of the subject's.
    pub claims: ClaimsPatch,
    /// Accepted failures.
    pub waivers: Vec<Waiver>,
    /// Variants and reference.
    pub company: Company<'a>,
    /// How the reference is written, for the command that reproduces the case.
    pub reference: Option<String>,
    /// Ids of the checks to run; all where empty.
    pub checks: Vec<String>,
    /// Sharpness.
    pub settings: Settings,
}

impl Case<'_> {
    /// The given direction.
    pub fn wo(&self) -> Direction {
        Direction::from_angles(self.theta_deg.to_radians(), self.phi_deg.to_radians())
    }

    /// As people name it: subject, direction, and mode where it is not radiance.
    pub fn label(&self) -> String {
        let mode = match self.transport {
            Transport::Radiance => "",
            Transport::Importance => " importance",
        };
        format!("{} θ={}° φ={}°{mode}", self.spelling, self.theta_deg, self.phi_deg)
    }
}

/// The cases to run and what they share.
#[derive(Clone)]
pub struct Plan<'a> {
    /// The suite's name.
    pub suite: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Probability that a run of correct subjects shows any failure.
    pub false_alarm: f64,
    /// Each statistical test's part of it; shared out equally where `None`, given
    /// where a case is run alone on the terms of its suite.
    pub share: Option<f64>,
    /// The cases.
    pub cases: Vec<Arc<Case<'a>>>,
}
