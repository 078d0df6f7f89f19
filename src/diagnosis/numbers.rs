//! Numbers of a textbook that fit better than its own.

use super::textbook::Textbook;
use super::view::{Point, Seen, View};

/// A parameter's value is looked for from 1/150 to 150 times the declared one: degrees
/// taken for radians are within.
const STEP: f64 = 0.25;
const STEPS: i32 = 20;

/// Golden sections of a step: to 1e-9 of it.
const SECTIONS: usize = 43;

/// A textbook with another number in place of one of its own.
pub struct Other {
    /// The parameter.
    pub name: String,
    /// Its value in the first textbook.
    pub declared: f64,
    /// That which fits better.
    pub found: f64,
    /// The textbook with it.
    pub book: Textbook,
    /// What is left of the loss.
    pub loss: f64,
}

/// For each number of a textbook, the value near which `loss` is least; none where it
/// changes nothing.
pub fn others(book: &Textbook, loss: impl Fn(&Textbook) -> f64) -> Vec<Other> {
    book.numbers().into_iter().filter_map(|(name, _)| nearest(book, &name, &loss)).collect()
}

/// The value of a parameter near which `loss` is least; `None` where it changes
/// nothing.
pub fn nearest(book: &Textbook, name: &str, loss: impl Fn(&Textbook) -> f64) -> Option<Other> {
    let declared = book.number(name)?;
    let value = |ln: f64| if declared == 0.0 { 0.1 * ln.exp() } else { declared * ln.exp() };
    let at = |ln: f64| book.with(name, value(ln)).map_or(f64::INFINITY, |b| loss(&b));
    let here = at(0.0);
    if [-1.0, -0.3, 0.3].map(at).iter().all(|l| !l.is_finite() || (l - here).abs() < 1e-12) {
        return None;
    }
    let steps = (-STEPS..=STEPS).map(|k| f64::from(k) * STEP).map(|ln| (ln, at(ln)));
    let best = steps.filter(|s| s.1.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let found = value(least(best - STEP, best + STEP, SECTIONS, at));
    let other = book.with(name, found)?;
    let loss = loss(&other);
    Some(Other { name: name.into(), declared, found, book: other, loss })
}

/// Where a function of one number is least, by golden sections.
pub fn least(mut lo: f64, mut hi: f64, sections: usize, f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.381_966_011_250_105;
    let (mut a, mut b) = (lo + GOLDEN * (hi - lo), hi - GOLDEN * (hi - lo));
    let (mut fa, mut fb) = (f(a), f(b));
    for _ in 0..sections {
        if fa < fb {
            (hi, b, fb) = (b, a, fa);
            a = lo + GOLDEN * (hi - lo);
            fa = f(a);
        } else {
            (lo, a, fa) = (a, b, fb);
            b = hi - GOLDEN * (hi - lo);
            fb = f(b);
        }
    }
    0.5 * (lo + hi)
}

/// Median of |ln(own/theirs)| over every `stride`-th point; infinite of fewer than
/// twelve. `pair` gives both, and `None` where there is nothing to compare.
pub fn median_error(view: &View, stride: usize, pair: impl Fn(&Seen, &Point) -> Option<(f64, f64)>) -> f64 {
    let points = view.cases.iter().flat_map(|s| s.points.iter().step_by(stride).map(move |p| (s, p)));
    let compared = points.filter_map(|(s, p)| pair(s, p)).filter(|(own, theirs)| *own > 0.0 || *theirs > 0.0);
    let mut off: Vec<f64> = compared.map(|(own, theirs)| (own / theirs).ln().abs()).collect();
    off.sort_by(f64::total_cmp);
    if off.len() < 12 { f64::INFINITY } else { off[off.len() / 2] }
}
