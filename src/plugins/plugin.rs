//! A plugin that was opened: its models, and the instances that answer for it.

use super::description::{Hello, hello};
use super::instance::{Fault, Instance};
use super::limits::Limits;
use super::route::Route;
use crate::bsdf::SubjectError;
use std::collections::{HashMap, HashSet};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// A subject is given up after so many instances ended under it: what crashes at
/// one direction is measured at the others, what hangs everywhere takes no more
/// than three time limits.
const ENDS: usize = 3;

/// An instance and the subjects that it made.
pub struct Running {
    /// Who answers.
    pub instance: Box<dyn Instance>,
    /// Its handles, by the number of the subject.
    pub handles: HashMap<u64, u64>,
}

/// A plugin that was opened.
pub struct Plugin {
    /// As it was written.
    pub name: String,
    /// What it says of itself.
    pub hello: Hello,
    route: Route,
    limits: Limits,
    pool: Mutex<Pool>,
    free: Condvar,
    /// Held for the length of a case where there may only be one instance.
    pub alone: Option<Mutex<()>>,
}

#[derive(Default)]
struct Pool {
    idle: Vec<Running>,
    busy: usize,
    ends: HashMap<u64, Vec<String>>,
    /// Subjects that instances forget before they work again.
    forgotten: HashSet<u64>,
}

impl Plugin {
    /// Starts a first instance and reads what it says of itself.
    pub fn open(name: &str, route: Route, limits: &Limits) -> Result<Self, Fault> {
        let mut instance = route.start(limits)?;
        let hello = hello(&instance.describe()?)?;
        // Two that draw by themselves would draw the same.
        let alone = !hello.parallel || hello.models.iter().any(|model| model.draws_by_itself());
        let idle = vec![Running { instance, handles: HashMap::new() }];
        Ok(Self {
            name: name.into(),
            hello,
            route,
            limits: *limits,
            pool: Mutex::new(Pool { idle, ..Pool::default() }),
            free: Condvar::new(),
            alone: alone.then(Mutex::default),
        })
    }

    /// Lets an instance work for the subject `subject`.
    pub fn with<T>(
        &self,
        subject: u64,
        work: impl FnOnce(&mut Running) -> Result<T, Fault>,
    ) -> Result<T, SubjectError> {
        let mut lent = self.lend(subject)?;
        if let Some(running) = &mut lent.running {
            let stale: Vec<u64> = {
                let pool = self.pool();
                running.handles.keys().filter(|subject| pool.forgotten.contains(subject)).copied().collect()
            };
            if !running.forget(&stale) {
                lent.running = None;
            }
        }
        let running = match &mut lent.running {
            Some(running) => running,
            none => {
                let instance = self.route.start(&self.limits).map_err(|fault| self.note(subject, fault))?;
                none.insert(Running { instance, handles: HashMap::new() })
            }
        };
        let result = work(running);
        if let Err(Fault::Ended(_)) = result {
            lent.running = None;
        }
        result.map_err(|fault| self.note(subject, fault))
    }

    /// An idle instance, or room for one.
    fn lend(&self, subject: u64) -> Result<Lent<'_>, SubjectError> {
        let mut pool = self.pool();
        loop {
            if let Some(ends) = pool.ends.get(&subject).filter(|ends| ends.len() >= ENDS) {
                let given_up = format!("it was given up after {ENDS} such ends; first, {}", ends[0]);
                return Err(SubjectError::Broken(given_up));
            }
            let running = pool.idle.pop();
            if running.is_some() || self.alone.is_none() || pool.busy == 0 {
                pool.busy += 1;
                return Ok(Lent { plugin: self, running });
            }
            pool = self.free.wait(pool).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn note(&self, subject: u64, fault: Fault) -> SubjectError {
        match fault {
            Fault::Refused(why) => SubjectError::Refused(why),
            Fault::Ended(how) => {
                self.pool().ends.entry(subject).or_default().push(how.clone());
                SubjectError::Broken(how)
            }
        }
    }

    fn pool(&self) -> MutexGuard<'_, Pool> {
        self.pool.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Ends of instances under a subject count no more.
    pub fn forgive(&self, subject: u64) {
        self.pool().ends.remove(&subject);
    }

    /// Lets instances forget a subject: the idle ones now, the others before they work
    /// again.
    pub fn forget(&self, subject: u64) {
        let mut pool = self.pool();
        pool.ends.remove(&subject);
        if pool.busy > 0 {
            pool.forgotten.insert(subject);
        }
        let idle = std::mem::take(&mut pool.idle);
        pool.busy += idle.len();
        drop(pool);
        // Nobody waits for the pool meanwhile.
        for mut running in idle {
            let alive = running.forget(&[subject]);
            drop(Lent { plugin: self, running: alive.then_some(running) });
        }
    }
}

impl Running {
    /// Whether it lives on without these subjects.
    fn forget(&mut self, subjects: &[u64]) -> bool {
        subjects.iter().all(|subject| match self.handles.remove(subject) {
            Some(handle) => !matches!(self.instance.destroy(handle), Err(Fault::Ended(_))),
            None => true,
        })
    }
}

/// An instance while it works, brought back whatever happens.
struct Lent<'a> {
    plugin: &'a Plugin,
    /// `None` before it is started, and after it ended.
    running: Option<Running>,
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        let mut pool = self.plugin.pool();
        pool.busy -= 1;
        pool.idle.extend(self.running.take());
        drop(pool);
        self.plugin.free.notify_all();
    }
}
