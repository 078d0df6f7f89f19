//! The standard normal distribution, by way of χ² with one degree of freedom.

use super::chi_square;
use super::special::ln_complement;
use std::f64::consts::LN_2;

/// Natural logarithm of P(Z > z); relative error at most 1e-12.
pub fn ln_sf(z: f64) -> f64 {
    let half = chi_square::ln_sf(z * z, 1.0) - LN_2;
    if z < 0.0 { ln_complement(half) } else { half }
}

/// The z with P(Z > z) = e^`ln_tail`.
pub fn quantile(ln_tail: f64) -> f64 {
    if ln_tail > -LN_2 {
        return -quantile(ln_complement(ln_tail));
    }
    chi_square::quantile(ln_tail + LN_2, 1.0).sqrt()
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "tables keep the digits they were printed with")]
mod tests {
    use super::*;

    #[test]
    fn matches_scipy_norm_logsf() {
        // mpmath, 40 digits: log(erfc(z/sqrt(2))/2)
        for (z, expected) in NORMAL {
            assert!((ln_sf(z) / expected - 1.0).abs() < 1e-12, "{z}: {} {expected}", ln_sf(z));
            assert!((quantile(expected) - z).abs() < 1e-11 * (1.0 + z.abs()), "{z}");
        }
    }
    const NORMAL: [(f64, f64); 11] = [
        (-6.0, -9.8658764552437573e-10),
        (-2.5, -6.2290254858600024e-3),
        (-0.3, -0.48141016158848121),
        (0.0, -LN_2),
        (0.2, -0.8657395226815953),
        (1.0, -1.8410216450092635),
        (3.0, -6.6077262215103495),
        (6.0, -20.736768949974706),
        (20.0, -203.91715537109726),
        (50.0, -1254.8313611394199),
        (300.0, -45006.622732118663),
    ];
}
