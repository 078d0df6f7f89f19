//! Fixed grids on correct subjects: how often the recipes that renderers use reject
//! what is right.

use super::fixed_grid::{FixedGrid, RECIPES, sidak};
use super::part::{Part, PartId, Picture};
use super::progress::Unfinished;
use super::rates::Rate;
use super::work::{Effort, Work};
use crate::bsdf::{Description, Direction, Subject, SubjectKind, Transport};
use crate::engine::CaseResult;
use crate::statistics::streams::StreamKey;
use crate::suite::{Case, Plan};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Directions that the recipes test of a BSDF.
const DIRECTIONS: usize = 5;

/// Draws of a quick test; the recipes' own else.
const QUICK_SAMPLES: u64 = 1 << 17;

/// Whether the recipe rejects, at this significance; `None` of what has no
/// sampler and pdf to compare, or fails.
pub(super) fn rejects(
    grid: &FixedGrid,
    subject: &dyn Subject,
    (wo, transport): (Direction, Transport),
    (effort, significance): (Effort, f64),
    key: &StreamKey,
) -> Option<bool> {
    let samples = if effort == Effort::Quick { QUICK_SAMPLES } else { grid.samples };
    let outcome = grid.test(subject, wo, transport, samples, key).ok()?;
    Some(outcome.p_value < significance)
}

/// Whether it is a BSDF with the two functions that a recipe compares.
fn has_both(description: &Description) -> bool {
    description.kind == SubjectKind::Bsdf && description.has.pdf && description.has.sample
}

fn key_of(case: &Case, seed: u64) -> StreamKey {
    StreamKey::new(seed)
        .with("subject", &case.spelling)
        .with("theta", &case.theta_deg.to_string())
        .with("phi", &case.phi_deg.to_string())
        .with("transport", &case.transport.to_string())
}

/// Which cases of a subject the recipes are given: as many directions as they test,
/// evenly from all.
pub(super) fn is_tested(k: usize, cases: usize) -> bool {
    let tested = DIRECTIONS.min(cases);
    (0..tested).any(|d| d * cases / tested == k)
}

/// What each recipe says of a measured case, beside others of its subject.
pub(super) fn of_case(result: &CaseResult, seed: u64) -> [Option<bool>; 2] {
    let case = &result.case;
    if !result.evidence.as_ref().is_some_and(|e| has_both(&e.description)) {
        return [None; 2];
    }
    let level = sidak(RECIPES[0].significance, DIRECTIONS as u32);
    RECIPES.map(|grid| {
        rejects(
            &grid,
            &*case.subject,
            (case.wo(), case.transport),
            (Effort::Full, level),
            &key_of(case, seed),
        )
    })
}

/// How often a recipe rejects correct subjects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridAlarms {
    /// The recipe.
    pub recipe: String,
    /// Its cells.
    pub cells: String,
    /// Rejections of correct subjects, each a single test at the recipe's significance.
    pub rejected: Rate,
    /// Subjects that it rejects in more than half of the tests, and at how many of
    /// how many directions.
    pub always: BTreeMap<String, (u64, u64)>,
}

/// Fixed grids on the correct subjects of a suite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Baselines {
    /// The suite.
    pub suite: String,
    /// By recipe.
    pub alarms: Vec<GridAlarms>,
}

impl Baselines {
    /// Tests every case that has a sampler and a continuous pdf.
    pub(super) fn measure(work: &Work) -> Result<Self, Unfinished> {
        let Plan { suite, mut cases, .. } = work.effort.plan();
        cases.retain(|case| has_both(&case.subject.describe()));
        if work.effort == Effort::Quick {
            cases.truncate(24);
        }
        work.begin("fixed grids", RECIPES.len() * cases.len());
        let mut alarms = Vec::new();
        for grid in RECIPES {
            let one = |case: &Arc<Case<'static>>| {
                let (wo, key) = (case.wo(), key_of(case, work.seed));
                let terms = (work.effort, grid.significance);
                (case.group.clone(), rejects(&grid, &*case.subject, (wo, case.transport), terms, &key))
            };
            let key = format!("fixed-grids/{}", grid.name);
            alarms.push(work.unit(&key, &cases, one, |all| counted(&grid, all))?);
        }
        Ok(Self { suite, alarms })
    }
}

fn counted(grid: &FixedGrid, all: Vec<(String, Option<bool>)>) -> GridAlarms {
    let mut by: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    for (group, rejected) in &all {
        // Smooth mirrors and glass have no pdf to compare.
        let Some(rejected) = rejected else { continue };
        let entry = by.entry(group.clone()).or_default();
        entry.0 += u64::from(*rejected);
        entry.1 += 1;
    }
    let (rejected, of) = by.values().fold((0, 0), |(n, m), (a, b)| (n + a, m + b));
    by.retain(|_, (a, b)| 2 * *a > *b);
    GridAlarms {
        recipe: grid.name.into(),
        cells: format!("{} × {}", grid.theta, grid.phi),
        rejected: Rate::new(rejected, of, grid.significance * of as f64),
        always: by,
    }
}

impl Part for Baselines {
    fn id(&self) -> PartId {
        PartId::Baselines
    }

    fn markdown(&self) -> String {
        let mut text = format!(
            "## Fixed grids\n\nThe χ² tests of Nori and pbrt-v4, restated: samples counted in a fixed grid, pdf integrated by adaptive Simpson, cells pooled to 5 expected, rejected at 0.01. On the correct subjects of the suite `{}`, each direction a single test:\n\n| recipe | cells | rejected | of | nominal | subjects rejected in more than half of their tests |\n|:--|:--|--:|--:|--:|:--|\n",
            self.suite
        );
        for a in &self.alarms {
            let always: Vec<_> = a.always.iter().map(|(s, (n, m))| format!("{s} ({n} of {m})")).collect();
            text += &format!(
                "| {} | {} | {} | {} | {:.1} | {} |\n",
                a.recipe,
                a.cells,
                a.rejected.count,
                a.rejected.of,
                a.rejected.expected(),
                always.join(", ")
            );
        }
        text
    }

    fn pictures(&self) -> Vec<Picture> {
        Vec::new()
    }

    /// They are others' recipes.
    fn errors(&self) -> Vec<String> {
        Vec::new()
    }

    fn summary(&self) -> Vec<String> {
        let line = |a: &GridAlarms| {
            let Rate { count, of, .. } = a.rejected;
            format!("fixed grid {} ({}): rejects {count} of {of} correct cases at 0.01", a.recipe, a.cells)
        };
        self.alarms.iter().map(line).collect()
    }
}
