//! The area of Gaussian facets turned away, tabulated.

use super::{Roughness, chebyshev};

/// Chebyshev points in t, and in cos 2ψ where there is anisotropy: as many as
/// bring the error below 1e-8 at all pairs of roughness.
const POINTS_T: usize = 64;
const POINTS_PSI: usize = 16;

/// Panels of each half of t and terms of the polynomial in each: as many as
/// follow the series through [`POINTS_T`] to 1e-10, see the test.
const PANELS: usize = 24;
const TERMS: usize = 8;

/// Backfacing area over the stretched sine s = |(αx x, αy y)|, as a function of
/// t = a/(1 + a), a = z/s the stretched cotangent: E(a) = ∫ (U − a) M(U) dU over
/// U > a, with M the marginal of the stretched slopes along ψ. In t it is
/// smooth for every α, at the horizon (t = 0) and at the normal (t = 1).
///
/// Polynomials on panels of the square root of the distance in t from the
/// nearer end, as Chebyshev points gather there.
#[derive(Clone)]
pub(super) struct AreaTable {
    /// Of each panel the powers of cos 2ψ, and of each of these the powers of
    /// the place in the panel, −1 to 1.
    panels: Vec<[f64; TERMS]>,
    /// Powers of cos 2ψ.
    azimuths: usize,
}

impl AreaTable {
    /// For D = `scale` exp(−(θm/α)²)/(αx αy).
    pub(super) fn new(alpha: Roughness, scale: f64) -> Self {
        let azimuths = if alpha.is_isotropic() { 1 } else { POINTS_PSI };
        let line = line();
        // Series in t at each azimuth.
        let rows: Vec<Vec<f64>> = chebyshev::points(azimuths)
            .map(|cos_2psi| {
                let (cos, sin) = ((0.5 * (1.0 + cos_2psi)).sqrt(), (0.5 * (1.0 - cos_2psi)).sqrt());
                chebyshev::coefficients(&area_at_points(|u| marginal(alpha, scale, (cos, sin), u, &line)))
            })
            .collect();
        let mut panels = vec![[0.0; TERMS]; 2 * PANELS * azimuths];
        for (p, panel) in panels.chunks_exact_mut(azimuths).enumerate() {
            let local: Vec<Vec<f64>> = rows.iter().map(|row| in_panel(row, p)).collect();
            for k in 0..TERMS {
                let column: Vec<_> = local.iter().map(|l| l.get(k).copied().unwrap_or(0.0)).collect();
                for (to, c) in panel.iter_mut().zip(chebyshev::powers(&chebyshev::coefficients(&column))) {
                    to[k] = c;
                }
            }
        }
        Self { panels, azimuths }
    }

    /// Backfacing area of a direction with stretched tangential part `s`, its
    /// square `x2` + `y2` > 0 split in both tangents, and cosine `z`.
    #[inline]
    pub(super) fn area(&self, x2: f64, y2: f64, z: f64) -> f64 {
        let tangential = (x2 + y2).sqrt();
        // Twice the distance from the nearer end of t.
        let (near, first) = if z < tangential { (z, 0) } else { (tangential, PANELS) };
        let place = (2.0 * near / (z + tangential)).sqrt() * PANELS as f64;
        let panel = (place as usize).min(PANELS - 1);
        let rows = &self.panels[(first + panel) * self.azimuths..][..self.azimuths];
        let mut terms = rows[self.azimuths - 1];
        if self.azimuths > 1 {
            let cos_2psi = (x2 - y2) / (x2 + y2);
            for row in rows[..self.azimuths - 1].iter().rev() {
                for (term, c) in terms.iter_mut().zip(row) {
                    *term = *term * cos_2psi + c;
                }
            }
        }
        let x = 2.0 * (place - panel as f64) - 1.0;
        let e = terms.iter().rev().fold(0.0, |sum, c| sum * x + c);
        // Interpolation may dip below 0 by its error.
        tangential * e.max(0.0)
    }
}

/// Powers of the place in panel `p` of the Chebyshev series `row` in 2t − 1.
fn in_panel(row: &[f64], p: usize) -> Vec<f64> {
    let values: Vec<f64> = chebyshev::points(TERMS)
        .map(|x| {
            let r = ((p % PANELS) as f64 + 0.5 * (1.0 + x)) / PANELS as f64;
            let from_middle = if p < PANELS { r * r - 1.0 } else { 1.0 - r * r };
            chebyshev::sum(row.len(), from_middle, |k| row[k])
        })
        .collect();
    chebyshev::powers(&chebyshev::coefficients(&values))
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
    fn panels_follow_the_series() {
        let line = line();
        for alpha in [1e-4, 0.05, 0.3, 1.0] {
            let alpha = Roughness::isotropic(alpha);
            let table = AreaTable::new(alpha, 1.0 / std::f64::consts::PI);
            let values =
                area_at_points(|u| marginal(alpha, 1.0 / std::f64::consts::PI, (1.0, 0.0), u, &line));
            let row = chebyshev::coefficients(&values);
            for i in 0..1000 {
                let t = f64::from(i) / 1000.0;
                let series = chebyshev::sum(row.len(), 2.0 * t - 1.0, |k| row[k]).max(0.0) * (1.0 - t);
                let error = table.area((1.0 - t).powi(2), 0.0, t) - series;
                assert!(error.abs() < 1e-10, "{alpha:?} {t}: {error:e}");
            }
        }
    }
}
