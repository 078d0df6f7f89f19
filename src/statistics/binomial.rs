//! Exact binomial tails in log space, and Clopper–Pearson intervals.

use super::roots::{bracket, find_root};
use super::special::{ln_binomial, ln_complement, ln_of};

/// Natural logarithm of P(X ≥ k) for X binomial of n trials with probability p.
///
/// For n to 2⁴⁰ and p from 1e-300 to 1; relative error at most 1e-9 there, 1e-12 for n ≤ 1e6.
/// Exact 0 (certain) for k = 0 or p = 1, −∞ (impossible) for k > n or p = 0. NaN stays NaN.
pub fn ln_upper_tail(k: u64, n: u64, p: f64) -> f64 {
    ln_tail(k, n, p, 1.0 - p)
}

/// Natural logarithm of the tail from k on outwards where k/n lies outside of `low` to
/// `high`, of which the nearer end is taken as p; 0 where it lies inside.
pub fn ln_tail_beyond(k: u64, n: u64, low: f64, high: f64) -> f64 {
    let share = k as f64 / n as f64;
    if share > high {
        ln_upper_tail(k, n, high)
    } else if share < low {
        ln_lower_tail(k, n, low.min(1.0))
    } else {
        0.0
    }
}

/// Natural logarithm of P(X ≤ k); otherwise as [`ln_upper_tail`].
pub fn ln_lower_tail(k: u64, n: u64, p: f64) -> f64 {
    if k >= n {
        return if p.is_nan() { f64::NAN } else { 0.0 };
    }
    ln_tail(n - k, n, 1.0 - p, p)
}

/// Clopper and Pearson's exact interval (Biometrika 26, 1934) for the probability behind k of n.
///
/// `tail` is the chance of missing on each side: 0.025 for a 95 % interval. Below the lower end
/// P(X ≥ k) < tail, above the upper end P(X ≤ k) < tail.
pub fn proportion_interval(k: u64, n: u64, tail: f64) -> (f64, f64) {
    let ln_tail_wanted = libm::log(tail);
    let estimate = (k as f64 + 0.5) / (n as f64 + 1.0);
    let start = libm::log(estimate / (1.0 - estimate));
    // Search over ln(p/q), handing both sides over so that neither loses digits.
    let solve = |k: u64, mirrored: bool, sign: f64| {
        let gap = |u: f64| {
            let (p, q) = (1.0 / (1.0 + libm::exp(-u)), 1.0 / (1.0 + libm::exp(u)));
            let ln = if mirrored { ln_tail(k, n, q, p) } else { ln_tail(k, n, p, q) };
            ln - ln_tail_wanted
        };
        // The estimate's own tail is about one half; for a larger `tail` search the other way.
        let direction = if gap(start) > 0.0 { sign } else { -sign };
        bracket(gap, start, 0.1 * direction)
            .map_or(f64::NAN, |end| 1.0 / (1.0 + libm::exp(-find_root(gap, start, end))))
    };
    let low = if k == 0 { 0.0 } else { solve(k, false, -1.0) };
    let high = if k >= n { 1.0 } else { solve(n - k, true, 1.0) };
    (low, high)
}

/// ln P(X ≥ k) given p and q = 1 − p separately.
fn ln_tail(k: u64, n: u64, p: f64, q: f64) -> f64 {
    if p.is_nan() {
        f64::NAN
    } else if k == 0 {
        0.0
    } else if k > n || p <= 0.0 {
        f64::NEG_INFINITY
    } else if q <= 0.0 {
        0.0
    } else if p * (n as f64 + 3.0) < k as f64 + 1.0 {
        ln_small_tail(k, n, p, q)
    } else {
        ln_complement(ln_small_tail(n - k + 1, n, q, p))
    }
}

/// P(X ≥ k) = I_p(k, n−k+1) = pmf(k)·q·(continued fraction DLMF 8.17.22), by modified Lentz, for
/// k above about np, where it converges within O(√n) steps.
fn ln_small_tail(k: u64, n: u64, p: f64, q: f64) -> f64 {
    if p > 0.5 {
        return ln_summed_tail(k, n, p, q);
    }
    let (a, b) = (k as f64, (n - k) as f64 + 1.0);
    let mut c = 1.0;
    let mut d = 1.0 / (1.0 - (a + b) * p / (a + 1.0));
    let mut value = d;
    for i in 1..100_000_000u32 {
        let i = f64::from(i);
        let even = i * (b - i) * p / ((a + 2.0 * i - 1.0) * (a + 2.0 * i));
        d = 1.0 / (1.0 + even * d);
        c = 1.0 + even / c;
        value *= c * d;
        let odd = -(a + i) * (a + b + i) * p / ((a + 2.0 * i) * (a + 2.0 * i + 1.0));
        d = 1.0 / (1.0 + odd * d);
        c = 1.0 + odd / c;
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() < 2.0 * f64::EPSILON {
            break;
        }
    }
    (ln_binomial(k, n, p, q) + ln_of(q, p) + libm::log(value)).min(0.0)
}

/// The same as pmf(k)·Σ Π (n−i)p/((i+1)q), which uses p/q alone: near p = 1 the fraction needs
/// digits of 1 − p that p no longer has. At most some 9√(npq) terms, as k is above about np.
fn ln_summed_tail(k: u64, n: u64, p: f64, q: f64) -> f64 {
    let odds = p / q;
    let (mut term, mut sum) = (1.0, 1.0);
    for i in k..n {
        let ratio = (n - i) as f64 / (i + 1) as f64 * odds;
        term *= ratio;
        sum += term;
        if ratio < 1.0 && term * ratio < 1e-17 * sum * (1.0 - ratio) {
            break;
        }
    }
    (ln_binomial(k, n, p, q) + libm::log(sum)).min(0.0)
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "tables keep the digits they were printed with")]
mod tests {
    use super::*;

    #[test]
    fn matches_direct_sums_of_forty_digits() {
        // mpmath, mp.dps = 40: log of sum over i >= k of binomial(n, i) p^i (1-p)^(n-i).
        for (k, n, p, expected) in TABLE {
            let value = ln_upper_tail(k, n, p);
            let error = (value / expected - 1.0).abs();
            assert!(error < 1e-9, "{k} {n} {p}: {value:e} {expected:e} off {error:e}");
        }
    }

    #[test]
    fn matches_brute_force_for_small_n() {
        for n in [1u64, 2, 13, 100, 2000] {
            for p in [1e-4, 0.03, 0.5, 0.77, 0.9999] {
                // Build ln pmf from k = 0 by ratios, add the tails in log space from both ends.
                let mut ln_pmf = vec![n as f64 * libm::log1p(-p)];
                for k in 0..n {
                    let ratio = (n - k) as f64 / (k + 1) as f64 * (p / (1.0 - p));
                    ln_pmf.push(ln_pmf[k as usize] + libm::log(ratio));
                }
                let add = |x: f64, y: f64| x.max(y) + libm::log1p(libm::exp(-(x - y).abs()));
                let mut upper = f64::NEG_INFINITY;
                for k in (0..=n).rev() {
                    let term = ln_pmf[k as usize];
                    upper = if upper == f64::NEG_INFINITY { term } else { add(upper, term) };
                    let value = ln_upper_tail(k, n, p);
                    assert!((value - upper).abs() < 1e-10 * (1.0 + upper.abs()), "{k} {n} {p}");
                }
                let mut lower = ln_pmf[0];
                for k in 0..n {
                    let value = ln_lower_tail(k, n, p);
                    assert!((value - lower).abs() < 1e-10 * (1.0 + lower.abs()), "{k} {n} {p}");
                    lower = add(lower, ln_pmf[k as usize + 1]);
                }
            }
        }
    }

    #[test]
    fn edges_are_exact() {
        let nothing = f64::NEG_INFINITY;
        assert_eq!(ln_upper_tail(0, 10, 0.0), 0.0);
        assert_eq!(ln_upper_tail(0, 0, 0.5), 0.0);
        assert_eq!(ln_upper_tail(1, 10, 0.0), nothing);
        assert_eq!(ln_upper_tail(10, 10, 1.0), 0.0);
        assert_eq!(ln_upper_tail(11, 10, 1.0), nothing);
        assert_eq!(ln_lower_tail(10, 10, 1.0), 0.0);
        assert_eq!(ln_lower_tail(9, 10, 1.0), nothing);
        assert_eq!(ln_lower_tail(0, 10, 0.0), 0.0);
        assert!(ln_upper_tail(3, 10, f64::NAN).is_nan());
        assert!((ln_upper_tail(2, 2, 1e-300) / (2.0 * libm::log(1e-300)) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn intervals_match_published_and_closed_forms() {
        // 10 of 20 at 95 %: 0.2720, 0.7280 (Clopper & Pearson's chart; scipy.stats.binomtest).
        let (low, high) = proportion_interval(10, 20, 0.025);
        assert!((low - 0.271_957_85).abs() < 1e-7 && (high - 0.728_042_15).abs() < 1e-7, "{low} {high}");
        // None of n: the upper end is 1 − tail^(1/n); all of n: its mirror image.
        for n in [5u64, 1000, 1 << 30] {
            let expected = -libm::expm1(libm::log(1e-9) / n as f64);
            let (low, high) = proportion_interval(0, n, 1e-9);
            assert!(low == 0.0 && (high / expected - 1.0).abs() < 1e-9, "{high} {expected}");
            let (low, high) = proportion_interval(n, n, 1e-9);
            assert!(high == 1.0 && (low + expected - 1.0).abs() < 1e-9, "{low} {expected}");
        }
        let (low, high) = proportion_interval(1 << 38, 1 << 40, 1e-6);
        assert!(low < 0.25 && high > 0.25 && high - low < 6e-6, "{low} {high}");
        assert_eq!(proportion_interval(0, 0, 0.025), (0.0, 1.0));
    }
    const TABLE: [(u64, u64, f64, f64); 15] = [
        (1, 10, 1e-300, -688.47294280521966),
        (3, 1099511627776, 1e-13, -8.497151741959366),
        (5, 1099511627776, 1e-12, -5.2166668378533007),
        (600000, 1000000, 0.5, -20141.528094297161),
        (500500, 1000000, 0.5, -1.839496909910938),
        (502500, 1000000, 0.5, -15.05986419758332),
        (1200, 1000000, 0.001, -21.502049644022069),
        (2000, 1000000, 0.001, -390.82230698579747),
        (1000000, 1000000, 0.999, -1000.5003335835344),
        (999500, 1000000, 0.999, -156.88700642176871),
        (549766299648, 1099511627776, 0.5, -203.91713626228953),
        (274877906944, 1099511627776, 0.2499, -29331.932812230206),
        (1099511627771, 1099511627776, 0.9, -1.1584511195139948e+11),
        (7, 8589934592, 1e-09, -0.28331733230680404),
        (900, 8589934592, 1e-09, -3299.5239075004748),
    ];
}
