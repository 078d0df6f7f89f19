//! Directions and cells along the plane of incidence, and around the normal.

use super::gathered::Evidence;
use super::stretch::Stretch;
use super::strips::{Strip, Widths, cells, strips};
use crate::bsdf::Direction;

/// Cells are near the plane whose middle is within so many degrees of it.
const NEAR: f64 = 8.0;

/// Strips along the plane.
const THETA: Widths = Widths { finest: 3.0, coarsest: 15.0, share: 1.0 / 24.0 };

/// Strips around the normal.
const PHI: Widths = Widths { finest: 10.0, coarsest: 30.0, share: 1.0 / 20.0 };

/// The plane of incidence of one wo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    sin: f64,
    cos: f64,
    side: f64,
}

impl Plane {
    /// Of this wo.
    pub fn of(wo: Direction) -> Self {
        let (sin, cos) = wo.phi().sin_cos();
        Self { sin, cos, side: if wo.z < 0.0 { -1.0 } else { 1.0 } }
    }

    /// Degrees from the normal of wo's side: below 0 on the side where wo is, beyond 90
    /// it is transmitted.
    pub fn theta(&self, wi: Direction) -> f64 {
        let away = -(wi.x * self.cos + wi.y * self.sin);
        away.atan2(self.side * wi.z).to_degrees()
    }

    /// The direction in the plane at such an angle.
    pub fn direction(&self, theta: f64) -> Direction {
        let (s, c) = theta.to_radians().sin_cos();
        Direction::new(-s * self.cos, -s * self.sin, c * self.side)
    }

    /// Degrees off the plane.
    fn off(&self, wi: Direction) -> f64 {
        (wi.y * self.cos - wi.x * self.sin).clamp(-1.0, 1.0).asin().abs().to_degrees()
    }

    /// The direction so many degrees off the plane.
    pub(super) fn beside(&self, theta: f64, off: f64) -> Direction {
        let (sin, cos) = off.to_radians().sin_cos();
        self.direction(theta) * cos + Direction::new(-self.sin, self.cos, 0.0) * sin
    }

    /// How a case's lobe is seen along the plane, and how far off it cells are near.
    fn seen(&self, cells: &[(Direction, Strip)]) -> Stretch {
        let near = cells.iter().filter(|(wi, _)| self.off(*wi) <= NEAR);
        Stretch::of(near.map(|(_, c)| (c.degrees, c.observed + c.expected)))
    }

    /// A case's cells near the plane, by θ. `None` where nothing was drawn or integrated.
    pub fn strips(evidence: &Evidence) -> Option<Vec<Strip>> {
        let plane = Self::of(evidence.wo);
        let mut cells = cells(evidence, |wi| plane.theta(wi))?;
        let stretch = plane.seen(&cells);
        cells.retain(|(wi, c)| plane.off(*wi) <= stretch.near(c.degrees, NEAR));
        Some(strips(cells.into_iter().map(|(_, cell)| cell).collect(), &THETA))
    }

    /// How a case's lobe is seen along the plane, and how many degrees off it at an angle
    /// still belong to it. `None` where nothing was drawn or integrated.
    pub(super) fn stretch(&self, evidence: &Evidence) -> Option<(Stretch, impl Fn(f64) -> f64)> {
        let stretch = self.seen(&cells(evidence, |wi| self.theta(wi))?);
        Some((stretch, move |theta: f64| stretch.near(theta, NEAR)))
    }
}

/// The azimuth of `wi` in degrees from −180 to 180, 0 being away from wo, where a mirror
/// reflects it to.
pub fn forward_azimuth(wo: Direction, wi: Direction) -> f64 {
    let (sin, cos) = wo.phi().sin_cos();
    let (along, across) = (wi.x * cos + wi.y * sin, wi.y * cos - wi.x * sin);
    (-across).atan2(-along).to_degrees()
}

/// A case's cells by [`forward_azimuth`]. `None` where nothing was drawn or integrated.
pub fn azimuths(evidence: &Evidence) -> Option<Vec<Strip>> {
    let cells = cells(evidence, |wi| forward_azimuth(evidence.wo, wi))?;
    Some(strips(cells.into_iter().map(|(_, cell)| cell).collect(), &PHI))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_counted_from_wos_side() {
        for theta in [0.5f64, 2.5] {
            let wo = Direction::from_angles(theta, 2.0);
            let plane = Plane::of(wo);
            let from_normal = if theta > 1.6 { 180.0 - theta.to_degrees() } else { theta.to_degrees() };
            assert!((plane.theta(wo) + from_normal).abs() < 1e-9);
            assert!((plane.theta(wo.mirrored()) - from_normal).abs() < 1e-9);
            assert!(plane.theta(-wo).abs() > 90.0, "transmitted");
            for x in [-120.0, -30.0, 0.0, 80.0, 170.0] {
                let wi = plane.direction(x);
                assert!((plane.theta(wi) - x).abs() < 1e-9 && plane.off(wi) < 1e-9);
                let beside = plane.beside(x, -5.0);
                assert!((plane.theta(beside) - x).abs() < 1e-9 && (plane.off(beside) - 5.0).abs() < 1e-9);
            }
            assert!((plane.off(wo.rotated(std::f64::consts::FRAC_PI_2)) - from_normal).abs() < 1e-9);
            assert!(forward_azimuth(wo, wo.mirrored()).abs() < 1e-9);
            assert!((forward_azimuth(wo, wo).abs() - 180.0).abs() < 1e-9);
            let turned = wo.mirrored().rotated(0.3);
            assert!((forward_azimuth(wo, turned) - 0.3f64.to_degrees()).abs() < 1e-9);
        }
    }
}
