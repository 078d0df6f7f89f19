//! The equal-area map between directions and a rectangle.

use crate::bsdf::Direction;
use std::f64::consts::{FRAC_PI_4, PI};

/// A point of the rectangle [0,2]×[0,1]: the front hemisphere is x in [0,1),
/// the back one x in [1,2].
pub type Point = [f64; 2];

/// Solid angle of a unit of area of the rectangle, in steradians: each
/// hemisphere of 2π sr is a unit square.
pub const STERADIANS: f64 = 2.0 * PI;

/// An equal-area map between the sphere and two unit squares, one a hemisphere.
///
/// A hemisphere goes to the unit disc by Lambert's azimuthal projection,
/// r² = t = 1 − |cos θ|, and the disc to the square by the concentric map
/// (Shirley and Chiu, "A low distortion map between disk and square", 1997).
/// Equal area, no singular pole, and no cell of the squares straddles the
/// horizon. Azimuths are counted from `phi0`, so that the plane of incidence
/// lies in the middle of a wedge of the concentric map and not on a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart {
    cos: f64,
    sin: f64,
}

impl Chart {
    /// A chart with its x axis at azimuth `phi0` (radians).
    pub fn new(phi0: f64) -> Self {
        let (sin, cos) = phi0.sin_cos();
        Self { cos, sin }
    }

    /// A chart whose x axis is at this (cos, sin).
    pub fn with_x_axis([cos, sin]: [f64; 2]) -> Self {
        Self { cos, sin }
    }

    /// cos and sin of the azimuth of its x axis.
    pub fn x_axis(&self) -> [f64; 2] {
        [self.cos, self.sin]
    }

    /// The azimuth of its x axis in (−π, π].
    pub fn phi0(&self) -> f64 {
        self.sin.atan2(self.cos)
    }

    /// The point of a direction. t = 1 − |z| is computed as (x² + y²)/(1 + |z|),
    /// which keeps all digits near the pole.
    #[inline(always)]
    pub fn to_point(&self, d: Direction) -> Point {
        let x = self.cos * d.x + self.sin * d.y;
        let y = self.cos * d.y - self.sin * d.x;
        let r = ((x * x + y * y) / (1.0 + d.z.abs())).sqrt().min(1.0);
        let along_x = x.abs() >= y.abs();
        let (major, minor) = if along_x { (x.abs(), y.abs()) } else { (y.abs(), x.abs()) };
        let other = r * octants(minor, major);
        let (u, v) = if along_x { (r, other) } else { (other, r) };
        // The front square is half open: its right edge stays below 1.
        let u = (0.5 + 0.5 * u.copysign(x)).min(1.0 - f64::EPSILON);
        let v = (0.5 + 0.5 * v.copysign(y)).min(1.0);
        [if d.z > 0.0 { u } else { 1.0 + u }, v]
    }

    /// The points of many directions, as [`to_point`](Self::to_point), in the widest
    /// vectors of this machine: the arithmetic is the same, so are the bits.
    pub fn to_points(&self, directions: &[Direction], points: &mut Vec<Point>) {
        points.clear();
        points.resize(directions.len(), [0.0; 2]);
        pulp::Arch::new().dispatch(Many { chart: *self, directions, points });
    }

    /// The unit direction of a point.
    #[inline]
    pub fn to_direction(&self, [u, v]: Point) -> Direction {
        let (u, side) = if u < 1.0 { (u, 1.0) } else { (u - 1.0, -1.0) };
        let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let along_x = a.abs() >= b.abs();
        let (major, minor) = if along_x { (a, b) } else { (b, a) };
        let ratio = if major == 0.0 { 0.0 } else { minor / major };
        let (sin, cos) = (FRAC_PI_4 * ratio).sin_cos();
        let (x, y) = if along_x { (major * cos, major * sin) } else { (major * sin, major * cos) };
        // t = major², so z = 1 − t and sin θ = r √(2 − t).
        let stretch = (2.0 - major * major).sqrt();
        let (x, y) = (x * stretch, y * stretch);
        Direction::new(
            self.cos * x - self.sin * y,
            self.sin * x + self.cos * y,
            side * (1.0 - major) * (1.0 + major),
        )
    }

    /// Where the disc that pictures show has this direction: x and y in
    /// [−1, 1], r² = 1 − |cos θ|, x along `phi0`.
    pub fn to_disc(&self, d: Direction) -> Point {
        let scale = 1.0 / (1.0 + d.z.abs()).sqrt();
        [(self.cos * d.x + self.sin * d.y) * scale, (self.cos * d.y - self.sin * d.x) * scale]
    }

    /// The direction on the front (or back) hemisphere at a place of the disc;
    /// `None` outside of it.
    pub fn from_disc(&self, [x, y]: Point, front: bool) -> Option<Direction> {
        let t = x * x + y * y;
        if t > 1.0 {
            return None;
        }
        let stretch = (2.0 - t).sqrt();
        let z = if front { 1.0 - t } else { t - 1.0 };
        Some(Direction::new(
            (self.cos * x - self.sin * y) * stretch,
            (self.sin * x + self.cos * y) * stretch,
            z,
        ))
    }
}

/// Arguments of [`Chart::to_points`].
struct Many<'a> {
    chart: Chart,
    directions: &'a [Direction],
    points: &'a mut [Point],
}

impl pulp::NullaryFnOnce for Many<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (many, rest) = self.directions.as_chunks::<8>();
        let (to_many, to_rest) = self.points.as_chunks_mut::<8>();
        for (d, p) in many.iter().zip(to_many) {
            let x: [f64; 8] = std::array::from_fn(|k| d[k].x);
            let y: [f64; 8] = std::array::from_fn(|k| d[k].y);
            let z: [f64; 8] = std::array::from_fn(|k| d[k].z);
            let mut u = [0.0; 8];
            let mut v = [0.0; 8];
            for k in 0..8 {
                [u[k], v[k]] = self.chart.to_point(Direction::new(x[k], y[k], z[k]));
            }
            for k in 0..8 {
                p[k] = [u[k], v[k]];
            }
        }
        for (d, p) in rest.iter().zip(to_rest) {
            *p = self.chart.to_point(*d);
        }
    }
}

/// (4/π) arctan(√t)/√t on 0 ≤ t ≤ tan²(π/8), interpolated at 12 Chebyshev nodes in
/// 50 digits; its error there is 1.6e-18.
const OCTANT: [f64; 12] = [
    1.2732395447351628,
    -0.42441318157838487,
    0.2546479089462799,
    -0.18189136345129195,
    0.1414710558636348,
    -0.11574889314407025,
    0.09793816295200183,
    -0.08483533733777557,
    0.07444476661415464,
    -0.06410891559538259,
    0.04833886711631351,
    -0.022670535831656992,
];

/// (4/π) arctan(minor/major) for 0 ≤ minor ≤ major; 0 where both are 0. Without a
/// call or a branch, since it is half of the cost of finding a cell.
#[inline(always)]
pub fn octants(minor: f64, major: f64) -> f64 {
    // tan(π/8); beyond it arctan(s) = π/4 − arctan((1−s)/(1+s)).
    let beyond = minor > (std::f64::consts::SQRT_2 - 1.0) * major;
    let numerator = if beyond { minor - major } else { minor };
    let denominator = if beyond { minor + major } else { major };
    let s = numerator / denominator.max(f64::MIN_POSITIVE);
    let t = s * s;
    let t2 = t * t;
    let t4 = t2 * t2;
    let pair = |k: usize| OCTANT[k] + OCTANT[k + 1] * t;
    let quad = |k: usize| pair(k) + pair(k + 2) * t2;
    let polynomial = quad(0) + (quad(4) + quad(8) * t4) * t4;
    (if beyond { 1.0 } else { 0.0 }) + s * polynomial
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn is_its_own_inverse(u in 0.0..2.0f64, v in 0.0..1.0f64, phi0 in -3.0..3.0f64) {
            let chart = Chart::new(phi0);
            let d = chart.to_direction([u, v]);
            prop_assert!((d.length() - 1.0).abs() < 1e-15 * 8.0);
            let [u2, v2] = chart.to_point(d);
            prop_assert!((u - u2).abs() < 1e-14 && (v - v2).abs() < 1e-14, "{u} {v} -> {u2} {v2}");
            let back = chart.from_disc(chart.to_disc(d), d.z > 0.0).unwrap();
            prop_assert!(back.angle(d) < 1e-14);
        }
    }

    /// Many at once give the same bits as one by one, in whole vectors and in the rest.
    #[test]
    fn many_points_are_the_points_of_each() {
        let chart = Chart::new(0.7);
        let spiral = |k: u32| Direction::from_angles(f64::from(k) * 0.1, f64::from(k * k));
        let edges = [Direction::NORMAL, -Direction::NORMAL, Direction::new(1.0, 0.0, 0.0)];
        for n in [0, 7, 8, 29] {
            let mut directions: Vec<_> = (0..n).map(spiral).collect();
            directions.extend(edges);
            let mut points = Vec::new();
            chart.to_points(&directions, &mut points);
            let each: Vec<_> = directions.iter().map(|d| chart.to_point(*d)).collect();
            assert_eq!(points, each);
        }
    }

    /// The area of a small square's image, by finite differences, is 2π times its own.
    #[test]
    fn is_equal_area() {
        let chart = Chart::new(0.4);
        let h = 1e-4;
        for i in 0..40 {
            for j in 0..20 {
                let (u, v) = (0.0251 + 0.05 * f64::from(i), 0.0253 + 0.05 * f64::from(j));
                let at = |du: f64, dv: f64| chart.to_direction([u + du * h, v + dv * h]);
                let area = (at(0.5, 0.0) - at(-0.5, 0.0)).cross(at(0.0, 0.5) - at(0.0, -0.5)).length();
                assert!((area / (h * h) / STERADIANS - 1.0).abs() < 1e-5, "at {u} {v}: {area}");
            }
        }
    }

    #[test]
    fn octants_are_arctangents() {
        for k in 0..=10_000 {
            let s = f64::from(k) * 1e-4;
            assert!((octants(s * 3.0, 3.0) - s.atan() / FRAC_PI_4).abs() < 4.5e-16, "{s}");
        }
        assert_eq!(octants(0.0, 0.0), 0.0);
    }

    #[test]
    fn keeps_digits_near_the_pole() {
        let chart = Chart::new(0.0);
        let theta = 1e-9;
        let [u, v] = chart.to_point(Direction::from_angles(theta, 0.3));
        let r = (2.0 * u - 1.0).abs().max((2.0 * v - 1.0).abs());
        // r = √(1 − cos θ) = θ/√2 to first order; u and v themselves hold 1e-16.
        assert!((r - theta / 2f64.sqrt()).abs() < 3e-16);
    }

    #[test]
    fn sides_do_not_mix() {
        let chart = Chart::new(0.0);
        for d in [Direction::new(1.0, 0.0, 1e-300), Direction::new(0.6, 0.8, 0.0), Direction::NORMAL] {
            assert_eq!(chart.to_point(d)[0] < 1.0, d.z > 0.0, "{d:?}");
            assert!(chart.to_point(-d)[0] >= 1.0 || d.z <= 0.0);
        }
    }
}
