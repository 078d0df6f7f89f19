//! Cells of a partition taken together along one angle.

use super::gathered::Evidence;
use crate::bsdf::Direction;

/// A strip closes once it expects, or got, so many samples.
const ENOUGH: f64 = 16.0;

/// Cells with similar angles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strip {
    /// The mean angle in degrees, by expected and counted samples.
    pub degrees: f64,
    /// Continuous samples that were counted, in all attempts.
    pub observed: f64,
    /// Those that pdf() predicts.
    pub expected: f64,
}

impl Strip {
    fn weight(&self) -> f64 {
        self.observed + self.expected
    }

    fn add(&mut self, cell: &Self) {
        let (a, b) = (self.weight(), cell.weight());
        let mean = (a * self.degrees + b * cell.degrees) / (a + b);
        // Where nothing came and nothing was expected, any of them will do.
        self.degrees = if a + b > 0.0 { mean } else { cell.degrees };
        self.observed += cell.observed;
        self.expected += cell.expected;
    }

    /// Observed over expected and its standard error; `None` where hardly any is
    /// expected.
    pub fn ratio(&self) -> Option<(f64, f64)> {
        let error = self.observed.max(1.0).sqrt() / self.expected;
        (self.expected >= 1.0).then_some((self.observed / self.expected, error))
    }
}

/// Each cell with the direction of its middle and the angle that `angle` gives it.
/// `None` where nothing was drawn or integrated.
pub(super) fn cells(
    evidence: &Evidence,
    angle: impl Fn(Direction) -> f64,
) -> Option<Vec<(Direction, Strip)>> {
    let (partition, integrals) = (evidence.partition.as_ref()?, evidence.integrals.as_ref()?);
    let draws: u64 = evidence.draws.iter().map(|d| d.samples).sum();
    // Saved evidence may come from anywhere.
    let whole = integrals.pdf.len() == partition.len()
        && evidence.draws.iter().all(|d| d.counts.len() == partition.len());
    if draws == 0 || !whole {
        return None;
    }
    let chart = partition.chart();
    let cell = |leaf: usize| {
        let cell = partition.leaf_cell(leaf);
        let middle = chart.to_direction(cell.at(0.5, 0.5));
        let strip = Strip {
            degrees: angle(middle),
            observed: evidence.draws.iter().map(|d| d.counts[leaf] as f64).sum(),
            expected: (integrals.pdf[leaf] * draws as f64).max(0.0),
        };
        (middle, strip)
    };
    Some((0..partition.len()).map(cell).collect())
}

/// How wide strips are.
pub(super) struct Widths {
    /// Degrees after which one ends that has enough.
    pub finest: f64,
    /// Degrees after which every one ends.
    pub coarsest: f64,
    /// One ends before that holds this share of the samples: narrow lobes have as many
    /// strips as broad ones.
    pub share: f64,
}

/// Takes cells together, in the order of their angles.
pub(super) fn strips(mut cells: Vec<Strip>, widths: &Widths) -> Vec<Strip> {
    let Widths { finest, coarsest, share } = *widths;
    cells.sort_by(|a, b| a.degrees.total_cmp(&b.degrees));
    let much = share * cells.iter().map(Strip::weight).sum::<f64>() * 0.5;
    let mut strips = Vec::new();
    let mut open: Option<(f64, Strip)> = None;
    for cell in cells {
        if let Some((from, strip)) = &open {
            let (span, held) = (cell.degrees - from, strip.observed.max(strip.expected));
            if span >= coarsest || held >= ENOUGH && (span >= finest || held >= much) {
                strips.push(*strip);
                open = None;
            }
        }
        let (_, strip) = open.get_or_insert((cell.degrees, Strip::default()));
        strip.add(&cell);
    }
    strips.extend(open.map(|(_, strip)| strip));
    strips
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTHS: Widths = Widths { finest: 3.0, coarsest: 15.0, share: 1.0 / 40.0 };

    fn cell(degrees: f64, observed: f64, expected: f64) -> Strip {
        Strip { degrees, observed, expected }
    }

    #[test]
    fn strips_end_where_they_have_enough() {
        let even: Vec<Strip> = (0..90).map(|k| cell(f64::from(k), 10.0, 10.0)).collect();
        let found = strips(even.clone(), &WIDTHS);
        assert_eq!(found.len(), 30);
        assert!((found[0].degrees - 1.0).abs() < 1e-6 && found[0].observed == 30.0, "{:?}", found[0]);
        let faint: Vec<Strip> = even.iter().map(|c| Strip { expected: 0.0, observed: 0.1, ..*c }).collect();
        assert_eq!(strips(faint, &WIDTHS).len(), 6);
        assert_eq!(strips(even, &WIDTHS).iter().map(|s| s.observed).sum::<f64>(), 900.0);
    }

    #[test]
    fn a_narrow_lobe_has_many_strips() {
        let lobe = (0..400).map(|k| cell(45.0 + 1e-4 * f64::from(k), 100.0, 90.0)).collect();
        let found = strips(lobe, &WIDTHS);
        assert!((30..=50).contains(&found.len()), "{}", found.len());
        let (ratio, error) = found[0].ratio().unwrap();
        assert!((ratio - 10.0 / 9.0).abs() < 1e-12 && error > 0.0);
        assert_eq!(cell(0.0, 5.0, 0.5).ratio(), None);
    }
}
