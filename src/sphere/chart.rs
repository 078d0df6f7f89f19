//! The maps between directions and a rectangle.

use super::octants::{octants, sin_cos_octants};
use super::partition::Cell;
use crate::bsdf::Direction;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A point of the rectangle [0,2]×[0,1]: the front hemisphere is x in [0,1),
/// the back one x in [1,2].
pub type Point = [f64; 2];

/// Solid angle of a unit of area of the rectangle, in steradians: each
/// hemisphere of 2π sr is a unit square.
pub const STERADIANS: f64 = 2.0 * PI;

/// How a [`Chart`] maps a hemisphere to its square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Equal area: Lambert's projection and the concentric map.
    #[default]
    EqualArea,
    /// Equal projected area: the projected disc and the concentric map.
    ProjectedConcentric,
    /// Equal projected area: u = φ/2π, v = sin² θ.
    ProjectedCylindrical,
}

/// A map between the sphere and two unit squares, one a hemisphere.
///
/// By default it is of equal area: a hemisphere goes to the unit disc by Lambert's azimuthal projection,
/// r² = t = 1 − |cos θ|, and the disc to the square by the concentric map
/// (Shirley and Chiu, "A low distortion map between disk and square", 1997).
/// Equal area, no singular pole, and no cell of the squares straddles the
/// horizon. Azimuths are counted from `phi0`, so that the plane of incidence
/// lies in the middle of a wedge of the concentric map and not on a seam.
///
/// Tables have jumps along the lines of [other maps](Shape), which keep projected
/// solid angle instead: their cells are rectangles there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart {
    cos: f64,
    sin: f64,
    shape: Shape,
}

impl Chart {
    /// A chart with its x axis at azimuth `phi0` (radians).
    pub fn new(phi0: f64) -> Self {
        let (sin, cos) = phi0.sin_cos();
        Self { cos, sin, shape: Shape::EqualArea }
    }

    /// A chart whose x axis is at this (cos, sin).
    pub fn with_x_axis([cos, sin]: [f64; 2]) -> Self {
        Self { cos, sin, shape: Shape::EqualArea }
    }

    /// The same x axis with another map.
    pub fn shaped(self, shape: Shape) -> Self {
        Self { shape, ..self }
    }

    /// How it maps a hemisphere.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// Steradians of a unit of area at the direction `d`.
    pub fn steradians(&self, d: Direction) -> f64 {
        self.unit() * self.stretch(d)
    }

    /// The constant part of [`steradians`](Self::steradians).
    pub(super) fn unit(&self) -> f64 {
        match self.shape {
            Shape::EqualArea => STERADIANS,
            _ => PI,
        }
    }

    /// The part of [`steradians`](Self::steradians) that varies: 1 where areas are
    /// equal, 1/|cos θ| where projected ones are.
    #[inline]
    pub(super) fn stretch(&self, d: Direction) -> f64 {
        match self.shape {
            Shape::EqualArea => 1.0,
            _ => 1.0 / d.z.abs().max(f64::MIN_POSITIVE),
        }
    }

    /// The solid angle of a cell, in steradians.
    pub fn solid_angle(&self, cell: &Cell) -> f64 {
        match self.shape {
            Shape::EqualArea => STERADIANS * cell.area(),
            // |Δφ| (cos θ0 − cos θ1), with 1 − v = cos² θ.
            Shape::ProjectedCylindrical => {
                let cos = |v: f64| (1.0 - v).max(0.0).sqrt();
                2.0 * PI * cell.width(0) * (cos(cell.lo[1]) - cos(cell.hi[1]))
            }
            Shape::ProjectedConcentric => {
                let side = if cell.is_front() { 0.0 } else { 1.0 };
                let [a0, a1] = [cell.lo[0], cell.hi[0]].map(|u| 2.0 * (u - side) - 1.0);
                let [b0, b1] = [cell.lo[1], cell.hi[1]].map(|v| 2.0 * v - 1.0);
                // A unit square is 4 units of (a, b).
                0.25 * PI * (corner(a1, b1) - corner(a0, b1) - corner(a1, b0) + corner(a0, b0))
            }
        }
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
        let r2 = match self.shape {
            Shape::EqualArea => (x * x + y * y) / (1.0 + d.z.abs()),
            Shape::ProjectedConcentric => x * x + y * y,
            Shape::ProjectedCylindrical => return cylindrical_point(x, y, d.z),
        };
        let r = r2.sqrt().min(1.0);
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
        if self.shape != Shape::EqualArea {
            // A shape that the compiler does not know keeps it from vectors.
            points.extend(directions.iter().map(|d| self.to_point(*d)));
            return;
        }
        points.resize(directions.len(), [0.0; 2]);
        let chart = self.shaped(Shape::EqualArea);
        pulp::Arch::new().dispatch(Many { chart, directions, points });
    }

    /// Appends the directions of many points, as [`to_points`](Self::to_points) does the
    /// other way.
    pub fn to_directions(&self, points: &[Point], directions: &mut Vec<Direction>) {
        if self.shape != Shape::EqualArea {
            directions.extend(points.iter().map(|p| self.to_direction(*p)));
            return;
        }
        let chart = self.shaped(Shape::EqualArea);
        let from = directions.len();
        directions.resize(from + points.len(), Direction::default());
        pulp::Arch::new().dispatch(Back { chart, points, directions: &mut directions[from..] });
    }

    /// The unit direction of a point.
    #[inline(always)]
    pub fn to_direction(&self, [u, v]: Point) -> Direction {
        let (u, side) = if u < 1.0 { (u, 1.0) } else { (u - 1.0, -1.0) };
        if self.shape == Shape::ProjectedCylindrical {
            let (sin, cos) = (2.0 * PI * u).sin_cos();
            let r = v.sqrt();
            return self.turned_back(r * cos, r * sin, side * (1.0 - v).max(0.0).sqrt());
        }
        let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let along_x = a.abs() >= b.abs();
        let (major, minor) = if along_x { (a, b) } else { (b, a) };
        let ratio = if major == 0.0 { 0.0 } else { minor / major };
        let (sin, cos) = sin_cos_octants(ratio);
        let (x, y) = if along_x { (major * cos, major * sin) } else { (major * sin, major * cos) };
        if self.shape == Shape::ProjectedConcentric {
            return self.turned_back(x, y, side * ((1.0 - major) * (1.0 + major)).max(0.0).sqrt());
        }
        // t = major², so z = 1 − t and sin θ = r √(2 − t).
        let stretch = (2.0 - major * major).sqrt();
        self.turned_back(x * stretch, y * stretch, side * (1.0 - major) * (1.0 + major))
    }

    /// From the chart's axes to the frame's.
    #[inline(always)]
    fn turned_back(&self, x: f64, y: f64, z: f64) -> Direction {
        Direction::new(self.cos * x - self.sin * y, self.sin * x + self.cos * y, z)
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

/// Arguments of [`Chart::to_directions`].
struct Back<'a> {
    chart: Chart,
    points: &'a [Point],
    directions: &'a mut [Direction],
}

impl pulp::NullaryFnOnce for Back<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (many, rest) = self.points.as_chunks::<8>();
        let (to_many, to_rest) = self.directions.as_chunks_mut::<8>();
        for (p, d) in many.iter().zip(to_many) {
            let u: [f64; 8] = std::array::from_fn(|k| p[k][0]);
            let v: [f64; 8] = std::array::from_fn(|k| p[k][1]);
            let (mut x, mut y, mut z) = ([0.0; 8], [0.0; 8], [0.0; 8]);
            for k in 0..8 {
                Direction { x: x[k], y: y[k], z: z[k] } = self.chart.to_direction([u[k], v[k]]);
            }
            for k in 0..8 {
                d[k] = Direction::new(x[k], y[k], z[k]);
            }
        }
        for (p, d) in rest.iter().zip(to_rest) {
            *d = self.chart.to_direction(*p);
        }
    }
}

fn cylindrical_point(x: f64, y: f64, z: f64) -> Point {
    let turns = y.atan2(x) / (2.0 * PI);
    // A tiny negative angle rounds to a whole turn.
    let u = if turns < 0.0 { turns + 1.0 } else { turns }.min(1.0 - f64::EPSILON);
    [if z > 0.0 { u } else { 1.0 + u }, (x * x + y * y).min(1.0)]
}

/// ∫∫ da db/√(1 − max(|a|, |b|)²) over [0, x] × [0, y], odd in both: in the square
/// up to the lesser, the integral of 2r/√(1 − r²); beyond it, arcsines.
fn corner(x: f64, y: f64) -> f64 {
    let sign = x.signum() * y.signum();
    let (less, more) = if x.abs() < y.abs() { (x.abs(), y.abs()) } else { (y.abs(), x.abs()) };
    let (less, more) = (less.min(1.0), more.min(1.0));
    sign * (2.0 * (1.0 - ((1.0 - less) * (1.0 + less)).sqrt()) + less * (more.asin() - less.asin()))
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
            let mut back = vec![Direction::NORMAL];
            chart.to_directions(&points, &mut back);
            let each = points.iter().map(|p| chart.to_direction(*p));
            assert_eq!(back, std::iter::once(Direction::NORMAL).chain(each).collect::<Vec<_>>());
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

    const SHAPES: [Shape; 3] = [Shape::EqualArea, Shape::ProjectedConcentric, Shape::ProjectedCylindrical];

    /// Every map is its own inverse, and the area of a small square's image is
    /// what `steradians` says.
    #[test]
    fn every_shape_keeps_its_measure() {
        for shape in SHAPES {
            let chart = Chart::new(0.4).shaped(shape);
            let h = 1e-4;
            for (i, j) in (0..40).flat_map(|i| (0..20).map(move |j| (i, j))) {
                let (u, v) = (0.0251 + 0.05 * f64::from(i), 0.0253 + 0.05 * f64::from(j));
                let d = chart.to_direction([u, v]);
                assert!((d.length() - 1.0).abs() < 1e-15 * 8.0);
                let [u2, v2] = chart.to_point(d);
                assert!((u - u2).abs() < 1e-14 && (v - v2).abs() < 1e-14, "{shape:?} {u} {v} -> {u2} {v2}");
                let at = |du: f64, dv: f64| chart.to_direction([u + du * h, v + dv * h]);
                let area = (at(0.5, 0.0) - at(-0.5, 0.0)).cross(at(0.0, 0.5) - at(0.0, -0.5)).length();
                let exact = chart.steradians(d);
                assert!((area / (h * h) / exact - 1.0).abs() < 1e-4, "{shape:?} at {u} {v}: {area} {exact}");
            }
        }
    }

    /// Solid angles of cells against a fine midpoint sum of the local measure,
    /// and of a hemisphere against 2π.
    #[test]
    fn cells_have_their_solid_angle() {
        for shape in SHAPES {
            let chart = Chart::new(1.0).shaped(shape);
            for (lo, hi) in [([0.1, 0.2], [0.3, 0.8]), ([0.4, 0.45], [0.9, 0.6]), ([1.25, 0.5], [1.75, 0.9])]
            {
                let cell = Cell { lo, hi };
                let n = 400;
                let sum: f64 = (0..n * n)
                    .map(|k| {
                        let part = |i: usize| (i as f64 + 0.5) / n as f64;
                        chart.steradians(chart.to_direction(cell.at(part(k % n), part(k / n))))
                    })
                    .sum();
                let sum = sum * cell.area() / (n * n) as f64;
                let exact = chart.solid_angle(&cell);
                assert!((sum / exact - 1.0).abs() < 1e-4, "{shape:?} {cell:?}: {sum} {exact}");
            }
            let back = Cell { lo: [1.0, 0.0], hi: [2.0, 1.0] };
            assert!((chart.solid_angle(&back) - 2.0 * PI).abs() < 1e-14);
        }
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
        for chart in SHAPES.map(|shape| Chart::new(0.0).shaped(shape)) {
            let grazing = Direction::new(1.0, -1e-300, 1e-300);
            for d in [grazing, Direction::new(0.6, 0.8, 0.0), Direction::NORMAL] {
                assert_eq!(chart.to_point(d)[0] < 1.0, d.z > 0.0, "{d:?}");
                assert!(chart.to_point(-d)[0] >= 1.0 || d.z <= 0.0);
            }
        }
    }
}
