//! The GGX (Trowbridge–Reitz) distribution of normals.

use super::Roughness;
use crate::bsdf::Direction;
use std::f64::consts::PI;

/// GGX (B. Walter et al., *Microfacet models for refraction through rough
/// surfaces*, EGSR 2007, eq. 33; T. S. Trowbridge and K. P. Reitz 1975).
#[derive(Clone, Copy, Debug)]
pub struct Ggx {
    /// α, a slope.
    pub alpha: Roughness,
}

impl Ggx {
    /// D(m) per steradian; ∫D cos θ = 1.
    #[inline]
    pub fn density(&self, m: Direction) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let s = self.alpha.scaled_square(m) + m.z * m.z;
        1.0 / (PI * self.alpha.x * self.alpha.y * s * s)
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0); cos θ times Smith's Λ (Heitz 2014, eq. 72).
    #[inline]
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        let s = self.alpha.scale(w);
        let t2 = s.x * s.x + s.y * s.y;
        let sum = s.z + (t2 + s.z * s.z).sqrt();
        if t2 == 0.0 { 0.0 } else { 0.5 * t2 / sum }
    }

    /// A normal with density D cos θ (Walter et al. 2007, eq. 35).
    #[inline]
    pub fn sample(&self, u: &[f64]) -> Direction {
        let r = u[0].sqrt();
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        self.alpha.scale(Direction::new(r * cos, r * sin, (1.0 - u[0]).sqrt())).normalized()
    }

    /// A normal visible from `wo` (J. Dupuy and A. Benyoub, *Sampling visible
    /// GGX normals with spherical caps*, HPG 2023): the half vector of the
    /// stretched view and a point of a spherical cap.
    #[inline]
    pub fn sample_visible(&self, wo: Direction, u: &[f64]) -> Direction {
        let w = self.alpha.scale(wo).normalized();
        let t2 = w.x * w.x + w.y * w.y;
        // The cap spans z from −w.z to 1. Its z + w.z, 1 − z and 1 + z are
        // formed without cancellation.
        let z = (1.0 - u[0]) * (1.0 + w.z);
        let below_top = u[0] * (1.0 + w.z);
        let above_bottom = z + t2 / (1.0 + w.z);
        let r = (below_top * above_bottom).sqrt();
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        self.alpha.scale(Direction::new(r * cos + w.x, r * sin + w.y, z)).normalized()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// tan²θ of Walter et al. (2007), eq. 33, written with angles.
    #[test]
    fn equals_the_published_form() {
        let alpha: f64 = 0.3;
        let ggx = Ggx { alpha: Roughness::isotropic(alpha) };
        for theta in [0.0f64, 0.2, 0.7, 1.4] {
            let d =
                alpha * alpha / (PI * theta.cos().powi(4) * (alpha * alpha + theta.tan().powi(2)).powi(2));
            let value = ggx.density(Direction::from_angles(theta, 0.8));
            assert!((value / d - 1.0).abs() < 1e-13);
            let lambda = ((1.0 + (alpha * theta.tan()).powi(2)).sqrt() - 1.0) / 2.0;
            let area = ggx.backfacing_area(Direction::from_angles(theta, 0.8));
            assert!((area - lambda * theta.cos()).abs() < 1e-15);
        }
    }
}
