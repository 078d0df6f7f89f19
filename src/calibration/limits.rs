//! What really happens at the detection limit that a pass prints.

use super::progress::Unfinished;
use super::trial::Trial;
use super::work::{Effort, Work};
use crate::checks::{POWER, Verdict, true_effects};
use crate::engine::CaseResult;
use crate::mutants::{Mutant, all};
use crate::registry::Registry;
use crate::statistics::binomial;
use serde::{Deserialize, Serialize};

/// How large the error of a mutant is, in the terms of the check's limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Truth {
    /// ε itself.
    Strength,
    /// √D of pdf against the correct model's, on the coarsest cells: integrated.
    Cells,
    /// The mean over all runs of the effect that the check estimates without bias.
    Mean,
}

/// A check, and a graded mutant whose size it measures.
struct Line {
    check: &'static str,
    mutant: &'static str,
    truth: Truth,
}

const fn line(check: &'static str, mutant: &'static str, truth: Truth) -> Line {
    Line { check, mutant, truth }
}

const GOODNESS_OF_FIT: &str = "goodness-of-fit";
const REFERENCE: &str = "reference";

const LINES: [Line; 5] = [
    line(GOODNESS_OF_FIT, "pdf-scaled", Truth::Cells),
    line(GOODNESS_OF_FIT, "pdf-alpha", Truth::Cells),
    line("normalization", "pdf-scaled", Truth::Strength),
    line("albedo", "weight-scaled", Truth::Strength),
    line("mis", "returned-pdf-scaled", Truth::Mean),
];

/// Errors tried, in parts of the limit.
const RATIOS: [f64; 5] = [0.25, 0.5, 0.75, 1.0, 1.25];

/// Runs that tell the limit, and the size of an error that is not known from ε.
const PRELIMINARY: u64 = 16;

/// Steps of the secant: √D is nearly proportional to the strength.
const SECANTS: u32 = 4;

/// With this probability a limit that holds is said not to.
const DOUBT: f64 = 1e-4;

/// How often an error was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Its strength.
    pub epsilon: f64,
    /// How large it is, over the limit.
    pub ratio: f64,
    /// Runs, each with its own seed.
    pub runs: u64,
    /// In which the check failed.
    pub failed: u64,
}

/// What was found of a check's limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// The check.
    pub check: String,
    /// The mutant's model.
    pub mutant: String,
    /// Draws at most.
    pub samples: u64,
    /// The limit that a pass prints, mean over runs of the correct model.
    pub limit: f64,
    /// Errors below, at and above it.
    pub points: Vec<Point>,
}

impl Limit {
    /// Sentences, if errors at the limit or above are found more rarely than promised.
    pub fn errors(&self) -> Vec<String> {
        let short = |p: &&Point| {
            p.ratio >= 1.0 && binomial::ln_upper_tail(p.runs - p.failed, p.runs, 1.0 - POWER) < DOUBT.ln()
        };
        let tell = |p: &Point| {
            format!(
                "{} finds {} at {:.2} of its limit {:.3e} in {} of {} runs; {POWER} was promised",
                self.check, self.mutant, p.ratio, self.limit, p.failed, p.runs
            )
        };
        self.points.iter().filter(short).map(tell).collect()
    }
}

/// What one run says of a check.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Said {
    failed: bool,
    limit: Option<f64>,
    effect: Option<f64>,
}

impl Said {
    fn of(check: &str, case: &CaseResult) -> Self {
        let outcome = case.findings.iter().find(|f| f.check == check).map(|f| &f.outcome);
        let effect = outcome.and_then(|o| o.effect.as_ref()).map(|e| e.value.0);
        Self {
            failed: outcome.is_some_and(|o| o.verdict == Verdict::Fail),
            limit: outcome.and_then(|o| o.detection_limit),
            effect: effect.filter(|e| e.is_finite()),
        }
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0u32), |(sum, n), v| (sum + v, n + 1));
    sum / f64::from(n.max(1))
}

/// What happens at detection limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// One for each check and mutant.
    pub limits: Vec<Limit>,
}

impl Limits {
    /// Measures the limits of statistical checks.
    pub(super) fn measure(work: &Work) -> Result<Self, Unfinished> {
        let (samples, runs, ratios) = match work.effort {
            Effort::Quick => (1 << 14, 20, &RATIOS[3..4]),
            Effort::Full => (1 << 16, 200, &RATIOS[..]),
        };
        let (registry, mutants) = (Registry::builtin(), all());
        work.begin(
            "detection limits",
            LINES.len() * (ratios.len() * runs as usize + 2 * PRELIMINARY as usize),
        );
        let one = |line: &Line| {
            let mutant = mutants.iter().find(|m| m.name == line.mutant).expect("the mutants of limits exist");
            Measuring { line, mutant, samples, runs, registry: &registry, work }.limit(ratios)
        };
        Ok(Self { limits: LINES.iter().map(one).collect::<Result<_, _>>()? })
    }
}

struct Measuring<'m> {
    line: &'m Line,
    mutant: &'m Mutant,
    samples: u64,
    runs: u64,
    registry: &'m Registry,
    work: &'m Work<'m>,
}

impl Measuring<'_> {
    fn trial<'t>(&'t self, epsilon: f64, compared: bool, checks: &'t [&'t str]) -> Trial<'t> {
        Trial { mutant: self.mutant, epsilon, samples: self.samples, compared, checks }
    }

    /// What the check says of an error in successive runs.
    fn said(&self, epsilon: f64, runs: u64) -> Result<Vec<Said>, Unfinished> {
        let (check, checks) = (self.line.check, [self.line.check]);
        let key = format!("limits/{check}/{}/{}/{epsilon:e}/{runs}", self.mutant.name, self.samples);
        let trial = self.trial(epsilon, false, &checks);
        trial.unit((&key, runs), self.registry, self.work, |case| Said::of(check, case), |all| all)
    }

    /// How large an error is, where that needs no runs.
    fn size(&self, epsilon: f64) -> Result<f64, Unfinished> {
        match self.line.truth {
            Truth::Strength => Ok(epsilon),
            Truth::Mean => Ok(mean(self.said(epsilon, PRELIMINARY)?.iter().filter_map(|s| s.effect)).abs()),
            Truth::Cells => {
                let of = |case: &CaseResult| {
                    let evidence = case.evidence.as_ref()?;
                    let masses = &evidence.reference.as_ref()?.masses;
                    let coarsest = true_effects(evidence, masses).into_iter().find(|(cells, _)| *cells > 1.0);
                    coarsest.map(|(_, effect)| effect)
                };
                let key = format!(
                    "limits/{}/{}/{}/{epsilon:e}/size",
                    self.line.check, self.mutant.name, self.samples
                );
                let trial = self.trial(epsilon, true, &[GOODNESS_OF_FIT, REFERENCE]);
                trial.unit((&key, 1), self.registry, self.work, of, |all| all[0].unwrap_or(0.0))
            }
        }
    }

    /// The strength of an error of this size, by the secant from a strong one.
    fn strength_of(&self, size: f64) -> Result<f64, Unfinished> {
        let mut epsilon = 0.1 * self.mutant.strength.map_or(1.0, |s| s.most);
        for _ in 0..SECANTS {
            // An error that the coarsest cells do not see has no size there.
            let now = self.size(epsilon)?.max(f64::MIN_POSITIVE);
            epsilon = (epsilon * size / now).min(self.mutant.strength.map_or(1.0, |s| s.most));
            if self.line.truth == Truth::Strength {
                break;
            }
        }
        Ok(epsilon)
    }

    fn limit(&self, ratios: &[f64]) -> Result<Limit, Unfinished> {
        let right = self.said(0.0, PRELIMINARY)?;
        let limit = mean(right.iter().filter_map(|s| s.limit));
        let mut points = Vec::new();
        for ratio in ratios {
            let epsilon = self.strength_of(ratio * limit)?;
            let all = self.said(epsilon, self.runs)?;
            let size = match self.line.truth {
                Truth::Mean => mean(all.iter().filter_map(|s| s.effect)).abs(),
                _ => self.size(epsilon)?,
            };
            let failed = all.iter().filter(|s| s.failed).count() as u64;
            points.push(Point { epsilon, ratio: size / limit, runs: self.runs, failed });
        }
        let (check, mutant) = (self.line.check.into(), self.mutant.model_name());
        Ok(Limit { check, mutant, samples: self.samples, limit, points })
    }
}
