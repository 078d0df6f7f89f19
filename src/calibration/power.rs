//! The smallest error that is found in 95 % of runs.

use super::progress::Unfinished;
use super::trial::{Found, THETA, Trial};
use super::work::{Effort, Work};
use crate::cause::Cause;
use crate::mutants::{Mutant, all};
use crate::registry::Registry;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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
}

impl Decision {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Strict, Self::Statistical, Self::Any];

    fn found(self, found: &Found) -> bool {
        match self {
            Self::Strict => found.strict,
            Self::Statistical => found.statistical,
            Self::Any => found.any,
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

impl Power {
    /// Measures the graded mutants.
    pub(super) fn measure(work: &Work) -> Result<Self, Unfinished> {
        let (exponents, runs, some): (&[u32], u64, &[&str]) = match work.effort {
            Effort::Quick => (&[14], 20, &["pdf-scaled", "pdf-alpha"]),
            Effort::Full => (&[14, 17, 20], 40, &[]),
        };
        let registry = Registry::builtin();
        let graded: Vec<Mutant> = all()
            .into_iter()
            .filter(|m| m.strength.is_some() && (some.is_empty() || some.contains(&m.name)))
            .collect();
        // A bisection from a good guess tries about ten strengths.
        work.begin("power", graded.len() * exponents.len() * 10 * runs as usize);
        let mut curves = Vec::new();
        for mutant in &graded {
            let mut before: Option<Curve> = None;
            for exponent in exponents {
                let curve = Search { mutant, samples: 1 << exponent, runs, registry: &registry, work }
                    .curve(before.as_ref())?;
                before = Some(curve.clone());
                curves.push(curve);
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

    fn point(&self, step: i32) -> Result<Point, Unfinished> {
        let epsilon = strength(self.most(), step);
        let key = format!("power/{}/{}/{step}", self.mutant.name, self.samples);
        let trial =
            Trial { mutant: self.mutant, epsilon, samples: self.samples, compared: false, checks: &[] };
        trial.unit((&key, self.runs), self.registry, self.work, Found::of, |all| {
            let count = |d: Decision| (d, all.iter().filter(|f| d.found(f)).count() as u64);
            Point { epsilon, runs: self.runs, found: Decision::ALL.into_iter().map(count).collect() }
        })
    }

    /// Brackets the smallest strength for each way to decide, from where fewer draws
    /// let one guess it, and halves the bracket.
    fn curve(&self, before: Option<&Curve>) -> Result<Curve, Unfinished> {
        let mut tried: BTreeMap<i32, Point> = BTreeMap::new();
        let mut smallest = BTreeMap::new();
        for decision in Decision::ALL {
            let mut is_found = |step: i32| -> Result<bool, Unfinished> {
                if let std::collections::btree_map::Entry::Vacant(entry) = tried.entry(step) {
                    entry.insert(self.point(step)?);
                }
                Ok(tried[&step].found[&decision] as f64 >= SHARE * self.runs as f64)
            };
            // Found at the first, not known to be at the second.
            let (mut found, mut missed) = (None, STEPS);
            if let Some(guess) = before.and_then(|b| self.guess(b, decision)) {
                let mut stride = PER_OCTAVE;
                let mut step = guess.clamp(0, STEPS - 1);
                // Outwards until the bracket has both ends.
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
            } else if is_found(0)? {
                found = Some(0);
            }
            let Some(mut found) = found else {
                smallest.insert(decision, None);
                continue;
            };
            while missed - found > 1 {
                let middle = (found + missed) / 2;
                if is_found(middle)? {
                    found = middle;
                } else {
                    missed = middle;
                }
            }
            smallest.insert(decision, Some(strength(self.most(), found)));
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
        let expected = match decision {
            // Exact checks do not see more with more draws.
            Decision::Any => epsilon,
            _ => epsilon * (before.samples as f64 / self.samples as f64).sqrt(),
        };
        Some(((self.most() / expected).log2() * f64::from(PER_OCTAVE)).round() as i32)
    }
}
