//! Masking and shadowing in V-shaped grooves.
//!
//! K. E. Torrance and E. M. Sparrow, *Theory for off-specular reflection from
//! roughened surfaces*, JOSA 1967; the min form of J. F. Blinn 1977 and Cook and
//! Torrance 1982; its visible normals in Heitz and d'Eon 2014, §3.

use crate::bsdf::Direction;

/// G1/cos θo for facets of normal `m`, `om` = wo·m > 0:
/// min(1, 2 cos θm cos θo/(wo·m))/cos θo.
#[inline]
pub(super) fn masking_over_cosine(wo: Direction, m: Direction, om: f64) -> f64 {
    (1.0 / wo.z).min(2.0 * m.z / om)
}

/// G2/(cos θo cos θi) for the half vector `m`, `om` = wo·m = wi·m > 0.
#[inline]
pub(super) fn masking_shadowing_over_cosines(wo: Direction, wi: Direction, m: Direction, om: f64) -> f64 {
    (1.0 / (wo.z * wi.z)).min(2.0 * m.z / (om * wo.z.max(wi.z)))
}

/// Of both walls of the groove, `m` and its mirror image, the one that `u`
/// hits as seen from `wo`.
#[inline]
pub(super) fn visible_wall(wo: Direction, m: Direction, u: f64) -> Direction {
    let other = m.mirrored();
    let (a, b) = (wo.dot(m).max(0.0), wo.dot(other).max(0.0));
    if u * (a + b) < b { other } else { m }
}
