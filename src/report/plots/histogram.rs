//! A histogram of p-values, which are uniform where all is right.

use super::albedo::WIDTH;
use super::axes::Axes;
use super::colours::{BAND, INK, LINES, SOFT_INK};
use super::figure::{Anchor, Figure, Pen, Type};
use crate::statistics::uniformity::kolmogorov_smirnov;

/// Bins of the histogram of a run's p-values.
const BINS: usize = 20;

/// Counts of p-values in equal bins from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// The heading.
    pub title: String,
    /// What is counted.
    pub name_y: String,
    /// Kolmogorov and Smirnov's distance from the uniform distribution.
    pub distance: f64,
    /// Its p-value.
    pub p: f64,
    /// The counts.
    pub counts: Vec<u64>,
    /// Half the width of the band, in standard deviations of a bin.
    pub deviations: f64,
    /// What the band is called.
    pub band: String,
}

impl Histogram {
    /// As SVG.
    pub fn svg(&self) -> String {
        let n: u64 = self.counts.iter().sum();
        let bins = self.counts.len();
        let share = 1.0 / bins as f64;
        let level = n as f64 * share;
        let reach = self.deviations * (level * (1.0 - share)).sqrt();
        let top = self.counts.iter().fold(level + reach, |top, c| top.max(*c as f64)) * 1.1;

        let digits = if self.distance < 0.01 { 5 } else { 3 };
        let facts = format!(
            "{n} values;  Kolmogorov–Smirnov D = {:.digits$}, p = {}",
            self.distance,
            probability(self.p)
        );
        let description =
            format!("{facts}. Histogram in {bins} bins; where every subject is right it is flat.");
        let mut figure = Figure::new(WIDTH, 430.0, &self.title, &description);
        figure.text((20.0, 26.0), &self.title, Type::new(Anchor::Start).size(20.0).bold());
        figure.text((20.0, 52.0), &facts, Type::new(Anchor::Start));
        let axes = Axes { from: (96.0, 76.0), to: (590.0, 370.0), x: (0.0, 1.0), y: (0.0, top) };
        axes.band(&mut figure, level - reach, level + reach, BAND);
        for (k, count) in self.counts.iter().enumerate() {
            let (left, right) = (k as f64 * share, (k + 1) as f64 * share);
            let (from, to) = (axes.place(left, *count as f64), axes.place(right, 0.0));
            if *count > 0 {
                let outline = [(from.0, to.1), from, (to.0, from.1), to];
                figure.line(&outline, Pen::new(LINES[0], 2.0));
            }
        }
        axes.draw(&mut figure, &[0.0, 0.2, 0.4, 0.6, 0.8, 1.0], 5.0, "p-value", &self.name_y);
        let ends = [axes.place(0.0, level), axes.place(1.0, level)];
        figure.line(&ends, Pen::new(INK, 1.6).dashed());
        let small = Type::new(Anchor::Start).size(15.0).colour(SOFT_INK);
        let note = ["dashed: uniform", &format!("band: {}", self.band), "of a bin"];
        for (k, text) in note.into_iter().enumerate() {
            figure.text((604.0, axes.place(0.0, level).1 + 21.0 * (k as f64 - 1.0)), text, small);
        }
        figure.finish()
    }
}

fn probability(p: f64) -> String {
    if p >= 1e-3 { format!("{p:.3}") } else { format!("{p:.0e}").replace('-', "−") }
}

/// Histogram of p-values, which are uniform where every subject is right.
/// `None` where there is none.
pub fn p_values(values: &[f64]) -> Option<String> {
    let mut values: Vec<f64> = values.iter().copied().filter(|p| (0.0..=1.0).contains(p)).collect();
    if values.is_empty() {
        return None;
    }
    let mut counts = vec![0u64; BINS];
    for p in &values {
        counts[((p * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let (distance, p) = kolmogorov_smirnov(&mut values);
    let histogram = Histogram {
        title: "p-values of the run".into(),
        name_y: "cases".into(),
        distance,
        p,
        counts,
        deviations: 2.0,
        band: "± 2 σ".into(),
    };
    Some(histogram.svg())
}

#[cfg(test)]
mod tests {
    use super::super::figure::{MOST_BYTES, tests::assert_well_formed};
    use super::*;
    use crate::statistics::streams::StreamKey;

    #[test]
    fn is_small_well_formed_and_alike() {
        let draw = || {
            let mut stream = StreamKey::new(5).block(0);
            p_values(&(0..600).map(|_| stream.next_f64()).collect::<Vec<_>>()).unwrap()
        };
        let svg = draw();
        assert_well_formed(&svg);
        assert!(svg.len() < MOST_BYTES / 3, "{} bytes", svg.len());
        assert_eq!(svg, draw());
    }

    #[test]
    fn no_value_is_no_histogram() {
        assert_eq!(p_values(&[f64::NAN]), None);
        assert!(p_values(&[0.0, 1.0]).is_some());
    }
}
