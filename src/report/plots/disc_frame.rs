//! The frame of a hemisphere: where directions lie on it, lines of equal θ and
//! φ, and marks.

use super::colours::{INK, PAPER, Rgb, SOFT_INK};
use super::figure::{Anchor, At, Figure, Pen, Type};
use super::raster::Raster;
use crate::bsdf::Direction;
use crate::sphere::{Chart, Point};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Points along a line of equal θ or φ.
const STEPS: usize = 120;

/// A square part of the disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its middle.
    pub centre: Point,
    /// Half its side; the whole disc is 1.
    pub half: f64,
}

impl Window {
    /// The whole disc.
    pub const WHOLE: Self = Self { centre: [0.0, 0.0], half: 1.0 };

    /// Whether it shows less than the disc.
    pub fn is_zoomed(&self) -> bool {
        self.half < 1.0
    }

    /// Whether it holds a place of the disc.
    pub fn holds(&self, p: Point) -> bool {
        (0..2).all(|k| (p[k] - self.centre[k]).abs() <= self.half)
    }

    /// Its middle as a direction.
    pub fn direction(&self, chart: &Chart, front: bool) -> Direction {
        let [x, y] = self.centre;
        let shrink = (1.0 / x.hypot(y)).min(1.0);
        chart.from_disc([x * shrink, y * shrink], front).unwrap_or(Direction::NORMAL)
    }
}

/// A hemisphere, or a part of one, somewhere on a figure.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    /// The map.
    pub chart: Chart,
    /// Which hemisphere.
    pub front: bool,
    /// Which part of it.
    pub window: Window,
    /// The middle on the figure.
    pub at: At,
    /// Half its side in pixels.
    pub radius: f64,
}

/// Azimuth in degrees from 0 to 360.
pub fn azimuth(d: Direction) -> f64 {
    d.phi().to_degrees().rem_euclid(360.0)
}

impl Disc {
    /// Where a place of the disc is on the figure.
    pub fn place(&self, [x, y]: Point) -> At {
        let scale = self.radius / self.window.half;
        let [cx, cy] = self.window.centre;
        (self.at.0 + (x - cx) * scale, self.at.1 - (y - cy) * scale)
    }

    /// Where a direction is on the figure, if it is in sight.
    pub fn direction(&self, d: Direction) -> Option<At> {
        let p = self.chart.to_disc(d);
        ((d.z > 0.0) == self.front && self.window.holds(p)).then(|| self.place(p))
    }

    /// An image with a colour a direction, and its outline.
    pub fn fill(&self, figure: &mut Figure, palette: Vec<Rgb>, colour: impl Fn(Direction) -> u8) {
        let size = (2.0 * self.radius) as usize;
        let mut raster = Raster::new(size, size, palette);
        let step = 2.0 * self.window.half / size as f64;
        let [cx, cy] = self.window.centre;
        for row in 0..size {
            for column in 0..size {
                let x = cx - self.window.half + (column as f64 + 0.5) * step;
                let y = cy + self.window.half - (row as f64 + 0.5) * step;
                if let Some(d) = self.chart.from_disc([x, y], self.front) {
                    raster.set(column, row, colour(d));
                }
            }
        }
        let corner = (self.at.0 - self.radius, self.at.1 - self.radius);
        figure.image(corner, (2.0 * self.radius, 2.0 * self.radius), &raster);
    }

    /// The polar angle in degrees that a disc's radius stands for.
    fn theta_at(&self, r: f64) -> f64 {
        let theta = 2.0 * (r / SQRT_2).min(1.0).asin().to_degrees();
        if self.front { theta } else { 180.0 - theta }
    }

    fn radius_of(&self, theta: f64) -> f64 {
        let from_pole = if self.front { theta } else { 180.0 - theta };
        SQRT_2 * (0.5 * from_pole.to_radians()).sin()
    }

    /// Lines of equal θ and φ; with numbers if `labelled`.
    pub fn graticule(&self, figure: &mut Figure, labelled: bool) {
        if self.window.is_zoomed() {
            self.fine_graticule(figure, labelled);
        } else {
            self.whole_graticule(figure, labelled);
        }
    }

    fn stroke(figure: &mut Figure, points: &[At]) {
        figure.line(points, Pen::new(PAPER, 2.2).opacity(0.45));
        figure.line(points, Pen::new(INK, 0.8).opacity(0.65));
    }

    fn whole_graticule(&self, figure: &mut Figure, labelled: bool) {
        for from_pole in [30.0, 60.0] {
            let theta = if self.front { from_pole } else { 180.0 - from_pole };
            let r = self.radius_of(theta);
            let ring: Vec<At> = (0..=STEPS)
                .map(|k| {
                    let (sin, cos) = (TAU * k as f64 / STEPS as f64).sin_cos();
                    self.place([r * cos, r * sin])
                })
                .collect();
            Self::stroke(figure, &ring);
        }
        figure.circle(self.at, self.radius, Pen::new(INK, 1.6));
        for k in 0..12 {
            let phi = 30.0 * f64::from(k);
            let (sin, cos) = (phi.to_radians() - self.chart.phi0()).sin_cos();
            let long = k % 3 == 0;
            let ends = [1.0, if long { 1.06 } else { 1.035 }].map(|r| self.place([r * cos, r * sin]));
            figure.line(&ends, Pen::new(INK, 1.4));
            if labelled && long {
                let (x, y) = self.place([1.11 * cos, 1.11 * sin]);
                let anchor = match cos {
                    c if c > 0.4 => Anchor::Start,
                    c if c < -0.4 => Anchor::End,
                    _ => Anchor::Middle,
                };
                let name = if k == 0 { "φ 0°".to_string() } else { format!("{phi}°") };
                figure.text((x, y - 5.0 * sin), &name, Type::new(anchor).size(14.0).colour(SOFT_INK));
            }
        }
        if labelled {
            for from_pole in [30.0, 60.0, 90.0] {
                let theta = if self.front { from_pole } else { 180.0 - from_pole };
                let r = self.radius_of(theta) - 0.08;
                let (x, y) = self.place([r * (-1.2f64).cos(), r * (-1.2f64).sin()]);
                figure.text((x, y), &format!("{theta}°"), Type::new(Anchor::Middle).size(14.0).rim());
            }
        }
    }

    fn fine_graticule(&self, figure: &mut Figure, labelled: bool) {
        let Window { centre: [cx, cy], half } = self.window;
        let corner = (self.at.0 - self.radius, self.at.1 - self.radius);
        let opposite = (self.at.0 + self.radius, self.at.1 + self.radius);
        let middle = cx.hypot(cy);
        let (nearest, farthest) = ((middle - 1.5 * half).max(0.0), (middle + 1.5 * half).min(1.0));
        let mut angles = [self.theta_at(nearest), self.theta_at(farthest)];
        angles.sort_by(f64::total_cmp);
        let step = nice_step((angles[1] - angles[0]) / 6.0);
        let around = if nearest > 0.0 { (3.0 * half / middle).min(PI) } else { PI };
        let heading = cy.atan2(cx);
        let label = Type::new(Anchor::Start).size(14.0).rim();

        for k in (angles[0] / step).ceil() as i64..=(angles[1] / step).floor() as i64 {
            let theta = k as f64 * step;
            let r = self.radius_of(theta);
            if r < 1e-9 {
                continue;
            }
            let line: Vec<Point> = (0..=STEPS)
                .map(|i| {
                    let turn = heading + around * (2.0 * i as f64 / STEPS as f64 - 1.0);
                    [r * turn.cos(), r * turn.sin()]
                })
                .collect();
            let lowest = self.runs(figure, &line).into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
            if let (true, Some((x, y))) = (labelled, lowest) {
                let x = x.clamp(corner.0 + 4.0, opposite.0 - 50.0);
                let text = format!("θ {}", degrees(theta, step));
                figure.text((x + 3.0, y.min(opposite.1 - 12.0)), &text, label);
            }
        }

        let turn_step =
            if nearest > 0.0 { nice_step((2.0 * half / middle).to_degrees() / 3.5) } else { 45.0 };
        let zero = self.chart.phi0().to_degrees();
        let (from, to) = (heading - around, heading + around);
        let last = if nearest > 0.0 { to } else { to - 1e-9 };
        for k in ((from.to_degrees() + zero) / turn_step).ceil() as i64
            ..=((last.to_degrees() + zero) / turn_step).floor() as i64
        {
            let phi = k as f64 * turn_step;
            let (sin, cos) = (phi - zero).to_radians().sin_cos();
            let line: Vec<Point> = (0..=2 * STEPS)
                .map(|i| {
                    let r = nearest + (farthest - nearest) * i as f64 / (2 * STEPS) as f64;
                    [r * cos, r * sin]
                })
                .collect();
            let run = self.runs(figure, &line);
            // Around the pole lines are told apart at their far ends only.
            let end = if nearest > 0.0 {
                run.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))
            } else {
                run.last().copied()
            };
            // The lower edge is where the numbers of θ are.
            let lowest = opposite.1 - 32.0;
            if let (true, Some((x, y))) = (labelled, end.filter(|p| p.1 < lowest)) {
                let text = format!("φ {}", degrees(phi.rem_euclid(360.0), turn_step));
                let x = x.clamp(corner.0 + 4.0, opposite.0 - 60.0);
                figure.text((x, (y - 11.0).max(corner.1 + 12.0)), &text, label);
            }
        }
        let horizon: Vec<Point> = (0..=STEPS)
            .map(|i| {
                let turn = heading + around * (2.0 * i as f64 / STEPS as f64 - 1.0);
                [0.999_999 * turn.cos(), 0.999_999 * turn.sin()]
            })
            .collect();
        for run in horizon.split(|p| !self.window.holds(*p)) {
            let points: Vec<At> = run.iter().map(|p| self.place(*p)).collect();
            figure.line(&points, Pen::new(INK, 1.6));
        }
        figure.frame(corner, opposite, Pen::new(INK, 1.6));
    }

    /// Draws the parts of a line that are in the window; returns their points.
    fn runs(&self, figure: &mut Figure, line: &[Point]) -> Vec<At> {
        let mut all = Vec::new();
        for run in line.split(|p| !self.window.holds(*p) || p[0].hypot(p[1]) > 1.0) {
            let mut points: Vec<At> = run.iter().map(|p| self.place(*p)).collect();
            all.extend(&points);
            if is_straight(&points) {
                points = [points.first(), points.last()].into_iter().flatten().copied().collect();
            }
            Self::stroke(figure, &points);
        }
        all
    }

    /// A ring at a direction, if it is in sight.
    pub fn mark_ring(&self, figure: &mut Figure, d: Direction) {
        if let Some(at) = self.direction(d) {
            ring(figure, at);
        }
    }

    /// A cross at a direction, if it is in sight.
    pub fn mark_cross(&self, figure: &mut Figure, d: Direction) {
        if let Some(at) = self.direction(d) {
            cross(figure, at);
        }
    }
}

/// Whether points are on a line to a tenth of a pixel.
fn is_straight(points: &[At]) -> bool {
    let (Some(a), Some(b)) = (points.first(), points.last()) else { return true };
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
    points.iter().all(|p| (dx * (p.1 - a.1) - dy * (p.0 - a.0)).abs() <= 0.1 * length)
}

/// The mark of wo.
pub fn ring(figure: &mut Figure, at: At) {
    figure.circle(at, 7.0, Pen::new(PAPER, 5.0));
    figure.circle(at, 7.0, Pen::new(INK, 2.4));
}

/// The mark of the mirror direction.
pub fn cross(figure: &mut Figure, (x, y): At) {
    for pen in [Pen::new(PAPER, 5.0), Pen::new(INK, 2.4)] {
        for (a, b) in [(-6.0, 6.0), (6.0, -6.0)] {
            figure.line(&[(x - 6.0, y + a), (x + 6.0, y + b)], pen);
        }
    }
}

/// The first of 1, 2, 5 times a power of ten that is at least `least`.
pub fn nice_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|s| *s >= least * 0.999).unwrap_or(10.0 * power)
}

/// With as many decimals as a step has.
pub fn decimals(value: f64, step: f64) -> String {
    let digits = (-(step * 1.001).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.digits$}")
}

fn degrees(value: f64, step: f64) -> String {
    format!("{}°", decimals(value, step))
}
