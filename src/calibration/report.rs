//! The result of a calibration: calibration.json, and the views made of it.

use super::baselines::Baselines;
use super::confusion::{Confusion, TRIALS};
use super::false_alarms::{FalseAlarms, Scope};
use super::kill_matrix::KillMatrix;
use super::limits::Limits;
use super::part::{Part, PartId};
use super::power::Power;
use super::progress::Unfinished;
use super::work::{Effort, Work};
use crate::report::{FileError, Machine, write_whole};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

/// The version of calibration.json; readers refuse a larger one.
pub const SCHEMA_VERSION: u32 = 1;

/// The file of the result.
pub const CALIBRATION: &str = "calibration.json";

/// The page for people.
const PAGE: &str = "calibration.md";

/// What the instrument's measurement of itself gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Version of this format.
    pub schema_version: u32,
    /// Version of gonio.
    pub gonio: String,
    /// How much was measured.
    pub effort: Effort,
    /// The first seed of all random numbers.
    pub seed: u64,
    /// When it began, in UTC (RFC 3339); if it was interrupted, for the last time.
    pub started: String,
    /// How long it took from then on, in seconds.
    pub duration_s: f64,
    /// Where it ran.
    pub machine: Machine,
    /// Where the instrument is not what it claims to be: none if calibration holds.
    pub errors: Vec<String>,
    /// How often correct subjects are called wrong; absent where not asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub false_alarms: Option<FalseAlarms>,
    /// Which check catches which planted bug.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kill_matrix: Option<KillMatrix>,
    /// Which cause a diagnosis names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnoses: Option<Confusion>,
    /// The smallest errors that are found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power: Option<Power>,
    /// What happens at detection limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
    /// Fixed grids on correct subjects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fixed_grids: Option<Baselines>,
}

impl Calibration {
    /// Measures these parts.
    ///
    /// # Errors
    /// As [`Work::unit`].
    pub fn measure(parts: &[PartId], work: &Work) -> Result<Self, Unfinished> {
        let (start, started) = (Instant::now(), jiff::Timestamp::now().to_string());
        let asked = |part| parts.contains(&part);
        let mut calibration = Self {
            schema_version: SCHEMA_VERSION,
            gonio: env!("CARGO_PKG_VERSION").into(),
            effort: work.effort,
            seed: work.seed,
            started,
            duration_s: 0.0,
            machine: Machine::this(),
            errors: Vec::new(),
            false_alarms: None,
            kill_matrix: None,
            diagnoses: None,
            power: None,
            limits: None,
            fixed_grids: None,
        };
        if asked(PartId::FalseAlarms) {
            calibration.false_alarms = Some(FalseAlarms::measure(&Scope::of(work.effort), work)?);
        }
        if asked(PartId::KillMatrix) {
            calibration.kill_matrix = Some(KillMatrix::measure(work)?);
        }
        if asked(PartId::Confusion) {
            calibration.diagnoses = Some(Confusion::measure(work)?);
        }
        if asked(PartId::Power) {
            calibration.power = Some(Power::measure(work)?);
        }
        if asked(PartId::Limits) {
            calibration.limits = Some(Limits::measure(work)?);
        }
        if asked(PartId::Baselines) {
            calibration.fixed_grids = Some(Baselines::measure(work)?);
        }
        calibration.errors = calibration.parts().iter().flat_map(|p| p.errors()).collect();
        calibration.duration_s = start.elapsed().as_secs_f64();
        Ok(calibration)
    }

    /// The parts that were measured, in the order of the report.
    pub fn parts(&self) -> Vec<&dyn Part> {
        let parts: [Option<&dyn Part>; 6] = [
            self.false_alarms.as_ref().map(|p| p as _),
            self.kill_matrix.as_ref().map(|p| p as _),
            self.diagnoses.as_ref().map(|p| p as _),
            self.power.as_ref().map(|p| p as _),
            self.limits.as_ref().map(|p| p as _),
            self.fixed_grids.as_ref().map(|p| p as _),
        ];
        parts.into_iter().flatten().collect()
    }

    /// What to type to have it again.
    fn command(&self) -> String {
        let mut words = vec!["gonio calibrate".to_string()];
        if self.effort == Effort::Quick {
            words.push("--quick".into());
        }
        let parts = self.parts();
        if parts.len() < PartId::ALL.len() {
            words.extend(parts.iter().map(|p| format!("--part {}", p.id().name())));
        }
        let trials = self.diagnoses.as_ref().map_or(TRIALS, |d| d.trials);
        if self.effort == Effort::Full && trials != TRIALS {
            words.push(format!("--trials {trials}"));
        }
        words.push(format!("--seed {}", self.seed));
        words.join(" ")
    }

    /// The page for people.
    pub fn markdown(&self) -> String {
        let Machine { os, arch, cores } = &self.machine;
        let mut text = format!(
            "# Calibration of gonio {}\n\n`{}`, {}, {:.0} s on {cores} cores ({os}, {arch}).\n",
            self.gonio,
            self.command(),
            self.started,
            self.duration_s
        );
        text.push_str("\n**Calibration ");
        text.push_str(if self.errors.is_empty() { "holds.**\n" } else { "does not hold:**\n\n" });
        for error in &self.errors {
            writeln!(text, "- {error}").expect("a string takes text");
        }
        for part in self.parts() {
            write!(text, "\n{}", part.markdown()).expect("a string takes text");
            for picture in part.pictures() {
                write!(text, "\n![{}]({})\n", picture.caption, picture.path).expect("a string takes text");
            }
        }
        text
    }
}

/// Writes calibration.json, the page and the pictures, each whole or not at all.
///
/// # Errors
/// A file cannot be written.
pub fn write(folder: &Path, calibration: &Calibration) -> Result<(), FileError> {
    for picture in calibration.parts().iter().flat_map(|p| p.pictures()) {
        write_whole(&folder.join(&picture.path), picture.svg.as_bytes())?;
    }
    write_whole(&folder.join(PAGE), calibration.markdown().as_bytes())?;
    let path = folder.join(CALIBRATION);
    let not_kept = |source| FileError::NotKept { path: path.clone(), source };
    let text = serde_json::to_string_pretty(calibration).map_err(not_kept)? + "\n";
    write_whole(&path, text.as_bytes())
}
