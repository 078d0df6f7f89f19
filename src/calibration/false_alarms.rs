//! A/A: correct subjects over many seeds, and how often they are called wrong.
//!
//! A *run* is one subject at one wo with all its checks, and has a budget of its own:
//! raised, so that false alarms are frequent enough to be counted, and the default one,
//! under which there should be none.

use super::progress::Unfinished;
use super::rates::Rate;
use super::uniformity::Uniformity;
use super::work::{Effort, Work};
use crate::checks::{self, Verdict, density_p_values, level_p_values};
use crate::engine::{CaseResult, Finding};
use crate::evidence::Figure;
use crate::statistics::budget::{Budget, attempt};
use crate::suite::{Case, FALSE_ALARM, Plan, reproduce};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The raised budget of a run: the 1 % at which other testers work, and at which ten
/// thousand runs tell a rate of twice the nominal one for certain.
pub const RAISED: f64 = 1e-2;

/// Seeds of a full calibration: 28 × 367 cases are more than the ten thousand runs of
/// which none failing excludes a rate of 3·10⁻⁴.
const FULL_SEEDS: u64 = 28;

/// Seeds of a quick one: 25 s of two cores.
const QUICK_SEEDS: u64 = 10;

/// Chance, as far as it is known, that the errors of this part call the rates and
/// p-values of a right instrument wrong; divided by the number of statements.
const LEVEL: f64 = 0.05;

/// What is run.
pub struct Scope {
    /// Where the cases come from: a suite's name.
    pub suite: String,
    /// Correct subjects, each at a direction.
    pub cases: Vec<Arc<Case<'static>>>,
    /// Number of seeds, from that of the calibration on.
    pub seeds: u64,
    /// Probability that a run shows any failure, raised.
    pub raised: f64,
    /// The same by default.
    pub default: f64,
}

impl Scope {
    /// The cases of the default suite, or of the quick one.
    pub fn of(effort: Effort) -> Self {
        let seeds = match effort {
            Effort::Quick => QUICK_SEEDS,
            Effort::Full => FULL_SEEDS,
        };
        let Plan { suite, cases, .. } = effort.plan();
        Self { suite, cases, seeds, raised: RAISED, default: FALSE_ALARM }
    }
}

/// A result that a correct subject must not have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// Subject and wo.
    pub case: String,
    /// Seed of its random numbers.
    pub seed: u64,
    /// Id of the check.
    pub check: String,
    /// `fail`, `error` or `warn`.
    pub verdict: Verdict,
    /// What the check said.
    pub message: String,
    /// What to type to see it again.
    pub command: String,
}

/// The false alarms of a check, or of all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckAlarms {
    /// Id of the check; `all` for runs with any.
    pub check: String,
    /// Runs that it judged.
    pub runs: u64,
    /// Statistical tests among them: the others decided without chance.
    pub tests: u64,
    /// First attempts that crossed their threshold, at the raised budget.
    pub suspicions: Rate,
    /// Failures at the raised budget.
    pub fails: Rate,
    /// First attempts that crossed their threshold, at the default budget.
    pub default_suspicions: Rate,
    /// Failures at the default budget.
    pub default_fails: Rate,
}

/// How often correct subjects are called wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FalseAlarms {
    /// Where the subjects come from.
    pub suite: String,
    /// Runs of a seed.
    pub cases: u64,
    /// Number of seeds.
    pub seeds: u64,
    /// The raised budget of a run.
    pub raised_budget: f64,
    /// The default budget of a run.
    pub default_budget: f64,
    /// Runs with any false alarm.
    pub in_all: CheckAlarms,
    /// By check, in the order of reports.
    pub checks: Vec<CheckAlarms>,
    /// Every `fail`, `error` and `warn` at the default budget.
    pub alarms: Vec<Alarm>,
    /// Runs with a suspicion at the raised budget, which were run again at the default.
    pub run_again: u64,
    /// Results at the raised budget that are `inconclusive`, but for a suspicion.
    pub undecided: u64,
    /// p-values of independent levels of the cell tree: ε = 0, all draws.
    pub p_values: Uniformity,
    /// The same along the density; apart, since they depend on those of levels.
    pub density_p_values: Uniformity,
    /// Runs whose draws ended before their number was full, so that their p-values would
    /// not be those of a fixed number.
    pub left_out: u64,
}

/// False alarms at one budget.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Crossed {
    suspicions: u64,
    fails: u64,
    /// Suspicions that the thresholds let expect at most.
    expected_suspicions: f64,
    expected_fails: f64,
}

/// Counts of a check, or of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Counts {
    runs: u64,
    tests: u64,
    raised: Crossed,
    default: Crossed,
}

impl Crossed {
    fn add(&mut self, other: &Self) {
        self.suspicions += other.suspicions;
        self.fails += other.fails;
        self.expected_suspicions += other.expected_suspicions;
        self.expected_fails += other.expected_fails;
    }
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.runs += other.runs;
        self.tests += other.tests;
        self.raised.add(&other.raised);
        self.default.add(&other.default);
    }

    fn alarms(&self, check: &str) -> CheckAlarms {
        let Self { runs, tests, raised, default } = *self;
        let rate = |count, expected| Rate::new(count, runs, expected);
        CheckAlarms {
            check: check.into(),
            runs,
            tests,
            suspicions: rate(raised.suspicions, raised.expected_suspicions),
            fails: rate(raised.fails, raised.expected_fails),
            default_suspicions: rate(default.suspicions, default.expected_suspicions),
            default_fails: rate(default.fails, default.expected_fails),
        }
    }
}

/// What one run, or all of a seed, gave.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Observed {
    in_all: Counts,
    checks: BTreeMap<String, Counts>,
    alarms: Vec<Alarm>,
    run_again: u64,
    undecided: u64,
    p_values: Vec<Figure>,
    density_p_values: Vec<Figure>,
    left_out: u64,
}

impl Observed {
    fn add(&mut self, mut other: Self) {
        self.in_all.add(&other.in_all);
        for (check, counts) in &other.checks {
            self.checks.entry(check.clone()).or_default().add(counts);
        }
        self.alarms.append(&mut other.alarms);
        self.run_again += other.run_again;
        self.undecided += other.undecided;
        self.p_values.append(&mut other.p_values);
        self.density_p_values.append(&mut other.density_p_values);
        self.left_out += other.left_out;
    }
}

/// Whether the first attempt crossed its threshold.
fn is_suspected(finding: &Finding) -> bool {
    finding.attempts.len() > 1 || is_fail(finding)
}

/// A waiver hides a failure from readers of a report, not from here.
fn is_fail(finding: &Finding) -> bool {
    matches!(finding.outcome.verdict, Verdict::Fail | Verdict::Waived)
}

fn is_alarm(finding: &Finding) -> bool {
    is_fail(finding) || matches!(finding.outcome.verdict, Verdict::Error | Verdict::Warn)
}

/// Runs a case at the raised budget, and at the default one where that could be told
/// apart.
///
/// Without a suspicion at the raised budget there is none at the default one, and no
/// other `fail`, `error` or `warn`: random numbers, looks and evidence are the same, and
/// what a check compares with its threshold does not depend on its share, or only so
/// that less of it crosses where the share is smaller (the normal bound of
/// `goodness-of-fit`). What may differ is a `pass`, whose detection limit is worse under
/// a smaller share. So only runs with a suspicion are run again.
fn observe(case: &Arc<Case<'static>>, seed: u64, scope: &Scope, work: &Work) -> Observed {
    let (raised_plan, raised) = work.alone(case, seed, scope.raised);
    let result = &raised.cases[0];
    let again = result.findings.iter().any(is_suspected);
    let second = again.then(|| work.alone(case, seed, scope.default));
    let default_share = Budget { total: scope.default }.share(raised.tests);
    let (plan, share, last) = match &second {
        Some((plan, results)) => (plan, results.share, &results.cases[0]),
        None => (&raised_plan, default_share, result),
    };
    let mut observed = Observed { run_again: u64::from(again), ..Observed::default() };
    for (finding, last) in result.findings.iter().zip(&last.findings) {
        if finding.outcome.verdict == Verdict::Skipped {
            continue;
        }
        let tested = !finding.attempts.is_empty();
        let crossed = |finding: &Finding, share: f64| Crossed {
            suspicions: u64::from(is_suspected(finding)),
            fails: u64::from(is_fail(finding)),
            expected_suspicions: if tested { attempt(share) } else { 0.0 },
            expected_fails: if tested { share } else { 0.0 },
        };
        let counts = Counts {
            runs: 1,
            tests: u64::from(tested),
            raised: crossed(finding, raised.share),
            default: crossed(last, default_share),
        };
        observed.checks.insert(finding.check.into(), counts);
        observed.in_all.add(&counts);
        let undecided = finding.outcome.verdict == Verdict::Inconclusive && !is_suspected(finding);
        observed.undecided += u64::from(undecided);
        if is_alarm(last) {
            observed.alarms.push(Alarm {
                case: case.label(),
                seed,
                check: last.check.into(),
                verdict: last.outcome.verdict,
                message: last.outcome.message.clone(),
                command: reproduce("gonio", plan, case, share, last.check),
            });
        }
    }
    // A run has its false alarm once, however many of its checks have one.
    let all = &mut observed.in_all;
    all.runs = 1;
    for crossed in [&mut all.raised, &mut all.default] {
        crossed.suspicions = crossed.suspicions.min(1);
        crossed.fails = crossed.fails.min(1);
    }
    observe_p_values(result, &mut observed);
    observed
}

/// The p-values of a run at the fixed number of draws, or that it has too few.
fn observe_p_values(result: &CaseResult, observed: &mut Observed) {
    let Some((evidence, draws)) = result.evidence.as_ref().and_then(|e| Some((e, e.draws.first()?))) else {
        return;
    };
    if draws.samples < result.case.settings.samples {
        observed.left_out = 1;
        return;
    }
    observed.p_values = level_p_values(evidence).into_iter().map(Figure).collect();
    observed.density_p_values = density_p_values(evidence).into_iter().map(Figure).collect();
}

impl FalseAlarms {
    /// Runs every case of `scope` at every seed.
    ///
    /// # Errors
    /// As [`Work::unit`].
    pub fn measure(scope: &Scope, work: &Work) -> Result<Self, Unfinished> {
        work.begin("false alarms", scope.cases.len() * scope.seeds as usize);
        let mut all = Observed::default();
        for seed in (0..scope.seeds).map(|k| work.seed.wrapping_add(k)) {
            let sum_up = |runs: Vec<Observed>| {
                let mut sum = Observed::default();
                runs.into_iter().for_each(|run| sum.add(run));
                sum
            };
            let key = format!("false-alarms/{seed}");
            all.add(work.unit(&key, &scope.cases, |case| observe(case, seed, scope, work), sum_up)?);
        }
        let uniformity =
            |p_values: &[Figure]| Uniformity::of(&mut p_values.iter().map(|p| p.0).collect::<Vec<f64>>());
        let of_check = |check: &&dyn checks::Check| Some(all.checks.get(check.id())?.alarms(check.id()));
        Ok(Self {
            suite: scope.suite.clone(),
            cases: scope.cases.len() as u64,
            seeds: scope.seeds,
            raised_budget: scope.raised,
            default_budget: scope.default,
            in_all: all.in_all.alarms("all"),
            checks: checks::all().iter().filter_map(of_check).collect(),
            alarms: all.alarms,
            run_again: all.run_again,
            undecided: all.undecided,
            p_values: uniformity(&all.p_values),
            density_p_values: uniformity(&all.density_p_values),
            left_out: all.left_out,
        })
    }

    /// Every row: all, then check by check.
    pub fn rows(&self) -> impl Iterator<Item = &CheckAlarms> {
        std::iter::once(&self.in_all).chain(&self.checks)
    }

    /// The level of each of the statements that its errors make.
    pub fn level(&self) -> f64 {
        let statements = 2 * (self.rows().count() + Uniformity::STATEMENTS);
        LEVEL / statements as f64
    }

    /// More false alarms than nominal, or than none; p-values that are not uniform; and
    /// nothing run.
    pub fn wrong(&self) -> Vec<String> {
        let mut errors = Vec::new();
        if self.in_all.runs == 0 {
            errors.push("nothing was run".into());
        }
        for alarm in &self.alarms {
            let Alarm { case, seed, check, verdict, message, command } = alarm;
            errors.push(format!(
                "a correct subject has `{}` at the default budget: {check} of {case}, seed {seed}: {message} ({command})",
                verdict.word()
            ));
        }
        let level = self.level();
        for row in self.rows() {
            for (rate, what) in [(&row.suspicions, "suspicions"), (&row.fails, "failures")] {
                if rate.exceeds(level) {
                    errors.push(format!(
                        "{} {what} ({}) in {} runs, where {:.1} are nominal at a budget of {:e} a run",
                        rate.count,
                        row.check,
                        rate.of,
                        rate.expected(),
                        self.raised_budget
                    ));
                }
            }
        }
        errors.extend(self.p_values.errors(level));
        errors.extend(
            self.density_p_values.errors(level).into_iter().map(|e| format!("along the density: {e}")),
        );
        errors
    }
}
