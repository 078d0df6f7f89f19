//! How a function deviates from what it should be, point by point.

use super::parts::At;
use super::textbook::{EQUAL, Textbook};
use super::view::{Point, Seen, View};
use crate::bsdf::Transport;

/// A value beside what it should be.
#[derive(Clone, Copy)]
pub struct Ratio<'p> {
    /// Where.
    pub at: At<'p>,
    /// What was measured.
    pub observed: f64,
    /// What it should be, > 0 unless nothing should be there.
    pub expected: f64,
    /// Rounding of `observed` over `expected`.
    pub error: f64,
}

impl Ratio<'_> {
    /// Whether the value is what it should be, times `factor`.
    fn is(&self, factor: f64) -> bool {
        let predicted = self.expected * factor;
        (self.observed - predicted).abs() <= self.error * (self.expected + predicted.abs())
    }
}

/// Some of the points, on which a bug may act by itself.
pub struct Region<'p> {
    /// In words, "" for all.
    pub name: String,
    /// The points.
    pub ratios: Vec<Ratio<'p>>,
}

/// How well a factor explains a region.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The power of the factor.
    pub power: f64,
    /// A constant beside it.
    pub scale: f64,
    /// Points that it explains.
    pub matched: usize,
    /// Of so many.
    pub of: usize,
}

/// Fewer points than this say nothing.
const FEWEST: usize = 24;

/// An explanation must hold at this share of the points.
const HOLDS: f64 = 0.97;

/// Nats for each point that an explanation does not hold at.
const MISSED: f64 = 7.0;

impl Fit {
    /// ln-likelihood over a perfect fit. A few points may be lost to cancellation,
    /// at most as many as [`HOLDS`] lets through.
    pub fn ln_likelihood(&self) -> f64 {
        -MISSED * (self.of - self.matched) as f64 / self.of as f64 * FEWEST as f64
    }

    /// In words.
    pub fn words(&self) -> String {
        format!("holds at {} of {} directions to 1e-6", self.matched, self.of)
    }
}

/// What may be fitted along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Free {
    /// Nothing.
    Nothing,
    /// The power of the factor.
    Power,
    /// A constant beside it.
    Scale,
}

/// Whether the region deviates from what it should be.
pub fn deviates(ratios: &[Ratio]) -> bool {
    let off = ratios.iter().filter(|r| !r.is(1.0)).count();
    off as f64 > (1.0 - HOLDS) * ratios.len() as f64 && off >= 4
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    if values.is_empty() {
        return None;
    }
    values.sort_by(f64::total_cmp);
    Some(values[values.len() / 2])
}

/// Whether a factor explains how the region deviates.
pub fn fit(ratios: &[Ratio], factor: impl Fn(&At) -> Option<f64>, free: Free) -> Option<Fit> {
    let known: Vec<(&Ratio, f64)> = ratios
        .iter()
        .filter_map(|r| Some((r, factor(&r.at).filter(|f| f.is_finite() && *f >= 0.0)?)))
        .collect();
    if known.len() < FEWEST || (known.len() as f64) < 0.7 * ratios.len() as f64 {
        return None;
    }
    let (mut power, mut scale) = (1.0, 1.0);
    let ln = |(r, f): &(&Ratio, f64)| (r.observed / r.expected).ln() / f.ln();
    match free {
        Free::Nothing => {}
        Free::Power => {
            let telling = known.iter().filter(|(_, f)| f.ln().abs() > 0.02);
            power = median(telling.map(ln).collect())?;
            // An easy number is meant where it is that close.
            let easy = (2.0 * power).round() / 2.0;
            if (power - easy).abs() < 1e-6 {
                power = easy;
            }
            if power.abs() < 1e-3 {
                return None;
            }
        }
        Free::Scale => scale = median(known.iter().map(|(r, f)| r.observed / (r.expected * f)).collect())?,
    }
    let of = |f: f64| scale * f.powf(power);
    let matched = known.iter().filter(|(r, f)| r.is(of(*f))).count();
    // Most points may be right by themselves: those that are not must be explained.
    let off = known.iter().filter(|(r, _)| !r.is(1.0));
    let (explained, off) = off.fold((0, 0), |(n, all), (r, f)| (n + usize::from(r.is(of(*f))), all + 1));
    // It must say something: a factor of 1 explains nothing.
    let telling =
        known.iter().filter(|(r, f)| !Ratio { observed: r.expected * of(*f), ..**r }.is(1.0)).count();
    let holds = matched as f64 >= HOLDS * known.len() as f64
        && telling * 20 > known.len()
        && explained * 10 >= off * 9;
    holds.then_some(Fit { power, scale, matched, of: known.len() })
}

/// The regions of a set of points: all of them, then those seen from each side and in
/// each mode where the others are right.
fn with_parts<'p>(all: Vec<Ratio<'p>>) -> Vec<Region<'p>> {
    let mut regions = Vec::new();
    type Split = (&'static str, fn(&At) -> bool);
    let splits: [Split; 6] = [
        ("where wo is in front", |at| !at.from_behind),
        ("where wo is behind", |at| at.from_behind),
        ("in importance mode", |at| at.transport == Transport::Importance),
        ("in radiance mode", |at| at.transport == Transport::Radiance),
        ("in reflection", |at| at.reflects()),
        ("in transmission", |at| !at.reflects()),
    ];
    for (name, within) in splits {
        let (inside, outside): (Vec<_>, Vec<_>) = all.iter().copied().partition(|r| within(&r.at));
        if inside.len() >= FEWEST && outside.len() >= FEWEST && deviates(&inside) && !deviates(&outside) {
            regions.push(Region { name: name.into(), ratios: inside });
        }
    }
    regions.insert(0, Region { name: String::new(), ratios: all });
    regions
}

/// Which function deviates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// pdf(), from the textbook's.
    Pdf,
    /// eval(), from the textbook's.
    Value,
}

/// Where nothing is expected, more than this of what is elsewhere is something.
const NOTHING: f64 = 1e-12;

/// How a function deviates from the textbook's: on all points, and on each lobe with
/// the others taken away.
pub fn from_textbook<'p>(view: &View, book: &'p Textbook, function: Function) -> Vec<Region<'p>> {
    let each = |k: Option<usize>| -> Vec<Ratio<'p>> {
        let mut ratios = Vec::new();
        for seen in &view.cases {
            for p in &seen.points {
                ratios.extend(ratio(book, seen, p, function, k));
            }
        }
        ratios
    };
    let whole = each(None);
    if !deviates(&whole) {
        return Vec::new();
    }
    let mut regions = with_parts(whole);
    if book.lobes.len() > 1 || !book.lobes.first().is_none_or(|l| l.name.is_empty()) {
        for (k, lobe) in book.lobes.iter().enumerate() {
            let ratios = each(Some(k));
            if ratios.len() >= FEWEST && deviates(&ratios) {
                for region in with_parts(ratios) {
                    let name = format!("in {} {}", lobe.name, region.name);
                    regions.push(Region { name: name.trim().into(), ..region });
                }
            }
        }
    }
    regions
}

/// A point's ratio, of a lobe or of all.
fn ratio<'p>(
    book: &'p Textbook,
    seen: &Seen,
    p: &Point,
    function: Function,
    lobe: Option<usize>,
) -> Vec<Ratio<'p>> {
    let (wo, wi, t) = (seen.wo, p.wi, seen.transport);
    let at = At::new(&book.parts, wo, wi, t);
    let of = |k: usize, channel: usize| match function {
        Function::Pdf => {
            let lobe = &book.lobes[k];
            (lobe.share)(wo) * (lobe.density)(wo, wi)
        }
        Function::Value => (book.lobes[k].value)(wo, wi, t)[channel],
    };
    let channels = if function == Function::Pdf { 1 } else { p.value.len() };
    let mut ratios = Vec::new();
    for channel in 0..channels {
        let (observed, whole) = match function {
            Function::Pdf => (p.pdf, book.pdf(wo, wi)),
            Function::Value => (p.value[channel], book.eval(wo, wi, t)[channel]),
        };
        let at = At { channel, ..at };
        let (observed, expected) = match lobe {
            None => (observed, whole),
            Some(k) => {
                let own = of(k, channel);
                let others: f64 = (0..book.lobes.len()).filter(|j| *j != k).map(|j| of(j, channel)).sum();
                if own < 0.02 * whole {
                    continue;
                }
                (observed - others, own)
            }
        };
        if !(observed.is_finite() && expected.is_finite()) || expected < 0.0 {
            continue;
        }
        if expected == 0.0 {
            // Something where nothing should be is no ratio; `support` speaks of it.
            if observed.abs() > NOTHING {
                ratios.push(Ratio { at, observed, expected: 0.0, error: 0.0 });
            }
            continue;
        }
        let error = EQUAL * (1.0 + whole / expected * 0.1);
        ratios.push(Ratio { at, observed, expected, error });
    }
    ratios
}

/// Whether a function is at every point what `predicted` says, `None` from which
/// leaves the point out, and above all where it is not what it should be.
pub fn equals(
    view: &View,
    observed: impl Fn(&Seen, &Point) -> f64,
    right: impl Fn(&Seen, &Point) -> f64,
    predicted: impl Fn(&Seen, &Point) -> Option<f64>,
) -> Option<Fit> {
    let (mut matched, mut of) = (0, 0);
    let (mut explained, mut off) = (0, 0);
    for seen in &view.cases {
        for p in &seen.points {
            let Some(predicted) = predicted(seen, p) else { continue };
            let observed = observed(seen, p);
            if observed == 0.0 && predicted == 0.0 {
                continue;
            }
            of += 1;
            let scale = observed.abs() + predicted.abs();
            let fits = (observed - predicted).abs() <= EQUAL * scale;
            matched += usize::from(fits);
            if (observed - right(seen, p)).abs() > EQUAL * scale {
                off += 1;
                explained += usize::from(fits);
            }
        }
    }
    let holds = of >= FEWEST && matched as f64 >= HOLDS * of as f64 && off >= 4 && explained * 10 >= off * 9;
    holds.then_some(Fit { power: 1.0, scale: 1.0, matched, of })
}
