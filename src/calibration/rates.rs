//! A frequency that was seen, beside the one that is allowed.

use crate::statistics::binomial::{ln_upper_tail, proportion_interval};
use serde::{Deserialize, Serialize};

/// Chance of missing the true rate, on the one side that each bound is for.
const TAIL: f64 = 0.05;

/// How often something was seen, and how often it may happen at most.
///
/// Trials may have different nominal rates; then `nominal` is their mean, and the
/// bounds of equal trials hold: among trials of one mean rate, equal ones vary most
/// (W. Hoeffding, *On the distribution of the number of successes in independent
/// trials*, Annals of Mathematical Statistics 27, 1956).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rate {
    /// How often it was seen.
    pub count: u64,
    /// In so many trials.
    pub of: u64,
    /// The rate per trial that is allowed.
    pub nominal: f64,
    /// The rate is at least this, with 95 % confidence (Clopper and Pearson).
    pub low: f64,
    /// The rate is at most this, with 95 % confidence.
    pub high: f64,
}

/// What a frequency says of the rate that is allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// The rate is shown to be at most nominal: one-sided, 95 %.
    Below,
    /// It may be below or above: too few trials to tell.
    Open,
    /// It is above, with 95 % confidence if this were the only rate looked at.
    Above,
}

impl Rate {
    /// `count` in `of` trials that allow `expected` in all.
    pub fn new(count: u64, of: u64, expected: f64) -> Self {
        let nominal = if of == 0 { 0.0 } else { (expected / of as f64).min(1.0) };
        let (low, high) = proportion_interval(count, of, TAIL);
        Self { count, of, nominal, low, high }
    }

    /// What it says of the nominal rate.
    pub fn standing(&self) -> Standing {
        if self.low > self.nominal {
            Standing::Above
        } else if self.high <= self.nominal {
            Standing::Below
        } else {
            Standing::Open
        }
    }

    /// How many the nominal rate lets expect.
    pub fn expected(&self) -> f64 {
        self.nominal * self.of as f64
    }

    /// Whether so many would be seen with a probability below `level` were the rate
    /// nominal.
    pub fn exceeds(&self, level: f64) -> bool {
        ln_upper_tail(self.count, self.of, self.nominal) < libm::log(level)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_below_open_or_above() {
        // 3/n is the familiar bound of none in n.
        let none = Rate::new(0, 10_000, 100.0);
        assert!((none.high - 3e-4).abs() < 1e-6 && none.low == 0.0);
        assert_eq!((none.standing(), none.nominal), (Standing::Below, 0.01));
        assert_eq!(Rate::new(0, 100, 1.0).standing(), Standing::Open);
        assert_eq!(Rate::new(5, 100, 1.0).standing(), Standing::Above);
        assert_eq!(Rate::new(0, 0, 0.0).standing(), Standing::Open);
    }

    #[test]
    fn more_than_allowed_is_told_at_its_level() {
        // P(X ≥ 5) of 100 at 1 % is 3.4e-3.
        let five = Rate::new(5, 100, 1.0);
        assert!(five.exceeds(0.05) && five.exceeds(4e-3) && !five.exceeds(3e-3));
        assert!(!Rate::new(0, 100, 0.0).exceeds(0.05) && Rate::new(1, 100, 0.0).exceeds(1e-9));
        assert!(!Rate::new(0, 0, 0.0).exceeds(0.05));
    }
}
