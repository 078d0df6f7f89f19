//! An axis of degrees, even or spread around a narrow lobe.

use super::axes::{Axes, Tick};
use super::colours::SOFT_INK;
use super::figure::{Anchor, Figure, Pen, Type};
use super::numbers::{Trim, power_of_ten};
use crate::evidence::Stretch;

/// Names of ticks are at least this far apart, in pixels.
const APART: f64 = 46.0;

/// An axis of degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleAxis {
    stretch: Stretch,
    /// Left and right end in degrees.
    range: (f64, f64),
    /// Degrees between ticks where it is even.
    step: f64,
}

impl AngleAxis {
    /// Between two angles.
    pub fn new(stretch: Stretch, range: (f64, f64), step: f64) -> Self {
        Self { stretch, range, step }
    }

    /// Where an angle is.
    pub fn place(&self, degrees: f64) -> f64 {
        self.stretch.place(degrees)
    }

    /// Where its ends are.
    pub fn ends(&self) -> (f64, f64) {
        (self.place(self.range.0), self.place(self.range.1))
    }

    /// Its ticks on so many pixels: angles, or how far they are from a narrow lobe.
    pub fn ticks(&self, pixels: f64) -> Vec<Tick> {
        let Stretch::Around { middle, width } = self.stretch else {
            let (first, last) = (self.range.0 / self.step, self.range.1 / self.step);
            let ticks = (first.ceil() as i32..=last.floor() as i32).map(|k| f64::from(k) * self.step);
            return ticks.map(|x| (x, format!("{x}").replace('-', "−"))).collect();
        };
        let (left, right) = self.ends();
        let scale = pixels / (right - left);
        let mut ticks = vec![(0.0, "0".to_string())];
        let mut last = 0.0;
        for power in -9..=2 {
            let offset = 10f64.powi(power);
            let place = (offset / width).asinh();
            if (place - last) * scale < APART {
                continue;
            }
            last = place;
            for (sign, name) in [(-1.0, "−"), (1.0, "+")] {
                let x = middle + sign * offset;
                if (self.range.0..=self.range.1).contains(&x) {
                    ticks.push((self.place(x), format!("{name}{}", power_of_ten(power))));
                }
            }
        }
        ticks
    }

    /// What it is called, for an angle of this name.
    pub fn name(&self, what: &str) -> String {
        match self.stretch {
            Stretch::Even => format!("{what}, degrees"),
            Stretch::Around { middle, .. } => {
                let middle = format!("{:.3}", Trim(middle)).replace('-', "−");
                format!("{what}, degrees from {middle}°, spread out there")
            }
        }
    }

    /// Lines at named angles; a name that would cover the last one is left out.
    pub fn landmarks(&self, figure: &mut Figure, axes: &Axes, marks: &[(f64, &str)]) {
        let mut marks: Vec<_> = marks.iter().filter(|m| m.0 >= self.range.0 && m.0 <= self.range.1).collect();
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut last = f64::NEG_INFINITY;
        for (degrees, name) in marks {
            let (x, bottom) = (axes.place(self.place(*degrees), axes.y.0).0, axes.to.1);
            // On the edge there is a line already.
            if x > axes.from.0 + 2.0 && x < axes.to.0 - 2.0 {
                figure.line(&[(x, axes.from.1), (x, bottom)], Pen::new(SOFT_INK, 1.0).opacity(0.5));
            }
            let reach = 4.0 * name.chars().count() as f64 + 4.0;
            let room = x - last > 2.0 * reach + 12.0;
            if room && x > axes.from.0 + reach && x < axes.to.0 - reach {
                let how = Type::new(Anchor::Middle).size(15.0).colour(SOFT_INK).rim();
                figure.text((x, bottom - 12.0), name, how);
                last = x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_angles_or_distances_from_the_lobe() {
        let names = |axis: AngleAxis| axis.ticks(520.0).into_iter().map(|t| t.1).collect::<Vec<_>>();
        let even = AngleAxis::new(Stretch::Even, (-90.0, 90.0), 30.0);
        assert_eq!(names(even), ["−90", "−60", "−30", "0", "30", "60", "90"]);
        assert_eq!(even.name("θi"), "θi, degrees");
        let stretch = Stretch::Around { middle: -45.0, width: 0.02 };
        let narrow = AngleAxis::new(stretch, (-90.0, 90.0), 30.0);
        assert_eq!(names(narrow), ["0", "−0.1", "+0.1", "−1", "+1", "−10", "+10", "+100"]);
        assert!(narrow.name("θi").contains("from −45°"));
        let ticks = narrow.ticks(520.0);
        let (left, right) = narrow.ends();
        assert!(ticks.iter().all(|(place, _)| (left..=right).contains(place)));
    }
}
