//! Torrance and Sparrow's Gaussian distribution of normals.

use super::area::AreaTable;
use super::{Roughness, chebyshev};
use crate::bsdf::Direction;
use std::f64::consts::{FRAC_PI_2, PI};

/// D = c exp(−(θm/α)²), a Gaussian of the angle (Torrance and Sparrow 1967),
/// with 1/α² = cos²φ/αx² + sin²φ/αy² and c such that ∫D cos θ = 1.
///
/// With φ by (cos φ, sin φ) ∝ (αx cos ψ, αy sin ψ), the roughness along φ is
/// a² = αx² cos²ψ + αy² sin²ψ, and ψ has a density that varies by less than a factor of two.
/// Normalisation and sampling are to rounding; the backfacing area is
/// interpolated with an absolute error below 1e-8.
#[derive(Clone)]
pub struct Gaussian {
    alpha: Roughness,
    /// D's factor c.
    scale: f64,
    /// The density of ψ as a series of cos 2nψ.
    azimuth: Vec<f64>,
    /// For [`Self::backfacing_area`].
    area: AreaTable,
    /// The one distribution of θ, where there is one.
    isotropic: Option<Shares>,
    /// ψ of a share of a half turn: polynomials on [`PANELS_PSI`] panels;
    /// none where ψ is uniform.
    psi: Vec<[f64; TERMS_PSI]>,
    /// Where to start looking for θ.
    start: Start,
}

/// Chebyshev points of the density of ψ: as many as bring it to rounding.
const POINTS_AZIMUTH: usize = 64;
/// Panels of a half turn and terms of the polynomial of ψ in each, for an
/// error below 1e-12.
const PANELS_PSI: usize = 64;
const TERMS_PSI: usize = 8;

impl std::fmt::Debug for Gaussian {
    /// Without the tables.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gaussian").field("alpha", &self.alpha).finish_non_exhaustive()
    }
}

impl Gaussian {
    /// With roughness `alpha` in radians.
    pub fn new(alpha: Roughness) -> Self {
        let azimuths = if alpha.is_isotropic() { 1 } else { POINTS_AZIMUTH };
        let shares: Vec<_> = chebyshev::points(azimuths).map(|x| Shares::new(alpha, x).all).collect();
        let azimuth = chebyshev::coefficients(&shares);
        let scale = 1.0 / (2.0 * PI * azimuth[0] * alpha.x * alpha.y);
        let area = AreaTable::new(alpha, scale * alpha.x * alpha.y);
        let isotropic = alpha.is_isotropic().then(|| Shares::new(alpha, 0.0));
        let mut gaussian =
            Self { alpha, scale, azimuth, area, isotropic, psi: Vec::new(), start: Start::new(alpha) };
        if !alpha.is_isotropic() {
            gaussian.psi = gaussian.psi_panels();
        }
        gaussian
    }

    /// The roughness in radians.
    pub fn alpha(&self) -> Roughness {
        self.alpha
    }

    /// D(m) per steradian.
    pub fn density(&self, m: Direction) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let r = (m.x * m.x + m.y * m.y).sqrt();
        let ratio = if r > 0.0 { r.atan2(m.z) / r } else { 1.0 };
        self.scale * (-ratio * ratio * self.alpha.scaled_square(m)).exp()
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0).
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        let s = self.alpha.scale(w);
        let (x2, y2) = (s.x * s.x, s.y * s.y);
        if x2 + y2 == 0.0 { 0.0 } else { self.area.area(x2, y2, s.z) }
    }

    /// A normal with density D cos θ: ψ, then θ, each by inverting its
    /// distribution function.
    pub fn sample(&self, u: &[f64]) -> Direction {
        let (sin, cos) = self.sample_psi(u[1]).sin_cos();
        let own;
        let shares = match &self.isotropic {
            Some(shares) => shares,
            None => {
                own = Shares::new(self.alpha, (cos - sin) * (cos + sin));
                &own
            }
        };
        let ratio = self.start.ratio(shares.alpha, u[0]);
        let (sin_theta, cos_theta) = shares.invert(u[0], ratio).sin_cos();
        let r = sin_theta / shares.alpha;
        Direction::new(r * self.alpha.x * cos, r * self.alpha.y * sin, cos_theta)
    }

    /// ψ below which is the share `u`.
    #[inline]
    fn sample_psi(&self, u: f64) -> f64 {
        if self.psi.is_empty() {
            return 2.0 * PI * u;
        }
        // Half turns are alike.
        let half = (2.0 * u).floor();
        let place = (2.0 * u - half) * PANELS_PSI as f64;
        let panel = (place as usize).min(PANELS_PSI - 1);
        let x = 2.0 * (place - panel as f64) - 1.0;
        half * PI + self.psi[panel].iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    /// Panels of ψ by interpolation.
    fn psi_panels(&self) -> Vec<[f64; TERMS_PSI]> {
        (0..PANELS_PSI)
            .map(|panel| {
                let psi = |x| self.invert_psi((panel as f64 + 0.5 * (1.0 + x)) / (2 * PANELS_PSI) as f64);
                let values: Vec<_> = chebyshev::points(TERMS_PSI).map(psi).collect();
                let powers = chebyshev::powers(&chebyshev::coefficients(&values));
                std::array::from_fn(|k| powers.get(k).copied().unwrap_or(0.0))
            })
            .collect()
    }

    /// ψ below which is the share `u`, by Newton's method: the density varies
    /// by less than a factor of two.
    fn invert_psi(&self, u: f64) -> f64 {
        let mut psi = 2.0 * PI * u;
        let mean = self.azimuth[0];
        for _ in 0..20 {
            let (excess, density) = self.psi_share(psi);
            let step = (excess - mean * 2.0 * PI * u) / density;
            psi -= step;
            if step.abs() <= 1e-15 * (1.0 + psi.abs()) {
                break;
            }
        }
        psi
    }

    /// The share of azimuths below `psi`, and its density, both times
    /// 2π × the mean.
    fn psi_share(&self, psi: f64) -> (f64, f64) {
        let (sin, cos) = (2.0 * psi).sin_cos();
        // Σ c_n sin 2nψ/2n by the recurrence of the second kind.
        let (mut a, mut b) = (0.0, 0.0);
        for n in (1..self.azimuth.len()).rev() {
            (a, b) = (self.azimuth[n] / (2.0 * n as f64) + 2.0 * cos * a - b, a);
        }
        let density = chebyshev::sum(self.azimuth.len(), cos, |n| self.azimuth[n]);
        (self.azimuth[0] * psi + sin * a, density)
    }
}

/// Steps of the table [`Start`] in the share, and in α² where it varies: with
/// these one or two steps of [`Shares::invert`] reach rounding.
const STEPS_SHARE: usize = 512;
const STEPS_ALPHA: usize = 32;

/// θ over that of an exponential distribution of θ², to start from: linear in
/// α² and in 1 − √(1 − u), which is smooth at the horizon.
#[derive(Clone)]
struct Start {
    /// α² of the first row, and rows a unit of α².
    from: f64,
    rows_per_alpha2: f64,
    /// Rows of [`STEPS_SHARE`] + 1.
    ratios: Vec<f64>,
}

impl Start {
    fn new(alpha: Roughness) -> Self {
        let (x2, y2) = (alpha.x * alpha.x, alpha.y * alpha.y);
        let (from, range) = (x2.min(y2), (x2 - y2).abs());
        let steps = if range > 0.0 { STEPS_ALPHA } else { 0 };
        let row = |k: usize| {
            let a2: f64 = from + range * k as f64 / STEPS_ALPHA as f64;
            let shares = Shares::new(Roughness::isotropic(a2.sqrt()), 0.0);
            (0..=STEPS_SHARE).map(move |j| {
                // Ratios at both ends are limits.
                let x = (j as f64 / STEPS_SHARE as f64).clamp(1e-6, 1.0 - 1e-8);
                let u = x * (2.0 - x);
                shares.invert(u, 1.0) / shares.exponential(u)
            })
        };
        let ratios = (0..=steps).flat_map(row).collect();
        Self { from, rows_per_alpha2: if range > 0.0 { STEPS_ALPHA as f64 / range } else { 0.0 }, ratios }
    }

    #[inline]
    fn ratio(&self, alpha: f64, u: f64) -> f64 {
        let place = u / (1.0 + (1.0 - u).sqrt()) * STEPS_SHARE as f64;
        let j = (place as usize).min(STEPS_SHARE - 1);
        let x = place - j as f64;
        let at = |row: usize| {
            let r = &self.ratios[row * (STEPS_SHARE + 1) + j..][..2];
            r[0] + x * (r[1] - r[0])
        };
        if self.rows_per_alpha2 == 0.0 {
            return at(0);
        }
        let place = (alpha * alpha - self.from) * self.rows_per_alpha2;
        let row = (place.max(0.0) as usize).min(STEPS_ALPHA - 1);
        at(row) + (place - row as f64) * (at(row + 1) - at(row))
    }
}

/// The share of normals beyond an angle, in one azimuth.
#[derive(Clone)]
struct Shares {
    /// Roughness along the azimuth, radians.
    alpha: f64,
    /// [`series`](Self::series) at the horizon.
    horizon: f64,
    /// All: ∫ exp(−θ²/α²) sin θ cos θ dθ/α² over [0, π/2], 1/2 for small α.
    all: f64,
    /// 1 − exp(−(π/2α)²).
    cut: f64,
}

impl Shares {
    fn new(alpha: Roughness, cos_2psi: f64) -> Self {
        let (c2, s2) = (0.5 * (1.0 + cos_2psi), 0.5 * (1.0 - cos_2psi));
        let alpha = (alpha.x * alpha.x * c2 + alpha.y * alpha.y * s2).sqrt();
        let horizon = Self::series(alpha, FRAC_PI_2).0;
        let cut = -(-(FRAC_PI_2 / alpha).powi(2)).exp_m1();
        Self { alpha, horizon, all: Self::series(alpha, 0.0).0 - horizon, cut }
    }

    /// ∫ exp(−t²/α²) sin t cos t dt/α² from `theta` to infinity: with y = θ²/α²,
    /// the series of sin 2t leads to ½ e^{−y} Σ_k a_k Σ_{j≤k} y^j/j!,
    /// a_k = (−4α²)^k k!/(2k + 1)!. For α ≤ 1 and θ ≤ π/2 it converges in 25
    /// terms, none much larger than the sum. And e^{−y}.
    fn series(alpha: f64, theta: f64) -> (f64, f64) {
        let a2 = alpha * alpha;
        let y = theta * theta / a2;
        // Beyond is less than the smallest step of u by a factor of 1e6.
        if y > 50.0 {
            return (0.0, 0.0);
        }
        let decay = (-y).exp();
        let (mut a, mut power, mut partial, mut sum) = (1.0, 1.0, 1.0, 1.0);
        for k in 1..40 {
            a *= -2.0 * a2 * INVERSE[2 * k as usize + 1];
            power *= y * INVERSE[k as usize];
            partial += power;
            let term: f64 = a * partial;
            sum += term;
            if k > 2 && term.abs() < 1e-18 {
                break;
            }
        }
        (0.5 * decay * sum, decay)
    }

    /// θ below which would be the share `u` were θ² exponential up to the
    /// horizon, as it is for small α.
    #[inline]
    fn exponential(&self, u: f64) -> f64 {
        self.alpha * (-(-u * self.cut).ln_1p()).sqrt()
    }

    /// θ below which is the share `u`, from `ratio` times the exponential one,
    /// by Halley's method on the logarithm of what is beyond, inside a bracket.
    fn invert(&self, u: f64, ratio: f64) -> f64 {
        let wanted = (1.0 - u) * self.all;
        let a2 = self.alpha * self.alpha;
        let (mut low, mut high) = (0.0, FRAC_PI_2);
        let mut theta = ratio * self.exponential(u);
        if theta == 0.0 {
            return 0.0;
        }
        for _ in 0..100 {
            theta = if theta > low && theta < high { theta } else { 0.5 * (low + high) };
            let (beyond, decay) = Self::series(self.alpha, theta);
            let beyond = beyond - self.horizon;
            if beyond > wanted {
                low = theta;
            } else {
                high = theta;
            }
            let (sin, cos) = theta.sin_cos();
            let slope = decay * sin * cos / a2;
            // ln_1p keeps small excesses; NaN or infinity fall to bisection.
            let newton = beyond * ((beyond - wanted) / wanted).ln_1p() / slope;
            let curvature = cos / sin - sin / cos - 2.0 * theta / a2 + slope / beyond;
            let step = newton / (1.0 + 0.5 * newton * curvature);
            theta += step;
            // The next step would be like the cube of this one.
            if step.abs() <= 1e-6 * theta || high - low <= 1e-15 * high {
                break;
            }
        }
        if theta.is_finite() { theta.clamp(low, high) } else { low }
    }
}

/// 1/k, for the series.
const INVERSE: [f64; 80] = {
    let mut inverse = [0.0; 80];
    let mut k = 1;
    while k < 80 {
        inverse[k] = 1.0 / k as f64;
        k += 1;
    }
    inverse
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverts_to_rounding() {
        for alpha in [1e-4, 0.05, 0.4, 1.0] {
            let shares = Shares::new(Roughness::isotropic(alpha), 0.0);
            let start = Start::new(Roughness { x: 1e-4, y: 1.0 });
            for i in 0..=1000 {
                let u = (f64::from(i) / 1000.0).clamp(0.0, 1.0 - f64::EPSILON / 2.0);
                let beyond = Shares::series(alpha, shares.invert(u, 1.0)).0 - shares.horizon;
                assert!((beyond / shares.all - (1.0 - u)).abs() < 2e-15, "{alpha} {u}");
                let theta = shares.invert(u, start.ratio(alpha, u));
                let beyond = Shares::series(alpha, theta).0 - shares.horizon;
                assert!((beyond / shares.all - (1.0 - u)).abs() < 2e-15, "{alpha} {u}");
            }
        }
    }

    #[test]
    fn azimuths_are_inverted() {
        for (x, y) in [(1e-4, 1.0), (1.0, 1e-4), (1.0, 0.2), (0.3, 0.05)] {
            let gaussian = Gaussian::new(Roughness { x, y });
            for i in 0..1000 {
                let u = f64::from(i) / 1000.0;
                let share = gaussian.psi_share(gaussian.sample_psi(u)).0 / (2.0 * PI * gaussian.azimuth[0]);
                assert!((share - u).abs() < 1e-12, "{x} {y} {u}: {:e}", share - u);
            }
        }
    }

    /// ∫ exp(−θ²/α²) sin θ cos θ dθ/α² by Simpson's rule.
    #[test]
    fn series_equals_quadrature() {
        for (alpha, theta) in [(1.0f64, 0.0), (1.0, 1.2), (0.3, 0.4), (0.05, 0.0)] {
            let (n, end) = (20_000, (7.0 * alpha).min(FRAC_PI_2));
            let f = |t: f64| (-t * t / (alpha * alpha)).exp() * t.sin() * t.cos() / (alpha * alpha);
            let h = (end - theta) / f64::from(n);
            let sum: f64 = (0..=n)
                .map(|k| {
                    let weight = if k == 0 || k == n { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
                    weight * f(theta + h * f64::from(k))
                })
                .sum();
            let value = Shares::series(alpha, theta).0 - Shares::series(alpha, FRAC_PI_2).0;
            assert!((value - sum * h / 3.0).abs() < 1e-13, "{alpha} {theta}");
        }
    }
}
