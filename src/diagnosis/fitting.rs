//! Textbooks for subjects that declare nothing of their parts: numbers are fitted to
//! what the functions return.

use super::pdf::least;
use super::textbook::Textbook;
use super::view::{Point, Seen, View};
use crate::bsdf::SubjectKind;
use crate::registry::{Kind, Registry};

/// Cases and points of each that numbers are fitted to.
const CASES: usize = 4;
const STRIDE: usize = 16;

/// Models whose tables take a millisecond or more to make, or that have more numbers
/// than can be told from one function.
const LEFT_OUT: [&str; 5] = ["rough-plastic", "disney", "lafortune", "factored", "measured"];

/// Models that make a table for each number that is tried.
const TABLES: [&str; 1] = ["ggx-multiscatter"];

/// A fit is exact where the median is off by less.
const EXACT: f64 = 1e-8;

/// Which function numbers are fitted to.
#[derive(Clone, Copy, PartialEq)]
enum To {
    Pdf,
    Value,
}

/// Models with numbers such that pdf() or eval() agree.
pub fn fitted(view: &View) -> Vec<Textbook> {
    let registry = Registry::builtin();
    let mut found = Vec::new();
    let mut models: Vec<_> = registry.models().filter(|m| m.kind() == SubjectKind::Bsdf).collect();
    models.retain(|m| !LEFT_OUT.contains(&m.name()));
    // What has tables comes last, and only where nothing else fits.
    models.sort_by_key(|m| TABLES.contains(&m.name()));
    for model in models {
        if TABLES.contains(&model.name()) && !found.is_empty() {
            break;
        }
        let unknown: Vec<String> = model
            .parameters()
            .iter()
            .filter(|p| matches!(p.kind, Kind::Number { .. }) && !view.parameters.0.contains_key(&p.name))
            // Of a surface that looks the same all round there is one roughness.
            .filter(|p| p.name != "alpha_y" || !view.description.claims.isotropic)
            .map(|p| p.name.clone())
            .collect();
        if unknown.is_empty() {
            continue;
        }
        for parameters in super::textbook::combinations(model, &view.parameters) {
            let Some(start) = Textbook::new(model.name(), &parameters) else { continue };
            // Normals of a Gaussian are tabulated.
            let text = |name: &str, is: &str| parameters.0.get(name).is_some_and(|v| v.to_string() == is);
            if start.channels() != view.channels() || text("distribution", "gaussian") {
                continue;
            }
            let mut book = start;
            let by_pdf = descend(&mut book, view, &unknown, To::Pdf);
            let by_value = descend(&mut book, view, &unknown, To::Value);
            if by_pdf < EXACT || by_value < EXACT {
                let whole = by_pdf < EXACT && by_value < EXACT;
                found.push(book);
                if whole {
                    return found;
                }
            }
        }
    }
    found
}

/// Fits one number after the other; what pdf() has settled stays. The median error
/// at the end.
fn descend(book: &mut Textbook, view: &View, unknown: &[String], to: To) -> f64 {
    let settled = to == To::Value && error(book, view, To::Pdf) < EXACT;
    let mut off = error(book, view, to);
    for _ in 0..3 {
        let (before, mut moving) = (off, 0);
        for name in unknown {
            if off < EXACT {
                return off;
            }
            let Some(value) = book.number(name) else { continue };
            let Some((better, at)) = nearest(book, view, name, value, to) else { continue };
            moving += 1;
            if at < off && !(settled && error(&better, view, To::Pdf) > EXACT) {
                (*book, off) = (better, at);
            }
        }
        // A single number is as good as it gets.
        if moving < 2 || off > 0.7 * before {
            break;
        }
    }
    off
}

/// The model with the number that fits best; `None` where it changes nothing.
fn nearest(book: &Textbook, view: &View, name: &str, value: f64, to: To) -> Option<(Textbook, f64)> {
    let with = |ln: f64| book.with(name, if value == 0.0 { 0.1 * ln.exp() } else { value * ln.exp() });
    let at = |ln: f64| with(ln).map_or(f64::INFINITY, |b| error(&b, view, to));
    let here = at(0.0);
    if [-0.5, 0.2].map(at).iter().all(|l| !l.is_finite() || (l - here).abs() < 1e-12) {
        return None;
    }
    const STEP: f64 = 0.2;
    let steps = (-18..=18).map(|k| f64::from(k) * STEP).map(|ln| (ln, at(ln)));
    let best = steps.filter(|s| s.1.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let ln = least(best - STEP, best + STEP, 44, at);
    let better = with(ln)?;
    let off = error(&better, view, to);
    Some((better, off))
}

/// Median of |ln(own/theirs)| where both are positive.
fn error(book: &Textbook, view: &View, to: To) -> f64 {
    let mut off: Vec<f64> = Vec::new();
    let mut look = |seen: &Seen, p: &Point| {
        let (own, theirs) = match to {
            To::Pdf => (p.pdf, book.pdf(seen.wo, p.wi)),
            To::Value => (p.value[0], book.eval(seen.wo, p.wi, seen.transport)[0]),
        };
        if own > 0.0 || theirs > 0.0 {
            off.push((own / theirs).ln().abs());
        }
    };
    for seen in view.cases.iter().take(CASES) {
        seen.points.iter().step_by(STRIDE).for_each(|p| look(seen, p));
    }
    off.sort_by(f64::total_cmp);
    if off.len() < 12 { f64::INFINITY } else { off[off.len() / 2] }
}
