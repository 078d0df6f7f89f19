//! What a case costs, guessed before it is run.

use crate::evidence::{BLOCK, Meter, Watch};
use crate::statistics::streams::StreamKey;
use crate::suite::Case;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Directions that a case of the default suite evaluates besides its draws (medians of
/// reports/seed: 66 k, 118 k and 146 k samples, of which 131 k are draws, and 16 k of the
/// others are matched with them).
const EVALS: f64 = 50e3;
const PDFS: f64 = 100e3;
const SAMPLES: f64 = 15e3;

/// Seconds that gonio itself spends on a draw, and on the rest of such a case. Guesses:
/// what cases really take corrects them all at once.
const HARNESS_DRAW: f64 = 20e-9;
const HARNESS_CASE: f64 = 10e-3;

/// One in so many draws is matched by one of the cosine, with eval and pdf.
const PER_LIGHT: f64 = 8.0;

/// Rows of a first, careful call; of a slow subject it says enough.
const FEW: usize = 64;

/// A call that takes so many seconds is timed well enough.
const LONG: f64 = 1e-3;

/// Seconds of one thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Besides draws; nearly the same for any number of them.
    pub fixed: f64,
    /// A draw.
    pub draw: f64,
}

impl Cost {
    /// Of a case, by timing calls of its subject. A subject that fails costs little.
    pub fn of(case: &Case) -> Self {
        let [sample, eval, pdf] = timed(case).unwrap_or_default();
        Self {
            fixed: HARNESS_CASE + SAMPLES * sample + EVALS * eval + PDFS * pdf,
            draw: HARNESS_DRAW + sample + (eval + pdf) / PER_LIGHT,
        }
    }

    /// Of a case with so many draws.
    pub fn with(&self, draws: f64) -> f64 {
        self.fixed + self.draw * draws
    }
}

/// Seconds a row of sample, eval and pdf; 0 where the subject has none.
fn timed(case: &Case) -> Option<[f64; 3]> {
    let watch = Arc::new(Watch::new(case.settings.time_limit, Arc::new(AtomicBool::new(false))));
    let description = Meter::describe(&*case.subject).ok()?;
    let has = description.has;
    let meter = Meter::new(&*case.subject, description, watch);
    let (wo, transport) = (case.wo(), case.transport);
    let mut stream = StreamKey::new(0).with("stage", "cost").block(0);
    let mut u = vec![0.0; BLOCK as usize * meter.dimensions()];
    stream.fill(meter.coarse_u(), &mut u);
    let (mut samples, mut out) = (Default::default(), Vec::new());
    let mut sample = 0.0;
    if has.sample {
        sample =
            per_row(|rows| meter.sample(wo, &u[..rows * meter.dimensions()], transport, &mut samples).ok())?;
    }
    // Near the lobe where one was drawn, since that is where most evaluations are.
    let wi = if samples.wi.is_empty() { vec![wo; BLOCK as usize] } else { samples.wi.clone() };
    let (mut eval, mut pdf) = (0.0, 0.0);
    if has.eval {
        eval = per_row(|rows| meter.eval(wo, &wi[..rows.min(wi.len())], transport, &mut out).ok())?;
    }
    if has.pdf {
        pdf = per_row(|rows| meter.pdf(wo, &wi[..rows.min(wi.len())], transport, &mut out).ok())?;
    }
    Some([sample, eval, pdf])
}

/// Seconds a row of `call`.
fn per_row(mut call: impl FnMut(usize) -> Option<()>) -> Option<f64> {
    let mut time = |rows: usize| {
        let start = Instant::now();
        call(rows)?;
        Some(start.elapsed().as_secs_f64() / rows as f64)
    };
    let first = time(FEW)?;
    if first * FEW as f64 > LONG { Some(first) } else { time(BLOCK as usize) }
}
