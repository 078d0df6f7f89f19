//! Burley's distribution of normals with the longest tail.

use crate::bsdf::Direction;
use crate::sphere::sin_cos_turns;
use std::f64::consts::PI;

/// Generalised Trowbridge–Reitz with exponent γ = 1; GGX has γ = 2 (B. Burley,
/// *Physically-based shading at Disney*, SIGGRAPH 2012 course notes, appendix B):
/// D = (α² − 1)/(π ln α² (1 + (α² − 1) cos²θ)).
#[derive(Clone, Copy, Debug)]
pub struct Gtr1 {
    alpha2: f64,
    ln_alpha2: f64,
    scale: f64,
}

impl Gtr1 {
    /// With `alpha` in (0, 1), where the normalisation is not 0/0.
    pub fn new(alpha: f64) -> Self {
        let alpha2 = alpha * alpha;
        let ln_alpha2 = alpha2.ln();
        Self { alpha2, ln_alpha2, scale: (alpha2 - 1.0) / (PI * ln_alpha2) }
    }

    /// D(m) per steradian, 0 below the horizon; ∫D cos θ = 1.
    #[inline]
    pub fn density(&self, m: Direction) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        // 1 + (α² − 1) cos²θ without cancellation at the pole.
        self.scale / (m.x * m.x + m.y * m.y + self.alpha2 * m.z * m.z)
    }

    /// A normal with density D cos θ.
    #[inline]
    pub fn sample(&self, u: &[f64]) -> Direction {
        // cos²θ = (1 − (α²)^(1−u))/(1 − α²), and the sine of it without cancellation.
        let sin2 = self.alpha2 * (-u[0] * self.ln_alpha2).exp_m1() / (1.0 - self.alpha2);
        let cos2 = -((1.0 - u[0]) * self.ln_alpha2).exp_m1() / (1.0 - self.alpha2);
        let (y, x) = sin_cos_turns(u[1]);
        let sin = sin2.sqrt();
        Direction::new(sin * x, sin * y, cos2.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫D cos θ in v = sin²θ is π ∫D dv; v = eˢ − 1 shifted to the pole's scale.
    #[test]
    fn density_is_normalised() {
        for alpha in [0.001, 0.1, 0.5, 0.999] {
            let d = Gtr1::new(alpha);
            let n = 20_000;
            let (from, to) = ((alpha * alpha * 1e-3).ln(), (1.0 + alpha * alpha * 1e-3).ln());
            let sum: f64 = (0..n)
                .map(|k| {
                    let shifted = (from + (to - from) * (f64::from(k) + 0.5) / f64::from(n)).exp();
                    let v = (shifted - alpha * alpha * 1e-3).max(0.0);
                    d.density(Direction::new(v.sqrt(), 0.0, (1.0 - v).sqrt().max(1e-300))) * shifted
                })
                .sum();
            let mass = PI * sum * (to - from) / f64::from(n);
            assert!((mass - 1.0).abs() < 1e-6, "{alpha}: {mass}");
        }
    }

    /// The area that u covers, by central differences, is the density's inverse.
    #[test]
    fn draws_follow_the_density() {
        let h = 1e-6;
        for alpha in [0.001, 0.1, 0.7] {
            let d = Gtr1::new(alpha);
            for (u, v) in [(0.02, 0.1), (0.5, 0.7), (0.97, 0.4)] {
                let at = |u: f64, v: f64| d.sample(&[u, v]);
                assert!((at(u, v).length() - 1.0).abs() < 1e-12);
                let area = (at(u + h, v) - at(u - h, v)).cross(at(u, v + h) - at(u, v - h)).length();
                let jacobian = area / (4.0 * h * h) * d.density(at(u, v)) * at(u, v).z;
                assert!((jacobian - 1.0).abs() < 1e-4, "{alpha} {u} {v}: {jacobian}");
            }
        }
    }
}
