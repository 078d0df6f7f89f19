//! Named lines over two linear axes.

use super::axes::Axes;
use super::colours::{INK, LINES, Rgb, SOFT_INK};
use super::disc_frame::nice_step;
use super::figure::{Anchor, Figure, Pen, Type};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 500.0;

/// Where names of the legend begin.
const LEGEND: f64 = 686.0;

/// A line, by its name in the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it is.
    pub name: String,
    /// Which colour of the palette; every [`Self::COLOURS`]th repeats.
    pub colour: usize,
    /// Whether it is dashed.
    pub dashed: bool,
    /// (x, y) from left to right; what lies below or above the axes is cut off.
    pub points: Vec<(f64, f64)>,
}

impl Line {
    /// Colours that repeat no other.
    pub const COLOURS: usize = 5;

    /// A solid line.
    pub fn new(name: impl Into<String>, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), colour, dashed: false, points }
    }

    /// Dashed.
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// The place where y is largest.
    pub fn peak(&self) -> Option<(f64, f64)> {
        self.points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn pen(&self) -> Pen {
        let colours: [Rgb; Self::COLOURS] = [LINES[0], LINES[1], LINES[2], INK, [0xcc, 0x79, 0xa7]];
        Pen { dashed: self.dashed, ..Pen::new(colours[self.colour % Self::COLOURS], 2.2) }
    }
}

/// A plot of lines.
#[derive(Clone, Debug, PartialEq)]
pub struct LinePlot {
    /// The heading.
    pub title: String,
    /// One line that says what to see.
    pub note: String,
    /// Name and unit along x.
    pub x_name: String,
    /// Name and unit along y.
    pub y_name: String,
    /// Left and right end.
    pub x: (f64, f64),
    /// Lower and upper end.
    pub y: (f64, f64),
    /// The lines.
    pub lines: Vec<Line>,
}

impl LinePlot {
    /// The line called `name`.
    pub fn line(&self, name: &str) -> Option<&Line> {
        self.lines.iter().find(|l| l.name == name)
    }

    /// As SVG.
    pub fn svg(&self) -> String {
        let names: Vec<&str> = self.lines.iter().map(|l| l.name.as_str()).collect();
        // The longest name of the legend, at half an em a letter.
        let longest = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
        let width = WIDTH.max(LEGEND + 8.0 * longest as f64);
        let mut figure =
            Figure::new(width, HEIGHT, &self.title, &format!("{} Lines: {}.", self.note, names.join(", ")));
        figure.text((20.0, 26.0), &self.title, Type::new(Anchor::Start).size(20.0).bold());
        figure.text((20.0, 54.0), &self.note, Type::new(Anchor::Start).colour(SOFT_INK));
        let axes = Axes { from: (96.0, 80.0), to: (620.0, 440.0), x: self.x, y: self.y };
        // Multiples of 10 would never be 90°.
        let span = self.x.1 - self.x.0;
        let step = if span == 90.0 { 15.0 } else { nice_step(span / 7.0) };
        let ticks: Vec<f64> = (0..)
            .map(|k| (self.x.0 / step).ceil() * step + f64::from(k) * step)
            .take_while(|x| *x <= self.x.1 + 1e-9 * span)
            .collect();
        axes.draw(&mut figure, &ticks, 6.0, &self.x_name, &self.y_name);
        for line in &self.lines {
            for run in visible(&line.points, self.y) {
                let path: Vec<_> = run.iter().map(|(x, y)| axes.place(*x, *y)).collect();
                figure.line(&path, line.pen());
            }
        }
        for (k, line) in self.lines.iter().enumerate() {
            let y = 96.0 + 27.0 * k as f64;
            figure.line(&[(640.0, y), (676.0, y)], line.pen());
            figure.text((LEGEND, y), &line.name, Type::new(Anchor::Start).size(15.0));
        }
        figure.finish()
    }
}

/// The runs of a line inside of two heights, cut where it crosses them.
fn visible(points: &[(f64, f64)], (low, high): (f64, f64)) -> Vec<Vec<(f64, f64)>> {
    let inside = |y: f64| y >= low && y <= high;
    let mut runs = vec![Vec::new()];
    for (k, p) in points.iter().enumerate() {
        let run = runs.last_mut().expect("there is always a run");
        let crossing = |q: &(f64, f64), edge: f64| {
            let t = (edge - q.1) / (p.1 - q.1);
            (q.0 + t * (p.0 - q.0), edge)
        };
        let before = k.checked_sub(1).map(|j| points[j]).filter(|q| inside(q.1) != inside(p.1));
        let edge = |y: f64| if y > high { high } else { low };
        match (before, inside(p.1)) {
            (Some(q), true) => run.extend([crossing(&q, edge(q.1)), *p]),
            (Some(q), false) => {
                run.push(crossing(&q, edge(p.1)));
                runs.push(Vec::new());
            }
            (None, true) => run.push(*p),
            (None, false) => {}
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::*;

    #[test]
    fn lines_are_cut_at_the_edges() {
        let points = [(0.0, -1.0), (1.0, 1.0), (2.0, 3.0), (3.0, 1.0), (4.0, f64::NAN), (5.0, 1.0)];
        let runs = visible(&points, (0.0, 2.0));
        assert_eq!(runs[0], [(0.5, 0.0), (1.0, 1.0), (1.5, 2.0)]);
        assert_eq!(runs[1][..2], [(2.5, 2.0), (3.0, 1.0)]);
    }

    #[test]
    fn draws_itself() {
        let lines =
            vec![Line::new("a", 0, vec![(0.0, 0.0), (90.0, 1.0)]), Line::new("b", 1, vec![]).dashed()];
        let plot = LinePlot {
            title: "t".into(),
            note: "n".into(),
            x_name: "θ in degrees".into(),
            y_name: "f".into(),
            x: (0.0, 90.0),
            y: (0.0, 1.0),
            lines,
        };
        let svg = plot.svg();
        assert_well_formed(&svg);
        assert!(svg.contains("\n75\n") && svg.len() < 10_000, "{svg}");
        assert_eq!(plot.line("a").and_then(Line::peak), Some((90.0, 1.0)));
    }
}
