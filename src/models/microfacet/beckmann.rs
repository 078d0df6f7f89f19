//! The Beckmann distribution of normals.

use super::Roughness;
use crate::bsdf::Direction;
use std::f64::consts::PI;

/// Gaussian slopes (P. Beckmann and A. Spizzichino, *The Scattering of
/// Electromagnetic Waves from Rough Surfaces*, 1963; R. L. Cook and K. E.
/// Torrance, *A reflectance model for computer graphics*, 1982).
#[derive(Clone, Copy, Debug)]
pub struct Beckmann {
    /// α, √2 times the standard deviation of the slope.
    pub alpha: Roughness,
}

impl Beckmann {
    /// D(m) per steradian; ∫D cos θ = 1.
    pub fn density(&self, m: Direction) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let z2 = m.z * m.z;
        let e = (-self.alpha.scaled_square(m) / z2).exp();
        if e == 0.0 { 0.0 } else { e / (PI * self.alpha.x * self.alpha.y * z2 * z2) }
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0); cos θ times Smith's Λ (Walter et al. 2007, before the
    /// rational fit; Heitz 2014, eq. 66).
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        let s = self.alpha.scale(w);
        let t = s.x.hypot(s.y);
        if t == 0.0 { 0.0 } else { tail(t, s.z, s.z / t) }
    }

    /// A normal with density D cos θ (Walter et al. 2007, eq. 28).
    pub fn sample(&self, u: &[f64]) -> Direction {
        let r = (-(-u[0]).ln_1p()).sqrt();
        let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
        self.alpha.scale(Direction::new(r * cos, r * sin, 1.0)).normalized()
    }

    /// A normal visible from `wo` (E. Heitz and E. d'Eon, *Importance sampling
    /// microfacet-based BSDFs using the distribution of visible normals*, EGSR
    /// 2014), with the distribution function of the slope inverted to rounding.
    pub fn sample_visible(&self, wo: Direction, u: &[f64]) -> Direction {
        let w = self.alpha.scale(wo).normalized();
        let t = w.x.hypot(w.y);
        let (cos, sin) = if t > 0.0 { (w.x / t, w.y / t) } else { (1.0, 0.0) };
        // Slopes towards the view and across, of unit roughness. Across, the
        // view does not matter.
        let p = visible_slope(w.z, t, u[0]);
        let q = gaussian_slope(u[1]);
        self.alpha.scale(Direction::new(cos * p - sin * q, sin * p + cos * q, 1.0)).normalized()
    }
}

/// ∫ (t x − z) exp(−x²)/√π dx over x from `p` up.
fn tail(t: f64, z: f64, p: f64) -> f64 {
    0.5 * (t * (-p * p).exp() / PI.sqrt() - z * libm::erfc(p))
}

/// The slope with the density exp(−q²)/√π below which is the share `u`; u = 0
/// counts as half the smallest step.
fn gaussian_slope(u: f64) -> f64 {
    let u = u.max(f64::EPSILON / 4.0);
    // The tail at hand keeps its relative precision.
    if u < 0.5 {
        -statrs::function::erf::erfc_inv(2.0 * u)
    } else {
        statrs::function::erf::erfc_inv(2.0 * (1.0 - u))
    }
}

/// The slope p > −z/t with a density like (z + t p) exp(−p²) below which is the
/// share `u`; (t, z) is a unit vector. Halley's method inside a bracket.
fn visible_slope(z: f64, t: f64, u: f64) -> f64 {
    if t == 0.0 {
        return gaussian_slope(u);
    }
    // Beyond 6.2 there is less than the smallest step of u.
    let (mut low, mut high) = ((-z / t).max(-6.2), 6.2);
    let wanted = (1.0 - u) * (z + tail(t, z, z / t));
    // Exact for a view along the normal and along the horizon.
    let mut p = z * gaussian_slope(u) + (1.0 - z) * (-(-u).ln_1p()).sqrt();
    for _ in 0..100 {
        p = if p > low && p < high { p } else { 0.5 * (low + high) };
        let excess = tail(t, -z, p) - wanted;
        if excess > 0.0 {
            low = p;
        } else {
            high = p;
        }
        let visible = z + t * p;
        let newton = excess * PI.sqrt() / (visible * (-p * p).exp());
        let step = newton / (1.0 + 0.5 * newton * (t / visible - 2.0 * p));
        p += step;
        if step.abs() <= 1e-15 * (1.0 + p.abs()) || high - low <= 1e-15 {
            break;
        }
    }
    if p.is_finite() { p.clamp(low, high) } else { low }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverts_to_rounding() {
        for theta in [0.0, 0.3, 1.0, 1.5, 89.99f64.to_radians(), PI / 2.0] {
            let (t, z) = theta.sin_cos();
            let z = z.max(0.0);
            for i in 0..=200 {
                let u = (f64::from(i) / 200.0).clamp(0.0, 1.0 - f64::EPSILON / 2.0);
                let p = visible_slope(z, t, u);
                let all = if t > 0.0 { z + tail(t, z, z / t) } else { z };
                let above = tail(t, -z, p) / all;
                assert!((above - (1.0 - u)).abs() < 2e-15, "{theta} {u} {p}: {above}");
            }
        }
    }

    #[test]
    fn area_equals_the_published_form() {
        let beckmann = Beckmann { alpha: Roughness::isotropic(0.5) };
        for theta in [0.3f64, 0.9, 1.3, 1.55] {
            let a = 1.0 / (0.5 * theta.tan());
            let lambda = 0.5 * (libm::erf(a) - 1.0) + (-a * a).exp() / (2.0 * a * PI.sqrt());
            let area = beckmann.backfacing_area(Direction::from_angles(theta, 2.0));
            assert!((area - lambda * theta.cos()).abs() < 1e-15);
        }
    }
}
