//! Phong's lobe as a density of directions: a power of the cosine about an axis
//! (E. P. Lafortune and Y. D. Willems, *Using the modified Phong reflectance
//! model for physically based rendering*, report CW 197, K.U. Leuven, 1994).

use crate::bsdf::Direction;
use crate::sphere::sin_cos_turns;
use std::f64::consts::TAU;

/// Density (n + 1)/2π cosⁿα per steradian over the hemisphere about the axis,
/// `cos` = cos α; 0 on the other one.
#[inline]
pub(super) fn density(cos: f64, n: f64) -> f64 {
    (n + 1.0) / TAU * power(cos, n)
}

/// cosⁿα, 0 where the cosine is not positive.
#[inline]
pub(super) fn power(cos: f64, n: f64) -> f64 {
    if cos > 0.0 { cos.powf(n) } else { 0.0 }
}

/// A direction with this density about the unit `axis`: cos α = (1 − u₀)^(1/(n+1)).
#[inline]
pub(super) fn sample(axis: Direction, n: f64, u: &[f64]) -> Direction {
    let log = (-u[0]).ln_1p() / (n + 1.0);
    // sin²α = 1 − cos²α without cancellation in narrow lobes.
    let (cos, sin) = (log.exp(), (-(2.0 * log).exp_m1()).sqrt());
    let (y, x) = sin_cos_turns(u[1]);
    let (s, t) = tangents(axis);
    s * (sin * x) + t * (sin * y) + axis * cos
}

/// Two unit vectors that make a right-handed frame with the unit `axis` (T. Duff
/// et al., *Building an orthonormal basis, revisited*, JCGT 2017).
#[inline]
fn tangents(axis: Direction) -> (Direction, Direction) {
    let sign = 1f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    (
        Direction::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        Direction::new(b, sign + axis.y * axis.y * a, -axis.y),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for axis in [Direction::NORMAL, -Direction::NORMAL, Direction::from_angles(1.9, 2.4)] {
            let (s, t) = tangents(axis);
            assert!((s.cross(t) - axis).length() < 1e-15);
            assert!((s.length() - 1.0).abs() < 1e-15 && (t.length() - 1.0).abs() < 1e-15);
        }
    }

    /// The area that u covers, by central differences, is the density's inverse.
    #[test]
    fn draws_follow_the_density() {
        let h = 1e-6;
        for axis in [Direction::NORMAL, Direction::from_angles(2.0, -1.0)] {
            for n in [0.0, 1.0, 30.0, 1e4] {
                for (u, v) in [(0.02, 0.1), (0.5, 0.7), (0.97, 0.4)] {
                    let at = |u: f64, v: f64| sample(axis, n, &[u, v]);
                    let area = (at(u + h, v) - at(u - h, v)).cross(at(u, v + h) - at(u, v - h)).length();
                    let jacobian = area / (4.0 * h * h) * density(axis.dot(at(u, v)), n);
                    assert!((jacobian - 1.0).abs() < 1e-5, "{axis:?} {n} {u} {v}: {jacobian}");
                }
            }
        }
    }
}
