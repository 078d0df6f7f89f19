//! A sampler for isotropic reflection of which only values are known.

use super::half_difference::angle;
use super::warp::{Blend, Slice, Warp, locate};
use crate::bsdf::Direction;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Nodes along s and along w, so that 64 patches span each.
const NODES: usize = 65;

/// Steps of θo, 2° each.
const STEPS: usize = 45;

/// The largest θo with a table of its own, in degrees: at 90° values of analytic
/// models are 0 or infinite.
const GRAZING: f64 = 89.9;

/// Share of a density ∝ cos θi that is mixed in, so that nothing with f > 0 has
/// p = 0, whatever a table missed.
const FLOOR: f64 = 0.05;

/// Slope of φ against w at the mirror azimuth over the mean one: patches there
/// are 0.4° wide, as narrow as lobes become towards grazing (2α cos θo).
const SLOPE: f64 = 0.05;

/// Draws wi nearly in proportion to f·cos θi, channels averaged, for a given wo:
/// tables of f·cos θi for steps of θo, linear in between, inverted by marginal
/// and conditional distributions. The density is exact: it is that of the
/// tables, not of f.
///
/// wi has the coordinates s = √(1 − cos θi) in [0, 1] and w in [−1, 1] with
/// φi − φo − π = π w (a + (1 − a)|w|), a = [`SLOPE`]: about the mirror azimuth,
/// where lobes are narrow in φ, patches are too. In polar coordinates the table
/// for normal incidence is exactly round.
#[derive(Clone, Debug)]
pub struct IsotropicSampler {
    warp: Warp,
    thetas: Vec<f64>,
}

/// s below which a direction is the normal.
const POLE: f64 = 1e-9;

/// φi − φo − π in [−π, π] of w.
fn azimuth(w: f64) -> f64 {
    PI * w * (SLOPE + (1.0 - SLOPE) * w.abs())
}

/// y.atan2(x).
fn turn(y: f64, x: f64) -> f64 {
    let first = angle(y.abs(), x.abs());
    (if x < 0.0 { PI - first } else { first }).copysign(y)
}

/// w of φi − φo − π in [−π, π].
fn inverse_azimuth(phi: f64) -> f64 {
    let q = phi.abs() / PI;
    (2.0 * q / (SLOPE + (SLOPE * SLOPE + 4.0 * (1.0 - SLOPE) * q).sqrt())).copysign(phi)
}

/// Solid angle of a unit of area of (s, (w + 1)/2): dω = 2s ds dφ.
fn area(s: f64, w: f64) -> f64 {
    4.0 * PI * s * (SLOPE + 2.0 * (1.0 - SLOPE) * w.abs())
}

/// The direction at s and w, for a wo whose azimuth has this (cos, sin).
fn direction(s: f64, w: f64, [cos, sin]: [f64; 2]) -> Direction {
    let (sin_w, cos_w) = azimuth(w).sin_cos();
    let (x, y) = (-cos_w, -sin_w);
    // cos θ = 1 − s², so sin θ = s √(2 − s²).
    let sin_theta = s * (2.0 - s * s).sqrt();
    Direction::new(sin_theta * (x * cos - y * sin), sin_theta * (x * sin + y * cos), (1.0 - s) * (1.0 + s))
}

/// cos and sin of the azimuth; of the tangent at the normal.
fn azimuth_of(d: Direction) -> [f64; 2] {
    let r = (d.x * d.x + d.y * d.y).sqrt();
    if r > 0.0 { [d.x / r, d.y / r] } else { [1.0, 0.0] }
}

impl IsotropicSampler {
    /// For `value`, f in sr⁻¹ of (wo, wi) with channels averaged. It is asked on
    /// the front side only, at 950 000 pairs; what is not finite and positive
    /// counts as 0.
    pub fn new(value: impl Fn(Direction, Direction) -> f64 + Sync) -> Self {
        let step = 90.0 / STEPS as f64;
        let thetas: Vec<f64> = (0..=STEPS).map(|k| (k as f64 * step).min(GRAZING).to_radians()).collect();
        let slices: Vec<Vec<f64>> = thetas.par_iter().map(|theta| slice(*theta, &value)).collect();
        let warp = Warp::new([NODES; 2], slices.concat()).expect("the floor is positive");
        Self { warp, thetas }
    }

    /// The density for a wo on the front side, which so many `calls` will ask for;
    /// `None` from behind.
    pub fn given(&self, wo: Direction, calls: usize) -> Option<GivenLobe<'_>> {
        let lobe = || {
            let blend = Blend::between(locate(&self.thetas, wo.theta()));
            GivenLobe { slice: self.warp.slice(blend, calls), axis: azimuth_of(wo) }
        };
        (wo.z > 0.0).then(lobe)
    }
}

/// The density of an [`IsotropicSampler`] for one wo.
#[derive(Clone, Debug)]
pub struct GivenLobe<'a> {
    slice: Slice<'a>,
    axis: [f64; 2],
}

impl GivenLobe<'_> {
    /// The density of [`sample`](Self::sample) in sr⁻¹; 0 behind.
    #[inline]
    pub fn pdf(&self, wi: Direction) -> f64 {
        if !(wi.z > 0.0) {
            return 0.0;
        }
        // 1 − cos θ without cancellation.
        let s = ((wi.x * wi.x + wi.y * wi.y) / (1.0 + wi.z)).sqrt();
        let [cos, sin] = self.axis;
        let (x, y) = (wi.x * cos + wi.y * sin, wi.y * cos - wi.x * sin);
        // The normal has no azimuth: its density is that towards the mirror direction.
        let (s, w) = if s < POLE { (POLE, 0.0) } else { (s.min(1.0), inverse_azimuth(turn(-y, -x))) };
        self.slice.density([s, 0.5 + 0.5 * w]) / area(s, w)
    }

    /// A direction from `u` in [0, 1)², and its density.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> Option<(Direction, f64)> {
        let ([s, x], density) = self.slice.sample(u);
        let w = 2.0 * x - 1.0;
        let wi = direction(s, w, self.axis);
        if !(wi.z > 0.0) {
            return None;
        }
        let pdf = if s < POLE { self.pdf(wi) } else { density / area(s, w) };
        Some((wi, pdf))
    }
}

/// The table for one θo: f·cos θi averaged about each node, per unit of (s, w),
/// with the floor.
fn slice(theta: f64, value: &(impl Fn(Direction, Direction) -> f64 + Sync)) -> Vec<f64> {
    let wo = Direction::from_angles(theta, 0.0);
    let pitch = 1.0 / (NODES - 1) as f64;
    let at = |s: f64, x: f64| {
        let wi = direction(s.clamp(0.0, 1.0), (2.0 * x - 1.0).clamp(-1.0, 1.0), [1.0, 0.0]);
        let f = if wi.z > 0.0 { value(wo, wi) * wi.z } else { 0.0 };
        if f > 0.0 && f < f64::INFINITY { f } else { 0.0 }
    };
    let mut table = Vec::with_capacity(NODES * NODES);
    let mut floor = Vec::with_capacity(NODES * NODES);
    // x of the warp is s, y is (w + 1)/2.
    for j in 0..NODES {
        let y = j as f64 * pitch;
        for i in 0..NODES {
            let s = i as f64 * pitch;
            let quarter = 0.25 * pitch;
            let about = at(s - quarter, y) + at(s + quarter, y) + at(s, y - quarter) + at(s, y + quarter);
            let area = area(s, 2.0 * y - 1.0);
            table.push(0.2 * (at(s, y) + about) * area);
            floor.push((1.0 - s * s).max(0.0) / PI * area);
        }
    }
    // w = −1 and w = 1 are one azimuth, that of wo.
    for i in 0..NODES {
        let j = NODES * (NODES - 1) + i;
        let mean = 0.5 * (table[i] + table[j]);
        (table[i], table[j]) = (mean, mean);
    }
    let sum: f64 = table.iter().sum();
    let scale = if sum > 0.0 { (1.0 - FLOOR) * floor.iter().sum::<f64>() / sum } else { 0.0 };
    table.iter().zip(floor).map(|(f, floor)| scale * f + FLOOR * floor).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, Transport};
    use crate::models::OrenNayar;

    fn diffuse() -> IsotropicSampler {
        let model = OrenNayar::new(0.8, 0.5);
        IsotropicSampler::new(|wo, wi| model.eval(wo, wi, Transport::Radiance)[0])
    }

    #[test]
    fn coordinates_invert() {
        for k in -50..=50 {
            let w = f64::from(k) / 50.0;
            assert!((inverse_azimuth(azimuth(w)) - w).abs() < 1e-14);
            let (sin, cos) = (PI * w).sin_cos();
            assert!((turn(sin, cos) - sin.atan2(cos)).abs() < 1e-15);
        }
        let axis = [0.6, 0.8];
        for (s, w) in [(0.3, 0.2), (0.9, -0.7), (1.0, 1.0), (0.0, 0.0)] {
            let d = direction(s, w, axis);
            assert!((d.length() - 1.0).abs() < 1e-15 && d.z >= 0.0);
        }
        // The mirror azimuth is w = 0.
        let mirrored = direction(0.5, 0.0, axis);
        assert!((mirrored.x * axis[1] - mirrored.y * axis[0]).abs() < 1e-15 && mirrored.x < 0.0);
    }

    /// A midpoint rule in angles, which the sampler knows nothing of.
    #[test]
    fn density_integrates_to_one_and_is_positive() {
        let sampler = diffuse();
        for theta in [0.0, 0.5, 1.2, 1.55] {
            let lobe = sampler.given(Direction::from_angles(theta, 2.0), usize::MAX).unwrap();
            let (n, m) = (1000, 800);
            let mut sum = 0.0;
            for i in 0..n {
                let theta = (f64::from(i) + 0.5) / f64::from(n) * PI / 2.0;
                for j in 0..m {
                    let wi = Direction::from_angles(theta, (f64::from(j) + 0.5) / f64::from(m) * 2.0 * PI);
                    let p = lobe.pdf(wi);
                    assert!(p > 0.0);
                    sum += p * theta.sin();
                }
            }
            let mass = sum * PI * PI / f64::from(n * m);
            assert!((mass - 1.0).abs() < 2e-4, "{theta}: {mass}");
        }
    }

    #[test]
    fn edges() {
        let sampler = diffuse();
        let last = 1.0 - f64::EPSILON / 2.0;
        for wo in [Direction::NORMAL, Direction::from_angles(1.2, 0.3), Direction::new(1.0, 0.0, 1e-100)] {
            let lobe = sampler.given(wo, 1).unwrap();
            for u in [[0.0, 0.0], [last, last], [last, 0.0], [0.0, last]] {
                let Some((wi, told)) = lobe.sample(u) else { continue };
                let p = lobe.pdf(wi);
                assert!(p > 0.0 && p.is_finite() && (told / p - 1.0).abs() < 1e-9, "{wo:?} {u:?} {p} {told}");
                assert!((wi.length() - 1.0).abs() < 1e-15);
            }
            // The density at the normal does not know from where the normal is seen.
            let turned = sampler.given(wo.rotated(1.0), 1).unwrap();
            let [p, q] = [&lobe, &turned].map(|l| l.pdf(Direction::NORMAL));
            assert!(p > 0.0 && (p / q - 1.0).abs() < 1e-12);
        }
        assert!(sampler.given(Direction::from_angles(2.0, 0.0), 1).is_none());
        let lobe = sampler.given(Direction::NORMAL, 1).unwrap();
        assert_eq!(lobe.pdf(Direction::from_angles(2.0, 0.0)), 0.0);
        // Nor does it jump where azimuths begin anew, even of values that do.
        let lopsided = IsotropicSampler::new(|wo, wi| if wo.x * wi.y > wo.y * wi.x { 1.0 } else { 0.5 });
        let lobe = lopsided.given(Direction::from_angles(1.0, 0.0), 1).unwrap();
        let beside = |phi: f64| lobe.pdf(Direction::from_angles(0.8, phi));
        assert!((beside(1e-9) / beside(-1e-9) - 1.0).abs() < 1e-6);
        // A black surface is still drawn from.
        let black = IsotropicSampler::new(|_, _| 0.0);
        let p = black.given(Direction::NORMAL, 1).unwrap().pdf(Direction::from_angles(0.7, 0.0));
        assert!((p - 0.7f64.cos() / PI).abs() < 1e-3);
    }
}
