//! Torrance and Sparrow's Gaussian distribution of normals.

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
#[derive(Clone, Debug)]
pub struct Gaussian {
    alpha: Roughness,
    /// D's factor c.
    scale: f64,
    /// The density of ψ as a series of cos 2nψ.
    azimuth: Vec<f64>,
    /// [`Self::backfacing_area`] over the stretched sine, as a Chebyshev
    /// series in 2t − 1, each coefficient one in cos 2ψ; see [`area_series`].
    area: Vec<Vec<f64>>,
}

/// Chebyshev points in t, and in cos 2ψ where there is anisotropy: as many as
/// bring the error below 1e-8 at all pairs of roughness.
const POINTS_T: usize = 64;
const POINTS_PSI: usize = 16;
const POINTS_AZIMUTH: usize = 64;

impl Gaussian {
    /// With roughness `alpha` in radians.
    pub fn new(alpha: Roughness) -> Self {
        let (psi, azimuth) = if alpha.is_isotropic() { (1, 1) } else { (POINTS_PSI, POINTS_AZIMUTH) };
        let shares: Vec<_> = chebyshev::points(azimuth).map(|x| Shares::new(alpha, x).all).collect();
        let azimuth = chebyshev::coefficients(&shares);
        let scale = 1.0 / (2.0 * PI * azimuth[0] * alpha.x * alpha.y);
        let area = area_series(alpha, scale * alpha.x * alpha.y, psi);
        Self { alpha, scale, azimuth, area }
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
        let r = m.x.hypot(m.y);
        let ratio = if r > 0.0 { r.atan2(m.z) / r } else { 1.0 };
        self.scale * (-ratio * ratio * self.alpha.scaled_square(m)).exp()
    }

    /// ∫D max(0, −w·m), the projected area of facets turned away from `w`
    /// (w.z ≥ 0).
    pub fn backfacing_area(&self, w: Direction) -> f64 {
        let s = self.alpha.scale(w);
        let (x2, y2) = (s.x * s.x, s.y * s.y);
        let t2 = x2 + y2;
        if t2 == 0.0 {
            return 0.0;
        }
        let tangential = t2.sqrt();
        let t = s.z / (s.z + tangential);
        let cos_2psi = (x2 - y2) / t2;
        let row = |k: usize| {
            let c = &self.area[k];
            chebyshev::sum(c.len(), cos_2psi, |j| c[j])
        };
        // Interpolation may dip below 0 by its error.
        tangential * chebyshev::sum(self.area.len(), 2.0 * t - 1.0, row).max(0.0)
    }

    /// A normal with density D cos θ: ψ, then θ, each by inverting its
    /// distribution function.
    pub fn sample(&self, u: &[f64]) -> Direction {
        let (sin, cos) = self.sample_psi(u[1]).sin_cos();
        let shares = Shares::new(self.alpha, (cos - sin) * (cos + sin));
        let (sin_theta, cos_theta) = shares.invert(u[0]).sin_cos();
        let r = sin_theta / shares.alpha;
        Direction::new(r * self.alpha.x * cos, r * self.alpha.y * sin, cos_theta)
    }

    /// ψ below which is the share `u`, by Newton's method: the density varies
    /// by less than a factor of two.
    fn sample_psi(&self, u: f64) -> f64 {
        let mut psi = 2.0 * PI * u;
        if self.azimuth.len() == 1 {
            return psi;
        }
        let mean = self.azimuth[0];
        for _ in 0..20 {
            let (sin, cos) = (2.0 * psi).sin_cos();
            // Σ c_n sin 2nψ/2n by the recurrence of the second kind.
            let (mut a, mut b) = (0.0, 0.0);
            for n in (1..self.azimuth.len()).rev() {
                (a, b) = (self.azimuth[n] / (2.0 * n as f64) + 2.0 * cos * a - b, a);
            }
            let density = chebyshev::sum(self.azimuth.len(), cos, |n| self.azimuth[n]);
            let step = (mean * (psi - 2.0 * PI * u) + sin * a) / density;
            psi -= step;
            if step.abs() <= 1e-15 * (1.0 + psi.abs()) {
                break;
            }
        }
        psi
    }
}

/// The share of normals beyond an angle, in one azimuth.
struct Shares {
    /// Roughness along the azimuth, radians.
    alpha: f64,
    /// [`series`](Self::series) at the horizon.
    horizon: f64,
    /// All: ∫ exp(−θ²/α²) sin θ cos θ dθ/α² over [0, π/2], 1/2 for small α.
    all: f64,
}

impl Shares {
    fn new(alpha: Roughness, cos_2psi: f64) -> Self {
        let (c2, s2) = (0.5 * (1.0 + cos_2psi), 0.5 * (1.0 - cos_2psi));
        let alpha = (alpha.x * alpha.x * c2 + alpha.y * alpha.y * s2).sqrt();
        let horizon = Self::series(alpha, FRAC_PI_2);
        Self { alpha, horizon, all: Self::series(alpha, 0.0) - horizon }
    }

    /// ∫ exp(−t²/α²) sin t cos t dt/α² from `theta` to infinity: with y = θ²/α²,
    /// the series of sin 2t leads to ½ e^{−y} Σ_k a_k Σ_{j≤k} y^j/j!,
    /// a_k = (−4α²)^k k!/(2k + 1)!. For α ≤ 1 and θ ≤ π/2 it converges in 25
    /// terms, none much larger than the sum.
    fn series(alpha: f64, theta: f64) -> f64 {
        let a2 = alpha * alpha;
        let y = theta * theta / a2;
        let decay = (-y).exp();
        if decay == 0.0 {
            return 0.0;
        }
        let (mut a, mut power, mut partial, mut sum) = (1.0, 1.0, 1.0, 1.0);
        for k in 1..40 {
            a *= -2.0 * a2 / f64::from(2 * k + 1);
            power *= y / f64::from(k);
            partial += power;
            let term: f64 = a * partial;
            sum += term;
            if k > 2 && term.abs() < 1e-18 {
                break;
            }
        }
        0.5 * decay * sum
    }

    /// θ below which is the share `u`, by Newton's method on the logarithm of
    /// what is beyond, inside a bracket; exact at once for small α.
    fn invert(&self, u: f64) -> f64 {
        let wanted = (1.0 - u) * self.all;
        let a2 = self.alpha * self.alpha;
        let cut = -(-FRAC_PI_2 * FRAC_PI_2 / a2).exp_m1();
        let (mut low, mut high) = (0.0, FRAC_PI_2);
        let mut theta = self.alpha * (-(-u * cut).ln_1p()).sqrt();
        if theta == 0.0 {
            return 0.0;
        }
        for _ in 0..100 {
            theta = if theta > low && theta < high { theta } else { 0.5 * (low + high) };
            let beyond = Self::series(self.alpha, theta) - self.horizon;
            if beyond > wanted {
                low = theta;
            } else {
                high = theta;
            }
            let slope = (-theta * theta / a2).exp() * theta.sin() * theta.cos() / a2;
            let excess = beyond - wanted;
            // ln_1p keeps small excesses; NaN or infinity fall to bisection.
            let step = beyond * (excess / wanted).ln_1p() / slope;
            theta += step;
            if step.abs() <= 1e-15 * theta || high - low <= 1e-15 * high {
                break;
            }
        }
        if theta.is_finite() { theta.clamp(low, high) } else { low }
    }
}

/// Backfacing area over the stretched sine s = |(αx x, αy y)|, as a function of
/// t = a/(1 + a), a = z/s the stretched cotangent: E(a) = ∫ (U − a) M(U) dU over
/// U > a, with M the marginal of the stretched slopes along ψ. In t it is
/// smooth for every α, at the horizon (t = 0) and at the normal (t = 1).
fn area_series(alpha: Roughness, scale: f64, azimuths: usize) -> Vec<Vec<f64>> {
    let line = line();
    // Rows: coefficients in t, of each azimuth.
    let rows: Vec<Vec<f64>> = chebyshev::points(azimuths)
        .map(|cos_2psi| {
            let (cos, sin) = ((0.5 * (1.0 + cos_2psi)).sqrt(), (0.5 * (1.0 - cos_2psi)).sqrt());
            chebyshev::coefficients(&area_at_points(|u| marginal(alpha, scale, (cos, sin), u, &line)))
        })
        .collect();
    let terms = rows.iter().map(Vec::len).max().unwrap_or(0);
    (0..terms)
        .map(|k| {
            let column: Vec<_> = rows.iter().map(|r| r.get(k).copied().unwrap_or(0.0)).collect();
            chebyshev::coefficients(&column)
        })
        .collect()
}

/// E at the Chebyshev points of t, by Gauss and Legendre's rule of five points
/// between each two, from t = 1 down.
fn area_at_points(marginal: impl Fn(f64) -> f64) -> Vec<f64> {
    let (near, far) = (2.0 * (10.0f64 / 7.0).sqrt(), 13.0 * 70f64.sqrt());
    let rule = [
        (0.0, 128.0 / 225.0),
        ((5.0 - near).sqrt() / 3.0, (322.0 + far) / 900.0),
        (-(5.0 - near).sqrt() / 3.0, (322.0 + far) / 900.0),
        ((5.0 + near).sqrt() / 3.0, (322.0 - far) / 900.0),
        (-(5.0 + near).sqrt() / 3.0, (322.0 - far) / 900.0),
    ];
    let (mut above, mut mass, mut moment) = (1.0, 0.0, 0.0);
    chebyshev::points(POINTS_T)
        .map(|x| {
            let t = 0.5 * (1.0 + x);
            for (node, weight) in rule {
                let s = 0.5 * (above + t) + 0.5 * (above - t) * node;
                let u = s / (1.0 - s);
                let m = 0.5 * (above - t) * weight * marginal(u) / ((1.0 - s) * (1.0 - s));
                mass += m;
                moment += m * u;
            }
            above = t;
            moment - t / (1.0 - t) * mass
        })
        .collect()
}

/// ∫ of the density of stretched slopes (P, Q), αx αy D cos⁴θ, over the line
/// P cos ψ + Q sin ψ = `u`: the trapezoidal rule on `line`.
fn marginal(alpha: Roughness, scale: f64, (cos, sin): (f64, f64), u: f64, line: &[(f64, f64)]) -> f64 {
    let used = line.partition_point(|(v, _)| *v <= 1e5 * (1.0 + u));
    let at = |v: f64| {
        let (p, q) = (u * cos - v * sin, u * sin + v * cos);
        let r2 = (alpha.x * p).powi(2) + (alpha.y * q).powi(2);
        let square = p * p + q * q;
        // Below rounding: for r ≤ 1, (atan r/r)² ≥ π²/16.
        if r2 <= 1.0 && square > 75.0 {
            return 0.0;
        }
        let r = r2.sqrt();
        let ratio = if r > 0.0 { r.atan() / r } else { 1.0 };
        (-ratio * ratio * square).exp() / ((1.0 + r2) * (1.0 + r2))
    };
    let sides = |&(v, weight): &(f64, f64)| weight * if v == 0.0 { at(v) } else { at(v) + at(-v) };
    scale * line[..used].iter().map(sides).sum::<f64>()
}

/// Points v = sinh s ≥ 0 at steps of s, with their weights: takes Gaussians and
/// algebraic tails alike.
fn line() -> Vec<(f64, f64)> {
    const STEP: f64 = 0.2;
    (0..120).map(|k| STEP * f64::from(k)).map(|s| (s.sinh(), STEP * s.cosh())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverts_to_rounding() {
        for alpha in [1e-4, 0.05, 0.4, 1.0] {
            let shares = Shares::new(Roughness::isotropic(alpha), 0.0);
            for i in 0..=1000 {
                let u = (f64::from(i) / 1000.0).clamp(0.0, 1.0 - f64::EPSILON / 2.0);
                let beyond = Shares::series(alpha, shares.invert(u)) - shares.horizon;
                assert!((beyond / shares.all - (1.0 - u)).abs() < 2e-15, "{alpha} {u}");
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
            let value = Shares::series(alpha, theta) - Shares::series(alpha, FRAC_PI_2);
            assert!((value - sum * h / 3.0).abs() < 1e-13, "{alpha} {theta}");
        }
    }
}
