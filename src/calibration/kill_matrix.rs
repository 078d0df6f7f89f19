//! Mutant by check: what caught what.

use crate::cause::Cause;
use crate::checks::{self, Verdict};
use crate::engine::{self, CaseResult, Options, Results};
use crate::mutants::Mutant;
use crate::registry::Registry;
use crate::suite::{Overrides, Plan, embedded, load};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How sharply the matrix is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sharpness {
    /// By the settings of the quick suite, where each mutant shows best.
    Quick,
    /// By the settings of the default suite, at all of its directions.
    Full,
}

impl Sharpness {
    fn suite(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Full => "seed",
        }
    }
}

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
}

impl Row {
    /// Whether any check failed or warned as it must.
    pub fn is_killed(&self) -> bool {
        self.checks.values().any(|a| a.failed > 0 || (a.expected == Expected::MustWarn && a.warned > 0))
    }

    /// What contradicts the labels, in sentences: a check that must fail and did
    /// not, one that failed and must not, a mutant that nothing caught.
    pub fn errors(&self) -> Vec<String> {
        let mut errors = Vec::new();
        for (check, answer) in &self.checks {
            let told = answer.told.as_deref().unwrap_or_default();
            let wrong = match answer.expected {
                Expected::MustFail if answer.failed == 0 => Some("misses it".into()),
                Expected::MustWarn if answer.warned == 0 => Some("does not warn".into()),
                Expected::MustWarn | Expected::MustNotFail if answer.failed > 0 => {
                    Some(format!("must not fail, and does at {} directions: {told}", answer.failed))
                }
                Expected::MustNotFail if answer.warned > 0 => Some(format!("must not warn: {told}")),
                _ => None,
            };
            errors.extend(wrong.map(|wrong: String| format!("{}: {check} {wrong}", self.mutant)));
        }
        if self.cause.is_some() && !self.is_killed() {
            errors.push(format!("{}: nothing catches it", self.mutant));
        }
        errors
    }
}

/// The suite that measures a mutant: the settings of the quick or the default
/// suite, which stand above its first subject.
fn suite_of(mutant: &Mutant, sharpness: Sharpness) -> String {
    let text = embedded(sharpness.suite()).expect("the suite comes with gonio").text;
    let settings = text.split("[[subject]]").next().unwrap_or_default();
    let mut suite = format!("{settings}[[subject]]\nuse = \"{}\"\n", mutant.model_name());
    if sharpness == Sharpness::Quick {
        suite += &format!("theta = {:?}\n", mutant.shows_at);
    }
    if mutant.compared {
        suite += &format!("reference = \"{}\"\n", mutant.of);
    }
    suite
}

/// The cases of a mutant, each of whose tests spends as much as one of the quick
/// or the default suite.
///
/// # Panics
/// If a mutant is not labelled rightly, which a test excludes.
pub fn plan_of(mutant: &Mutant, sharpness: Sharpness, registry: &Registry, seed: u64) -> Plan<'static> {
    let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
    let of = |name: &str, text: &str| match load(name, text, registry, &overrides) {
        Ok(expanded) => expanded.plan,
        Err(e) => panic!("{}: {e:?}", mutant.name),
    };
    let own = embedded(sharpness.suite()).expect("the suite comes with gonio");
    let (_, share) = engine::shares(&of(own.name, own.text));
    Plan { share: Some(share), ..of(mutant.name, &suite_of(mutant, sharpness)) }
}

/// Measures a mutant; `None` where that was stopped.
pub fn row(
    mutant: &Mutant,
    sharpness: Sharpness,
    registry: &Registry,
    seed: u64,
    options: &Options,
) -> Option<Row> {
    let results = engine::run(&plan_of(mutant, sharpness, registry, seed), options, &mut |_| {});
    results.partial.is_none().then(|| judged(mutant, &results))
}

fn expected(mutant: &Mutant, check: &str) -> Expected {
    match check {
        c if mutant.must_fail.contains(&c) => Expected::MustFail,
        c if mutant.may_fail.contains(&c) => Expected::MayFail,
        c if mutant.must_warn.contains(&c) => Expected::MustWarn,
        _ => Expected::MustNotFail,
    }
}

fn judged(mutant: &Mutant, results: &Results) -> Row {
    let mut checks = BTreeMap::new();
    for check in checks::all() {
        let answer = answer(check.id(), expected(mutant, check.id()), &results.cases);
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
        cases: results.cases.len(),
        samples: results.cases.iter().map(draws).sum(),
        checks,
    }
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
