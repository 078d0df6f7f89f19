//! A mixture of lobes drawn with one sample (E. Veach, *Robust Monte Carlo
//! Methods for Light Transport Simulation*, 1997, §9.2.4): a lobe is chosen with
//! its share as probability, the random number that chose it is used again, and
//! pdf is Σ share · density whichever lobe was drawn from.

/// A lobe that is there at all is drawn at least so often: a rarer one would only
/// be found by luck, with large weights where it overlaps with others.
const LEAST: f64 = 0.05;

/// Shares of lobes with these `weights` ≥ 0: their parts of the sum, raised to
/// [`LEAST`] where they are not 0. All of it goes to the first where the sum is 0.
#[inline]
pub(crate) fn shares<const N: usize>(weights: [f64; N]) -> [f64; N] {
    let sum: f64 = weights.iter().sum();
    if sum <= 0.0 {
        return std::array::from_fn(|k| f64::from(k == 0));
    }
    let rest = 1.0 - LEAST * weights.iter().filter(|w| **w > 0.0).count() as f64;
    weights.map(|w| if w > 0.0 { LEAST + rest * (w / sum) } else { 0.0 })
}

/// The lobe that `u` in [0, 1) chooses, each with its share, and `u` stretched
/// from the lobe's part of [0, 1) to all of it.
#[inline]
pub(crate) fn choose<const N: usize>(shares: [f64; N], u: f64) -> (usize, f64) {
    // Below 1, whatever the division rounds to.
    let stretched = |below: f64, share: f64| ((u - below) / share).min(1.0 - f64::EPSILON / 2.0);
    let (mut below, mut chosen) = (0.0, (0, 0.0));
    for (lobe, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
        chosen = (lobe, stretched(below, share));
        below += share;
        if u < below {
            break;
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_parts_of_the_sum_and_never_tiny() {
        let [a, b, c] = shares([1.0, 0.0, 3.0]);
        assert!((a - (0.05 + 0.9 * 0.25)).abs() < 1e-15 && b == 0.0 && (a + c - 1.0).abs() < 1e-15);
        assert_eq!(shares([1e-9, 1.0]).map(|s| (s * 1e6).round()), [50_000.0, 950_000.0]);
        assert_eq!(shares([0.0, 2.0]), [0.0, 1.0]);
        assert_eq!(shares([0.0, 0.0]), [1.0, 0.0]);
    }

    #[test]
    fn the_number_that_chose_is_uniform_again() {
        let last = 1.0 - f64::EPSILON / 2.0;
        assert_eq!(choose([0.25, 0.75], 0.125), (0, 0.5));
        assert_eq!(choose([0.25, 0.75], 0.25), (1, 0.0));
        assert_eq!(choose([0.25, 0.75], 0.625), (1, 0.5));
        assert_eq!(choose([0.0, 1.0, 0.0], 0.0), (1, 0.0));
        // Shares that round to less than 1 still leave the last lobe.
        for third in [[1.0 / 3.0; 3], [0.1, 0.2, 0.7]] {
            let (lobe, u) = choose(third, last);
            assert!(lobe == 2 && (0.99..1.0).contains(&u));
        }
    }
}
