//! Mutant by check: what caught what.

use super::baselines::{is_tested, of_case};
use super::fixed_grid::RECIPES;
use super::progress::Unfinished;
use super::work::{Effort, Work};
use crate::cause::Cause;
use crate::checks::{self, Verdict};
use crate::engine::{self, CaseResult, Options};
use crate::mutants::{Mutant, all, controls};
use crate::registry::Registry;
use crate::suite::{Overrides, PHI, Plan, THETA, load};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What the identity of a check lets one expect of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Expected {
    /// The bug breaks the check's identity by more than it tolerates.
    MustFail,
    /// It breaks the identity, perhaps by less.
    MayFail,
    /// The check tells it as a convention.
    MustWarn,
    /// The identity holds.
    MustNotFail,
}

/// How a check answered a mutant over all directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// What its identity lets one expect.
    pub expected: Expected,
    /// Directions at which it ran, and did not skip.
    pub ran: usize,
    /// Of these it failed, or could not measure what the mutant did.
    pub failed: usize,
    /// Of these it warned.
    pub warned: usize,
    /// Of these it could not decide.
    pub inconclusive: usize,
    /// Its first failure or warning, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub told: Option<String>,
}

impl Answer {
    /// What contradicts the label, in words.
    fn wrong(&self) -> Option<String> {
        let told = self.told.as_deref().unwrap_or_default();
        match self.expected {
            Expected::MustFail if self.failed == 0 => Some("misses it".into()),
            Expected::MustWarn if self.warned == 0 => Some("does not warn".into()),
            Expected::MustWarn | Expected::MustNotFail if self.failed > 0 => {
                Some(format!("must not fail, and does at {} directions: {told}", self.failed))
            }
            Expected::MustNotFail if self.warned > 0 => Some(format!("must not warn: {told}")),
            _ => None,
        }
    }

    /// Whether it contradicts the label.
    pub fn is_wrong(&self) -> bool {
        self.wrong().is_some()
    }
}

/// A row of the matrix.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The mutant's model.
    pub mutant: String,
    /// Its cause; none of a negative control, with which nothing is wrong.
    pub cause: Option<Cause>,
    /// Its bug.
    pub what: String,
    /// The correct model.
    pub of: String,
    /// Where the bug was found.
    pub source: String,
    /// Its strength, where graded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength: Option<f64>,
    /// Directions at which it was measured.
    pub cases: usize,
    /// Draws in all.
    pub samples: u64,
    /// How each check answered that ran at all.
    pub checks: BTreeMap<String, Answer>,
    /// By recipe of a fixed grid: directions at which it rejects, of how many.
    pub grids: BTreeMap<String, (usize, usize)>,
}

impl Row {
    /// Whether any check failed or warned as it must.
    pub fn is_killed(&self) -> bool {
        self.checks.values().any(|a| a.failed > 0 || (a.expected == Expected::MustWarn && a.warned > 0))
    }

    /// What contradicts the labels, in sentences: a check that must fail and did
    /// not, one that failed and must not, a mutant that nothing caught.
    pub fn errors(&self) -> Vec<String> {
        let of = |(check, answer): (&String, &Answer)| {
            answer.wrong().map(|wrong| format!("{}: {check} {wrong}", self.mutant))
        };
        let mut errors: Vec<_> = self.checks.iter().filter_map(of).collect();
        if self.cause.is_some() && !self.is_killed() {
            errors.push(format!("{}: nothing catches it", self.mutant));
        }
        errors
    }
}

/// The suite that measures a mutant: the settings of the quick suite where the mutant
/// shows best, or those of the default suite at all of its directions.
fn suite_of(mutant: &Mutant, effort: Effort) -> String {
    // They stand above its first subject, and comments may speak of subjects.
    let settings = effort.suite().text.split("\n[[subject]]").next().unwrap_or_default();
    let mut suite = format!("{settings}\n[[subject]]\nuse = \"{}\"\n", mutant.model_name());
    if effort == Effort::Quick {
        suite += &format!("theta = {:?}\n", mutant.shows_at);
    }
    if mutant.compared {
        suite += &format!("reference = \"{}\"\n", mutant.of);
    }
    suite
}

/// The plans of mutants, in which each test spends as much as one of the quick or
/// the default suite does.
struct Plans {
    registry: Registry,
    effort: Effort,
    seed: u64,
    share: f64,
}

impl Plans {
    fn new(effort: Effort, seed: u64) -> Self {
        let (_, share) = engine::shares(&effort.plan());
        Self { registry: Registry::builtin(), effort, seed, share }
    }

    fn of(&self, mutant: &Mutant) -> Plan<'static> {
        let overrides = Overrides { seed: Some(self.seed), ..Overrides::default() };
        let expanded = load(mutant.name, &suite_of(mutant, self.effort), &self.registry, &overrides);
        let mut plan = expanded.unwrap_or_else(|e| panic!("{}: {e:?}", mutant.name)).plan;
        if self.effort == Effort::Full {
            // Each polar angle once, the azimuths in turn: the suite itself spreads
            // them over a model's parameters.
            let place = |all: &[f64], angle: f64| all.iter().position(|a| *a == angle);
            plan.cases.retain(|case| {
                let polar = place(&THETA, case.theta_deg.min(180.0 - case.theta_deg));
                let azimuth = place(&PHI, case.phi_deg);
                polar.zip(azimuth).is_none_or(|(t, p)| t % PHI.len() == p)
            });
        }
        Plan { share: Some(self.share), ..plan }
    }
}

/// The matrix.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct KillMatrix {
    /// The suite whose settings and thresholds are taken.
    pub suite: String,
    /// Mutants by cause, then negative controls.
    pub rows: Vec<Row>,
}

impl KillMatrix {
    /// Measures every mutant and control.
    pub(super) fn measure(work: &Work) -> Result<Self, Unfinished> {
        let plans = Plans::new(work.effort, work.seed);
        let all: Vec<_> = all().into_iter().chain(controls()).collect();
        let planned: Vec<_> = all.iter().map(|mutant| (mutant, plans.of(mutant))).collect();
        work.begin("mutants", planned.iter().map(|(_, plan)| plan.cases.len()).sum());
        let row = |(mutant, plan): &(&Mutant, Plan<'static>)| {
            let cases: Vec<usize> = (0..plan.cases.len()).collect();
            let one = |k: &usize| {
                let alone = Plan { cases: vec![plan.cases[*k].clone()], ..plan.clone() };
                let result = work.run(&alone).cases.remove(0);
                // Their recipes take longer than all checks.
                let grids = match work.effort == Effort::Full && is_tested(*k, cases.len()) {
                    true => of_case(&result, work.seed),
                    false => [None; 2],
                };
                (result, grids)
            };
            let sum_up = |all: Vec<(CaseResult<'static>, [Option<bool>; 2])>| {
                let (cases, grids): (Vec<_>, Vec<_>) = all.into_iter().unzip();
                Row { grids: rejections(&grids), ..judged(mutant, &cases) }
            };
            work.unit(&format!("mutants/{}", mutant.model_name()), &cases, one, sum_up)
        };
        let rows = planned.iter().map(row).collect::<Result<_, _>>()?;
        Ok(Self { suite: work.effort.suite().name.into(), rows })
    }
}

/// The rows of these mutants, made at once: for tests.
pub fn quick_rows(mutants: &[Mutant]) -> Vec<Row> {
    let plans = Plans::new(Effort::Quick, crate::suite::SEED);
    let row =
        |mutant| judged(mutant, &engine::run(&plans.of(mutant), &Options::default(), &mut |_| {}).cases);
    mutants.iter().map(row).collect()
}

fn expected(mutant: &Mutant, check: &str) -> Expected {
    match check {
        c if mutant.must_fail.contains(&c) => Expected::MustFail,
        c if mutant.may_fail.contains(&c) => Expected::MayFail,
        c if mutant.must_warn.contains(&c) => Expected::MustWarn,
        _ => Expected::MustNotFail,
    }
}

fn judged(mutant: &Mutant, cases: &[CaseResult]) -> Row {
    let mut checks = BTreeMap::new();
    for check in checks::all() {
        let answer = answer(check.id(), expected(mutant, check.id()), cases);
        if answer.ran > 0 || answer.expected == Expected::MustFail {
            checks.insert(check.id().to_string(), answer);
        }
    }
    let draws =
        |case: &CaseResult| case.evidence.iter().flat_map(|e| e.draws.iter().map(|d| d.samples)).sum::<u64>();
    Row {
        mutant: mutant.model_name(),
        cause: mutant.cause,
        what: mutant.what.into(),
        of: mutant.of.into(),
        source: mutant.source.into(),
        strength: mutant.strength.map(|s| s.default),
        cases: cases.len(),
        samples: cases.iter().map(draws).sum(),
        checks,
        grids: BTreeMap::new(),
    }
}

/// By recipe, in how many cases it rejects, of those that it was given.
fn rejections(grids: &[[Option<bool>; 2]]) -> BTreeMap<String, (usize, usize)> {
    let mut by = BTreeMap::new();
    for (k, grid) in RECIPES.iter().enumerate() {
        let said: Vec<bool> = grids.iter().filter_map(|g| g[k]).collect();
        if !said.is_empty() {
            by.insert(grid.name.into(), (said.iter().filter(|r| **r).count(), said.len()));
        }
    }
    by
}

fn answer(check: &'static str, expected: Expected, cases: &[CaseResult]) -> Answer {
    let mut answer = Answer { expected, ran: 0, failed: 0, warned: 0, inconclusive: 0, told: None };
    for case in cases {
        for finding in case.findings.iter().filter(|f| f.check == check) {
            let counter = match finding.outcome.verdict {
                Verdict::Skipped => continue,
                Verdict::Fail | Verdict::Error => &mut answer.failed,
                Verdict::Warn => &mut answer.warned,
                Verdict::Inconclusive => &mut answer.inconclusive,
                Verdict::Pass | Verdict::Waived => {
                    answer.ran += 1;
                    continue;
                }
            };
            *counter += 1;
            answer.ran += 1;
            if matches!(finding.outcome.verdict, Verdict::Fail | Verdict::Error | Verdict::Warn) {
                answer.told.get_or_insert_with(|| {
                    format!(
                        "θ = {}°, φ = {}°: {}",
                        case.case.theta_deg, case.case.phi_deg, finding.outcome.message
                    )
                });
            }
        }
    }
    answer
}
