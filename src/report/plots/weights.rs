//! How the weights of samples are spread, and what that costs.

use super::axes::{Axes, log_ticks};
use super::colours::{BAND, INK, LINES, SOFT_INK};
use super::disc::given;
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::numbers::{count, three_digits};
use crate::evidence::{Draws, Evidence};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 480.0;

/// More bars than this are taken together.
const MOST_BARS: usize = 120;

/// Weights below this part of the largest are taken together at the edge.
const FLOOR: f64 = 1e-9;

/// Samples with weights from one size to another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bar {
    low: f64,
    high: f64,
    samples: u64,
}

/// The bars of a histogram, from the smallest weight.
fn bars(draws: &Draws) -> Vec<Bar> {
    let weights = &draws.log_weights;
    let each = weights.counts.iter().enumerate();
    let all: Vec<Bar> = each
        .filter_map(|(k, samples)| {
            let (low, high) = weights.edges(k)?;
            Some(Bar { low, high, samples: *samples })
        })
        .collect();
    let largest = all.last().map_or(0.0, |b| b.high);
    let (faint, seen): (Vec<Bar>, Vec<Bar>) = all.into_iter().partition(|b| b.high < FLOOR * largest);
    let taken = |bars: &[Bar]| Bar {
        low: bars[0].low.max(0.5 * FLOOR * largest),
        high: bars[bars.len() - 1].high,
        samples: bars.iter().map(|b| b.samples).sum(),
    };
    let together = seen.len().div_ceil(MOST_BARS).max(1);
    let faint = (!faint.is_empty()).then(|| taken(&faint));
    faint.into_iter().chain(seen.chunks(together).map(taken)).collect()
}

/// The share of draws that as many draws of equal weight would be worth, of the channel
/// where it is least: (E w)²/E w², no sample counting as 0.
fn effective(draws: &Draws) -> Option<f64> {
    let sums = draws.weight.sum.iter().zip(&draws.weight.square);
    let shares = sums.filter(|(_, square)| **square > 0.0);
    let shares = shares.map(|(sum, square)| sum * sum / (square * draws.weight.count as f64));
    shares.filter(|s| s.is_finite()).min_by(f64::total_cmp)
}

/// How many of the heaviest samples make up half of the sum of squares.
fn half_of_squares(bars: &[Bar]) -> u64 {
    let square = |b: &Bar| b.samples as f64 * (b.low * b.high);
    let total: f64 = bars.iter().map(square).sum();
    let (mut sum, mut samples) = (0.0, 0.0);
    for bar in bars.iter().rev() {
        let part = square(bar);
        if sum + part >= 0.5 * total {
            samples += bar.samples as f64 * (0.5 * total - sum) / part.max(f64::MIN_POSITIVE);
            break;
        }
        sum += part;
        samples += bar.samples as f64;
    }
    samples.ceil() as u64
}

/// The picture of a case; `None` where no weight above 0 was drawn, or evidence is from
/// a time before weights were kept.
pub fn picture(evidence: &Evidence) -> Option<String> {
    let draws = evidence.draws.first()?;
    let bars = bars(draws);
    let (first, last) = (bars.first()?, bars.last()?);
    let most = bars.iter().map(|b| b.samples).max().filter(|n| *n > 0)?;
    let largest = draws.weight.largest.0;
    // What the cubature met and the sampler did not draw yet.
    let beyond = evidence.integrals.as_ref().map(|i| i.largest_weight);
    let beyond = beyond.filter(|w| w.is_finite() && *w > 1.05 * largest && *w < largest / FLOOR);

    let title = format!("{}: weights", evidence.subject);
    let description = "Histogram of the weights of samples, of the largest channel of each, both axes logarithmic, \
                       with the largest weight, the mean and the effective number of draws.";
    let mut figure = Figure::new(WIDTH, HEIGHT, &title, description);
    figure.text((20.0, 26.0), &shortened(&evidence.subject, 72), Type::new(Anchor::Start).size(20.0).bold());
    let note = format!("weights of samples, {}", given(evidence));
    figure.text((20.0, 54.0), &note, Type::new(Anchor::Start).colour(SOFT_INK));

    // Equal weights fill a bar of a decade's tenth: around it there is room.
    let x = (first.low.log10() - 0.15, beyond.unwrap_or(last.high).max(last.high).log10() + 0.15);
    let y = (-0.3, (most as f64).log10() + 0.3);
    let axes = Axes { from: (96.0, 80.0), to: (570.0, 410.0), x, y };
    let place = |w: f64, n: f64| axes.clamped(w.log10().clamp(x.0, x.1), n.max(0.5).log10());
    let mut outline = vec![place(first.low, 0.5)];
    for bar in &bars {
        outline.extend([bar.low, bar.high].map(|w| place(w, bar.samples as f64)));
    }
    outline.push(place(last.high, 0.5));
    outline.dedup();
    figure.polygon(&outline, BAND);
    figure.line(&outline, Pen::new(LINES[0], 1.8));
    axes.ticks_x(&mut figure, &log_ticks(x, 8));
    axes.ticks_y(&mut figure, &log_ticks(y, 8));
    axes.outline(&mut figure, "weight, f·|cos θi| over pdf", "samples");

    let channels = draws.weight.sum.len().max(1) as f64;
    let mean = draws.weight.sum.iter().sum::<f64>() / (channels * draws.weight.count.max(1) as f64);
    let line = |figure: &mut Figure, w: f64, pen: Pen| {
        if w > 0.0 && w.is_finite() {
            let px = place(w, 1.0).0;
            figure.line(&[(px, axes.from.1), (px, axes.to.1)], pen);
        }
    };
    let facts = facts(draws, &bars, mean, beyond);
    for (k, (mark, text)) in facts.into_iter().enumerate() {
        let y = 96.0 + 23.0 * k as f64;
        if let Some((w, pen)) = mark {
            line(&mut figure, w, pen);
            figure.line(&[(590.0, y), (620.0, y)], pen);
        }
        let x = if mark.is_some() { 630.0 } else { 590.0 };
        if !text.is_empty() {
            figure.text((x, y), &text, Type::new(Anchor::Start).size(15.0));
        }
    }
    Some(figure.finish())
}

/// A line at a weight, if it has one, and what is told beside the plot.
type Fact = (Option<(f64, Pen)>, String);

fn facts(draws: &Draws, bars: &[Bar], mean: f64, beyond: Option<f64>) -> Vec<Fact> {
    let largest = draws.weight.largest.0;
    let pens = [Pen::new(LINES[1], 2.2), Pen::new(INK, 1.6).dashed(), Pen::new(LINES[2], 1.8).dashed()];
    let mut told = vec![
        (Some((largest, pens[0])), format!("largest: {}", three_digits(largest))),
        (Some((mean, pens[1])), format!("mean: {}", three_digits(mean))),
    ];
    if let Some(w) = beyond {
        told.push((Some((w, pens[2])), format!("largest f·|cos| / pdf: {}", three_digits(w))));
        told.push((None, "(by cubature)".into()));
    }
    let n = draws.samples;
    let percent = |part: u64| match part {
        0 => "0".into(),
        part => three_digits(100.0 * part as f64 / n.max(1) as f64),
    };
    if let Some(share) = effective(draws) {
        let effective = (share * n as f64).round() as u64;
        told.push((None, String::new()));
        told.push((None, format!("N = {} draws,", count(n))));
        told.push((None, format!("worth {} ({} %)", count(effective), three_digits(100.0 * share))));
        told.push((None, "of equal weight".into()));
    }
    told.push((None, String::new()));
    let half = half_of_squares(bars);
    told.push((None, "half of the sum of squares:".into()));
    told.push((
        None,
        if half < 2 { "the heaviest draw".into() } else { format!("the {} heaviest", count(half)) },
    ));
    told.push((None, String::new()));
    told.push((
        None,
        format!("weight 0: {} ({} %)", count(draws.log_weights.zero), percent(draws.log_weights.zero)),
    ));
    told.push((None, format!("no sample: {} ({} %)", count(draws.none), percent(draws.none))));
    told
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::super::synthetic::gallery;
    use super::*;
    use crate::evidence::{Figure as Number, LogWeights};

    /// Evidence with these counts by weight, four bins to a factor of two from 1/8 on.
    fn weighing(counts: Vec<u64>, zero: u64) -> Evidence {
        let (_, mut evidence) = gallery().remove(0);
        let first = ((0.125f64).to_bits() >> 50) as u32;
        let draws = &mut evidence.draws[0];
        draws.log_weights = LogWeights { zero, first, counts };
        let bars = bars(draws);
        draws.samples = zero + bars.iter().map(|b| b.samples).sum::<u64>();
        draws.weight.count = draws.samples;
        // Powers of two, which the tests are about.
        let weight = |b: &Bar| b.low / 0.9375;
        draws.weight.sum = vec![bars.iter().map(|b| b.samples as f64 * weight(b)).sum(); 3];
        draws.weight.square = vec![bars.iter().map(|b| b.samples as f64 * weight(b).powi(2)).sum(); 3];
        draws.weight.largest = Number(bars.last().map_or(0.0, weight));
        evidence
    }

    #[test]
    fn equal_weights_are_worth_all_draws_and_heavy_ones_few() {
        let even = weighing(vec![1000], 0);
        assert!((effective(&even.draws[0]).unwrap() - 1.0).abs() < 1e-12);
        let svg = picture(&even).unwrap();
        assert_well_formed(&svg);
        assert!(svg.contains("worth 1\u{2009}000 (100 %)") && svg.contains("largest: 0.125"), "{svg}");

        // One sample of 2^10 among a million of 1/8.
        let mut counts = vec![0; 4 * 13 + 1];
        (counts[0], counts[52]) = (1_000_000, 1);
        let heavy = weighing(counts, 0);
        assert_eq!(half_of_squares(&bars(&heavy.draws[0])), 1);
        let svg = picture(&heavy).unwrap();
        assert_well_formed(&svg);
        assert!(svg.contains("largest: 1024") && svg.contains("the heaviest draw"), "{svg}");
        assert!(effective(&heavy.draws[0]).unwrap() < 0.02);
        assert!(svg.len() < 60_000 && svg == picture(&heavy).unwrap(), "{} bytes", svg.len());
    }

    #[test]
    fn what_cubature_met_beyond_the_largest_is_drawn() {
        let mut evidence = weighing(vec![1000], 100);
        evidence.integrals.as_mut().unwrap().largest_weight = 0.125;
        assert!(!picture(&evidence).unwrap().contains("by cubature"));
        evidence.integrals.as_mut().unwrap().largest_weight = 50.0;
        let svg = picture(&evidence).unwrap();
        assert!(svg.contains("by cubature") && svg.contains("weight 0: 100 (9.09 %)"), "{svg}");
    }

    #[test]
    fn many_bars_are_taken_together_and_keep_their_samples() {
        let evidence = weighing((0..4 * 200).map(|k| k % 7).collect(), 0);
        let draws = &evidence.draws[0];
        let taken = bars(draws);
        assert!(taken.len() <= MOST_BARS + 1, "{}", taken.len());
        let sum: u64 = taken.iter().map(|b| b.samples).sum();
        assert_eq!(sum, draws.log_weights.counts.iter().sum::<u64>());
        assert!(taken.windows(2).all(|w| w[0].high <= w[1].low));
        let svg = picture(&evidence).unwrap();
        assert_well_formed(&svg);
        assert!(svg.len() < 60_000, "{} bytes", svg.len());
    }

    #[test]
    fn no_weight_is_no_picture() {
        let (_, evidence) = gallery().remove(0);
        assert_eq!(picture(&evidence), None, "of a time before weights were kept");
        assert_eq!(picture(&weighing(vec![], 10)), None);
        let mut forged = weighing(vec![5], 0);
        forged.draws[0].log_weights.first = u32::MAX;
        assert_eq!(picture(&forged), None);
    }
}
