//! Which direction the factors are functions of.

use crate::bsdf::Direction;

/// Which direction ωp, given wo, stands for wi (Lawrence et al. 2004).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameterisation {
    /// The half vector, about which glossy lobes change little with wo.
    HalfAngle,
    /// wi itself, for diffuse reflection.
    Incident,
}

impl Parameterisation {
    /// ωp of a `wi` above the surface, and dωp/dωi, which is 1/(4 wo·h) of the half
    /// vector; `None` where wi = −wo has none.
    #[inline]
    pub fn forward(self, wo: Direction, wi: Direction) -> Option<(Direction, f64)> {
        match self {
            Self::Incident => Some((wi, 1.0)),
            Self::HalfAngle => {
                let sum = wo + wi;
                // wo·h is half of the length of wo + wi.
                let length = sum.length();
                (length > 0.0).then(|| (sum * (1.0 / length), 0.5 / length))
            }
        }
    }

    /// wi of ωp, and dωp/dωi; `None` where wi lies below the surface.
    #[inline]
    pub fn backward(self, wo: Direction, wp: Direction) -> Option<(Direction, f64)> {
        match self {
            Self::Incident => (wp.z > 0.0).then_some((wp, 1.0)),
            Self::HalfAngle => {
                let cosine = wo.dot(wp);
                let wi = wo.reflected(wp);
                (cosine > 0.0 && wi.z > 0.0).then(|| (wi, 0.25 / cosine))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forward_undoes_backward_and_the_half_vectors_jacobian_is_a_ratio_of_areas() {
        let wo = Direction::from_angles(0.9, 0.4);
        let at = |theta, phi| {
            let (wi, jacobian) =
                Parameterisation::HalfAngle.backward(wo, Direction::from_angles(theta, phi)).unwrap();
            let (wh, same) = Parameterisation::HalfAngle.forward(wo, wi).unwrap();
            assert!((wh.theta() - theta).abs() < 1e-12 && (same - jacobian).abs() < 1e-12);
            (wi, jacobian)
        };
        for (theta, phi) in [(0.1, 1.0), (0.5, 0.2), (0.3, 3.0)] {
            let h = 1e-5;
            let slope = |a: Direction, b: Direction| (a - b) * (0.5 / h);
            let along = slope(at(theta + h, phi).0, at(theta - h, phi).0);
            let across = slope(at(theta, phi + h).0, at(theta, phi - h).0);
            // dωi/(sin θh dθh dφh).
            let area = along.cross(across).length() / theta.sin();
            assert!((area * at(theta, phi).1 - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn below_the_surface_there_is_nothing() {
        let wo = Direction::from_angles(1.5, 0.0);
        let away = Direction::from_angles(0.3, std::f64::consts::PI);
        assert_eq!(Parameterisation::HalfAngle.backward(wo, away), None);
        assert_eq!(Parameterisation::HalfAngle.forward(wo, -wo), None);
    }
}
