//! A graded mutant at one strength, one direction and one number of draws, measured
//! with many seeds.

use super::fixed_grid::FixedGrid;
use super::progress::Unfinished;
use super::work::Work;
use crate::checks::{self, Verdict, strict_ln_p};
use crate::engine::{CaseResult, shares};
use crate::mutants::{Mutant, STRENGTH};
use crate::registry::Registry;
use crate::statistics::streams::StreamKey;
use crate::suite::{Overrides, Plan, load};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::sync::{Arc, OnceLock};

/// Where graded bugs are measured: away from the normal, where all terms show, and
/// at a generic azimuth. Degrees.
pub(super) const THETA: f64 = 45.0;
const PHI: f64 = 17.0;

/// The level of the test without tolerance: it is a single look at a single
/// number, and what a screen over many cases would use.
pub(super) const STRICT: f64 = 1e-5;

/// A graded mutant of one strength.
#[derive(Clone, Copy)]
pub(super) struct Trial<'m> {
    pub mutant: &'m Mutant,
    pub epsilon: f64,
    pub samples: u64,
    /// Whether the correct model stands beside it.
    pub compared: bool,
    /// The checks to look at, which decide as among all; all where empty.
    pub checks: &'m [&'m str],
}

impl Trial<'_> {
    /// Its one case, decided as `gonio check` decides it.
    ///
    /// # Panics
    /// If the mutant is not graded, which its caller knows.
    fn plan(&self, registry: &Registry) -> Plan<'static> {
        let reference =
            if self.compared { format!("reference = \"{}\"\n", self.mutant.of) } else { String::new() };
        let text = format!(
            "[suite]\nname = \"calibration\"\nsamples = {}\ndetect = 1.0\ntheta = [{THETA}]\nphi = [{PHI}]\n\
             [[subject]]\nuse = \"{}\"\n{STRENGTH} = {}\n{reference}",
            self.samples,
            self.mutant.model_name(),
            self.epsilon
        );
        let expanded = load("calibration", &text, registry, &Overrides::default());
        let mut plan = expanded.unwrap_or_else(|e| panic!("{}: {e:?}", self.mutant.name)).plan;
        // The front side, in the first mode.
        plan.cases.truncate(1);
        plan.share = Some(shares(&plan).1);
        Arc::make_mut(&mut plan.cases[0]).checks = self.checks.iter().map(|c| (*c).into()).collect();
        plan
    }

    /// A unit of work called `key`: what `sum_up` makes of what `of` makes of each of
    /// `runs` results, which have successive seeds.
    pub fn unit<T: Send, S: Serialize + DeserializeOwned>(
        &self,
        (key, runs): (&str, u64),
        registry: &Registry,
        work: &Work,
        of: impl Fn(&CaseResult) -> T + Sync,
        sum_up: impl FnOnce(Vec<T>) -> S,
    ) -> Result<S, Unfinished> {
        let plan = self.plan(registry);
        let seeds: Vec<u64> = (0..runs).map(|k| work.seed + k).collect();
        let one = |seed: &u64| of(&work.run(&Plan { seed: *seed, ..plan.clone() }).cases[0]);
        work.unit(key, &seeds, one, sum_up)
    }
}

impl Trial<'_> {
    /// As [`unit`](Self::unit), for the rejections of a fixed grid, each a single test.
    pub fn grid_unit<S: Serialize + DeserializeOwned>(
        &self,
        (key, runs): (&str, u64),
        registry: &Registry,
        work: &Work,
        grid: &FixedGrid,
        sum_up: impl FnOnce(Vec<bool>) -> S,
    ) -> Result<S, Unfinished> {
        let plan = self.plan(registry);
        let case = &plan.cases[0];
        let stream = StreamKey::new(work.seed).with("mutant", &case.spelling);
        // What is expected is the same for every seed.
        let expected = OnceLock::new();
        let one = |run: &u64| {
            let expected = expected.get_or_init(|| grid.expect(&*case.subject, case.wo(), case.transport));
            let Ok(expected) = expected else { return false };
            let key = stream.with("run", &run.to_string());
            let observed = grid.observe(&*case.subject, case.wo(), case.transport, self.samples, &key);
            observed.is_ok_and(|observed| grid.compare(expected, &observed).rejected)
        };
        work.unit(key, &(0..runs).collect::<Vec<_>>(), one, sum_up)
    }
}

/// What a run found.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    /// The statistic at ε = 0 is below [`STRICT`].
    pub strict: bool,
    /// A statistical check fails: the error is beyond its tolerance.
    pub statistical: bool,
    /// Any check fails.
    pub any: bool,
}

impl Found {
    pub fn of(case: &CaseResult) -> Self {
        let fails = |statistical: bool| {
            case.findings.iter().any(|f| {
                let fits = !statistical || checks::find(f.check).is_some_and(|c| c.is_statistical());
                fits && matches!(f.outcome.verdict, Verdict::Fail | Verdict::Error)
            })
        };
        let strict = case.evidence.as_ref().and_then(strict_ln_p);
        Self {
            strict: strict.is_some_and(|ln_p| ln_p < STRICT.ln()),
            statistical: fails(true),
            any: fails(false),
        }
    }
}
