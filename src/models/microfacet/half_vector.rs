//! The facet normal that takes light from one direction to another.

use crate::bsdf::Direction;

/// The normal that reflects `wi` to `wo`, and its cosine with both; `None` off
/// the front side, and where both are so close to the horizon and opposite that
/// their sum has no length in f64.
#[inline]
pub(crate) fn of_reflection(wo: Direction, wi: Direction) -> Option<(Direction, f64)> {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return None;
    }
    let sum = wo + wi;
    let length = sum.length();
    (length > 0.0).then(|| (sum * (1.0 / length), 0.5 * length))
}

/// The facet that refracts light from one direction to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refracting {
    /// Its normal, on the side of wo.
    pub m: Direction,
    /// wo·m > 0.
    pub cos_o: f64,
    /// −wi·m > 0.
    pub cos_i: f64,
    /// |wo + η wi|.
    pub length: f64,
}

/// The facet that refracts `wi`, below, to `wo`, above, `eta` ≠ 1 being the index
/// below over the index above: m = ∓(wo + η wi)/|wo + η wi|, which points into
/// the thinner medium (B. Walter et al., *Microfacet models for refraction
/// through rough surfaces*, EGSR 2007, eq. 16). `None` where that is no facet
/// seen from above by `wo` and from below by `wi`.
#[inline]
pub(crate) fn of_refraction(wo: Direction, wi: Direction, eta: f64) -> Option<Refracting> {
    if wo.z <= 0.0 || wi.z >= 0.0 {
        return None;
    }
    // As (wo + wi) + (η − 1) wi, whose first sum is exact where η is near 1 and
    // the directions nearly opposite.
    let sum = (wo + wi) + wi * (eta - 1.0);
    let length = sum.length();
    let m = sum * (if eta > 1.0 { -1.0 } else { 1.0 } / length);
    let (cos_o, cos_i) = (wo.dot(m), -wi.dot(m));
    (m.z > 0.0 && cos_o > 0.0 && cos_i > 0.0).then_some(Refracting { m, cos_o, cos_i, length })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::fresnel::refracted_cosine;

    /// Snell's law in the plane of each facet.
    #[test]
    fn refraction_is_undone() {
        for eta in [1.01, 1.5, 1.0 / 1.5, 2.4] {
            for tilt in [0.0, 0.3, 0.9] {
                for theta in [0.0, 0.5, 1.2] {
                    let m = Direction::from_angles(tilt, 2.0);
                    let wo = Direction::from_angles(theta, 0.3);
                    let cos_o = wo.dot(m);
                    let Some(cos_i) = refracted_cosine(cos_o, eta).filter(|_| cos_o > 0.0) else { continue };
                    let wi = m * (cos_o / eta - cos_i) - wo * (1.0 / eta);
                    let Some(found) = of_refraction(wo, wi, eta) else {
                        assert!(wi.z >= 0.0, "{eta} {tilt} {theta}");
                        continue;
                    };
                    assert!((found.m - m).length() < 1e-13, "{eta} {tilt} {theta}: {found:?}");
                    assert!((found.cos_o - cos_o).abs() < 1e-13 && (found.cos_i - cos_i).abs() < 1e-13);
                    let length = (eta * eta - 1.0).abs() / (cos_o + eta * cos_i);
                    assert!((found.length / length - 1.0).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn none_beyond_the_critical_angle_or_on_one_side() {
        let (up, down) = (Direction::NORMAL, -Direction::NORMAL);
        assert!(of_refraction(up, up, 1.5).is_none());
        // From above, glass below holds what comes from 41.8° around −wo: at 60° the
        // facet would have to be seen from behind.
        let wide = Direction::from_angles(120f64.to_radians(), 1.0);
        assert!(of_refraction(up, wide, 1.5).is_none());
        assert!(of_refraction(up, down, 1.5).is_some());
        let horizon = Direction::new(1.0, 0.0, 0.0);
        assert!(of_refraction(up, horizon, 1.5).is_none() && of_refraction(horizon, down, 1.5).is_none());
    }
}
