//! What a submission has earned, and why: grade.json, the one source of every page and
//! gradebook.

use crate::bsdf::Transport;
use crate::checks::{Effect, Verdict};
use crate::evidence::Place;
use crate::plugins::Incident;
use crate::report::{Diagnosis, WoAngles, as_committed};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of this format.
pub const GRADE_VERSION: u32 = 1;

/// The JSON Schema of grade.json as it is committed.
pub fn schema_text() -> String {
    as_committed(&schemars::schema_for!(Grade).to_value())
}

/// The grade of a submission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "gonio grade")]
pub struct Grade {
    /// Version of this format.
    pub grade_version: u32,
    /// Version of gonio.
    pub gonio: String,
    /// Title of the rubric.
    pub rubric: String,
    /// What the submission is called.
    pub id: String,
    /// Named parts of the name of its folder or zip.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub names: BTreeMap<String, String>,
    /// Its language, if one was told.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub language: Option<String>,
    /// How it was kept apart from this machine.
    pub isolation: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Whether the hidden items are among them.
    pub hidden: bool,
    /// Why it could not be measured, if so: not found, no language, not built, no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub broken: Option<Broken>,
    /// Points, at least 0.
    pub score: f64,
    /// Points that can be reached without a bonus.
    pub max: f64,
    /// By item, in the rubric's order.
    pub items: Vec<ItemGrade>,
    /// What is wrong with its subjects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub diagnoses: Vec<Diagnosis>,
    /// What it tried that no BRDF needs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub incidents: Vec<Incident>,
    /// What a teacher should look at: undecided cases, time that was up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub review: Vec<String>,
}

/// Why a submission could not be measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Broken {
    /// In one sentence.
    pub why: String,
    /// What the compiler or the program said last.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub said: String,
}

/// An item and what was earned of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ItemGrade {
    /// Its id.
    pub id: String,
    /// Its title.
    pub title: String,
    /// What counts how.
    pub kind: ItemKind,
    /// Whether students see no more of it than its title, points and text.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hidden: bool,
    /// Points at stake.
    pub points: f64,
    /// Points earned; negative where a penalty takes them.
    pub earned: f64,
    /// Cases, and how many of them passed; 0 where there is nothing to measure.
    pub cases: usize,
    /// Passed cases.
    pub passed: usize,
    /// The item that must earn something first, where it did not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unmet: Option<String>,
    /// The rubric's text on a loss, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<String>,
    /// How much of a diagnosis students see here.
    pub hints: Hints,
    /// What was found, one entry a check that did not pass.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lost: Vec<Lost>,
}

impl ItemGrade {
    /// Whether something is missing, or was taken.
    pub fn is_lost(&self) -> bool {
        match self.kind {
            ItemKind::Penalty => self.earned < 0.0,
            ItemKind::Regular | ItemKind::Bonus => self.earned < self.points,
        }
    }
}

/// How the points of an item count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ItemKind {
    /// Part of the maximum.
    #[default]
    Regular,
    /// On top of the maximum.
    Bonus,
    /// Taken where it fails.
    Penalty,
}

/// How much of a diagnosis students see.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Hints {
    /// The rubric's text alone.
    None,
    /// Where it fails: directions and pictures.
    Region,
    /// What is wrong, too.
    #[default]
    Cause,
    /// How it is mended, and what speaks for that, too.
    Full,
}

/// A check that did not pass on a case of an item.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Lost {
    /// The subject as the rubric spells it.
    pub subject: String,
    /// Id of the check.
    pub check: String,
    /// The given direction.
    pub wo: Option<WoAngles>,
    /// The mode of transport.
    #[serde(default)]
    pub transport: Transport,
    /// fail, error, or skipped.
    pub verdict: Verdict,
    /// One sentence.
    pub message: String,
    /// How large the error is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effect: Option<Effect>,
    /// Where it is worst.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst: Option<Place>,
    /// File of the evidence, from the submission's own folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub evidence: Option<String>,
}
