//! Deviation of a mean of bounded variables whose variance is known.
//!
//! Bernstein's inequality (Boucheron, Lugosi, Massart, *Concentration Inequalities*, 2013,
//! Theorem 2.10, with equation 2.10 for bounded variables): for N independent variables of
//! variance v that stay within `bound` of their mean, each side has
//! P(mean − μ ≥ t) ≤ exp(−N t² / (2v + 2·bound·t/3)). It holds for every N, unlike the normal
//! approximation, which a rare large weight deceives.

use std::f64::consts::LN_2;

/// The t with P(|mean − μ| ≥ t) ≤ e^`ln_tail`, both sides together.
///
/// `bound` is the largest possible |X − μ|; the full range of X serves as well. Infinite for
/// n = 0.
pub fn bernstein_deviation(variance: f64, bound: f64, n: u64, ln_tail: f64) -> f64 {
    if n == 0 {
        return f64::INFINITY;
    }
    // N t² − (2/3)·bound·L·t − 2vL = 0, its positive root.
    let l = LN_2 - ln_tail;
    let n = n as f64;
    let linear = bound * l / 3.0;
    (linear + (linear * linear + 2.0 * n * variance * l).sqrt()) / n
}

/// Natural logarithm of the bound on P(|mean − μ| ≥ |`deviation`|); never above 0.
///
/// A deviation of 0 gives 0, also when variance and bound are 0; with those 0, any other
/// deviation is impossible and gives −∞.
pub fn bernstein_ln_tail(deviation: f64, variance: f64, bound: f64, n: u64) -> f64 {
    let t = deviation.abs();
    if t == 0.0 {
        return 0.0;
    }
    let exponent = n as f64 * t * t / (2.0 * variance + 2.0 * bound * t / 3.0);
    if n == 0 || exponent < LN_2 { 0.0 } else { LN_2 - exponent }
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "tables keep the digits they were printed with")]
mod tests {
    use super::super::streams::StreamKey;
    use super::*;

    #[test]
    fn hand_computed_case() {
        // v = 1/4, bound = 1/2, N = 100, L = ln 2 − ln(2e-6) = ln 1e6:
        // t = (L/6 + sqrt(L²/36 + 50 L))/100, bc -l.
        let t = bernstein_deviation(0.25, 0.5, 100, libm::log(2e-6));
        assert!((t - HAND).abs() < 1e-14, "{t}");
    }

    #[test]
    fn deviation_and_tail_are_inverse() {
        for ln_tail in [-0.5, -3.0, -14.0, -900.0] {
            for (v, b, n) in [(0.25, 0.5, 1u64), (1e-4, 3.0, 1_000_000), (0.0, 1.0, 50), (2.0, 0.0, 7)] {
                let t = bernstein_deviation(v, b, n, ln_tail);
                let back = bernstein_ln_tail(-t, v, b, n);
                assert!((back - ln_tail).abs() < 1e-12 * (1.0 - ln_tail), "{back} {ln_tail}");
            }
        }
    }

    #[test]
    fn degenerate_cases() {
        assert_eq!(bernstein_ln_tail(0.0, 0.0, 0.0, 10), 0.0);
        assert_eq!(bernstein_ln_tail(1e-9, 0.0, 0.0, 10), f64::NEG_INFINITY);
        assert_eq!(bernstein_ln_tail(1e-9, 1.0, 1.0, 10), 0.0);
        assert_eq!(bernstein_ln_tail(5.0, 1.0, 1.0, 0), 0.0);
        assert!(bernstein_ln_tail(f64::NAN, 1.0, 1.0, 10).is_nan());
        assert_eq!(bernstein_deviation(1.0, 1.0, 0, -1.0), f64::INFINITY);
    }

    #[test]
    fn rare_large_weights_stay_within_the_nominal_rate() {
        // X = 50 with probability 1/50, else 0: mean 1, variance 49. The normal interval of the
        // same size is crossed far more often than nominal; Bernstein's never.
        let (n, runs, ln_tail) = (200u64, 4000, libm::log(0.01));
        let limit = bernstein_deviation(49.0, 49.0, n, ln_tail);
        let mut stream = StreamKey::new(7).with("test", "bernstein").block(0);
        let beyond = (0..runs)
            .filter(|_| {
                let hits = (0..n).filter(|_| stream.next_f64() < 0.02).count();
                (hits as f64 * 50.0 / n as f64 - 1.0).abs() >= limit
            })
            .count();
        assert!(beyond <= 40, "{beyond} of {runs} beyond {limit}");
    }
    const HAND: f64 = 0.28685864381374634;
}
