//! The GGX (Trowbridge–Reitz) distribution of normals.

use super::Roughness;
use crate::bsdf::Direction;
use crate::sphere::sin_cos_turns;
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
    #[inline(always)]
    pub fn density(&self, m: Direction) -> f64 {
        let s = self.alpha.scaled_square(m) + m.z * m.z;
        let density = 1.0 / (PI * self.alpha.x * self.alpha.y * s * s);
        if m.z <= 0.0 { 0.0 } else { density }
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0); cos θ times Smith's Λ (Heitz 2014, eq. 72).
    #[inline(always)]
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        let s = self.alpha.scale(w);
        let t2 = s.x * s.x + s.y * s.y;
        let area = 0.5 * t2 / (s.z + (t2 + s.z * s.z).sqrt());
        if t2 == 0.0 { 0.0 } else { area }
    }

    /// A normal with density D cos θ (Walter et al. 2007, eq. 35).
    #[inline]
    pub fn sample(&self, u: &[f64]) -> Direction {
        let r = u[0].sqrt();
        let (sin, cos) = sin_cos_turns(u[1]);
        self.alpha.scale(Direction::new(r * cos, r * sin, (1.0 - u[0]).sqrt())).normalized()
    }

    /// A normal visible from `wo`.
    #[inline]
    pub fn sample_visible(&self, wo: Direction, u: &[f64]) -> Direction {
        self.seen_from(wo).sample([u[0], u[1]])
    }

    /// What the normals visible from `wo` have in common.
    #[inline]
    pub fn seen_from(&self, wo: Direction) -> VisibleNormals {
        let w = self.alpha.scale(wo).normalized();
        let above = 1.0 + w.z;
        VisibleNormals { alpha: self.alpha, w, above, below: (w.x * w.x + w.y * w.y) / above }
    }
}

/// Normals visible from one direction (J. Dupuy and A. Benyoub, *Sampling visible GGX
/// normals with spherical caps*, HPG 2023): half vectors of the stretched view and
/// points of a spherical cap.
#[derive(Clone, Copy, Debug)]
pub struct VisibleNormals {
    alpha: Roughness,
    /// The stretched view.
    w: Direction,
    /// 1 + w.z
    above: f64,
    /// 1 − w.z
    below: f64,
}

impl VisibleNormals {
    /// One of them.
    #[inline(always)]
    pub fn sample(&self, [u, v]: [f64; 2]) -> Direction {
        // The cap spans z from −w.z to 1. Its z + w.z, 1 − z and 1 + z are
        // formed without cancellation.
        let z = (1.0 - u) * self.above;
        let below_top = u * self.above;
        let above_bottom = z + self.below;
        let r = (below_top * above_bottom).sqrt();
        let (sin, cos) = sin_cos_turns(v);
        self.alpha.scale(Direction::new(r * cos + self.w.x, r * sin + self.w.y, z)).normalized()
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
