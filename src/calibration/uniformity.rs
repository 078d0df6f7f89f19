//! p-values that must be uniform.

use super::rates::Rate;
use crate::evidence::Figure;
use crate::statistics::uniformity::kolmogorov_smirnov;
use serde::{Deserialize, Serialize};

/// Bins of the histogram: wide enough that each expects a hundred values of a quick
/// calibration.
const BINS: usize = 50;

/// p-values below this are counted: tails are where thresholds lie.
const SMALL: f64 = 1e-3;

/// How uniform p-values are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Uniformity {
    /// Number of p-values.
    pub count: u64,
    /// Kolmogorov and Smirnov's largest distance from the uniform distribution.
    pub distance: Figure,
    /// Its p-value, two-sided.
    pub p_value: Figure,
    /// Counts in equal bins from 0 to 1.
    pub bins: Vec<u64>,
    /// Those below 10⁻³.
    pub small: Rate,
}

impl Uniformity {
    /// Of these p-values, which are sorted. One that is no number counts as not
    /// uniform.
    pub fn of(values: &mut [f64]) -> Self {
        let (distance, p_value) = kolmogorov_smirnov(values);
        let mut bins = vec![0; BINS];
        for p in values.iter().filter(|p| p.is_finite()) {
            bins[((p.clamp(0.0, 1.0) * BINS as f64) as usize).min(BINS - 1)] += 1;
        }
        let count = values.len() as u64;
        let small = values.iter().filter(|p| **p < SMALL).count() as u64;
        Self {
            count,
            distance: distance.into(),
            p_value: p_value.into(),
            bins,
            small: Rate::new(small, count, SMALL * count as f64),
        }
    }

    /// What is wrong, each with a probability below `level` were the values uniform.
    pub fn errors(&self, level: f64) -> Vec<String> {
        let mut errors = Vec::new();
        if self.p_value.0 < level {
            errors.push(format!(
                "{} p-values are not uniform: Kolmogorov–Smirnov D = {:.5}, p = {:.1e}",
                self.count, self.distance.0, self.p_value.0
            ));
        }
        if self.small.exceeds(level) {
            let Rate { count, of, .. } = self.small;
            errors.push(format!("{count} of {of} p-values are below 10⁻³, one in 1000 is nominal"));
        }
        errors
    }

    /// Statements that may be wrong in [`Self::errors`].
    pub const STATEMENTS: usize = 2;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::streams::StreamKey;

    fn drawn(n: usize, power: f64) -> Vec<f64> {
        let mut stream = StreamKey::new(9).with("test", "uniformity").block(0);
        (0..n).map(|_| stream.next_f64().powf(power)).collect()
    }

    #[test]
    fn uniform_values_have_no_error_and_bent_ones_have() {
        let flat = Uniformity::of(&mut drawn(20_000, 1.0));
        assert_eq!(flat.errors(1e-3), [""; 0], "{flat:?}");
        assert_eq!(flat.bins.iter().sum::<u64>(), flat.count);
        // u^1.3 is below 1e-3 with probability 1e-3^(1/1.3) = 4.9e-3.
        let bent = Uniformity::of(&mut drawn(20_000, 1.3));
        assert_eq!(bent.errors(1e-3).len(), 2, "{bent:?}");
    }

    #[test]
    fn none_is_no_error_and_no_number_is_one() {
        assert_eq!(Uniformity::of(&mut []).errors(0.05), [""; 0]);
        assert_eq!(Uniformity::of(&mut [0.5, f64::NAN, 1.0]).errors(0.05).len(), 1);
    }
}
