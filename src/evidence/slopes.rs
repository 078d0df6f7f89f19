//! Normals by their slopes, in the scale of what is drawn.

use crate::bsdf::Direction;
use crate::sphere::Point;

/// Normals m above the horizon in slices along which visibility is smooth.
///
/// The slopes s = m·x/m.z towards wo and t = m·y/m.z across are taken in the
/// scale of the normals drawn, t less a multiple of s so that the longest
/// direction of an anisotropic lobe lies along the coordinates, and both brought
/// from the real line to (−1, 1) by [`line`]: in these coordinates a lobe of any
/// roughness, anisotropy and azimuth is about as wide as the square.
///
/// Planes through the horizontal y are lines of constant s: the horizon; the
/// edge wo·m = 0 of what is turned away, s = −cot θo; and the edge wo·m = 2 cos
/// θm cos θo where V-shaped grooves begin to mask, s = cot θo. Cut there, no
/// cell of a cubature straddles an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slopes {
    x: Direction,
    y: Direction,
    scale: [f64; 2],
    shear: f64,
    cot_theta: f64,
}

/// Coordinates from `from` on, a point's u in [0, 1) being the share of `width`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    from: f64,
    width: f64,
}

/// A thinner slice is none.
const THINNEST: f64 = 1e-12;

/// Rounds of fitting the scales: each leaves out what is far off by the last.
const ROUNDS: usize = 12;

/// Far off, in medians: some 95 % of a Gaussian are nearer.
const FAR: f64 = 3.0;

/// (−1, 1) to the real line, with algebraic tails as slopes have them, and its
/// derivative; both ends are as near as f64 comes to them.
fn line(x: f64) -> (f64, f64) {
    let x = x.clamp(f64::EPSILON - 1.0, 1.0 - f64::EPSILON);
    let rest = (1.0 - x) * (1.0 + x);
    (x / rest, (1.0 + x * x) / (rest * rest))
}

/// The inverse of [`line`].
fn unline(s: f64) -> f64 {
    if s.is_infinite() { s.signum() } else { 2.0 * s / (1.0 + (4.0 * s * s + 1.0).sqrt()) }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    // Where nothing usable was drawn any scale will do.
    values.get(values.len() / 2).copied().filter(|v| *v > 0.0 && v.is_finite()).unwrap_or(1.0)
}

impl Slopes {
    /// In the scale of `drawn` normals, as seen from `wo`, wo.z > 0.
    pub(super) fn of(wo: Direction, drawn: &[Direction]) -> Self {
        let (sin, cos) = wo.phi().sin_cos();
        let (x, y) = (Direction::new(cos, sin, 0.0), Direction::new(-sin, cos, 0.0));
        let pairs: Vec<(f64, f64)> =
            drawn.iter().filter(|m| m.z > 0.0).map(|m| (m.dot(x) / m.z, m.dot(y) / m.z)).collect();
        let scale_s = median(pairs.iter().map(|p| p.0.abs()).collect());
        let mut shear = 0.0;
        let mut scale_t = 1.0;
        for _ in 0..ROUNDS {
            scale_t = median(pairs.iter().map(|(s, t)| (t - shear * s).abs()).collect());
            let near =
                |(s, t): &&(f64, f64)| s.abs() < FAR * scale_s && (t - shear * s).abs() < FAR * scale_t;
            let (sum, square) =
                pairs.iter().filter(near).fold((0.0, 0.0), |(a, b), (s, t)| (a + s * t, b + s * s));
            shear = if square > 0.0 { sum / square } else { 0.0 };
        }
        let cot_theta = wo.z / wo.x.hypot(wo.y);
        Self { x, y, scale: [scale_s, scale_t], shear, cot_theta }
    }

    /// The slices.
    pub(super) fn slices(&self) -> Vec<Slice> {
        let edge = unline(self.cot_theta / self.scale[0]);
        [-1.0, -edge, edge, 1.0]
            .windows(2)
            .map(|pair| Slice { from: pair[0], width: pair[1] - pair[0] })
            .filter(|slice| slice.width > THINNEST)
            .collect()
    }

    /// The normal at a point of a slice, and its steradians for a unit of area in
    /// u and v.
    pub(super) fn normal(&self, slice: &Slice, [u, v]: Point) -> (Direction, f64) {
        let (s, ds) = line(slice.from + slice.width * u);
        let (t, dt) = line(2.0 * v - 1.0);
        let s = self.scale[0] * s;
        let t = self.shear * s + self.scale[1] * t;
        let z = 1.0 / (1.0 + s * s + t * t).sqrt();
        let m = (self.x * s + self.y * t + Direction::NORMAL) * z;
        // dω = cos³θ ds dt.
        (m, z * z * z * self.scale[0] * ds * slice.width * self.scale[1] * dt * 2.0)
    }

    /// The point of a normal, if it lies within the slice.
    pub(super) fn point(&self, slice: &Slice, m: Direction) -> Option<Point> {
        if m.z <= 0.0 {
            return None;
        }
        let (s, t) = (m.dot(self.x) / m.z, m.dot(self.y) / m.z);
        let u = (unline(s / self.scale[0]) - slice.from) / slice.width;
        let v = 0.5 * (1.0 + unline((t - self.shear * s) / self.scale[1]));
        ((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v)).then_some([u, v])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An oblique lobe as if drawn, with slopes up to `a` along and `b` across.
    fn drawn(a: f64, b: f64) -> Vec<Direction> {
        let golden = |k: usize, step: f64| (k as f64 * step).fract() * 2.0 - 1.0;
        (0..2000)
            .map(|k| {
                let (p, q) = (a * golden(k, 0.618_033_988_749_895), b * golden(k, 0.414_213_562_373_095));
                Direction::new(0.6 * p - 0.8 * q, 0.8 * p + 0.6 * q, 1.0).normalized()
            })
            .collect()
    }

    #[test]
    fn slices_cover_the_hemisphere_and_come_back() {
        for theta in [0.0, 0.4, 1.2, 1.57] {
            let wo = Direction::from_angles(theta, 0.7);
            for (a, b) in [(1.0, 1.0), (1.0, 1e-3), (1e-3, 1e-3)] {
                let slopes = Slopes::of(wo, &drawn(a, b));
                let slices = slopes.slices();
                for (tilt, azimuth) in [(1e-4, 0.1), (0.3, 2.0), (1.0, 4.0), (1.5, 5.5)] {
                    let m = Direction::from_angles(tilt, azimuth);
                    let found: Vec<_> =
                        slices.iter().filter_map(|l| Some((l, slopes.point(l, m)?))).collect();
                    assert_eq!(found.len(), 1, "{theta} {tilt} {azimuth}");
                    assert!((slopes.normal(found[0].0, found[0].1).0 - m).length() < 1e-10);
                    // Within a slice no edge is crossed.
                    let sides = |m: Direction| (wo.dot(m) > 0.0, wo.dot(m) > 2.0 * m.z * wo.z);
                    for corner in [[0.01, 0.3], [0.99, 0.8]] {
                        assert_eq!(sides(slopes.normal(found[0].0, corner).0), sides(m));
                    }
                }
            }
        }
    }

    #[test]
    fn steradians_are_those_of_the_map() {
        let wo = Direction::from_angles(0.9, 2.0);
        let slopes = Slopes::of(wo, &drawn(1.0, 0.01));
        for slice in slopes.slices() {
            for [u, v] in [[0.3, 0.4], [0.8, 0.5], [0.5, 0.9]] {
                let at = |du: f64, dv: f64| slopes.normal(&slice, [u + du, v + dv]).0;
                let h = 1e-6;
                let across = (at(h, 0.0) - at(-h, 0.0)).cross(at(0.0, h) - at(0.0, -h));
                let area = across.length() / (4.0 * h * h);
                let told = slopes.normal(&slice, [u, v]).1;
                assert!((area / told - 1.0).abs() < 1e-5, "{u} {v}: {area} {told}");
            }
        }
    }

    #[test]
    fn the_scale_is_that_of_the_lobe() {
        // A lobe 1000 times longer than wide, at 53° to the coordinates.
        let slopes = Slopes::of(Direction::from_angles(0.5, 0.0), &drawn(1.0, 1e-3));
        assert!((slopes.shear - 0.8 / 0.6).abs() < 1e-3, "{slopes:?}");
        assert!(slopes.scale[1] < 2e-3, "{slopes:?}");
    }
}
