//! How weights are spread: counts by size, cheap enough for every draw.

use serde::{Deserialize, Serialize};

/// Bits of a number to the right of its exponent and the two highest bits of its
/// mantissa. What is left numbers the bins: four to a factor of two.
const SHIFT: u32 = 50;

/// Half a bin, so that weights that are 1 but for rounding share one.
const HALF: u64 = 1 << (SHIFT - 1);

/// Bins of all numbers without a sign.
const BINS: usize = 1 << (63 - SHIFT);

/// Bins of 0 and of what is too small to be told from it (below 2⁻¹⁰²²).
const ZERO: usize = 4;

/// Weights by size: of each sample, continuous or discrete, the channel where it is
/// largest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LogWeights {
    /// Samples of weight 0.
    pub zero: u64,
    /// The number of the first bin that holds a sample, see [`edges`](Self::edges).
    pub first: u32,
    /// Samples by bin from there, up to the last bin that holds one.
    pub counts: Vec<u64>,
}

impl LogWeights {
    /// Where the bin at this place of [`counts`](Self::counts) begins and ends: a bin is
    /// an eighth to a quarter of its
    /// weights wide. `None` for bins of no number.
    pub fn edges(&self, place: usize) -> Option<(f64, f64)> {
        let bin = u64::from(self.first) + place as u64;
        if !(1..BINS as u64).contains(&bin) {
            return None;
        }
        let [low, high] = [bin, bin + 1].map(|bin| f64::from_bits((bin << SHIFT) - HALF));
        high.is_finite().then_some((low, high))
    }

    /// Whether nothing was counted.
    pub fn is_empty(&self) -> bool {
        self.zero == 0 && self.counts.is_empty()
    }
}

/// Weights in a row go to tables of their own: many share a bin, and each count of one
/// waits for the one before.
const TABLES: usize = 2;

/// All bins, while draws are under way.
pub(super) struct WeightTable([Box<[u64; BINS]>; TABLES]);

impl WeightTable {
    pub(super) fn new() -> Self {
        let bins = || vec![0; BINS].into_boxed_slice();
        Self(std::array::from_fn(|_| bins().try_into().expect("as many bins as there are")))
    }

    /// Counts rows of `channels` weights, of which none is negative.
    pub(super) fn look(&mut self, rows: &[f64], channels: usize) {
        // Masked, since −0 has a sign.
        let mut count = |table: usize, w: f64| {
            self.0[table][((w.to_bits() + HALF) >> SHIFT) as usize % BINS] += 1;
        };
        if channels == 1 {
            let (many, rest) = rows.as_chunks::<TABLES>();
            many.iter().for_each(|row| (0..TABLES).for_each(|k| count(k, row[k])));
            rest.iter().for_each(|w| count(0, *w));
        } else {
            let largest = |row: &[f64]| row.iter().fold(0.0, |a: f64, b| a.max(*b));
            rows.chunks_exact(channels).for_each(|row| count(0, largest(row)));
        }
    }

    /// Adds what was counted to `to`, without `none` draws that gave no sample and
    /// count as weight 0 here.
    pub(super) fn add_to(&self, to: &mut LogWeights, none: u64) {
        let all: Vec<u64> = (0..BINS).map(|bin| self.0.iter().map(|table| table[bin]).sum()).collect();
        to.zero += all[..ZERO].iter().sum::<u64>().saturating_sub(none);
        let found = || (ZERO..BINS).filter(|bin| all[*bin] > 0);
        let (Some(first), Some(last)) = (found().next(), found().next_back()) else { return };
        let kept = (to.first as usize, to.first as usize + to.counts.len());
        let (from, past) = if to.counts.is_empty() {
            (first, last + 1)
        } else {
            (first.min(kept.0), (last + 1).max(kept.1))
        };
        let mut counts = all[from..past].to_vec();
        for (old, n) in (kept.0..kept.1).zip(&to.counts) {
            counts[old - from] += n;
        }
        (to.first, to.counts) = (from as u32, counts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(rows: &[f64], channels: usize, none: u64) -> LogWeights {
        let mut table = WeightTable::new();
        table.look(rows, channels);
        let mut weights = LogWeights::default();
        table.add_to(&mut weights, none);
        weights
    }

    #[test]
    fn each_weight_is_within_the_edges_of_its_bin() {
        for w in [1e-300, 0.013, 0.5, 0.999, 1.0, 1.25, 1.7, 2.0, 3e7, 1e300f64] {
            let weights = counted(&[w], 1, 0);
            assert_eq!((weights.zero, &weights.counts[..]), (0, &[1][..]));
            let (low, high) = weights.edges(0).unwrap();
            assert!(low <= w && w < high && high / low <= 1.25, "{w}: {low} to {high}");
        }
        let rounded = counted(&[1.0 - 1e-16, 1.0, 1.0 + 1e-15], 1, 0);
        assert_eq!((rounded.counts.len(), rounded.edges(0)), (1, Some((0.9375, 1.125))));
    }

    #[test]
    fn zero_and_no_sample_are_counted_apart_and_rows_by_their_largest() {
        let weights = counted(&[0.0, -0.0, 0.0, 0.0, 0.25, 4.0, 4.0, 0.0], 2, 1);
        assert_eq!((weights.zero, &weights.counts[..]), (1, &[2][..]));
        assert_eq!(weights.edges(0), Some((3.75, 4.5)));
        assert!(!weights.is_empty() && counted(&[0.0], 1, 1).is_empty());
    }

    #[test]
    fn later_looks_widen_the_bins_and_add_up() {
        let mut weights = counted(&[1.0, 1.0, 2.0], 1, 0);
        for rows in [[4.0, 1.0], [0.5, 2.0]] {
            let mut table = WeightTable::new();
            table.look(&rows, 1);
            table.add_to(&mut weights, 0);
        }
        assert_eq!(weights.edges(0), Some((0.46875, 0.5625)));
        assert_eq!(weights.counts, [1, 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0, 1]);
    }

    #[test]
    fn bins_of_no_number_have_no_edges() {
        let weights = LogWeights { first: u32::MAX, counts: vec![1], zero: 0 };
        assert_eq!(weights.edges(0), None);
        assert_eq!(counted(&[f64::MAX], 1, 0).edges(0), None, "its upper end is infinite");
    }
}
