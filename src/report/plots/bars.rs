//! A histogram of anything that is counted.

use super::axes::{Axes, even_ticks};
use super::colours::{LINES, SOFT_INK};
use super::disc_frame::nice_step;
use super::figure::{Anchor, Figure, Type};

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 380.0;

/// Counts in bins of equal width from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    /// The heading.
    pub title: String,
    /// What stands below the heading.
    pub facts: String,
    /// What lies along x, and what is counted.
    pub names: [String; 2],
    /// The width of a bin.
    pub width: f64,
    /// The counts.
    pub counts: Vec<u64>,
}

impl Bars {
    /// About `bins` bins that fill 0 to `range`, of a width that reads well.
    pub fn width_of(range: f64, bins: f64) -> f64 {
        if range > 0.0 { nice_step(range / bins) } else { 1.0 }
    }

    /// As SVG.
    pub fn svg(&self) -> String {
        let Self { title, facts, names: [name_x, name_y], width, counts } = self;
        let end = width * counts.len() as f64;
        let most = counts.iter().copied().max().unwrap_or(0).max(1);
        let told: Vec<String> = counts
            .iter()
            .enumerate()
            .filter(|(_, count)| **count > 0)
            .map(|(k, count)| {
                let [from, to] = [k, k + 1].map(|k| (width * k as f64 * 1e6).round() / 1e6);
                format!("{count} from {from} to {to}")
            })
            .collect();
        let description = format!("{facts}. {name_y} by {name_x}: {}.", told.join(", "));
        let mut figure = Figure::new(WIDTH, HEIGHT, title, &description);
        figure.text((20.0, 26.0), title, Type::new(Anchor::Start).size(20.0).bold());
        figure.text((20.0, 52.0), facts, Type::new(Anchor::Start).colour(SOFT_INK));
        let axes =
            Axes { from: (96.0, 76.0), to: (690.0, 320.0), x: (0.0, end), y: (0.0, 1.12 * most as f64) };
        for (k, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let (left, right) = (width * k as f64, width * (k + 1) as f64);
            let (from, to) = (axes.place(left, *count as f64), axes.place(right, 0.0));
            figure.rectangle((from.0 + 1.5, from.1), (to.0 - 1.5, to.1), LINES[0]);
            let middle = 0.5 * (from.0 + to.0);
            figure.text((middle, from.1 - 10.0), &count.to_string(), Type::new(Anchor::Middle).size(15.0));
        }
        axes.ticks_x(&mut figure, &even_ticks(axes.x, counts.len().min(12) as f64));
        // Nobody is a part of one.
        let whole = |tick: &(f64, String)| tick.0.fract() == 0.0;
        axes.ticks_y(&mut figure, &even_ticks(axes.y, 5.0).into_iter().filter(whole).collect::<Vec<_>>());
        axes.outline(&mut figure, name_x, name_y);
        figure.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::{MOST_BYTES, tests::assert_well_formed};
    use super::*;

    #[test]
    fn is_small_well_formed_and_tells_its_counts() {
        for counts in [vec![], vec![0], vec![3, 0, 12, 1], vec![1; 40]] {
            let names = ["points <a>".to_string(), "submissions".into()];
            let bars = Bars { title: "Scores & more".into(), facts: "n".into(), names, width: 0.5, counts };
            let svg = bars.svg();
            assert_well_formed(&svg);
            assert!(svg.len() < MOST_BYTES / 3, "{} bytes", svg.len());
            assert_eq!(svg.contains("12 from 1 to 1.5"), bars.counts.len() == 4, "{svg}");
        }
        assert_eq!(Bars::width_of(12.0, 12.0), 1.0);
        assert_eq!(Bars::width_of(0.0, 12.0), 1.0);
    }
}
