//! Diagnoses of mutants: the cause that is named against the one that is there.

use super::progress::Unfinished;
use super::work::{Effort, Work};
use crate::bsdf::Transport;
use crate::cause::Cause;
use crate::checks::Verdict;
use crate::diagnosis::diagnose;
use crate::engine::{CaseResult, Options, Results, run_here};
use crate::mutants::{Mutant, STRENGTH, all};
use crate::registry::{Parameters, Registry};
use crate::statistics::streams::StreamKey;
use crate::suite::{Overrides, Plan, load};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Sets of random parameters, each with a seed of its own, where no other number is
/// asked for.
pub const TRIALS: u64 = 20;

/// So many make a unit of work.
const BATCH: u64 = 4;

/// Of all so many are diagnosed without declared parameters too, which takes longer.
const UNDECLARED: u64 = 2;

/// How the words of a wrong cause begin that was named with confidence.
const CONFIDENT: &str = "(confident)";

/// Draws at most: what a developer's suite takes.
const SAMPLES: u64 = 1 << 16;

/// A polar angle besides those where a mutant shows best, in degrees.
const THETA: f64 = 55.0;

/// How often causes were named for one mutant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// Trials in which a check failed, and so confirmed that something is wrong.
    pub confirmed: usize,
    /// Of these the right cause was named first.
    pub first: usize,
    /// The right cause was among the first two.
    pub first_two: usize,
    /// A wrong cause was named with confidence.
    pub confidently_wrong: usize,
    /// Nothing fitted, or nothing that says enough.
    pub none: usize,
    /// Causes named first, by slug; "none" where nothing fitted.
    pub causes: BTreeMap<String, usize>,
    /// What was said wrongly, with the parameters: the first, confident ones before
    /// others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong: Option<String>,
}

/// A mutant's row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnosed {
    /// The mutant's model.
    pub mutant: String,
    /// Its cause.
    pub cause: Cause,
    /// Causes that no measurement tells from it, with the reason.
    pub equivalent: Vec<(Cause, String)>,
    /// Where the parts of the model are declared, as by parameters called alpha.
    pub declared: Named,
    /// Where they are not.
    pub undeclared: Named,
}

/// Diagnoses of all mutants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Confusion {
    /// Sets of random parameters for each.
    pub trials: u64,
    /// Draws at most for each direction.
    pub samples: u64,
    /// One a mutant that a check fails, by cause.
    pub rows: Vec<Diagnosed>,
}

/// A diagnosis of one trial.
#[derive(Clone, Debug)]
struct Said {
    ranked: Vec<Cause>,
    confident: bool,
    text: String,
}

/// What one trial gave, with parts declared and without; `None` where no check failed.
type Trial = Option<(Said, Option<Said>)>;

impl Confusion {
    /// Diagnoses every mutant that some check must fail; a few of each cause where time
    /// is short.
    pub(super) fn measure(work: &Work) -> Result<Self, Unfinished> {
        let registry = Registry::builtin();
        let quick = work.effort == Effort::Quick;
        let run = |plan: &Plan<'static>| work.run(plan);
        let mutants = if quick { few() } else { failing() };
        let trials = if quick { 1 } else { work.trials };
        work.begin("diagnoses", mutants.len() * trials.div_ceil(BATCH) as usize);
        let mut rows: Vec<Diagnosed> = Vec::new();
        // All mutants a few times, then all of them again: what was interrupted has
        // something of each.
        for first in (0..trials).step_by(BATCH as usize) {
            let batch = first..(first + BATCH).min(trials);
            let one = |mutant: &Mutant| {
                let trial = |k: u64| {
                    let undeclared = !quick && k < UNDECLARED;
                    trial(mutant, work.seed + k, undeclared, &registry, &run)
                };
                row_of(mutant, &batch.clone().map(trial).collect::<Vec<_>>())
            };
            let key = format!("diagnoses/{}-{}", batch.start, batch.end);
            let more = work.unit(&key, &mutants, one, |rows| rows)?;
            if rows.is_empty() {
                rows = more;
            } else {
                rows.iter_mut().zip(more).for_each(|(row, more)| row.add(more));
            }
        }
        Ok(Self { trials, samples: SAMPLES, rows })
    }
}

impl Diagnosed {
    fn add(&mut self, more: Self) {
        self.declared.add(more.declared);
        self.undeclared.add(more.undeclared);
    }
}

impl Named {
    /// The same mutant at other parameters.
    pub fn add(&mut self, more: Self) {
        self.confirmed += more.confirmed;
        self.first += more.first;
        self.first_two += more.first_two;
        self.confidently_wrong += more.confidently_wrong;
        self.none += more.none;
        for (cause, times) in more.causes {
            *self.causes.entry(cause).or_default() += times;
        }
        let confident = |wrong: &Option<String>| wrong.as_ref().is_some_and(|w| w.starts_with(CONFIDENT));
        if self.wrong.is_none() || (confident(&more.wrong) && !confident(&self.wrong)) {
            self.wrong = more.wrong;
        }
    }
}

/// Mutants that a check must fail: only what fails is diagnosed.
fn failing() -> Vec<Mutant> {
    all().into_iter().filter(|m| !m.must_fail.is_empty()).collect()
}

/// Some of each cause.
fn few() -> Vec<Mutant> {
    const EACH: usize = 3;
    let mut taken: BTreeMap<Option<Cause>, usize> = BTreeMap::new();
    let mut few = failing();
    few.retain(|m| {
        let n = taken.entry(m.cause).or_default();
        *n += 1;
        *n <= EACH
    });
    few
}

/// Rows of some mutants of each cause, made at once: for tests.
pub fn quick_diagnoses(seed: u64) -> Vec<Diagnosed> {
    let (registry, mutants) = (Registry::builtin(), few());
    let run = |plan: &Plan<'static>| run_here(plan, &Options::default());
    let row = |m: &Mutant| row_of(m, &[trial(m, seed, false, &registry, &run)]);
    mutants.par_iter().with_max_len(1).map(row).collect()
}

/// The suite of a mutant with random parameters.
fn plan(mutant: &Mutant, seed: u64, registry: &Registry) -> Plan<'static> {
    let mut stream = StreamKey::new(seed).with("mutant", mutant.name).with("stage", "parameters").block(0);
    let mut theta: Vec<f64> = mutant.shows_at.iter().chain(&[THETA]).copied().collect();
    theta.sort_by(f64::total_cmp);
    theta.dedup();
    let phi = (stream.next_f64() * 360.0 * 8.0).round() / 8.0;
    let mut values = String::new();
    for (name, least, most) in mutant.varied {
        // Rounded, so that it can be typed.
        let value = least + (most - least) * stream.next_f64();
        values += &format!("{name} = {:?}\n", (value * 1e5).round() / 1e5);
    }
    let mut given = String::new();
    let of: crate::registry::Spelling = mutant.of.parse().expect("a mutant says of what it is one");
    for (name, value) in &of.parameters {
        if !mutant.varied.iter().any(|v| v.0 == name) {
            given += &format!(
                "{name} = {}\n",
                match value {
                    crate::registry::Value::Number(v) => format!("{v:?}"),
                    crate::registry::Value::Text(t) => format!("{t:?}"),
                }
            );
        }
    }
    // The correct model stands beside those that break no identity of their own.
    let reference = match mutant.compared {
        true => {
            let drawn: Vec<String> = values
                .lines()
                .chain(given.lines())
                .map(|l| l.replace(" = ", "=").replace('"', ""))
                .map(|l| match l.split_once('=') {
                    Some((k, v)) if v.contains(',') && !v.starts_with('(') => format!("{k}=({v})"),
                    _ => l.clone(),
                })
                .collect();
            let name = &of.name;
            if drawn.is_empty() {
                format!("reference = {name:?}\n")
            } else {
                format!("reference = {:?}\n", format!("{name}:{}", drawn.join(",")))
            }
        }
        false => String::new(),
    };
    let text = format!(
        "[suite]\nname = \"calibration\"\nsamples = {SAMPLES}\ndetect = 1.0\ntheta = {theta:?}\nphi = [{phi:?}]\n\
         [[subject]]\nuse = \"{}\"\n{values}{reference}",
        mutant.model_name()
    );
    let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
    let expanded = load("calibration", &text, registry, &overrides);
    let mut plan = expanded.unwrap_or_else(|e| panic!("{}: {e:?}\n{text}", mutant.name)).plan;
    // The other mode says nothing of most bugs, and takes as long again.
    if mutant.cause != Some(Cause::TransportMode) {
        plan.cases.retain(|case| case.transport == Transport::Radiance);
    }
    plan
}

fn trial(
    mutant: &Mutant,
    seed: u64,
    undeclared: bool,
    registry: &Registry,
    run: &(dyn Fn(&Plan<'static>) -> Results<'static> + Sync),
) -> Trial {
    let plan = plan(mutant, seed, registry);
    let results = run(&plan);
    let cases: Vec<&CaseResult> = results.cases.iter().collect();
    let failed = |c: &&CaseResult| matches!(c.worst(), Verdict::Fail | Verdict::Error);
    let first = cases.iter().copied().find(failed)?;
    let mut declared = first.case.parameters.clone();
    declared.0.remove(STRENGTH);
    let says = |parameters: &Parameters| {
        let verdict = diagnose(&cases, &[], parameters);
        let ranked: Vec<Cause> = verdict.iter().flat_map(|v| v.ranked.iter().map(|r| r.1.cause)).collect();
        let statement = verdict.as_ref().and_then(|v| v.ranked.first()).map_or("none", |r| &r.1.statement);
        let book = verdict.as_ref().and_then(|v| v.textbook.clone()).unwrap_or_default();
        Said {
            confident: verdict.as_ref().is_some_and(|v| v.confident),
            text: format!("{}: {statement} [{book}]", first.case.spelling),
            ranked,
        }
    };
    Some((says(&declared), undeclared.then(|| says(&Parameters::default()))))
}

fn row_of(mutant: &Mutant, trials: &[Trial]) -> Diagnosed {
    let cause = mutant.cause.expect("a mutant has a cause");
    let named = |said: &mut dyn Iterator<Item = &Said>| {
        let mut named = Named::default();
        let mut wrong: Option<(bool, String)> = None;
        for said in said {
            let right = |c: &Cause| *c == cause || mutant.equivalent.iter().any(|(e, _)| e == c);
            named.confirmed += 1;
            named.first += usize::from(said.ranked.first().is_some_and(right));
            named.first_two += usize::from(said.ranked.iter().take(2).any(right));
            let first = said.ranked.first();
            named.none += usize::from(first.is_none());
            *named.causes.entry(first.map_or("none", |c| c.slug()).into()).or_default() += 1;
            if first.is_none_or(|c| !right(c)) {
                let confident = said.confident && first.is_some();
                named.confidently_wrong += usize::from(confident);
                if wrong.as_ref().is_none_or(|(before, _)| confident && !before) {
                    let mark = if confident { format!("{CONFIDENT} ") } else { String::new() };
                    wrong = Some((confident, format!("{mark}{}", said.text)));
                }
            }
        }
        Named { wrong: wrong.map(|w| w.1), ..named }
    };
    Diagnosed {
        mutant: mutant.model_name(),
        cause,
        equivalent: mutant.equivalent.iter().map(|(c, why)| (*c, (*why).into())).collect(),
        declared: named(&mut trials.iter().flatten().map(|t| &t.0)),
        undeclared: named(&mut trials.iter().flatten().filter_map(|t| t.1.as_ref())),
    }
}
