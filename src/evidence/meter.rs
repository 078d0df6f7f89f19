//! Calls a subject on behalf of the measurements: counts, times, catches
//! panics, and looks at every number that comes back.

use super::tally::{Place, Tally};
use crate::bsdf::MAX_CHANNELS;
use crate::bsdf::{
    Cosine, Description, Direction, Lobe, NativeCells, Precision, Samples, Subject, SubjectError, Transport,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Why a measurement ended early.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Halt {
    /// The subject failed.
    #[error(transparent)]
    Subject(#[from] SubjectError),
    /// The run was told to stop.
    #[error("the run was stopped before this was measured")]
    Stopped,
}

/// Number of directions evaluated, by function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Evaluations {
    /// Rows of eval.
    pub eval: u64,
    /// Rows of pdf.
    pub pdf: u64,
    /// Rows of sample.
    pub sample: u64,
}

impl Evaluations {
    /// All functions together.
    pub fn total(&self) -> u64 {
        self.eval + self.pdf + self.sample
    }
}

/// The time that a subject may take, and whether the run is to stop. Shared
/// with whoever watches a case from outside.
#[derive(Debug)]
pub struct Watch {
    limit: Duration,
    deadline: Option<Instant>,
    stop: Arc<AtomicBool>,
    origin: Instant,
    /// Microseconds from `origin` to the start of the call under way, plus
    /// one; 0 between calls.
    call_started: AtomicU64,
}

impl Watch {
    /// A subject may take `limit` in all, unless `stop` is set before.
    pub fn new(limit: Duration, stop: Arc<AtomicBool>) -> Self {
        Self { limit, deadline: None, stop, origin: Instant::now(), call_started: AtomicU64::new(0) }
    }

    /// Stops by itself at `deadline`.
    pub fn until(mut self, deadline: Option<Instant>) -> Self {
        self.deadline = deadline;
        self
    }

    /// How long the call under way has taken.
    pub fn in_call(&self) -> Option<Duration> {
        let started = self.call_started.load(Ordering::Relaxed).checked_sub(1)?;
        Some(self.origin.elapsed().saturating_sub(Duration::from_micros(started)))
    }

    /// The limit.
    pub fn limit(&self) -> Duration {
        self.limit
    }
}

thread_local! {
    /// The panic message of the call under way on this thread.
    static PANIC: RefCell<Option<Option<String>>> = const { RefCell::new(None) };
}

/// Makes panics inside of a measured call silent and remembers their message
/// and place; other panics go where they went before.
fn listen_to_panics() {
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            let measured = PANIC.with_borrow_mut(|slot| match slot {
                Some(message) => {
                    let text = info.payload_as_str().unwrap_or("a panic without text");
                    let place = info.location().map(|l| format!(" at {}:{}", l.file(), l.line()));
                    *message = Some(format!("{text}{}", place.unwrap_or_default()));
                    true
                }
                None => false,
            });
            if !measured {
                usual(info);
            }
        }));
    });
}

/// What every number that a subject returns must satisfy, and how often it
/// did not. Where a number fails, measurements go on with 0 in its place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sanity {
    /// By the sentence that is broken.
    pub tallies: BTreeMap<String, Tally>,
    /// Numbers looked at.
    pub checked: u64,
}

impl Sanity {
    #[cold]
    fn broken(&mut self, sentence: &str, size: f64, place: Place) {
        let tally = self.tallies.entry(sentence.to_string()).or_insert_with(|| Tally::new(0.0));
        tally.look(if size.abs() > 0.0 { size.abs() } else { f64::INFINITY }, || place);
    }
}

/// How far |wi| may be from 1: rounding of a normalisation and a rotation.
fn length_tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F64 => 1e-9,
        Precision::F32 => 1e-5,
    }
}

/// A subject as the measurements see it.
pub struct Meter<'a> {
    subject: &'a dyn Subject,
    /// What it says of itself, with the claims in force.
    pub description: Description,
    /// Whether its eval holds the cosine; set by the probe of conventions.
    pub cosine: Cell<Cosine>,
    watch: Arc<Watch>,
    spent: Cell<Duration>,
    evaluations: Cell<Evaluations>,
    sanity: RefCell<Sanity>,
}

impl<'a> Meter<'a> {
    /// Measures `subject`, described with the claims in force.
    pub fn new(subject: &'a dyn Subject, description: Description, watch: Arc<Watch>) -> Self {
        listen_to_panics();
        let cosine = Cell::new(description.claims.cosine);
        Self {
            subject,
            description,
            cosine,
            watch,
            spent: Cell::default(),
            evaluations: Cell::default(),
            sanity: RefCell::default(),
        }
    }

    /// Asks any subject for its description, with the same protection.
    pub fn describe(subject: &dyn Subject) -> Result<Description, SubjectError> {
        listen_to_panics();
        let description = guarded("describe", || Ok(subject.describe()))?;
        let channels = description.channels.len();
        if !(1..=MAX_CHANNELS).contains(&channels) {
            return Err(SubjectError::Broken(format!(
                "it describes {channels} channels; a subject has 1 to {MAX_CHANNELS}"
            )));
        }
        Ok(description)
    }

    /// Number of channels.
    pub fn channels(&self) -> usize {
        self.description.channels.len()
    }

    /// Number of random numbers a sample, at least one.
    pub fn dimensions(&self) -> usize {
        self.description.dimensions.max(1)
    }

    /// Whether u has 24 bits, as f32 subjects get them.
    pub fn coarse_u(&self) -> bool {
        self.description.precision == Precision::F32
    }

    /// What was evaluated so far.
    pub fn evaluations(&self) -> Evaluations {
        self.evaluations.get()
    }

    /// What was found of the numbers so far.
    pub fn sanity(&self) -> Sanity {
        self.sanity.borrow().clone()
    }

    /// Directions of narrow peaks that the subject names.
    pub fn hints(&self, wo: Direction) -> Result<Vec<Direction>, Halt> {
        self.call("hints", || Ok(self.subject.hints(wo)))
    }

    /// The cells of a table, given `wo`.
    pub fn cells(&self, wo: Direction) -> Result<Option<NativeCells>, Halt> {
        self.call("cells", || Ok(self.subject.cells(wo)))
    }

    /// Calls a part of the subject, with the protection of all calls; `rows` are
    /// counted as values.
    pub(super) fn part<T>(
        &self,
        function: &'static str,
        rows: usize,
        f: impl FnOnce(&dyn Subject) -> Result<T, SubjectError>,
    ) -> Result<T, Halt> {
        let value = self.call(function, || f(self.subject))?;
        self.count(|e| e.eval += rows as u64);
        Ok(value)
    }

    /// `value` if it is finite and not negative; else 0, which
    /// [`sanity`](Self::sanity) tells of `function`.
    pub(super) fn sane(&self, function: &str, value: f64, place: impl FnOnce() -> Place) -> f64 {
        let mut sanity = self.sanity.borrow_mut();
        sanity.checked += 1;
        if value.is_finite() && value >= 0.0 {
            return value;
        }
        let sentence = if value.is_finite() { "() ≥ 0" } else { "() is finite" };
        sanity.broken(&format!("{function}{sentence}"), value, place().value(function, value));
        0.0
    }

    fn call<T>(
        &self,
        function: &'static str,
        f: impl FnOnce() -> Result<T, SubjectError>,
    ) -> Result<T, Halt> {
        let over = self.watch.deadline.is_some_and(|d| Instant::now() > d);
        if over || self.watch.stop.load(Ordering::Relaxed) {
            return Err(Halt::Stopped);
        }
        let start = Instant::now();
        let since = start.saturating_duration_since(self.watch.origin).as_micros() as u64;
        self.watch.call_started.store(since + 1, Ordering::Relaxed);
        let result = guarded(function, f);
        self.watch.call_started.store(0, Ordering::Relaxed);
        self.spent.set(self.spent.get() + start.elapsed());
        let value = result?;
        if self.spent.get() > self.watch.limit {
            let done = self.evaluations.get().total();
            return Err(Halt::Subject(SubjectError::TimedOut {
                limit_s: self.watch.limit.as_secs_f64(),
                state: format!("it was in {function}() after {done} directions"),
            }));
        }
        Ok(value)
    }

    fn count(&self, add: impl FnOnce(&mut Evaluations)) {
        let mut evaluations = self.evaluations.get();
        add(&mut evaluations);
        self.evaluations.set(evaluations);
    }

    /// Values f (cosine excluded, whatever the subject's convention) for each
    /// row of `wi`, row-major.
    pub fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut Vec<f64>,
    ) -> Result<(), Halt> {
        let channels = self.channels();
        out.clear();
        out.resize(wi.len() * channels, 0.0);
        self.call("eval", || self.subject.eval(wo, wi, transport, out))?;
        self.count(|e| e.eval += wi.len() as u64);
        let mut sanity = self.sanity.borrow_mut();
        sanity.checked += out.len() as u64;
        for (wi, row) in wi.iter().zip(out.chunks_exact_mut(channels)) {
            for f in row.iter_mut() {
                if !(f.is_finite() && *f >= 0.0) {
                    let sentence = if f.is_finite() { "eval() ≥ 0" } else { "eval() is finite" };
                    sanity.broken(sentence, *f, Place::pair(wo, *wi).value("eval", *f));
                    *f = 0.0;
                }
            }
            if self.cosine.get() == Cosine::Included {
                let cosine = wi.abs_cos_theta();
                for f in row {
                    *f = if cosine > 0.0 { *f / cosine } else { 0.0 };
                }
            }
        }
        Ok(())
    }

    /// Densities for each row of `wi`.
    pub fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut Vec<f64>,
    ) -> Result<(), Halt> {
        out.clear();
        out.resize(wi.len(), 0.0);
        self.call("pdf", || self.subject.pdf(wo, wi, transport, out))?;
        self.count(|e| e.pdf += wi.len() as u64);
        let mut sanity = self.sanity.borrow_mut();
        sanity.checked += out.len() as u64;
        for (wi, p) in wi.iter().zip(out) {
            if !(p.is_finite() && *p >= 0.0) {
                let sentence = if p.is_finite() { "pdf() ≥ 0" } else { "pdf() is finite" };
                sanity.broken(sentence, *p, Place::pair(wo, *wi).value("pdf", *p));
                *p = 0.0;
            }
        }
        Ok(())
    }

    /// One draw for each row of `u`. What is not what it must be is told by
    /// [`sanity`](Self::sanity): a weight counts as 0 then, and a draw without a
    /// direction or a density as no sample.
    pub fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), Halt> {
        let rows = u.len() / self.dimensions();
        out.clear(self.channels());
        self.call("sample", || {
            self.subject.sample(wo, u, transport, out)?;
            let lengths = [out.wi.len(), out.pdf.len(), out.lobe.len(), out.weight.len() / self.channels()];
            match lengths.into_iter().find(|l| *l != rows) {
                Some(got) => Err(SubjectError::WrongLength { function: "sample", expected: rows, got }),
                None => Ok(()),
            }
        })?;
        self.count(|e| e.sample += rows as u64);
        let tolerance = length_tolerance(self.description.precision);
        let mut sanity = self.sanity.borrow_mut();
        sanity.checked += rows as u64;
        if is_sound(out, tolerance) {
            return Ok(());
        }
        for k in 0..rows {
            if !out.lobe[k].is_valid() {
                continue;
            }
            let (wi, pdf) = (out.wi[k], out.pdf[k]);
            let length = (wi.dot(wi) - 1.0).abs();
            let weights = &out.weight[k * out.channels..(k + 1) * out.channels];
            if pdf == 0.0 {
                // Integrators drop such a draw: it is no sample.
                out.lobe[k] = Lobe::NONE;
                out.weight[k * out.channels..(k + 1) * out.channels].fill(0.0);
                continue;
            }
            let place = || Place::pair(wo, wi).drawn_by(&u[k * self.dimensions()..][..self.dimensions()]);
            if let Some(w) = weights.iter().find(|w| !(**w >= 0.0 && **w < f64::INFINITY)) {
                let sentence =
                    if w.is_finite() { "sample().weight ≥ 0" } else { "sample().weight is finite" };
                sanity.broken(sentence, *w, place().value("weight", *w));
                out.weight[k * out.channels..(k + 1) * out.channels].fill(0.0);
            }
            if !(length <= 2.0 * tolerance) {
                sanity.broken("|wi| = 1", wi.length() - 1.0, place().value("|wi|", wi.length()));
                out.lobe[k] = Lobe::NONE;
            }
            if !(pdf > 0.0 && pdf < f64::INFINITY) {
                let sentence = if pdf.is_finite() { "sample().pdf ≥ 0" } else { "sample().pdf is finite" };
                sanity.broken(sentence, pdf, place().value("sample.pdf", pdf));
                out.lobe[k] = Lobe::NONE;
            }
            if !out.lobe[k].is_valid() {
                out.weight[k * out.channels..(k + 1) * out.channels].fill(0.0);
            }
        }
        Ok(())
    }
}

/// Whether no row needs a closer look, told without a branch a row.
fn is_sound(samples: &Samples, tolerance: f64) -> bool {
    let positive = |x: f64| (x > 0.0) & (x < f64::INFINITY);
    let rows = samples.wi.iter().zip(&samples.pdf).zip(&samples.lobe);
    pulp::Arch::new().dispatch(|| {
        let drawn = rows.fold(true, |sound, ((wi, pdf), lobe)| {
            let unit = (wi.dot(*wi) - 1.0).abs() <= 2.0 * tolerance;
            sound & (!lobe.is_valid() | (unit & positive(*pdf)))
        });
        samples.weight.iter().fold(drawn, |sound, w| sound & (*w >= 0.0) & (*w < f64::INFINITY))
    })
}

/// Calls `function`; its panic is an error.
pub(crate) fn guarded<T>(
    function: &'static str,
    f: impl FnOnce() -> Result<T, SubjectError>,
) -> Result<T, SubjectError> {
    PANIC.set(Some(None));
    let result = catch_unwind(AssertUnwindSafe(f));
    let message = PANIC.replace(None).flatten();
    result.unwrap_or_else(|_| {
        Err(SubjectError::Panicked {
            function,
            message: message.unwrap_or_else(|| "a panic without text".into()),
        })
    })
}
