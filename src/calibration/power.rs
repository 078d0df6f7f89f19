//! The smallest error that is found in 95 % of runs.

use super::fixed_grid::{FixedGrid, NORI, PBRT};
use super::progress::Unfinished;
use super::trial::{Found, THETA, Trial};
use super::work::{Effort, Work};
use crate::cause::Cause;
use crate::mutants::{Mutant, all};
use crate::registry::Registry;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The share of runs in which an error must be found.
const SHARE: f64 = 0.95;

/// Strengths tried are a sixth of an octave apart (12 %), over this many steps
/// (2⁻²⁰ of the largest).
const PER_OCTAVE: i32 = 6;
const STEPS: i32 = 120;

/// What decides whether a run found the bug.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Decision {
    /// The fixed-N statistic of samples against pdf at ε = 0, below 10⁻⁵.
    Strict,
    /// The verdict `fail` of a statistical check, tolerance and confirmation included.
    Statistical,
    /// The verdict `fail` of any check.
    Any,
    /// A rejection by Nori's fixed grid, a single test at 0.01.
    NoriGrid,
    /// A rejection by pbrt-v4's.
    PbrtGrid,
}

impl Decision {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Strict, Self::Statistical, Self::Any, Self::NoriGrid, Self::PbrtGrid];

    fn grid(self) -> Option<FixedGrid> {
        match self {
            Self::NoriGrid => Some(NORI),
            Self::PbrtGrid => Some(PBRT),
            _ => None,
        }
    }
}

/// How often a bug of one strength was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Its strength.
    pub epsilon: f64,
    /// Runs, each with its own seed.
    pub runs: u64,
    /// In how many of them it was found, by what decides.
    pub found: BTreeMap<Decision, u64>,
}

/// What was found of one graded bug with one number of draws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// The mutant's model.
    pub mutant: String,
    /// Its cause.
    pub cause: Option<Cause>,
    /// What ε is.
    pub meaning: String,
    /// The correct model.
    pub of: String,
    /// Polar angle of wo in degrees.
    pub theta_deg: f64,
    /// Draws at most (confirmations take up to eight times more).
    pub samples: u64,
    /// Strengths tried, strongest first.
    pub points: Vec<Point>,
    /// The smallest ε tried that was found in 95 % of the runs, as were all larger
    /// ones tried; `None` where not even the largest is.
    pub smallest: BTreeMap<Decision, Option<f64>>,
}

/// The power of the instrument on graded bugs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Power {
    /// A curve for each mutant and number of draws.
    pub curves: Vec<Curve>,
}

/// What is measured with one number of draws.
struct Scope {
    exponent: u32,
    runs: u64,
    decisions: &'static [Decision],
    /// Names of mutants; all graded ones where empty.
    mutants: &'static [&'static str],
}

/// The bugs for which figures of other testers are at hand.
const COMPARED: &[&str] =
    &["pdf-scaled", "pdf-alpha", "pdf-without-g1", "lobe-share-off", "azimuth-shifted", "stray-samples"];

/// Exact checks do not see more with more draws, so they are asked for with few.
const FULL: &[Scope] = &[
    Scope { exponent: 14, runs: 20, decisions: &[Decision::Statistical, Decision::Any], mutants: &[] },
    Scope {
        exponent: 20,
        runs: 20,
        decisions: &[Decision::Strict, Decision::Statistical, Decision::NoriGrid, Decision::PbrtGrid],
        mutants: COMPARED,
    },
];

const QUICK: &[Scope] = &[Scope {
    exponent: 14,
    runs: 20,
    decisions: &[Decision::Strict, Decision::Any],
    mutants: &["pdf-scaled", "pdf-alpha"],
}];

impl Power {
    /// Measures the graded mutants.
    pub(super) fn measure(work: &Work) -> Result<Self, Unfinished> {
        let scopes = if work.effort == Effort::Quick { QUICK } else { FULL };
        let registry = Registry::builtin();
        let graded: Vec<Mutant> = all().into_iter().filter(|m| m.strength.is_some()).collect();
        let of = |scope: &'static Scope| {
            graded.iter().filter(|m| scope.mutants.is_empty() || scope.mutants.contains(&m.name))
        };
        // A bisection tries about seven strengths.
        let steps = |s: &'static Scope| of(s).count() * 7 * s.decisions.len() * s.runs as usize;
        work.begin("power", scopes.iter().map(steps).sum());
        let mut curves: Vec<Curve> = Vec::new();
        for scope in scopes {
            for mutant in of(scope) {
                let before = curves.iter().rev().find(|c| c.mutant == mutant.model_name()).cloned();
                let search = Search {
                    mutant,
                    samples: 1 << scope.exponent,
                    runs: scope.runs,
                    registry: &registry,
                    work,
                };
                curves.push(search.curve(scope.decisions, before.as_ref())?);
            }
        }
        Ok(Self { curves })
    }
}

fn strength(most: f64, step: i32) -> f64 {
    most * 2f64.powf(-f64::from(step) / f64::from(PER_OCTAVE))
}

/// The search for the smallest strengths that are found.
struct Search<'s> {
    mutant: &'s Mutant,
    samples: u64,
    runs: u64,
    registry: &'s Registry,
    work: &'s Work<'s>,
}

impl Search<'_> {
    fn most(&self) -> f64 {
        self.mutant.strength.map_or(0.0, |s| s.most)
    }

    /// How often a strength is found, by the decisions that one measurement serves.
    fn point(&self, step: i32, decision: Decision) -> Result<Point, Unfinished> {
        let epsilon = strength(self.most(), step);
        let trial =
            Trial { mutant: self.mutant, epsilon, samples: self.samples, compared: false, checks: &[] };
        let key = format!("power/{}/{}/{step}", self.mutant.name, self.samples);
        let Some(grid) = decision.grid() else {
            return trial.unit((&key, self.runs), self.registry, self.work, Found::of, |all| {
                let count = |found: fn(&Found) -> bool| all.iter().filter(|f| found(f)).count() as u64;
                let found = [
                    (Decision::Strict, count(|f| f.strict)),
                    (Decision::Statistical, count(|f| f.statistical)),
                    (Decision::Any, count(|f| f.any)),
                ];
                Point { epsilon, runs: self.runs, found: found.into() }
            });
        };
        let key = format!("{key}/{}", grid.name);
        trial.grid_unit((&key, self.runs), self.registry, self.work, &grid, |rejected| {
            let found = rejected.iter().filter(|r| **r).count() as u64;
            Point { epsilon, runs: self.runs, found: [(decision, found)].into() }
        })
    }

    /// Brackets the smallest strength for each way to decide, from where fewer draws
    /// let one guess it, and halves the bracket.
    fn curve(&self, decisions: &[Decision], before: Option<&Curve>) -> Result<Curve, Unfinished> {
        let mut tried: BTreeMap<i32, Point> = BTreeMap::new();
        let mut smallest = BTreeMap::new();
        for decision in decisions.iter().copied() {
            let mut is_found = |step: i32| -> Result<bool, Unfinished> {
                if tried.get(&step).is_none_or(|p| !p.found.contains_key(&decision)) {
                    let point = self.point(step, decision)?;
                    match tried.entry(step) {
                        Entry::Vacant(entry) => {
                            entry.insert(point);
                        }
                        Entry::Occupied(mut entry) => entry.get_mut().found.extend(point.found),
                    }
                }
                Ok(tried[&step].found[&decision] as f64 >= SHARE * self.runs as f64)
            };
            let guess = before.and_then(|b| self.guess(b, decision));
            let found = smallest_step(&mut is_found, guess)?;
            smallest.insert(decision, found.map(|step| strength(self.most(), step)));
        }
        Ok(Curve {
            mutant: self.mutant.model_name(),
            cause: self.mutant.cause,
            meaning: self.mutant.strength.map_or("", |s| s.meaning).into(),
            of: self.mutant.of.into(),
            theta_deg: THETA,
            samples: self.samples,
            points: tried.into_values().collect(),
            smallest,
        })
    }

    /// The step of the strength that is smaller by the root of the draws.
    fn guess(&self, before: &Curve, decision: Decision) -> Option<i32> {
        let epsilon = before.smallest.get(&decision).copied().flatten()?;
        let expected = epsilon * (before.samples as f64 / self.samples as f64).sqrt();
        Some(((self.most() / expected).log2() * f64::from(PER_OCTAVE)).round() as i32)
    }
}

/// The last step, of ever smaller strengths, that is found: outwards from a guess
/// until both ends are known, then by halves; `None` if not even the first is.
fn smallest_step(
    is_found: &mut dyn FnMut(i32) -> Result<bool, Unfinished>,
    guess: Option<i32>,
) -> Result<Option<i32>, Unfinished> {
    // Found at the first, not known to be at the second.
    let (mut found, mut missed) = (None, STEPS);
    let (mut step, mut stride) = (guess.unwrap_or(0).clamp(0, STEPS - 1), PER_OCTAVE);
    if guess.is_none() {
        stride = STEPS;
    }
    loop {
        if is_found(step)? {
            found = Some(step);
            if step + stride >= missed {
                break;
            }
            step += stride;
        } else {
            missed = step;
            if found.is_some() || step == 0 {
                break;
            }
            step = (step - stride).max(0);
        }
        stride *= 2;
    }
    let Some(mut found) = found else { return Ok(None) };
    while missed - found > 1 {
        let middle = (found + missed) / 2;
        if is_found(middle)? {
            found = middle;
        } else {
            missed = middle;
        }
    }
    Ok(Some(found))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_ends_at_the_last_step_that_is_found() {
        for last in [0, 1, 17, 63, STEPS - 1] {
            for guess in [None, Some(0), Some(15), Some(last), Some(STEPS * 2)] {
                let mut tried = 0;
                let mut is_found = |step: i32| {
                    tried += 1;
                    Ok(step <= last)
                };
                assert_eq!(smallest_step(&mut is_found, guess).unwrap(), Some(last), "{guess:?}");
                assert!(tried <= 16, "{last} {guess:?}: {tried}");
            }
        }
        assert_eq!(smallest_step(&mut |_| Ok(false), Some(9)).unwrap(), None);
    }
}
