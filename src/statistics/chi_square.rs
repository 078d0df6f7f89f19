//! The χ² distribution, in log space so that no tail is ever too small to tell from zero.

use super::roots::{bracket, find_root};
use super::special::{ln_complement, ln_poisson};
use std::f64::consts::LN_2;

/// Natural logarithm of P(χ² > x) with `dof` degrees of freedom.
///
/// For `dof` from 1 to 100 000 and x to 1e7; relative error at most 1e-10 (1e-12 in the table
/// below). 0 for x ≤ 0, −∞ for x = ∞, NaN stays NaN.
pub fn ln_sf(x: f64, dof: f64) -> f64 {
    ln_gamma_upper(0.5 * dof, 0.5 * x)
}

/// P(χ² > x); underflows to 0 below 1e-308, where [`ln_sf`] goes on.
pub fn sf(x: f64, dof: f64) -> f64 {
    libm::exp(ln_sf(x, dof))
}

/// The x with `ln_sf(x, dof) = ln_tail`: the critical value of a test of size e^`ln_tail`.
pub fn quantile(ln_tail: f64, dof: f64) -> f64 {
    quantile_of(|x| ln_sf(x, dof), ln_tail, dof, 2.0 * dof)
}

/// Upper-tail quantile of any distribution on x > 0, from its ln survival function, mean and
/// variance. The search runs over ln x, because lower quantiles span hundreds of decades.
pub(super) fn quantile_of(ln_sf: impl Fn(f64) -> f64, ln_tail: f64, mean: f64, variance: f64) -> f64 {
    if ln_tail.is_nan() || ln_tail >= 0.0 {
        return if ln_tail.is_nan() { f64::NAN } else { 0.0 };
    }
    if ln_tail == f64::NEG_INFINITY {
        return f64::INFINITY;
    }
    // Below the median compare ln(−ln sf) ≈ ln cdf, which still resolves cdf = 1e-300.
    let lower = ln_tail > -LN_2;
    let gap = |u: f64| {
        let value = ln_sf(libm::exp(u));
        if lower { libm::log(-ln_tail) - libm::log(-value) } else { value - ln_tail }
    };
    let start = libm::log(mean);
    let step = variance.sqrt() / mean;
    let step = if gap(start) > 0.0 { step } else { -step };
    bracket(gap, start, step).map_or(f64::NAN, |end| libm::exp(find_root(gap, start, end)))
}

/// ln Q(a, x), the regularised upper incomplete gamma function.
pub(super) fn ln_gamma_upper(a: f64, x: f64) -> f64 {
    if x.is_nan() || a.is_nan() {
        f64::NAN
    } else if x <= 0.0 {
        0.0
    } else if x < a + 1.0 {
        ln_complement(ln_lower_series(a, x))
    } else {
        ln_upper_fraction(a, x)
    }
}

/// ln P(a, x), the regularised lower incomplete gamma function.
pub(super) fn ln_gamma_lower(a: f64, x: f64) -> f64 {
    if x.is_nan() || a.is_nan() {
        f64::NAN
    } else if x <= 0.0 {
        f64::NEG_INFINITY
    } else if x < a + 1.0 {
        ln_lower_series(a, x)
    } else {
        ln_complement(ln_upper_fraction(a, x))
    }
}

/// P(a,x) = xᵃe⁻ˣ/Γ(a+1) · Σ xⁿ/((a+1)…(a+n)), DLMF 8.11.4; all terms positive.
fn ln_lower_series(a: f64, x: f64) -> f64 {
    let (mut sum, mut term, mut divisor) = (1.0, 1.0, a);
    while term > f64::EPSILON * 0.01 * sum {
        divisor += 1.0;
        term *= x / divisor;
        sum += term;
    }
    ln_poisson(a, x) + libm::log(sum)
}

/// Q(a,x) = xᵃe⁻ˣ/Γ(a) · 1/(x+1−a − 1(1−a)/(x+3−a − 2(2−a)/(x+5−a − …))), DLMF 8.9.2,
/// by the modified Lentz method. About √a steps at x ≈ a, few elsewhere.
fn ln_upper_fraction(a: f64, x: f64) -> f64 {
    if x == f64::INFINITY {
        return f64::NEG_INFINITY;
    }
    let mut b = x + 1.0 - a;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut value = d;
    for i in 1..10_000_000u32 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / (b + numerator * d);
        c = b + numerator / c;
        let factor = c * d;
        value *= factor;
        if (factor - 1.0).abs() < 2.0 * f64::EPSILON {
            break;
        }
    }
    ln_poisson(a, x) + libm::log(a * value)
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "tables keep the digits they were printed with")]
mod tests {
    use super::*;

    #[test]
    fn matches_mpmath() {
        // mpmath, 40 digits: log(gammainc(dof/2, x/2, inf, regularized=True))
        for (x, dof, expected) in TABLE {
            let error = (ln_sf(x, dof) / expected - 1.0).abs();
            assert!(error < 1e-12, "{x} {dof}: {} {expected} off {error:e}", ln_sf(x, dof));
        }
    }

    #[test]
    fn critical_values_of_the_nist_handbook() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4, to the three decimals printed.
        for (dof, tail, expected) in [
            (1.0, 0.05, 3.841),
            (1.0, 0.001, 10.828),
            (5.0, 0.10, 9.236),
            (10.0, 0.01, 23.209),
            (30.0, 0.025, 46.979),
            (100.0, 0.001, 149.449),
            (100.0, 0.95, 77.929),
            (20.0, 0.99, 8.260),
            (1.0, 0.975, 0.001),
        ] {
            let x = quantile(libm::log(tail), dof);
            assert!((x - expected).abs() <= 0.000_51, "{dof} {tail}: {x}");
        }
    }

    #[test]
    fn quantile_inverts_the_tail() {
        for dof in [1.0, 2.0, 15.0, 1023.0, 1e5] {
            for ln_tail in [-1e-12, -1e-3, -0.5, -0.7, -5.0, -40.0, -1e4] {
                let back = ln_sf(quantile(ln_tail, dof), dof);
                assert!((back / ln_tail - 1.0).abs() < 1e-10, "{dof} {ln_tail} {back}");
            }
        }
        // Two degrees of freedom are exponential: ln sf = −x/2.
        assert!((quantile(-500.0, 2.0) - 1000.0).abs() < 1e-9);
    }

    #[test]
    fn edges() {
        assert_eq!(ln_sf(0.0, 3.0), 0.0);
        assert_eq!(ln_sf(-1.0, 3.0), 0.0);
        assert_eq!(ln_sf(f64::INFINITY, 3.0), f64::NEG_INFINITY);
        assert!(ln_sf(f64::NAN, 3.0).is_nan());
        assert_eq!(quantile(0.0, 3.0), 0.0);
        assert_eq!(quantile(f64::NEG_INFINITY, 3.0), f64::INFINITY);
        assert!(quantile(f64::NAN, 3.0).is_nan());
    }
    const TABLE: [(f64, f64, f64); 30] = [
        (0.001, 1.0, -0.025550779355950622),
        (0.5, 1.0, -0.7350111298370844),
        (3.0, 1.0, -2.4857327909860796),
        (50.0, 1.0, -27.200889545537434),
        (5000.0, 1.0, -2504.4845878484514),
        (10000000.0, 1.0, -5.0000082848392781e+6),
        (0.1, 2.0, -0.050000000000000003),
        (2.0, 3.0, -0.55790551845634767),
        (20.0, 3.0, -8.6812283547992423),
        (5.0, 15.0, -7.9047490250320104e-3),
        (15.5, 15.0, -0.87698274955478414),
        (60.0, 15.0, -15.193009679370736),
        (900.0, 15.0, -417.80973806361106),
        (30.0, 100.0, -9.0561255431522378e-13),
        (101.0, 100.0, -0.79143890955987206),
        (190.0, 100.0, -15.721693912008049),
        (500.0, 1023.0, -1.1912430974482637e-47),
        (1023.0, 1023.0, -0.70497669444016363),
        (1025.5, 1023.0, -0.75053832182095341),
        (1300.0, 1023.0, -18.694819187623878),
        (5000.0, 1023.0, -1182.2999504695423),
        (9000.0, 10000.0, -1.2697731705205227e-13),
        (10001.0, 10000.0, -0.70259440619192089),
        (11000.0, 10000.0, -26.345008644630426),
        (98000.0, 100000.0, -3.3847599563730096e-6),
        (100000.0, 100000.0, -0.69433730468638594),
        (100003.0, 100000.0, -0.699710330198508),
        (103000.0, 100000.0, -24.903878989868767),
        (1000000.0, 100000.0, -334879.27140668625),
        (10000000.0, 100000.0, -4.7197524146499917e+6),
    ];
}
