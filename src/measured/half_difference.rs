//! Coordinates of a pair of directions relative to the direction half way
//! between them.

use crate::bsdf::Direction;
use crate::sphere::octants;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// θh, θd and φd of S. Rusinkiewicz, *A new change of variables for efficient
/// BRDF representation*, 1998: the polar angle of the half vector h, and the
/// angles of wi in the frame whose normal is h and whose tangent lies in the
/// plane of h and the surface normal. φh is left out: the surface is isotropic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfDifference {
    /// In [0, π/2].
    pub theta_h: f64,
    /// In [0, π/2].
    pub theta_d: f64,
    /// In [0, π): φd and φd + π are a pair and the exchanged pair.
    pub phi_d: f64,
}

/// sin θh below which h is the normal, so that φd has no meaning; and the
/// relative distance from the plane of h and the normal within which φd is 0 and
/// not just below π. Rounding is 1e-16, and nothing measured resolves 1e-9.
const COINCIDENT: f64 = 1e-9;

/// The angle in [0, π/2] whose tangent is y/x, of numbers that are not negative: as
/// y.atan2(x), in a quarter of the time.
#[inline]
pub(super) fn angle(y: f64, x: f64) -> f64 {
    if y <= x { FRAC_PI_4 * octants(y, x) } else { FRAC_PI_2 - FRAC_PI_4 * octants(x, y) }
}

impl HalfDifference {
    /// Of directions on the front side. Exchanging them gives the same bits.
    #[inline]
    pub fn new(wo: Direction, wi: Direction) -> Self {
        let (sum, difference) = (wo + wi, wi - wo);
        let across = (sum.x * sum.x + sum.y * sum.y).sqrt();
        let theta_h = angle(across, sum.z);
        // |wi − wo| = 2 sin θd and |wi + wo| = 2 cos θd.
        let (sin_d, cos_d) = (difference.length(), sum.length());
        let theta_d = angle(sin_d, cos_d);
        if across <= COINCIDENT * cos_d {
            return Self { theta_h, theta_d, phi_d: 0.0 };
        }
        let (cos_phi, sin_phi) = (sum.x / across, sum.y / across);
        // wi − wo has no part along h, so turning it by −φh and −θh leaves x and y.
        let along = difference.x * cos_phi + difference.y * sin_phi;
        let y = difference.y * cos_phi - difference.x * sin_phi;
        let x = (along * sum.z - difference.z * across) / cos_d;
        let (x, y) = if y < 0.0 { (-x, -y) } else { (x, y) };
        let phi_d = match x {
            _ if y <= COINCIDENT * sin_d => 0.0,
            0.0.. => angle(y, x),
            _ => PI - angle(y, -x),
        };
        Self { theta_h, theta_d, phi_d }
    }

    /// A pair (wo, wi) with these coordinates and φh = 0; either may be below the
    /// horizon.
    pub fn pair(self) -> [Direction; 2] {
        let (sin_h, cos_h) = self.theta_h.sin_cos();
        let turned = |phi_d: f64| {
            let d = Direction::from_angles(self.theta_d, phi_d);
            Direction::new(d.x * cos_h + d.z * sin_h, d.y, d.z * cos_h - d.x * sin_h)
        };
        [turned(self.phi_d + PI), turned(self.phi_d)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn pairs_have_their_coordinates(
            theta_h in 1e-6..1.5f64, theta_d in 1e-6..1.5f64, phi_d in 1e-6..3.1f64, turn in -3.0..3.0f64,
        ) {
            let [wo, wi] = HalfDifference { theta_h, theta_d, phi_d }.pair();
            prop_assert!((wo.length() - 1.0).abs() < 1e-15 * 8.0);
            let found = HalfDifference::new(wo.rotated(turn), wi.rotated(turn));
            for (a, b) in [(found.theta_h, theta_h), (found.theta_d, theta_d)] {
                prop_assert!((a - b).abs() < 1e-12, "{found:?}");
            }
            // Near the normal or a pair of equal directions φd is less certain.
            let slack = 1e-15 / theta_h.min(theta_d).powi(2) + 1e-12;
            prop_assert!((found.phi_d - phi_d).abs() < slack, "{found:?}");
            let exchanged = HalfDifference::new(wi.rotated(turn), wo.rotated(turn));
            prop_assert_eq!(exchanged, found);
        }
    }

    /// By hand, and as the definition by two rotations of wi says.
    #[test]
    fn known_pairs() {
        let at = |theta: f64, phi: f64| Direction::from_angles(theta.to_radians(), phi.to_radians());
        let close = |a: HalfDifference, b: [f64; 3]| {
            let found = [a.theta_h, a.theta_d, a.phi_d].map(f64::to_degrees);
            assert!((0..3).all(|k| (found[k] - b[k]).abs() < 1e-9), "{found:?} {b:?}");
        };
        // The mirror pair: h is the normal.
        close(HalfDifference::new(at(40.0, 20.0), at(40.0, 200.0)), [0.0, 40.0, 0.0]);
        // In one plane: φd is 0 or π, which are the same.
        close(HalfDifference::new(at(0.0, 0.0), at(60.0, 77.0)), [30.0, 30.0, 0.0]);
        close(HalfDifference::new(at(60.0, 77.0), at(0.0, 0.0)), [30.0, 30.0, 0.0]);
        // Either side of a plane: the difference is perpendicular to it.
        close(HalfDifference::new(at(90.0, 45.0), at(90.0, -45.0)), [90.0, 45.0, 90.0]);
        // Equal directions.
        close(HalfDifference::new(at(30.0, 10.0), at(30.0, 10.0)), [30.0, 0.0, 0.0]);
    }
}
