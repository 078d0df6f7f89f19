//! The Beckmann distribution of normals.

use super::Roughness;
use crate::bsdf::Direction;
use crate::sphere::sin_cos_turns;
use std::f64::consts::PI;
use std::sync::LazyLock;

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
        let x = self.alpha.scaled_square(m) / z2;
        if x > STEEPEST * STEEPEST { 0.0 } else { (-x).exp() / (PI * self.alpha.x * self.alpha.y * z2 * z2) }
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0); cos θ times Smith's Λ (Walter et al. 2007, before the
    /// rational fit; Heitz 2014, eq. 66).
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        let s = self.alpha.scale(w);
        let t = (s.x * s.x + s.y * s.y).sqrt();
        if t == 0.0 { 0.0 } else { tail(t, s.z, s.z / t) }
    }

    /// A normal with density D cos θ (Walter et al. 2007, eq. 28).
    pub fn sample(&self, u: &[f64]) -> Direction {
        let r = (-(-u[0]).ln_1p()).sqrt();
        let (sin, cos) = sin_cos_turns(u[1]);
        self.alpha.scale(Direction::new(r * cos, r * sin, 1.0)).normalized()
    }

    /// A normal visible from `wo` (E. Heitz and E. d'Eon, *Importance sampling
    /// microfacet-based BSDFs using the distribution of visible normals*, EGSR
    /// 2014), with the distribution function of the slope inverted to rounding;
    /// `backfacing` is wo's [backfacing area](Self::backfacing_area).
    pub fn sample_visible(&self, wo: Direction, backfacing: f64, u: &[f64]) -> Direction {
        let scaled = self.alpha.scale(wo);
        let per_length = 1.0 / scaled.length();
        let w = scaled * per_length;
        let t = (w.x * w.x + w.y * w.y).sqrt();
        let (cos, sin) = if t > 0.0 { (w.x / t, w.y / t) } else { (1.0, 0.0) };
        // Slopes towards the view and across, of unit roughness. Across, the
        // view does not matter.
        let p = visible_slope(w.z, t, w.z + backfacing * per_length, u[0]);
        let q = gaussian_slope(u[1]);
        self.alpha.scale(Direction::new(cos * p - sin * q, sin * p + cos * q, 1.0)).normalized()
    }
}

/// exp(−p²) counts as 0 beyond this slope p of unit roughness: no draw comes near, and
/// from 26.6 on it is subnormal, which processors take a hundred times as long for.
const STEEPEST: f64 = 26.0;

/// ∫ (t x − z) exp(−x²)/√π dx over x from `p` up.
fn tail(t: f64, z: f64, p: f64) -> f64 {
    if p > STEEPEST {
        return 0.0;
    }
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

/// The slope p > −z/t with the density (z + t p) exp(−p²)/√π, of which there is `all`,
/// below which is the share `u`; (t, z) is a unit vector.
#[inline]
fn visible_slope(z: f64, t: f64, all: f64, u: f64) -> f64 {
    if t == 0.0 {
        return gaussian_slope(u);
    }
    search(z, t, all, u, START.at(z, t, u))
}

/// As [`visible_slope`], from `p` by a method of third order inside a bracket.
fn search(z: f64, t: f64, all: f64, u: f64, mut p: f64) -> f64 {
    // Beyond 6.2 there is less than the smallest step of u.
    let (mut low, mut high) = ((-z / t).max(-6.2), 6.2);
    let wanted = (1.0 - u) * all;
    for _ in 0..100 {
        p = if p > low && p < high { p } else { 0.5 * (low + high) };
        let decay = (-p * p).exp();
        let excess = 0.5 * (t * decay / PI.sqrt() + z * libm::erfc(p)) - wanted;
        if excess > 0.0 {
            low = p;
        } else {
            high = p;
        }
        let visible = z + t * p;
        let newton = excess * PI.sqrt() / (visible * decay);
        // First and second derivative of the density over it: Halley's step
        // with the next term of the inverse series.
        let ratio = t / visible;
        let (first, second) = (ratio - 2.0 * p, 4.0 * p * p - 2.0 - 4.0 * p * ratio);
        let half = 0.5 * newton * first;
        let third = newton * newton * (0.25 * first * first - second / 6.0);
        let step = newton / (1.0 + half - third.clamp(-0.5, 0.5));
        p += step;
        // The next step would be like the fourth power of this one.
        if (step * (first.abs() + 1.0)).abs() <= SMALL_STEP || high - low <= 1e-15 {
            break;
        }
    }
    if p.is_finite() { p.clamp(low, high) } else { low }
}

/// A step after which [`search`] is at rounding.
const SMALL_STEP: f64 = 1e-4;

/// Slopes to start from, linear between places in z/(z + t) and in
/// √(−ln(1 − u)), which is the slope itself at the horizon.
struct Start {
    /// Rows of one z/(z + t), [`STEPS_SHARE`] + 1 each.
    slopes: Vec<f64>,
}

/// Steps in z/(z + t) and in √(−ln(1 − u)) up to 6.2: with as many, one step of
/// [`search`] is enough for most u.
const STEPS_VIEW: usize = 64;
const STEPS_SHARE: usize = 256;
const SHARE_SCALE: f64 = STEPS_SHARE as f64 / 6.2;

static START: LazyLock<Start> = LazyLock::new(Start::new);

impl Start {
    fn new() -> Self {
        let row = |k: usize| {
            let view = (k as f64 / STEPS_VIEW as f64).min(1.0 - 1e-9);
            let length = view.hypot(1.0 - view);
            let (z, t) = (view / length, (1.0 - view) / length);
            let all = z + tail(t, z, z / t);
            (0..=STEPS_SHARE).map(move |j| {
                let r = j as f64 / SHARE_SCALE;
                let u = (-(-r * r).exp_m1()).clamp(1e-6, 1.0 - f64::EPSILON);
                search(z, t, all, u, z * gaussian_slope(u) + (1.0 - z) * r)
            })
        };
        Self { slopes: (0..=STEPS_VIEW).flat_map(row).collect() }
    }

    #[inline]
    fn at(&self, z: f64, t: f64, u: f64) -> f64 {
        let view = z / (z + t) * STEPS_VIEW as f64;
        let share = (-(-u).ln_1p()).sqrt() * SHARE_SCALE;
        let (k, j) = ((view as usize).min(STEPS_VIEW - 1), (share as usize).min(STEPS_SHARE - 1));
        let x = share - j as f64;
        let row = |k: usize| {
            let s = &self.slopes[k * (STEPS_SHARE + 1) + j..][..2];
            s[0] + x * (s[1] - s[0])
        };
        let (a, b) = (row(k), row(k + 1));
        a + (view - k as f64) * (b - a)
    }
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
                let all = if t > 0.0 { z + tail(t, z, z / t) } else { z };
                let p = visible_slope(z, t, all, u);
                let above = tail(t, -z, p) / all;
                assert!((above - (1.0 - u)).abs() < 2e-15, "{theta} {u} {p}: {above}");
            }
        }
    }

    #[test]
    fn nothing_is_subnormal() {
        for k in 0..=4000 {
            let p = 24.0 + 1e-3 * f64::from(k);
            let (t, z) = (1.0 / p.hypot(1.0), p / p.hypot(1.0));
            let area = tail(t, z, p);
            assert!(!area.is_subnormal() && area.abs() < 1e-250, "{p}: {area:e}");
            let beckmann = Beckmann { alpha: Roughness::isotropic(0.01) };
            let density = beckmann.density(Direction::from_angles((0.01 * p).atan(), 0.4));
            assert!(!density.is_subnormal() && density < 1e-240, "{p}: {density:e}");
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
