//! Smith's masking from both sides of a surface.

/// How much less is visible from both sides at once than if masking above and
/// below were independent: G2/(G1 G1) for directions on opposite sides, in
/// (0, 1], from Smith's Λ of both.
///
/// A facet at a height that the share C of the surface lies below is visible
/// from above with probability C^Λo, and from below with (1 − C)^Λi; C is uniform
/// over facets. So G2 = ∫ C^Λo (1 − C)^Λi dC = B(1 + Λo, 1 + Λi), where reflection
/// has 1/(1 + Λo + Λi) (E. Heitz et al., *Multiple-scattering microfacet BSDFs
/// with the Smith model*, 2016, §5; E. d'Eon's Beta function, in Heitz 2014, §4).
pub(super) fn opposite_sides(lambda_o: f64, lambda_i: f64) -> f64 {
    // Γ(2 + a) Γ(2 + b)/Γ(2 + a + b)
    let (small, large) = if lambda_o < lambda_i { (lambda_o, lambda_i) } else { (lambda_i, lambda_o) };
    if small == 0.0 {
        return 1.0;
    }
    // B(1 + s, 1 + s) < 4^−s is below f64 there.
    if !(small < 600.0 && large < f64::MAX) {
        return 0.0;
    }
    (libm::lgamma(2.0 + small) - ln_gamma_step(2.0 + large, small)).exp().min(1.0)
}

/// ln Γ(x + s) − ln Γ(x) for x ≥ 2, s ≥ 0, without the cancellation of large x.
fn ln_gamma_step(x: f64, s: f64) -> f64 {
    // Γ(x + 1) = x Γ(x) leads to where Stirling's series is at rounding.
    let (mut product, mut x) = (1.0, x);
    while x < STIRLING {
        product *= 1.0 + s / x;
        x += 1.0;
    }
    let y = x + s;
    s * y.ln() + (x - 0.5) * (s / x).ln_1p() - s + stirling(y) - stirling(x) - product.ln()
}

/// From here on the first term left out of [`stirling`], 691/(360360 x¹¹), is
/// below 2e-14.
const STIRLING: f64 = 10.0;

/// ln Γ(x) − (x − ½) ln x + x − ½ ln 2π (Abramowitz and Stegun 1964, 6.1.41).
fn stirling(x: f64) -> f64 {
    let r = 1.0 / x;
    let r2 = r * r;
    r * (1.0 / 12.0 - r2 * (1.0 / 360.0 - r2 * (1.0 / 1260.0 - r2 * (1.0 / 1680.0 - r2 / 1188.0))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Midpoints of C = sin² t, where nothing is singular.
    fn by_heights(a: f64, b: f64) -> f64 {
        let n = 20_000;
        let sum: f64 = (0..n)
            .map(|k| {
                let (sin, cos) = ((f64::from(k) + 0.5) / f64::from(n) * PI / 2.0).sin_cos();
                sin.powf(2.0 * a) * cos.powf(2.0 * b) * 2.0 * sin * cos
            })
            .sum();
        sum / f64::from(n) * PI / 2.0
    }

    #[test]
    fn is_the_integral_over_heights() {
        for (a, b) in [(0.0, 3.0), (0.01, 0.02), (0.5, 1.5), (3.0, 40.0), (300.0, 0.3), (20.0, 25.0)] {
            let g2 = opposite_sides(a, b) / ((1.0 + a) * (1.0 + b));
            let error = g2 / by_heights(a, b) - 1.0;
            assert!(error.abs() < 1e-6, "{a} {b}: {error:e}");
            assert_eq!(opposite_sides(a, b), opposite_sides(b, a));
        }
        // B(2, 3) = 1! 2!/4!, and B(1 + a, 2) = 1/((1 + a)(2 + a)).
        assert!((opposite_sides(1.0, 2.0) / 6.0 - 1.0 / 12.0).abs() < 1e-13);
        for a in [1e-9, 0.1, 7.0, 1e3, 1e9] {
            assert!((opposite_sides(a, 1.0) * (2.0 + a) - 2.0).abs() < 1e-11, "{a}");
        }
    }

    #[test]
    fn stays_between_0_and_1_at_the_horizon() {
        for big in [1e3, 1e16, 1e300, f64::MAX, f64::INFINITY] {
            for other in [0.0, 1e-300, 1e-9, 1.0, 600.0, big] {
                let g = opposite_sides(big, other);
                assert!((0.0..=1.0).contains(&g), "{big} {other}: {g}");
            }
            assert_eq!(opposite_sides(big, 0.0), 1.0);
        }
    }
}
