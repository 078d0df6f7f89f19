//! A histogram of p-values, which are uniform where all is right.

use super::axes::Axes;
use super::colours::{BAND, INK, LINES, SOFT_INK};
use super::curves::WIDTH;
use super::figure::{Anchor, Figure, Pen, Type};

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
