//! A rubric as it was read.

use crate::bsdf::{ClaimsPatch, Precision, Transport};
use crate::grading::output::{Export, Template};
use crate::grading::{Hints, ItemKind};
use crate::plugins::Limits;
use crate::suite::Settings;
use regex::Regex;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What a submission must be, and what earns how many points.
#[derive(Clone, Debug)]
pub struct Rubric {
    /// Its file.
    pub path: PathBuf,
    /// The name of the assignment.
    pub title: String,
    /// A submission of the teacher's own, which must lose nothing.
    pub solution: Option<PathBuf>,
    /// Seed of all random numbers: the hidden one where the hidden part was read.
    pub seed: u64,
    /// Whether the hidden part was read.
    pub hidden: bool,
    /// The file of the hidden part.
    pub hidden_path: Option<PathBuf>,
    /// Probability that a correct submission loses any point of the items that are not
    /// hidden. Hidden ones are held to the same thresholds, and add to it.
    pub false_alarm: f64,
    /// For which precision all are judged, whatever a submission says of itself.
    pub precision: Precision,
    /// What one submission may take to be measured.
    pub limit: Duration,
    /// What folders and zips must be called; its named groups are told apart.
    pub pattern: Regex,
    /// What a submission is called, with `{GROUP}`s of the pattern.
    pub id: Option<Template>,
    /// What building and running may take.
    pub sandbox: SandboxTerms,
    /// What one call may take.
    pub limits: Limits,
    /// Languages, of which the first that fits is a submission's.
    pub languages: Vec<Language>,
    /// What a submission must offer, with what it is held to.
    pub models: BTreeMap<String, ClaimsPatch>,
    /// What earns points, hidden ones last.
    pub items: Vec<Item>,
    /// Tables for other systems; none for students, who lack the hidden items.
    pub exports: Vec<Export>,
}

impl Rubric {
    /// The folder that its paths start from.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The files that no submission may see: this rubric, its hidden part, the solution.
    pub fn own_files(&self) -> Vec<PathBuf> {
        let named = [Some(&self.path), self.hidden_path.as_ref(), self.solution.as_ref()];
        named.into_iter().flatten().cloned().collect()
    }

    /// Points that can be reached without a bonus.
    pub fn max(&self) -> f64 {
        self.items.iter().filter(|i| i.kind == ItemKind::Regular).map(|i| i.points).sum()
    }
}

/// What building and running may take.
#[derive(Clone, Debug, PartialEq)]
pub struct SandboxTerms {
    /// For a build: of processor time, and of the clock.
    pub build_time: Duration,
    /// Processes at once.
    pub processes: u64,
    /// Bytes of files, in memory.
    pub disk: u64,
    /// Bytes of messages that are kept.
    pub output: u64,
    /// Folders beside /usr that may be read.
    pub read: Vec<PathBuf>,
}

impl Default for SandboxTerms {
    fn default() -> Self {
        Self {
            build_time: Duration::from_secs(60),
            processes: 64,
            disk: 256 << 20,
            output: 1 << 20,
            read: Vec::new(),
        }
    }
}

/// How submissions in a language are told and built.
#[derive(Clone, Debug, PartialEq)]
pub struct Language {
    /// As people call it.
    pub name: String,
    /// A file that says so.
    pub when: String,
    /// Files and folders of the course that are put over the submission's.
    pub files: Vec<PathBuf>,
    /// A shell's line that builds it; nothing to build where `None`.
    pub build: Option<String>,
    /// What is measured.
    pub route: Route,
}

/// What of a submission is measured, by its path in the submission's folder.
#[derive(Clone, Debug, PartialEq)]
pub enum Route {
    /// A WebAssembly module.
    Wasm(String),
    /// A shared library.
    Library(String),
    /// A program with its arguments.
    Process(Vec<String>),
}

/// What a part of the cases counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Credit {
    /// As much as the part.
    #[default]
    Fraction,
    /// Nothing, unless it is the whole.
    Whole,
}

/// What earns points.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Its name in tables, and for `needs`.
    pub id: String,
    /// What students read.
    pub title: String,
    /// Points at stake.
    pub points: f64,
    /// How they count.
    pub kind: ItemKind,
    /// What a part of the cases counts.
    pub credit: Credit,
    /// Whether students do not have it.
    pub hidden: bool,
    /// Items of which each must earn something first.
    pub needs: Vec<String>,
    /// What students read on a loss.
    pub loss: Option<String>,
    /// How much of a diagnosis they see.
    pub hints: Hints,
    /// Subjects, MODEL:KEY=VALUE,…; none where it is earned by offering every model.
    pub subjects: Vec<String>,
    /// Ids of checks.
    pub checks: Vec<String>,
    /// What its subjects are held to besides what their models are.
    pub claims: ClaimsPatch,
    /// Polar angles of wo in degrees.
    pub theta: Vec<f64>,
    /// Azimuths of wo in degrees.
    pub phi: Vec<f64>,
    /// The mode of transport.
    pub transport: Transport,
    /// What eval is compared with: `solution`, or a subject with `{KEY}`s of the submission's
    /// parameters.
    pub reference: Option<String>,
    /// The relative difference of values that counts as none there.
    pub within: Option<f64>,
    /// Sharpness.
    pub settings: Settings,
}
