//! Textbooks for subjects that declare nothing of their parts: numbers are fitted to
//! what the functions return.

use super::numbers::{median_error, nearest};
use super::textbook::Textbook;
use super::view::View;
use crate::bsdf::SubjectKind;
use crate::registry::{Kind, Registry};

/// Numbers are fitted to every so many-th point.
const STRIDE: usize = 24;

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
            let Some(better) = nearest(book, name, |b| error(b, view, to)) else { continue };
            moving += 1;
            if better.loss < off && !(settled && error(&better.book, view, To::Pdf) > EXACT) {
                (*book, off) = (better.book, better.loss);
            }
        }
        // A single number is as good as it gets.
        if moving < 2 || off > 0.7 * before {
            break;
        }
    }
    off
}

/// Median error of a function.
fn error(book: &Textbook, view: &View, to: To) -> f64 {
    median_error(view, STRIDE, |s, p| {
        Some(match to {
            To::Pdf => (p.pdf, book.pdf(s.wo, p.wi)),
            To::Value => (p.value[0], book.eval(s.wo, p.wi, s.transport)[0]),
        })
    })
}
