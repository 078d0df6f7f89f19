//! Axes of what was counted over pdf().

use super::angle_axis::AngleAxis;
use super::axes::{Axes, even_ticks, log_ticks};
use super::colours::SOFT_INK;
use super::figure::{At, Figure, Pen};

/// Ratios beyond these are drawn at the edge.
const MOST: f64 = 1e3;

/// Ratios that span more than this are on a logarithmic axis.
const LINEAR: f64 = 2.5;

/// Axes of ratios over angles, linear where all are near 1.
pub struct RatioAxes {
    /// Where they are; x in places of the axis of angles.
    pub axes: Axes,
    angles: AngleAxis,
    logarithmic: bool,
}

impl RatioAxes {
    /// Between two corners, for ratios with their standard errors, and lines.
    pub fn new(
        (from, to): (At, At),
        angles: AngleAxis,
        counted: impl Iterator<Item = (f64, f64)>,
        lines: impl Iterator<Item = f64>,
    ) -> Self {
        // The error bars of well counted bins, and not those of the tails.
        let counted = counted.flat_map(|(r, e)| {
            let wide = 2.0 * e > 0.5 * r;
            if wide { vec![r] } else { vec![r - 2.0 * e, r + 2.0 * e] }
        });
        let ends = |(a, b): (f64, f64), r: f64| (a.min(r), b.max(r));
        let bounded = |r: f64| r.clamp(1.0 / MOST, MOST);
        let seen = counted.chain(lines).filter(|r| *r > 0.0).map(bounded);
        let (low, high) = seen.fold((0.97, 1.03), ends);
        let logarithmic = high / low > LINEAR;
        let y = if logarithmic {
            (low.log10() - 0.06, high.log10() + 0.06)
        } else {
            let margin = 0.06 * (high - low);
            (low - margin, high + margin)
        };
        Self { axes: Axes { from, to, x: angles.ends(), y }, angles, logarithmic }
    }

    /// Where a ratio is, no farther out than the frame.
    pub fn place(&self, degrees: f64, ratio: f64) -> At {
        let y = if self.logarithmic { ratio.max(1e-300).log10() } else { ratio };
        self.axes.clamped(self.angles.place(degrees), y)
    }

    /// Frame, ticks, names and the line at 1.
    pub fn draw(&self, figure: &mut Figure, name_x: &str) {
        let y = self.axes.y;
        self.axes.ticks_x(figure, &self.angles.ticks(self.axes.to.0 - self.axes.from.0));
        self.axes.ticks_y(figure, &if self.logarithmic { log_ticks(y, 8) } else { even_ticks(y, 6.0) });
        self.axes.outline(figure, &self.angles.name(name_x), "counted / pdf()");
        let (left, right) = (self.axes.from.0, self.axes.to.0);
        let y = self.place(0.0, 1.0).1;
        figure.line(&[(left, y), (right, y)], even_line());
    }
}

/// The line where samples follow pdf().
pub fn even_line() -> Pen {
    Pen::new(SOFT_INK, 1.6).dashed()
}
