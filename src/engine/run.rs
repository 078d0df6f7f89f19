//! Runs all cases of a plan on a pool of threads.

use super::allotment::{Allotment, Draws};
use super::case::{not_run, run_case, statistical_tests};
use super::results::{CaseResult, Event, Results};
use crate::bsdf::SubjectError;
use crate::checks::Outcome;
use crate::evidence::Watch;
use crate::statistics::budget::Budget;
use crate::suite::{Case, Plan};
use std::collections::{HashMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How a plan is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Threads; by `RAYON_NUM_THREADS` or the number of processors where `None`.
    pub threads: Option<usize>,
    /// Set from outside to stop: what is measured by then is kept.
    pub stop: Arc<AtomicBool>,
    /// Stop by itself after this time.
    pub deadline: Option<Duration>,
    /// Numbers of the cases to run; all where `None`.
    pub cases: Option<Vec<usize>>,
    /// How many draws cases get.
    pub draws: Draws,
}

/// How often the run looks for calls that do not return.
const TICK: Duration = Duration::from_millis(50);

/// A call that has not returned this long after its case's time limit is
/// given up, and its thread with it.
const GRACE: Duration = Duration::from_secs(1);

/// What workers tell the run.
enum Message {
    Started(usize, Arc<Watch>),
    Done(Box<CaseResult<'static>>),
}

/// What workers share.
struct Shared {
    cases: Vec<Arc<Case<'static>>>,
    queue: Mutex<VecDeque<usize>>,
    stop: Arc<AtomicBool>,
    seed: u64,
    share: f64,
    allotment: Allotment,
}

/// Runs a plan. Results come in the plan's order and are the same bits for any
/// number of threads. `observe` is called on this thread only.
pub fn run(plan: &Plan<'static>, options: &Options, observe: &mut dyn FnMut(&Event)) -> Results<'static> {
    let start = Instant::now();
    let (tests, share) = shares(plan);
    let chosen = options.cases.clone().unwrap_or_else(|| (0..plan.cases.len()).collect());
    // A single case has no use for more than one thread.
    let pool = pool(if chosen.len() == 1 { 1 } else { options.threads.unwrap_or(0) });
    let threads = pool.current_num_threads();
    observe(&Event::Started { cases: chosen.len(), threads });
    let allotment = Allotment::new(&options.draws, plan, &chosen, threads);
    let shared = Arc::new(Shared {
        cases: plan.cases.clone(),
        queue: Mutex::new(allotment.order(plan, &chosen).into()),
        // Its own: that time is up for this run stops no other.
        stop: Arc::new(AtomicBool::new(false)),
        seed: plan.seed,
        share,
        allotment,
    });
    let (sender, receiver) = mpsc::channel();
    for _ in 0..threads {
        spawn_worker(&pool, &shared, &sender);
    }
    // Threads stuck in a call are replaced by pools of one.
    let mut pools = vec![pool];
    let mut running: HashMap<usize, Arc<Watch>> = HashMap::new();
    let mut done: Vec<Option<CaseResult<'static>>> = plan.cases.iter().map(|_| None).collect();
    let mut open = chosen.len();
    while open > 0 {
        if options.stop.load(Ordering::Relaxed) || options.deadline.is_some_and(|d| start.elapsed() > d) {
            shared.stop.store(true, Ordering::Relaxed);
        }
        let finished = match receiver.recv_timeout(TICK) {
            Ok(Message::Started(index, watch)) => {
                observe(&Event::CaseStarted(&plan.cases[index]));
                running.insert(index, watch);
                continue;
            }
            Ok(Message::Done(result)) => vec![*result],
            Err(RecvTimeoutError::Timeout) => {
                let stuck = stuck(&plan.cases, &running);
                for _ in &stuck {
                    let extra = pool_of_one();
                    spawn_worker(&extra, &shared, &sender);
                    pools.push(extra);
                }
                stuck
            }
            Err(RecvTimeoutError::Disconnected) => break,
        };
        for result in finished {
            running.remove(&result.index);
            // A case that was given up may yet return.
            if done[result.index].is_none() {
                observe(&Event::CaseDone(&result));
                open -= 1;
                let index = result.index;
                done[index] = Some(result);
            }
        }
        if shared.stop.load(Ordering::Relaxed) {
            open -= skip_the_rest(&shared, &mut done);
        }
    }
    let unfinished = done.iter().flatten().filter(|r| r.evidence.is_none() && is_skipped(r)).count();
    let stopped = shared.stop.load(Ordering::Relaxed);
    let late = options.deadline.is_some_and(|d| start.elapsed() > d);
    let why = match &options.draws {
        _ if stopped && !late => "interrupted",
        Draws::Given(_) => "as in the run whose allocation this one follows",
        _ => "time was up",
    };
    let refused = !matches!(options.draws, Draws::Planned) && unfinished > 0;
    let partial =
        (stopped || refused).then(|| format!("{why}: {unfinished} of {} cases were not begun", chosen.len()));
    let cases = done.into_iter().flatten().collect();
    let allocation = shared.allotment.dealt();
    Results { cases, share, tests, allocation, partial, seconds: start.elapsed().as_secs_f64() }
}

/// Runs the cases one after the other on this thread, as unit tests want it.
pub fn run_here<'a>(plan: &Plan<'a>, options: &Options) -> Results<'a> {
    let start = Instant::now();
    let (tests, share) = shares(plan);
    let mut cases = Vec::new();
    let mut left = 0;
    for (index, case) in plan.cases.iter().enumerate() {
        if options.deadline.is_some_and(|d| start.elapsed() > d) {
            left += 1;
            cases.push(not_run(index, case, &Outcome::skipped("time was up before this case")));
            continue;
        }
        let watch = Watch::new(case.settings.time_limit, options.stop.clone());
        let watch = Arc::new(watch.until(options.deadline.map(|d| start + d)));
        cases.push(run_case(index, case, plan.seed, share, &watch));
    }
    let partial =
        (left > 0).then(|| format!("time was up: {left} of {} cases were not begun", plan.cases.len()));
    Results { cases, share, tests, allocation: None, partial, seconds: start.elapsed().as_secs_f64() }
}

/// Number of statistical tests of a plan, and what each may spend.
pub fn shares(plan: &Plan) -> (usize, f64) {
    let tests = plan.cases.iter().map(|c| statistical_tests(c)).sum();
    (tests, plan.share.unwrap_or_else(|| Budget { total: plan.false_alarm }.share(tests)))
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .thread_name(|k| format!("gonio-{k}"))
        .build()
        .unwrap_or_else(|_| pool_of_one())
}

fn pool_of_one() -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started")
}

fn spawn_worker(pool: &rayon::ThreadPool, shared: &Arc<Shared>, sender: &Sender<Message>) {
    let (shared, sender) = (shared.clone(), sender.clone());
    pool.spawn(move || {
        while !shared.stop.load(Ordering::Relaxed) {
            let Some(index) = shared.queue.lock().ok().and_then(|mut q| q.pop_front()) else { return };
            let case = &shared.cases[index];
            // Time spent on waiting for others is not the case's.
            let _alone = case.subject.alone().map(|one| one.lock().unwrap_or_else(PoisonError::into_inner));
            let case = match shared.allotment.grant(index, case) {
                Ok(case) => case,
                Err(why) => {
                    let skipped = not_run(index, case, &Outcome::skipped(why));
                    if sender.send(Message::Done(Box::new(skipped))).is_err() {
                        return;
                    }
                    continue;
                }
            };
            let watch = Arc::new(Watch::new(case.settings.time_limit, shared.stop.clone()));
            if sender.send(Message::Started(index, watch.clone())).is_err() {
                return;
            }
            let run = || run_case(index, &case, shared.seed, shared.share, &watch);
            let result = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|payload| {
                let text = payload
                    .downcast_ref::<String>()
                    .map(String::as_str)
                    .or_else(|| payload.downcast_ref::<&str>().copied())
                    .unwrap_or("a panic without text");
                let outcome = Outcome::error(format!("gonio itself failed on this case: {text}"));
                not_run(index, &case, &outcome)
            });
            shared.allotment.settle(index, result.seconds);
            if sender.send(Message::Done(Box::new(result))).is_err() {
                return;
            }
        }
    });
}

/// Cases whose call does not return.
fn stuck(cases: &[Arc<Case<'static>>], running: &HashMap<usize, Arc<Watch>>) -> Vec<CaseResult<'static>> {
    let late = |watch: &Watch| watch.in_call().is_some_and(|t| t > watch.limit() + GRACE);
    let mut stuck: Vec<CaseResult<'static>> = running
        .iter()
        .filter(|(_, watch)| late(watch))
        .map(|(index, watch)| {
            let error = SubjectError::TimedOut {
                limit_s: watch.limit().as_secs_f64(),
                state: "a call does not return; its thread was given up".into(),
            };
            not_run(*index, &cases[*index], &Outcome::error(error.to_string()))
        })
        .collect();
    stuck.sort_by_key(|r| r.index);
    stuck
}

/// After a stop: cases that nobody took yet. Returns how many.
fn skip_the_rest(shared: &Shared, done: &mut [Option<CaseResult<'static>>]) -> usize {
    let Ok(mut queue) = shared.queue.lock() else { return 0 };
    let mut count = 0;
    for index in queue.drain(..) {
        let outcome = Outcome::skipped("the run was stopped before this case");
        done[index] = Some(not_run(index, &shared.cases[index], &outcome));
        count += 1;
    }
    count
}

fn is_skipped(result: &CaseResult) -> bool {
    result.findings.iter().all(|f| f.outcome.verdict == crate::checks::Verdict::Skipped)
}
