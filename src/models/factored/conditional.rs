//! The factored density at one wo.

use super::{FactoredDensity, Grid, bezier};
use crate::bsdf::Direction;
use crate::sphere::sin_cos_turns;
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
        let ((i, a), (k, b)) = (spot.t, spot.phi);
        let (u, v) = (self.density.t.interval(i), self.density.phi.interval(k));
        let mut sum = 0.0;
        for (l, p) in self.probabilities.iter().enumerate() {
            let v = bezier(v.map(|c| c[l]), b);
            // At the pole there is no azimuth.
            let pole = if i == 0 { bezier([u[0][l], 0.0, 0.0], a) } else { 0.0 };
            sum += p * ((bezier(u.map(|c| c[l]), a) - pole) * v + pole / TAU);
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
            let (sin, cos) = sin_cos_turns(u[2]);
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
        let t = term.t.sample(u[1]);
        // What of the density at t belongs to the pole is even in azimuth.
        let share = (t / self.density.grid.t.at()[1]).min(1.0);
        let curve = [term.t.value(0), term.t.middle(0), term.t.value(1)];
        let pole = bezier([curve[0], 0.0, 0.0], share);
        let even = if pole > 0.0 { pole / bezier(curve, share) } else { 0.0 };
        let wp = Grid::direction(t, term.phi.sample_evened(u[2], even));
        let wp = self.turned(wp, self.turn.1);
        self.density.grid.over.backward(self.wo, wp).map(|(wi, _)| wi)
    }

    /// Turned about the normal by the angle of this sine.
    fn turned(&self, w: Direction, sin: f64) -> Direction {
        let cos = self.turn.0;
        Direction::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
    }
}
