//! The non-central χ² distribution: what Pearson's statistic follows when the sampler is off.
//!
//! P(χ'² > x) = Σⱼ Poisson(j; λ/2) · Q(dof/2 + j, x/2) (Abramowitz & Stegun 26.4.25). The terms
//! are log-concave in j, so the sum starts 8.5 standard deviations before its largest term and
//! stops when the geometric bound on the rest is below rounding: O(√λ) terms. The upper sum runs
//! upwards and the lower one downwards: in those directions every recurrence only adds, so the
//! smaller tail is found to full relative accuracy and the other is its complement.

use super::chi_square::{self, ln_gamma_lower, ln_gamma_upper, quantile_of};
use super::roots::{bracket, find_root};
use super::special::{ln_complement, ln_poisson};

/// Sums below this fraction of the total are rounding.
const NEGLIGIBLE: f64 = 1e-17;

/// Rescale before a running term overflows.
const HUGE: f64 = 1e250;

/// Natural logarithm of P(χ'² > x) with `dof` degrees of freedom and non-centrality `lambda`.
///
/// For dof from 1 to 100 000, λ from 0 to 1e7, x to 1e7; relative error at most 1e-10 (absolute
/// near 0). Takes some 13 µs at λ = 1e4, growing like √λ.
pub fn ln_sf(x: f64, dof: f64, lambda: f64) -> f64 {
    ln_tails(x, dof, lambda).0
}

/// P(χ'² > x).
pub fn sf(x: f64, dof: f64, lambda: f64) -> f64 {
    libm::exp(ln_sf(x, dof, lambda))
}

/// Natural logarithm of P(χ'² ≤ x), as accurate as [`ln_sf`].
pub fn ln_cdf(x: f64, dof: f64, lambda: f64) -> f64 {
    ln_tails(x, dof, lambda).1
}

/// P(χ'² ≤ x); small values keep their relative accuracy.
pub fn cdf(x: f64, dof: f64, lambda: f64) -> f64 {
    libm::exp(ln_cdf(x, dof, lambda))
}

/// The x with `ln_sf(x, dof, lambda) = ln_tail`.
pub fn quantile(ln_tail: f64, dof: f64, lambda: f64) -> f64 {
    if lambda == 0.0 {
        return chi_square::quantile(ln_tail, dof);
    }
    quantile_of(|x| ln_sf(x, dof, lambda), ln_tail, dof + lambda, 2.0 * dof + 4.0 * lambda)
}

/// The λ with sf(x; dof, λ) = p, where sf grows with λ.
///
/// 0 if λ = 0 already gives p or more, ∞ for p ≥ 1, NaN for a NaN. With p = 0.025 and 0.975 the
/// two ends of a central 95 % interval; with p a power and x a threshold, the detection limit.
pub fn lambda_where_sf(x: f64, dof: f64, p: f64) -> f64 {
    if x.is_nan() || dof.is_nan() || p.is_nan() {
        return f64::NAN;
    }
    if p >= 1.0 {
        return f64::INFINITY;
    }
    // Compare the smaller of the two tails; search in √λ, in which the tail is nearly a normal one.
    let gap = |root: f64| {
        let (ln_sf, ln_cdf) = ln_tails(x, dof, root * root);
        if p <= 0.5 { ln_sf - libm::log(p) } else { libm::log1p(-p) - ln_cdf }
    };
    if p <= 0.0 || gap(0.0) >= 0.0 {
        return 0.0;
    }
    let step = (x - dof).max(1.0).sqrt() + 1.0;
    bracket(gap, 0.0, step).map_or(f64::NAN, |end| find_root(gap, 0.0, end).powi(2))
}

/// (ln sf, ln cdf).
fn ln_tails(x: f64, dof: f64, lambda: f64) -> (f64, f64) {
    if x.is_nan() || dof.is_nan() || lambda.is_nan() {
        return (f64::NAN, f64::NAN);
    }
    if x <= 0.0 {
        return (0.0, f64::NEG_INFINITY);
    }
    if x == f64::INFINITY {
        return (f64::NEG_INFINITY, 0.0);
    }
    let (a, y, m) = (0.5 * dof, 0.5 * x, 0.5 * lambda);
    if m == 0.0 {
        return (ln_gamma_upper(a, y), ln_gamma_lower(a, y));
    }
    if x >= dof + lambda {
        let upper = ln_upper_sum(a, y, m);
        (upper, ln_complement(upper))
    } else {
        let lower = ln_lower_sum(a, y, m);
        (ln_complement(lower), lower)
    }
}

/// Where Poisson(j; m) · (gamma density of shape a + j at y) is largest: j(a+j) = my.
fn largest_term(a: f64, y: f64, m: f64) -> f64 {
    2.0 * m * y / (a + (a * a + 4.0 * m * y).sqrt())
}

/// For x above the mean. The largest term lies at or above `largest_term`, below which the terms
/// fall faster than a Gaussian of variance j.
fn ln_upper_sum(a: f64, y: f64, m: f64) -> f64 {
    let peak = largest_term(a, y, m).max(m);
    let mut j = (peak - 8.5 * peak.sqrt() - 2.0).floor().max(0.0);
    let ln_first = ln_gamma_upper(a + j, y);
    let mut scale = ln_poisson(j, m) + ln_first;
    // hazard = (yˢ e⁻ʸ / Γ(s+1)) / Q(s, y) with s = a + j, so that Q(s+1) = Q(s)(1 + hazard).
    let mut hazard = libm::exp(ln_poisson(a + j, y) - ln_first);
    let (mut term, mut sum) = (1.0, 1.0);
    loop {
        let growth = 1.0 + hazard;
        j += 1.0;
        let ratio = m / j * growth;
        hazard *= y / ((a + j) * growth);
        term *= ratio;
        sum += term;
        if ratio < 1.0 && term * ratio < NEGLIGIBLE * sum * (1.0 - ratio) {
            return (scale + libm::log(sum)).min(0.0);
        }
        if sum > HUGE {
            (term, sum) = (term / HUGE, sum / HUGE);
            scale += libm::log(HUGE);
        }
    }
}

/// For x below the mean: the same downwards, from above the largest term, with
/// P(s−1, y) = P(s, y) + yˢ⁻¹ e⁻ʸ / Γ(s).
fn ln_lower_sum(a: f64, y: f64, m: f64) -> f64 {
    let peak = largest_term(a, y, m).min(m);
    // The upper Poisson tail is heavier: Bernstein's bound at e⁻⁴⁰.
    let mut j = (peak + 9.0 * peak.sqrt() + 28.0).ceil();
    let ln_first = ln_gamma_lower(a + j, y);
    let mut scale = ln_poisson(j, m) + ln_first;
    let mut hazard = libm::exp(ln_poisson(a + j - 1.0, y) - ln_first);
    let (mut term, mut sum) = (1.0, 1.0);
    while j > 0.0 {
        let growth = 1.0 + hazard;
        let ratio = j / m * growth;
        j -= 1.0;
        hazard *= (a + j) / (y * growth);
        term *= ratio;
        sum += term;
        if ratio < 1.0 && term * ratio < NEGLIGIBLE * sum * (1.0 - ratio) {
            break;
        }
        if sum > HUGE {
            (term, sum) = (term / HUGE, sum / HUGE);
            scale += libm::log(HUGE);
        }
    }
    (scale + libm::log(sum)).min(0.0)
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "tables keep the digits they were printed with")]
mod tests {
    use super::*;

    #[test]
    fn matches_the_mixture_in_sixty_digits() {
        // mpmath, mp.dps = 60: sum of exp(j log m - m - loggamma(j+1)) gammainc(a+j, y, inf,
        // regularized=True) over 25 standard deviations either side; columns x, dof, lambda,
        // log sf, log cdf.
        for (x, dof, lambda, sf_expected, cdf_expected) in TABLE {
            let (sf, cdf) = ln_tails(x, dof, lambda);
            for (value, expected) in [(sf, sf_expected), (cdf, cdf_expected)] {
                let error = (value - expected).abs();
                assert!(
                    error <= 1e-10 * expected.abs(),
                    "{x} {dof} {lambda}: {value:e} {expected:e} off {error:e}"
                );
            }
        }
    }

    #[test]
    fn even_degrees_of_freedom_two_is_marcum_q() {
        // P(χ'²₂ > x) by integrating the Rice density over r from √x: an independent route.
        let (x, lambda) = (9.0f64, 4.0f64);
        let bessel_i0 = |z: f64| {
            let (mut term, mut sum) = (1.0, 1.0);
            for k in 1..200 {
                term *= (z * 0.5 / f64::from(k)).powi(2);
                sum += term;
            }
            sum
        };
        let density = |r: f64| r * libm::exp(-0.5 * (r * r + lambda)) * bessel_i0(r * lambda.sqrt());
        let (n, from, to) = (20_000, x.sqrt(), 14.0);
        let h = (to - from) / f64::from(n);
        let simpson: f64 = (0..=n)
            .map(|i| {
                let weight = if i == 0 || i == n {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                weight * density(from + h * f64::from(i))
            })
            .sum::<f64>()
            * h
            / 3.0;
        assert!((sf(x, 2.0, lambda) - simpson).abs() < 1e-11, "{simpson}");
    }

    #[test]
    fn inverses_return_to_where_they_started() {
        for ln_tail in [-1e-9, -0.02, -0.7, -6.9, -30.0, -400.0] {
            for (dof, lambda) in [(1.0, 0.0), (1.0, 2.0), (15.0, 90.0), (1023.0, 1e4), (63.0, 1e6)] {
                let x = quantile(ln_tail, dof, lambda);
                let back = ln_sf(x, dof, lambda);
                assert!((back / ln_tail - 1.0).abs() < 1e-9, "{dof} {lambda}: {back:e} {ln_tail:e}");
                let p = libm::exp(ln_tail);
                if p > 1e-300 && lambda > 0.0 {
                    let found = lambda_where_sf(x, dof, p);
                    // p near 1 has lost digits of its complement, whatever follows.
                    let tolerance = if p > 0.999 { 1e-5 } else { 1e-8 };
                    assert!((found / lambda - 1.0).abs() < tolerance, "{dof} {lambda} {p}: {found}");
                }
            }
        }
    }

    #[test]
    fn edges() {
        assert_eq!(lambda_where_sf(1.0, 10.0, 0.5), 0.0);
        assert_eq!(lambda_where_sf(1.0, 10.0, 0.0), 0.0);
        assert_eq!(lambda_where_sf(1.0, 10.0, 1.0), f64::INFINITY);
        assert!(lambda_where_sf(f64::NAN, 10.0, 0.5).is_nan());
        assert_eq!(sf(0.0, 5.0, 3.0), 1.0);
        assert_eq!(sf(f64::INFINITY, 5.0, 3.0), 0.0);
        assert!(sf(1.0, 5.0, f64::NAN).is_nan());
        assert_eq!(quantile(0.0, 5.0, 3.0), 0.0);
        let continuous = ln_sf(20.0, 9.0, 1e-12) / ln_sf(20.0, 9.0, 0.0) - 1.0;
        assert!(continuous.abs() < 1e-11);
    }

    #[test]
    fn monotone_in_x_and_lambda_across_the_switch_of_sums() {
        let mut last = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..2000 {
            let step = f64::from(i);
            let down = ln_sf(1000.0 + step, 1023.0, 900.0);
            let up = ln_sf(1500.0, 1023.0, step);
            assert!(down < last.0 && up > last.1, "{i}");
            last = (down, up);
        }
    }
    const TABLE: [(f64, f64, f64, f64, f64); 29] = [
        (0.5, 1.0, 0.1, -0.69111289050440547, -0.69518561738868768),
        (10.0, 1.0, 3.0, -2.572735695062425, -0.079396574579284012),
        (100.0, 1.0, 20.0, -17.937782202298846, -1.6207654696210329e-8),
        (1.0, 4.0, 30.0, -1.9492901938288449e-7, -15.4506304452771),
        (40.0, 4.0, 30.0, -1.283445337450886, -0.32445811902979849),
        (300.0, 4.0, 30.0, -71.799189263170022, -6.5767040306117386e-32),
        (2.0, 15.0, 0.001, -2.9642313161758658e-5, -10.426322539806776),
        (900.0, 1023.0, 90.0, -1.7542100046973868e-6, -13.253492819268209),
        (1100.0, 1023.0, 90.0, -0.51205567037059738, -0.91444849422540605),
        (1113.0, 1023.0, 90.0, -0.7048714980006038, -0.68155873131519656),
        (1400.0, 1023.0, 90.0, -17.380231682427445, -2.830487832224019e-8),
        (3000.0, 1023.0, 90.0, -368.78457313012424, -6.9007275075159033e-161),
        (1000.0, 15.0, 10000.0, -1.0039308112636662e-1021, -2350.9354568411097),
        (9000.0, 1024.0, 10000.0, -1.4868503393406251e-25, -57.167967308476861),
        (11024.0, 1024.0, 10000.0, -0.69698245285725731, -0.68932656139536662),
        (13000.0, 1024.0, 10000.0, -45.769897878969649, -1.3255188675190896e-20),
        (40000.0, 1024.0, 10000.0, -4657.481016743115, -1.9129114174893865e-2023),
        (200.0, 15.0, 10000.0, -9.885765998677924e-1610, -3704.8709037757788),
        (100000.0, 10000.0, 100000.0, -1.3660600909360227e-56, -128.63283445704918),
        (110000.0, 10000.0, 100000.0, -0.69435953692805486, -0.6919362922202051),
        (120000.0, 10000.0, 100000.0, -117.43315953334586, -9.9868107989113151e-52),
        (990000.0, 15.0, 1000000.0, -2.5892224426791115e-7, -15.166738164963402),
        (1000020.0, 15.0, 1000000.0, -0.69554368708209241, -0.69075640355322343),
        (1010000.0, 15.0, 1000000.0, -14.964456342047613, -3.1697079914871055e-7),
        (10000000.0, 1.0, 5000.0, -4.7789021576220141e+6, -1.4567640488499924e-2075451),
        (9980000.0, 1023.0, 10000000.0, -4.4134459082031447e-4, -7.7259052667391031),
        (10001000.0, 1023.0, 10000000.0, -0.69037565185365137, -0.69592641199087583),
        (10040000.0, 1023.0, 10000000.0, -21.714498711299187, -3.7111886599685842e-10),
        (50.0, 30.0, 1e-200, -4.3898926331705657, -0.012479608105938984),
    ];
}
