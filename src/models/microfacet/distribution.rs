//! Distributions of normals, as one type.

use super::{Beckmann, Gaussian, Ggx, Roughness};
use crate::bsdf::Direction;
use crate::models::memo::Memo;
use std::sync::Arc;

/// A distribution D of facet normals m over the upper hemisphere.
#[derive(Clone, Debug)]
pub enum Distribution {
    /// GGX.
    Ggx(Ggx),
    /// Beckmann.
    Beckmann(Beckmann),
    /// Torrance and Sparrow's own.
    Gaussian(Arc<Gaussian>),
}

impl Distribution {
    /// GGX of this slope roughness.
    pub fn ggx(alpha: Roughness) -> Self {
        Self::Ggx(Ggx { alpha })
    }

    /// Beckmann of this slope roughness.
    pub fn beckmann(alpha: Roughness) -> Self {
        Self::Beckmann(Beckmann { alpha })
    }

    /// A Gaussian of the angle, of this roughness in radians; makes tables, once.
    pub fn gaussian(alpha: Roughness) -> Self {
        static KNOWN: Memo<[u64; 2], Gaussian> = Memo::new();
        Self::Gaussian(KNOWN.of([alpha.x, alpha.y].map(f64::to_bits), || Gaussian::new(alpha)))
    }

    /// The roughness.
    #[inline]
    pub fn alpha(&self) -> Roughness {
        match self {
            Self::Ggx(d) => d.alpha,
            Self::Beckmann(d) => d.alpha,
            Self::Gaussian(d) => d.alpha(),
        }
    }

    /// D(m) per steradian, 0 below the horizon; ∫D cos θ = 1.
    #[inline]
    pub fn density(&self, m: Direction) -> f64 {
        match self {
            Self::Ggx(d) => d.density(m),
            Self::Beckmann(d) => d.density(m),
            Self::Gaussian(d) => d.density(m),
        }
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0). Smith's functions all follow from it, and unlike them it is
    /// finite at the horizon.
    #[inline]
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        match self {
            Self::Ggx(d) => d.backfacing_area(w),
            Self::Beckmann(d) => d.backfacing_area(w),
            Self::Gaussian(d) => d.backfacing_area(w),
        }
    }

    /// Smith's Λ(w) (B. G. Smith 1967): backfacing area over cos θ.
    #[inline]
    pub fn lambda(&self, w: Direction) -> f64 {
        self.backfacing_area(w) / w.z
    }

    /// Smith's masking G1(w) = 1/(1 + Λ).
    #[inline]
    pub fn g1(&self, w: Direction) -> f64 {
        w.z / (w.z + self.backfacing_area(w))
    }

    /// A normal with density D cos θ.
    #[inline]
    pub fn sample(&self, u: &[f64]) -> Direction {
        match self {
            Self::Ggx(d) => d.sample(u),
            Self::Beckmann(d) => d.sample(u),
            Self::Gaussian(d) => d.sample(u),
        }
    }

    /// A normal with density [`Self::visible_density`], where a way to draw
    /// it is known: not for the Gaussian.
    #[inline]
    pub fn sample_visible(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        self.sample_visible_of(wo, || self.backfacing_area(wo), u)
    }

    /// The same where wo's [backfacing area](Self::backfacing_area) may be known; not
    /// every distribution needs it.
    #[inline]
    pub(super) fn sample_visible_of(
        &self,
        wo: Direction,
        backfacing: impl FnOnce() -> f64,
        u: &[f64],
    ) -> Option<Direction> {
        match self {
            Self::Ggx(d) => Some(d.sample_visible(wo, u)),
            Self::Beckmann(d) => Some(d.sample_visible(wo, backfacing(), u)),
            Self::Gaussian(_) => None,
        }
    }

    /// Density of normals visible from `wo` under Smith's masking per
    /// steradian: G1 max(0, wo·m) D/cos θo.
    #[inline]
    pub fn visible_density(&self, wo: Direction, m: Direction) -> f64 {
        self.density(m) * wo.dot(m).max(0.0) / (wo.z + self.backfacing_area(wo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn all() -> Vec<Distribution> {
        [(1e-4, 1e-4), (0.2, 0.2), (1.0, 1.0), (0.3, 0.05), (1e-4, 1.0)]
            .into_iter()
            .flat_map(|(x, y)| {
                let alpha = Roughness { x, y };
                [Distribution::ggx(alpha), Distribution::beckmann(alpha), Distribution::gaussian(alpha)]
            })
            .collect()
    }

    /// Gauss and Legendre's rule of two points on each of `n` pieces.
    fn integral(from: f64, to: f64, n: i32, f: impl Fn(f64) -> f64) -> f64 {
        let h = (to - from) / f64::from(n);
        let off = 0.5 / 3f64.sqrt();
        (0..n)
            .map(|k| {
                let mid = f64::from(k) + 0.5;
                0.5 * h * (f(from + h * (mid - off)) + f(from + h * (mid + off)))
            })
            .sum()
    }

    /// ∫ D g(m) dm over stretched slopes beyond `start(ψ)`, from `psi` over a
    /// range.
    fn over_slopes(
        d: &Distribution,
        (psi, range): (f64, f64),
        start: impl Fn(f64) -> f64,
        g: impl Fn(Direction) -> f64,
    ) -> f64 {
        let alpha = d.alpha();
        // Points gather at both ends, where `start` may change fast.
        integral(0.0, 1.0, 500, |x| {
            let psi = psi + range * x * x * (3.0 - 2.0 * x);
            let (sin, cos) = psi.sin_cos();
            let s = start(psi);
            let inner = integral(s / (1.0 + s), 1.0, 600, |t| {
                let r = t / (1.0 - t);
                let m = alpha.scale(Direction::new(r * cos, r * sin, 1.0)).normalized();
                let area = alpha.x * alpha.y * m.z.powi(3) * r / ((1.0 - t) * (1.0 - t));
                if area > 0.0 { d.density(m) * g(m) * area } else { 0.0 }
            });
            inner * range * 6.0 * x * (1.0 - x)
        })
    }

    #[test]
    fn density_is_normalised() {
        for d in all() {
            let sum = over_slopes(&d, (0.0, TAU), |_| 0.0, |m| m.z);
            assert!((sum - 1.0).abs() < 1e-8, "{:?}: {:e}", d.alpha(), sum - 1.0);
        }
    }

    #[test]
    fn visible_facets_fill_the_view() {
        for d in all() {
            for theta in [1e-3, 0.3, 1.0, 1.4, 1.57] {
                let azimuths = if d.alpha().is_isotropic() { 1 } else { 3 };
                for phi in &[0.7, 0.0, PI / 2.0][..azimuths] {
                    let w = Direction::from_angles(theta, *phi);
                    let s = d.alpha().scale(w);
                    let (t, psi) = (s.x.hypot(s.y), s.y.atan2(s.x));
                    // Slopes that face away begin where s.z + t r cos(ψ − ψw) = 0.
                    let start = |p: f64| s.z / (-t * (p - psi).cos()).max(1e-300);
                    let hidden = over_slopes(&d, (psi + PI / 2.0, PI), start, |m| (-w.dot(m)).max(0.0));
                    let error = (d.backfacing_area(w) - hidden) / (w.z + hidden);
                    assert!(error.abs() < 1e-8, "{d:?} {theta} {phi}: {error:e}");
                    assert!((d.g1(w) * (1.0 + d.lambda(w)) - 1.0).abs() < 1e-15);
                }
            }
        }
    }

    /// The area that u covers, by central differences, is the density's inverse.
    #[test]
    fn sampling_follows_the_density() {
        let h = 1e-6;
        let area = |sample: &dyn Fn(f64, f64) -> Direction, u: f64, v: f64| {
            let du = sample(u + h, v) - sample(u - h, v);
            let dv = sample(u, v + h) - sample(u, v - h);
            du.cross(dv).length() / (4.0 * h * h)
        };
        for d in all() {
            for (u, v) in [(0.05, 0.1), (0.3, 0.36), (0.6, 0.7), (0.97, 0.9)] {
                let sample = |u, v| d.sample(&[u, v]);
                let m = sample(u, v);
                let jacobian = area(&sample, u, v) * d.density(m) * m.z;
                assert!((jacobian - 1.0).abs() < 1e-5, "{d:?} {u} {v}: {jacobian}");
                for theta in [0.0f64, 50.0, 85.0, 89.9] {
                    let wo = Direction::from_angles(theta.to_radians(), 0.4);
                    if d.sample_visible(wo, &[u, v]).is_none() {
                        continue;
                    }
                    let sample = |u, v| d.sample_visible(wo, &[u, v]).unwrap();
                    let jacobian = area(&sample, u, v) * d.visible_density(wo, sample(u, v));
                    assert!((jacobian - 1.0).abs() < 1e-5, "{d:?} {theta} {u} {v}: {jacobian}");
                }
            }
        }
    }

    /// Kolmogorov's distance of 10⁵ draws stays below its 99.9 % point.
    #[test]
    fn drawn_angles_follow_their_distribution() {
        use rand_xoshiro::Xoshiro256PlusPlus;
        use rand_xoshiro::rand_core::{Rng, SeedableRng};
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        let mut uniform = || (random.next_u64() >> 11) as f64 * f64::EPSILON / 2.0;
        let n = 100_000;
        for alpha in [1e-4, 0.3, 1.0] {
            let density = |t: f64| (-t * t / (alpha * alpha)).exp() * t.sin() * t.cos();
            let end = (8.0 * alpha).min(PI / 2.0);
            let all = integral(0.0, end, 2000, density);
            let gaussian = |t: f64| integral(0.0, t.min(end), 60, density) / all;
            let beckmann = |t: f64| -(-(t.tan() / alpha).powi(2)).exp_m1();
            let tests: [(_, &dyn Fn(f64) -> f64); 2] = [
                (Distribution::gaussian(Roughness::isotropic(alpha)), &gaussian),
                (Distribution::beckmann(Roughness::isotropic(alpha)), &beckmann),
            ];
            for (d, cdf) in tests {
                let mut angles: Vec<_> = (0..n).map(|_| d.sample(&[uniform(), uniform()]).theta()).collect();
                angles.sort_by(f64::total_cmp);
                let distance = angles
                    .iter()
                    .enumerate()
                    .map(|(k, t)| (cdf(*t) - (k as f64 + 0.5) / n as f64).abs())
                    .fold(0.0, f64::max);
                assert!(distance < 1.95 / (n as f64).sqrt(), "{d:?}: {distance}");
            }
        }
    }
}
