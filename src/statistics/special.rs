//! Logarithms of point probabilities without cancellation, and small helpers in log space.
//!
//! `x ln m − m − ln Γ(x+1)` subtracts numbers of the size of x ln x to leave one of order 1.
//! Loader's form (C. Loader, *Fast and accurate computation of binomial probabilities*, 2000)
//! splits it into Stirling's error and a deviance, both small where the probability is not.

use std::f64::consts::{LN_2, PI};

const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_8;

/// From here on Stirling's series, cut after a⁻¹¹, is exact to the last bit.
const STIRLING_FROM: f64 = 16.0;

/// ln(1 − eˡ) for l ≤ 0: the logarithm of the other tail.
pub fn ln_complement(l: f64) -> f64 {
    if l > -LN_2 { libm::log(-libm::expm1(l)) } else { libm::log1p(-libm::exp(l)) }
}

/// ln Γ(a+1) − ln(√(2πa) (a/e)ᵃ) for a > 0; absolute error below 1e-14.
pub fn stirling_error(a: f64) -> f64 {
    if a < STIRLING_FROM {
        return libm::lgamma(a + 1.0) - (a + 0.5) * libm::log(a) + a - HALF_LN_TWO_PI;
    }
    // Bernoulli numbers: B₂ₖ / (2k(2k−1) a²ᵏ⁻¹), Abramowitz & Stegun 6.1.40.
    let s = 1.0 / (a * a);
    let tail = 1.0 / 1680.0 - s * (1.0 / 1188.0 - s * (691.0 / 360_360.0));
    (1.0 / 12.0 - s * (1.0 / 360.0 - s * (1.0 / 1260.0 - s * tail))) / a
}

/// x ln(x/m) + m − x for x, m > 0, given `excess` = m − x computed as exactly as the caller can.
pub fn deviance(x: f64, m: f64, excess: f64) -> f64 {
    let d = excess / x;
    if d.abs() >= 0.1 {
        // The quotient overflows only for m far below anything a count can be compared with.
        let ln_ratio = if m > 1e-250 { libm::log(x / m) } else { libm::log(x) - libm::log(m) };
        return x * ln_ratio + excess;
    }
    // d − ln(1+d) with r = d/(2+d): ln(1+d) = 2 artanh r and d − 2r = d·r exactly.
    let r = d / (2.0 + d);
    let r2 = r * r;
    let mut power = r * r2;
    let mut sum = 0.0;
    let mut odd = 3.0;
    while power.abs() > f64::EPSILON * 1e-3 * r2 {
        sum += power / odd;
        power *= r2;
        odd += 2.0;
    }
    x * (d * r - 2.0 * sum)
}

/// ln(mᵏ e⁻ᵐ / Γ(k+1)) for real k ≥ 0 and m ≥ 0: the Poisson probability, and the gamma density.
///
/// Absolute error about 1e-14 + 1e-15·|value|.
pub fn ln_poisson(k: f64, m: f64) -> f64 {
    if k == 0.0 {
        -m
    } else if m == 0.0 {
        f64::NEG_INFINITY
    } else if k < STIRLING_FROM {
        k * libm::log(m) - m - libm::lgamma(k + 1.0)
    } else {
        -deviance(k, m, m - k) - stirling_error(k) - 0.5 * libm::log(2.0 * PI * k)
    }
}

/// ln of the binomial probability of k out of n, with p + q = 1 and both positive.
///
/// Both are taken, because the smaller one carries digits that 1 − the other has lost.
pub fn ln_binomial(k: u64, n: u64, p: f64, q: f64) -> f64 {
    if k == 0 {
        return n as f64 * ln_of(q, p);
    }
    if k == n {
        return n as f64 * ln_of(p, q);
    }
    let (k_f, n_f, rest) = (k as f64, n as f64, (n - k) as f64);
    // n·p − k without rounding the product, from the side whose probability is exact.
    let excess = if p <= q { libm::fma(n_f, p, -k_f) } else { -libm::fma(n_f, q, -rest) };
    stirling_error(n_f)
        - stirling_error(k_f)
        - stirling_error(rest)
        - deviance(k_f, n_f * p, excess)
        - deviance(rest, n_f * q, -excess)
        - 0.5 * libm::log(2.0 * PI * k_f * (rest / n_f))
}

/// ln p, given its complement q too.
pub(super) fn ln_of(p: f64, q: f64) -> f64 {
    if q < 0.5 { libm::log1p(-q) } else { libm::log(p) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{a:e} against {b:e}");
    }

    #[test]
    fn point_probabilities_match_their_definition() {
        for m in [0.3, 7.0, 40.0, 900.0] {
            let mut direct = -m; // ln of e⁻ᵐ mᵏ/k!, built up factor by factor
            for k in 0..1000u32 {
                close(ln_poisson(f64::from(k), m), direct, 1e-13);
                direct += libm::log(m / f64::from(k + 1));
            }
        }
    }

    #[test]
    fn binomial_probabilities_sum_to_one() {
        for (n, p) in [(1u64, 0.4), (17, 0.01), (60, 0.5), (2000, 0.97)] {
            let total: f64 = (0..=n).map(|k| libm::exp(ln_binomial(k, n, p, 1.0 - p))).sum();
            close(total, 1.0, 1e-12);
        }
    }

    #[test]
    fn complement_is_its_own_inverse() {
        for l in [-1e-12, -0.1, -0.7, -5.0, -30.0] {
            close(ln_complement(ln_complement(l)) / l, 1.0, 1e-3_f64.min(1e-15 / libm::exp(l)));
        }
    }
}
