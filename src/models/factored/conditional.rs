//! The factored density at one wo.

use super::{FactoredDensity, Grid};
use crate::bsdf::Direction;
use std::f64::consts::{FRAC_1_PI, TAU};

/// p(wi | wo) on the front side.
pub struct Conditional<'a> {
    density: &'a FactoredDensity,
    wo: Direction,
    /// cos and sin of the azimuth from which φp counts.
    turn: (f64, f64),
    /// Share of each term, by rising sums, after the cosine's share.
    probabilities: Vec<f64>,
    cosine: f64,
}

impl<'a> Conditional<'a> {
    pub(super) fn new(density: &'a FactoredDensity, wo: Direction) -> Self {
        let radius = wo.x.hypot(wo.y);
        let turn =
            if density.isotropic && radius > 0.0 { (wo.x / radius, wo.y / radius) } else { (1.0, 0.0) };
        let mut probabilities = density.probabilities(wo);
        probabilities.iter_mut().for_each(|p| *p *= 1.0 - density.floor);
        let cosine = 1.0 - probabilities.iter().sum::<f64>();
        Self { density, wo, turn, probabilities, cosine }
    }

    /// The density of `wi` in sr⁻¹: the cosine's share, and dωp/dωi Σ_l F_l u_l v_l.
    pub fn pdf(&self, wi: Direction) -> f64 {
        if !(self.wo.z > 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        let even = self.cosine * FRAC_1_PI * wi.z;
        let Some((wp, jacobian)) = self.density.grid.over.forward(self.wo, wi) else { return even };
        let spot = self.density.grid.locate(self.turned(wp, -self.turn.1));
        let n = self.probabilities.len();
        let ((i, a), (k, b)) = (spot.t, spot.phi);
        let at = |values: &'a [f64], knot: usize| &values[knot * n..][..n];
        let (u0, u1) = (at(&self.density.t_values, i), at(&self.density.t_values, i + 1));
        let (v0, v1) = (at(&self.density.phi_values, k), at(&self.density.phi_values, k + 1));
        let mut sum = 0.0;
        for l in 0..n {
            let u = u0[l] + a * (u1[l] - u0[l]);
            let v = v0[l] + b * (v1[l] - v0[l]);
            sum += self.probabilities[l] * u * v;
        }
        even + jacobian * sum
    }

    /// Draws wi: `u[0]` in [0, 1) chooses the term, `u[1]` θp and `u[2]` φp of that
    /// term. `None` where wi falls below the surface.
    pub fn sample(&self, u: [f64; 3]) -> Option<Direction> {
        if !(self.wo.z > 0.0) {
            return None;
        }
        if u[0] < self.cosine {
            let (sin, cos) = (TAU * u[2]).sin_cos();
            let r = u[1].sqrt();
            return Some(Direction::new(r * cos, r * sin, (1.0 - u[1]).sqrt()));
        }
        let mut below = self.cosine;
        let chosen = self.probabilities.iter().position(|p| {
            below += p;
            u[0] < below
        });
        // Rounding may leave the sum a little below 1.
        let last = || self.probabilities.iter().rposition(|p| *p > 0.0);
        let term = &self.density.terms()[chosen.or_else(last)?];
        let wp = Grid::direction(term.t.sample(u[1]), term.phi.sample(u[2]));
        let wp = self.turned(wp, self.turn.1);
        self.density.grid.over.backward(self.wo, wp).map(|(wi, _)| wi)
    }

    /// Turned about the normal by the angle of this sine.
    fn turned(&self, w: Direction, sin: f64) -> Direction {
        let cos = self.turn.0;
        Direction::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
    }
}
