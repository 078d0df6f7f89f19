//! The grids on which a subject is tabulated before it is factored.

use super::{Knots, Parameterisation};
use crate::bsdf::Direction;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Knots of ωp: t = 1 − cos θp, which makes equal areas of equal steps, so that a
/// smooth function of t is a smooth density about the pole; and the azimuth φp
/// around the full circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// What ωp is.
    pub over: Parameterisation,
    /// Knots in t from 0 to 1.
    pub t: Knots,
    /// Knots in φ from −π to π.
    pub phi: Knots,
}

/// A cell of a [`Grid`], and a place in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Number of the knot below in t, and the share of the way to the next.
    pub t: (usize, f64),
    /// The same in φ.
    pub phi: (usize, f64),
}

impl Grid {
    /// `theta` × `phi` cells. Half angles are dense near the normal, as √θ (W.
    /// Matusik's warp of the MERL tables): lobes are narrow there; directions of
    /// incidence are even in θ.
    pub fn new(over: Parameterisation, theta: usize, phi: usize) -> Self {
        let knot = |k: usize| {
            let x = k as f64 / theta as f64;
            let theta = FRAC_PI_2 * if over == Parameterisation::HalfAngle { x * x } else { x };
            2.0 * (0.5 * theta).sin().powi(2)
        };
        let mut t: Vec<f64> = (0..=theta).map(knot).collect();
        t[theta] = 1.0;
        let phi = (0..=phi).map(|k| -PI + TAU * k as f64 / phi as f64).collect();
        Self { over, t: Knots::new(t, false), phi: Knots::new(phi, true) }
    }

    /// Width in degrees of the first cell in θp.
    pub fn first_width(&self) -> f64 {
        (1.0 - self.t.at()[1]).acos().to_degrees()
    }

    /// The direction at (t, φ).
    #[inline]
    pub fn direction(t: f64, phi: f64) -> Direction {
        let r = (t * (2.0 - t)).max(0.0).sqrt();
        let (sin, cos) = phi.sin_cos();
        Direction::new(r * cos, r * sin, 1.0 - t)
    }

    /// The cell in which a direction of the upper hemisphere lies.
    #[inline]
    pub fn locate(&self, wp: Direction) -> Spot {
        // 1 − z without its cancellation.
        let t = (wp.x * wp.x + wp.y * wp.y) / (1.0 + wp.z);
        let knots = self.t.at();
        let below = knots[1..knots.len() - 1].partition_point(|k| *k <= t);
        let share = ((t - knots[below]) / (knots[below + 1] - knots[below])).clamp(0.0, 1.0);
        let cells = self.phi.intervals();
        let along = (wp.phi() + PI) / TAU * cells as f64;
        let cell = (along as usize).min(cells - 1);
        Spot { t: (below, share), phi: (cell, (along - cell as f64).clamp(0.0, 1.0)) }
    }
}

/// The directions wo at which a subject is tabulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Polar angles in radians, rising from 0.
    theta: Vec<f64>,
    /// Azimuths around the circle; 1 of an isotropic subject.
    phi: usize,
}

/// The last polar angle, in degrees, at which a subject is asked: at 90° there is
/// nothing to see.
const GRAZING: f64 = 89.9;

impl Given {
    /// `theta` ≥ 2 polar angles, dense towards the horizon, where reflection changes
    /// most, and `phi` azimuths.
    pub fn new(theta: usize, phi: usize) -> Self {
        let angle = |k: usize| {
            let short = 1.0 - k as f64 / (theta - 1) as f64;
            (90.0 * (1.0 - short * short)).min(GRAZING).to_radians()
        };
        Self { theta: (0..theta).map(angle).collect(), phi }
    }

    /// Number of directions.
    pub fn len(&self) -> usize {
        self.theta.len() * self.phi
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.theta.is_empty()
    }

    /// Direction `row`.
    pub fn direction(&self, row: usize) -> Direction {
        Direction::from_angles(self.theta[row / self.phi], TAU * (row % self.phi) as f64 / self.phi as f64)
    }

    /// The directions around `wo` with their shares in it, which add up to 1:
    /// bilinear in θ and φ.
    pub fn around(&self, wo: Direction) -> [(usize, f64); 4] {
        let last = self.theta.len() - 1;
        let theta = wo.theta().min(self.theta[last]);
        let below = self.theta[1..last].partition_point(|k| *k <= theta);
        let a = (theta - self.theta[below]) / (self.theta[below + 1] - self.theta[below]);
        let along = wo.phi().rem_euclid(TAU) / TAU * self.phi as f64;
        let cell = (along as usize).min(self.phi - 1);
        let b = (along - cell as f64).clamp(0.0, 1.0);
        let row = |theta: usize, phi: usize| theta * self.phi + phi % self.phi;
        [
            (row(below, cell), (1.0 - a) * (1.0 - b)),
            (row(below, cell + 1), (1.0 - a) * b),
            (row(below + 1, cell), a * (1.0 - b)),
            (row(below + 1, cell + 1), a * b),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_found_where_they_were_put() {
        for over in [Parameterisation::HalfAngle, Parameterisation::Incident] {
            let grid = Grid::new(over, 9, 7);
            for (i, k) in (0..9).flat_map(|i| (0..7).map(move |k| (i, k))) {
                let t = 0.3 * grid.t.at()[i] + 0.7 * grid.t.at()[i + 1];
                let phi = 0.6 * grid.phi.at()[k] + 0.4 * grid.phi.at()[k + 1];
                let spot = grid.locate(Grid::direction(t, phi));
                assert_eq!((spot.t.0, spot.phi.0), (i, k));
                assert!((spot.t.1 - 0.7).abs() < 1e-9 && (spot.phi.1 - 0.4).abs() < 1e-9);
            }
            // The corners of the hemisphere are in it.
            for wp in [Direction::NORMAL, Direction::new(-1.0, -0.0, 0.0), Direction::new(1.0, 0.0, 0.0)] {
                let spot = grid.locate(wp);
                assert!(spot.t.0 < 9 && spot.phi.0 < 7 && spot.t.1.is_finite());
            }
        }
    }

    #[test]
    fn given_directions_are_interpolated() {
        let given = Given::new(6, 8);
        for row in 8..given.len() {
            let around = given.around(given.direction(row));
            let own: f64 = around.iter().filter(|(r, _)| *r == row).map(|(_, share)| share).sum();
            assert!((own - 1.0).abs() < 1e-9, "{row} {around:?}");
        }
        for wo in [Direction::NORMAL, Direction::from_angles(1.57, -3.1), Direction::from_angles(0.7, 6.2)] {
            let sum: f64 = given.around(wo).iter().map(|(_, share)| share).sum();
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }
}
