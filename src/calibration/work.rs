//! What every part of a calibration works with.

use super::progress::{Progress, Unfinished};
use crate::engine::{Options, Results, run_here};
use crate::registry::Registry;
use crate::suite::{Case, Embedded, Overrides, Plan, embedded, load};
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// All parts within two minutes of two cores.
    Quick,
    /// All parts within an hour.
    Full,
}

impl Effort {
    /// The embedded suite whose subjects, settings and thresholds are taken.
    pub(super) fn suite(self) -> Embedded {
        let name = match self {
            Self::Quick => "quick",
            Self::Full => "seed",
        };
        embedded(name).expect("the suite comes with gonio")
    }

    /// The plan of that suite with its own seed.
    pub(super) fn plan(self) -> Plan<'static> {
        let Embedded { name, text } = self.suite();
        let loaded = load(name, text, &Registry::builtin(), &Overrides::default());
        loaded.unwrap_or_else(|e| panic!("the suite `{name}` is right: {e:?}")).plan
    }
}

/// What is told on the way, from any thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<'e> {
    /// A part begins, of so many steps.
    Part {
        /// What is measured.
        title: &'e str,
        /// Its steps.
        steps: u64,
    },
    /// So many steps are done, now or by the process that was interrupted.
    Steps(u64),
}

/// Threads, saved units of work, and someone who watches.
pub struct Work<'w> {
    /// How much is measured.
    pub effort: Effort,
    /// The first seed of all random numbers.
    pub seed: u64,
    /// Sets of random parameters at which each mutant is diagnosed.
    pub trials: u64,
    progress: &'w Progress,
    pool: ThreadPool,
    options: Options,
    observe: &'w (dyn Fn(Event) + Sync),
}

impl<'w> Work<'w> {
    /// On so many threads, by `RAYON_NUM_THREADS` or the number of processors where
    /// `None`.
    ///
    /// # Errors
    /// No thread can be started.
    pub fn new(
        effort: Effort,
        seed: u64,
        threads: Option<usize>,
        progress: &'w Progress,
        observe: &'w (dyn Fn(Event) + Sync),
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let name = |k| format!("gonio-{k}");
        let pool = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).thread_name(name).build()?;
        let options = Options { threads: Some(1), stop: progress.stop().clone(), ..Options::default() };
        Ok(Self { effort, seed, trials: super::confusion::TRIALS, progress, pool, options, observe })
    }

    /// Tells that a part begins.
    pub fn begin(&self, title: &str, steps: usize) {
        (self.observe)(Event::Part { title, steps: steps as u64 });
    }

    /// A unit that is computed once, whatever ends the process in between: one step
    /// for each of `items`, in parallel, and what `sum_up` makes of them in their
    /// order. The same bits for any number of threads.
    ///
    /// # Errors
    /// As [`Progress::unit`].
    pub fn unit<I: Sync, R: Send, T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        items: &[I],
        step: impl Fn(&I) -> R + Sync,
        sum_up: impl FnOnce(Vec<R>) -> T,
    ) -> Result<T, Unfinished> {
        let done = self.progress.has(key);
        let value = self.progress.unit(key, || {
            let one = |item: &I| {
                // After a stop nothing of the unit is kept.
                let result = (!self.progress.is_stopped()).then(|| step(item));
                (self.observe)(Event::Steps(1));
                result
            };
            // Steps differ much in length: none waits in a bundle with others.
            let results: Option<Vec<R>> =
                self.pool.install(|| items.par_iter().with_max_len(1).map(one).collect());
            results.map(sum_up)
        })?;
        if done {
            (self.observe)(Event::Steps(items.len() as u64));
        }
        Ok(value)
    }

    /// Runs a plan on the thread of the step that asks for it.
    pub fn run(&self, plan: &Plan<'static>) -> Results<'static> {
        run_here(plan, &self.options)
    }

    /// Runs a case alone, as `gonio check` does: `budget` is the probability that it
    /// shows any failure though its subject is right, shared out equally over its
    /// statistical tests. Random numbers are those of the case in any plan of this
    /// seed.
    pub fn alone(
        &self,
        case: &Arc<Case<'static>>,
        seed: u64,
        budget: f64,
    ) -> (Plan<'static>, Results<'static>) {
        let plan = Plan {
            suite: "calibration".into(),
            seed,
            false_alarm: budget,
            share: None,
            cases: vec![case.clone()],
        };
        let results = self.run(&plan);
        (plan, results)
    }
}
