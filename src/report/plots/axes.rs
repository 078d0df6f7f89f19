//! Two linear axes.

use super::colours::{INK, Rgb, SOFT_INK};
use super::disc_frame::{decimals, nice_step};
use super::figure::{Anchor, At, Figure, Pen, Type};

/// A frame with linear axes, in pixels and in values.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    /// Upper left corner.
    pub from: At,
    /// Lower right corner.
    pub to: At,
    /// Values at the left and right edge.
    pub x: (f64, f64),
    /// Values at the lower and upper edge.
    pub y: (f64, f64),
}

impl Axes {
    /// Where a value is on the figure.
    pub fn place(&self, x: f64, y: f64) -> At {
        let along = |v: f64, (a, b): (f64, f64)| (v - a) / (b - a);
        (
            self.from.0 + along(x, self.x) * (self.to.0 - self.from.0),
            self.to.1 - along(y, self.y) * (self.to.1 - self.from.1),
        )
    }

    /// Where a value is, no farther out than the frame.
    pub fn clamped(&self, x: f64, y: f64) -> At {
        self.place(x, y.clamp(self.y.0, self.y.1))
    }

    /// The frame, ticks at the given x, about `rows` ticks along y, and names.
    pub fn draw(&self, figure: &mut Figure, ticks: &[f64], rows: f64, name_x: &str, name_y: &str) {
        let tick = Pen::new(INK, 1.4);
        let small = |anchor| Type::new(anchor).size(15.0);
        for x in ticks {
            let (px, py) = self.place(*x, self.y.0);
            figure.line(&[(px, py), (px, py + 6.0)], tick);
            figure.text((px, py + 17.0), &format!("{x}"), small(Anchor::Middle));
        }
        let step = nice_step((self.y.1 - self.y.0) / rows);
        let (first, last) = ((self.y.0 / step - 1e-6).ceil() as i64, (self.y.1 / step + 1e-6).floor() as i64);
        for k in first..=last {
            let y = k as f64 * step;
            let (px, py) = self.place(self.x.0, y);
            figure.line(&[(px - 6.0, py), (px, py)], tick);
            let text = decimals(y, step).replace('-', "−");
            figure.text((px - 10.0, py), &text, small(Anchor::End));
            if k > first && k < last {
                figure.line(&[(px, py), (self.to.0, py)], Pen::new(SOFT_INK, 0.6).opacity(0.3));
            }
        }
        figure.frame(self.from, self.to, Pen::new(INK, 1.4));
        let middle_x = 0.5 * (self.from.0 + self.to.0);
        figure.text((middle_x, self.to.1 + 40.0), name_x, Type::new(Anchor::Middle));
        let middle_y = 0.5 * (self.from.1 + self.to.1);
        figure.text((self.from.0 - 66.0, middle_y), name_y, Type::new(Anchor::Middle).upwards());
    }

    /// A band between two heights.
    pub fn band(&self, figure: &mut Figure, low: f64, high: f64, colour: Rgb) {
        figure.rectangle(self.clamped(self.x.0, high), self.clamped(self.x.1, low), colour);
    }
}

/// A mark: its shape tells a series apart as well as its colour.
pub fn mark(figure: &mut Figure, (x, y): At, series: usize, colour: Rgb) {
    match series % 3 {
        0 => figure.dot((x, y), 5.0, colour),
        1 => figure.rectangle((x - 4.5, y - 4.5), (x + 4.5, y + 4.5), colour),
        _ => figure.polygon(&[(x, y - 6.5), (x + 6.0, y + 4.5), (x - 6.0, y + 4.5)], colour),
    }
}
