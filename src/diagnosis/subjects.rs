//! Diagnoses the failing subjects of a run, within the time that one may take.

use super::contest::{Verdict, diagnose};
use super::explanation::Explanation;
use crate::bsdf::{
    Description, Direction, FresnelFunction, NativeCells, NormalDistribution, Samples, Subject, SubjectError,
    Transport,
};
use crate::checks;
use crate::engine::{CaseResult, Options, Results};
use crate::evidence::Halt;
use crate::suite::Case;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// How often a run looks whether it was told to stop.
const TICK: Duration = Duration::from_millis(50);

/// Where no diagnosis has ended this long after a case's time limit, a call does not
/// return: those that are open are given up, and their threads with them.
const GRACE: Duration = Duration::from_secs(10);

/// A failing subject as it is spelled, and what a contest says of it.
pub type Diagnosed = (String, Verdict);

/// Diagnoses the failing subjects of a run in parallel, in the order of the plan;
/// none after an interrupt, none that hung. `more` are explanations besides those
/// that come with gonio.
pub fn diagnose_all(
    results: &Results<'static>,
    more: &Arc<Vec<Box<dyn Explanation>>>,
    options: &Options,
) -> Vec<Diagnosed> {
    let failing = failing(results);
    let threads = options.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (Ok(pool), false) = (pool, failing.is_empty() || options.stop.load(Ordering::Relaxed)) else {
        return Vec::new();
    };
    let mut found: Vec<Option<Diagnosed>> = failing.iter().map(|_| None).collect();
    let longest = failing.iter().flatten().map(|c| c.case.settings.time_limit).max().unwrap_or_default();
    let (sender, receiver) = mpsc::channel();
    for (k, cases) in failing.iter().enumerate() {
        // A thread that is given up keeps what it works on.
        let cases: Vec<CaseResult<'static>> = cases.iter().map(|c| (*c).clone()).collect();
        let (sender, more, stop) = (sender.clone(), more.clone(), options.stop.clone());
        pool.spawn(move || {
            let verdict = one(&cases.iter().collect::<Vec<_>>(), &more, &stop);
            let _ = sender.send((k, verdict));
        });
    }
    let (mut open, mut last) = (failing.len(), Instant::now());
    while open > 0 && !options.stop.load(Ordering::Relaxed) {
        match receiver.recv_timeout(TICK) {
            Ok((k, verdict)) => {
                found[k] = verdict.map(|v| (failing[k][0].case.spelling.clone(), v));
                open -= 1;
                last = Instant::now();
            }
            Err(RecvTimeoutError::Timeout) if last.elapsed() < longest + GRACE => {}
            Err(_) => break,
        }
    }
    found.into_iter().flatten().collect()
}

/// Diagnoses the failing subjects of a run on this thread, as unit tests want it.
pub fn diagnose_here(results: &Results, more: &[Box<dyn Explanation>]) -> Vec<Diagnosed> {
    let stop = Arc::new(AtomicBool::new(false));
    let said = |cases: Vec<&CaseResult>| Some((cases[0].case.spelling.clone(), one(&cases, more, &stop)?));
    failing(results).into_iter().filter_map(said).collect()
}

/// An error is no measurement: there is nothing to explain.
fn fails(case: &CaseResult) -> bool {
    case.findings.iter().any(|f| f.outcome.verdict == checks::Verdict::Fail)
}

/// Whether a call to the subject may not return: one did not, or not in time.
fn hung(case: &CaseResult) -> bool {
    match &case.evidence {
        Some(evidence) => {
            let late = |halt: &Halt| matches!(halt, Halt::Subject(SubjectError::TimedOut { .. }));
            evidence.halts.iter().any(|(_, halt)| late(halt))
        }
        None => case.worst() == checks::Verdict::Error,
    }
}

/// The cases of each subject that fails and may be called again.
fn failing<'r, 'a>(results: &'r Results<'a>) -> Vec<Vec<&'r CaseResult<'a>>> {
    let mut subjects: Vec<Vec<&CaseResult>> = Vec::new();
    for case in &results.cases {
        match subjects.iter_mut().find(|s| s[0].case.spelling == case.case.spelling) {
            Some(cases) => cases.push(case),
            None => subjects.push(vec![case]),
        }
    }
    subjects.retain(|cases| cases.iter().any(|c| fails(c)) && !cases.iter().any(|c| hung(c)));
    subjects
}

/// The verdict on one subject; `None` where time was up or gonio itself failed.
fn one(cases: &[&CaseResult], more: &[Box<dyn Explanation>], stop: &Arc<AtomicBool>) -> Option<Verdict> {
    let limit = cases.iter().map(|c| c.case.settings.time_limit).max()?;
    let end = End { at: Instant::now() + limit, limit, stop: stop.clone() };
    let cases: Vec<CaseResult> = cases.iter().map(|c| until(&end, c)).collect();
    let cases: Vec<&CaseResult> = cases.iter().collect();
    let verdict = || diagnose(&cases, more, &cases[0].case.parameters);
    let verdict = catch_unwind(AssertUnwindSafe(verdict)).ok()?;
    // What a subject did not answer in time must not speak against a claim.
    end.check().is_ok().then_some(verdict)?
}

/// When a diagnosis must end.
#[derive(Clone)]
struct End {
    at: Instant,
    limit: Duration,
    stop: Arc<AtomicBool>,
}

impl End {
    fn check(&self) -> Result<(), SubjectError> {
        if Instant::now() < self.at && !self.stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        Err(SubjectError::TimedOut { limit_s: self.limit.as_secs_f64(), state: "in its diagnosis".into() })
    }
}

/// The case with a subject that answers until the end only.
fn until<'a>(end: &End, result: &CaseResult<'a>) -> CaseResult<'a> {
    let bounded = |subject: &Arc<dyn Subject + 'a>| -> Arc<dyn Subject + 'a> {
        Arc::new(Bounded { subject: subject.clone(), end: end.clone() })
    };
    let mut case = Case::clone(&result.case);
    case.subject = bounded(&case.subject);
    case.company.reference = case.company.reference.map(|(name, subject)| (name, bounded(&subject)));
    CaseResult { case: Arc::new(case), ..result.clone() }
}

struct Bounded<'a> {
    subject: Arc<dyn Subject + 'a>,
    end: End,
}

impl Subject for Bounded<'_> {
    fn describe(&self) -> Description {
        self.subject.describe()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.end.check()?;
        self.subject.eval(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.end.check()?;
        self.subject.pdf(wo, wi, transport, out)
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        self.end.check()?;
        self.subject.sample(wo, u, transport, out)
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        self.subject.hints(wo)
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        self.subject.cells(wo)
    }

    fn distribution(&self) -> Option<&dyn NormalDistribution> {
        self.subject.distribution()
    }

    fn fresnel(&self) -> Option<&dyn FresnelFunction> {
        self.subject.fresnel()
    }
}
