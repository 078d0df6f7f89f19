//! Two axes.

use super::colours::{INK, Rgb, SOFT_INK};
use super::disc_frame::{decimals, nice_step};
use super::figure::{Anchor, At, Figure, Pen, Type};
use super::numbers::{Trim, power_of_ten};

/// Where a tick is, in values, and what it is called.
pub type Tick = (f64, String);

/// About `rows` ticks at even steps.
pub fn even_ticks((low, high): (f64, f64), rows: f64) -> Vec<Tick> {
    let step = nice_step((high - low) / rows);
    let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
    let tick = |k: i64| (k as f64 * step, decimals(k as f64 * step, step).replace('-', "−"));
    (first..=last).map(tick).collect()
}

/// Ticks of a logarithmic axis between two powers of ten, `most` steps of whole powers at
/// most; numbers between them where there is room.
pub fn log_ticks((low, high): (f64, f64), most: i32) -> Vec<Tick> {
    let digits: &[f64] = match high - low {
        span if span < 0.8 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
        span if span < 2.2 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let (first, last) = (low.floor() as i32, high.ceil() as i32);
    let stride = ((last - first + most - 1) / most).max(1);
    let name = |power: i32, digit: f64| match digit {
        1.0 => power_of_ten(power),
        digit => Trim(10f64.powi(power) * digit).to_string(),
    };
    (first..=last)
        .filter(|power| power.rem_euclid(stride) == 0)
        .flat_map(|power| digits.iter().map(move |d| (f64::from(power) + d.log10(), name(power, *d))))
        .filter(|(at, _)| (low..=high).contains(at))
        .collect()
}

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
        let labelled: Vec<Tick> = ticks.iter().map(|x| (*x, format!("{x}").replace('-', "−"))).collect();
        self.ticks_x(figure, &labelled);
        self.ticks_y(figure, &even_ticks(self.y, rows));
        self.outline(figure, name_x, name_y);
    }

    /// Ticks along x.
    pub fn ticks_x(&self, figure: &mut Figure, ticks: &[Tick]) {
        for (x, name) in ticks {
            let (px, py) = self.place(*x, self.y.0);
            figure.line(&[(px, py), (px, py + 6.0)], Pen::new(INK, 1.4));
            figure.text((px, py + 17.0), name, Type::new(Anchor::Middle).size(15.0));
        }
    }

    /// Ticks along y, with lines across where there is no edge.
    pub fn ticks_y(&self, figure: &mut Figure, ticks: &[Tick]) {
        for (y, name) in ticks {
            let (px, py) = self.place(self.x.0, *y);
            figure.line(&[(px - 6.0, py), (px, py)], Pen::new(INK, 1.4));
            figure.text((px - 10.0, py), name, Type::new(Anchor::End).size(15.0));
            if py > self.from.1 + 1.0 && py < self.to.1 - 1.0 {
                figure.line(&[(px, py), (self.to.0, py)], Pen::new(SOFT_INK, 0.6).opacity(0.3));
            }
        }
    }

    /// The frame and the names of both axes.
    pub fn outline(&self, figure: &mut Figure, name_x: &str, name_y: &str) {
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

/// A bar between two heights; its ends are told by strokes across where `capped`.
pub fn error_bar(figure: &mut Figure, ends: [At; 2], colour: Rgb, capped: bool) {
    figure.line(&ends, Pen::new(colour, 1.6));
    if capped {
        for (x, y) in ends {
            figure.line(&[(x - 5.0, y), (x + 5.0, y)], Pen::new(colour, 1.6));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_room_and_names_that_read() {
        let names = |ticks: Vec<Tick>| ticks.into_iter().map(|t| t.1).collect::<Vec<_>>().join(" ");
        assert_eq!(names(even_ticks((-1.0, 1.0), 4.0)), "−1.0 −0.5 0.0 0.5 1.0");
        assert_eq!(names(log_ticks((-0.31, 0.4), 8)), "0.5 0.7 1 1.5 2");
        assert_eq!(names(log_ticks((-3.2, 2.1), 8)), "10⁻³ 0.01 0.1 1 10 100");
        assert_eq!(names(log_ticks((-8.0, 8.0), 4)), "10⁻⁸ 10⁻⁴ 1 10⁴ 10⁸");
    }
}
