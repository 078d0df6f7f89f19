//! Named rows of intervals over a logarithmic axis.

use super::axes::{Axes, mark};
use super::colours::{INK, LINES, SOFT_INK};
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::numbers::power_of_ten;

const WIDTH: f64 = 860.0;

/// Height of a row, in pixels.
const ROW: f64 = 30.0;

/// A value with its interval, above 0; nothing is drawn of what lies off the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end; 0 where the interval has none.
    pub low: f64,
    /// The value; 0 where only the upper end is known.
    pub value: f64,
    /// Upper end.
    pub high: f64,
    /// What the value is compared with: a tick across the row.
    pub limit: f64,
}

/// A row: one interval for each series that it has.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalRow {
    /// What it is of.
    pub name: String,
    /// In the order of the series.
    pub intervals: Vec<Option<Interval>>,
}

/// A plot of intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalPlot {
    /// The heading.
    pub title: String,
    /// One line that says what to see.
    pub note: String,
    /// Name and unit along the axis.
    pub x_name: String,
    /// Left and right end as powers of ten.
    pub decades: (i32, i32),
    /// Names of at most three series.
    pub series: Vec<String>,
    /// What the ticks across a row are.
    pub limit_name: String,
    /// The rows, from above.
    pub rows: Vec<IntervalRow>,
}

impl IntervalPlot {
    /// As SVG.
    pub fn svg(&self) -> String {
        let bottom = 80.0 + ROW * self.rows.len() as f64;
        let (first, last) = self.decades;
        let description = format!("{} Series: {}.", self.note, self.series.join(", "));
        let mut figure = Figure::new(WIDTH, bottom + 64.0, &self.title, &description);
        figure.text((20.0, 26.0), &self.title, Type::new(Anchor::Start).size(20.0).bold());
        figure.text((20.0, 54.0), &self.note, Type::new(Anchor::Start).colour(SOFT_INK));
        let axes = Axes {
            from: (190.0, 76.0),
            to: (640.0, bottom),
            x: (f64::from(first), f64::from(last)),
            y: (0.0, 1.0),
        };
        self.draw_axis(&mut figure, &axes);
        for (k, row) in self.rows.iter().enumerate() {
            let y = 80.0 + ROW * (k as f64 + 0.5);
            let name = shortened(&row.name, 20);
            figure.text((axes.from.0 - 12.0, y), &name, Type::new(Anchor::End).size(15.0));
            let many = row.intervals.len() as f64;
            for (series, interval) in row.intervals.iter().enumerate() {
                // Series side by side within their row.
                let y = y + 0.7 * ROW * ((series as f64 + 0.5) / many - 0.5);
                if let Some(interval) = interval {
                    draw_interval(&mut figure, &axes, y, series, interval);
                }
            }
        }
        self.draw_legend(&mut figure);
        figure.finish()
    }

    fn draw_axis(&self, figure: &mut Figure, axes: &Axes) {
        for power in self.decades.0..=self.decades.1 {
            let (x, y) = axes.place(f64::from(power), 0.0);
            figure.line(&[(x, y), (x, y + 6.0)], Pen::new(INK, 1.4));
            figure.line(&[(x, axes.from.1), (x, y)], Pen::new(SOFT_INK, 0.6).opacity(0.3));
            figure.text((x, y + 17.0), &power_of_ten(power), Type::new(Anchor::Middle).size(15.0));
        }
        figure.frame(axes.from, axes.to, Pen::new(INK, 1.4));
        let middle = 0.5 * (axes.from.0 + axes.to.0);
        figure.text((middle, axes.to.1 + 42.0), &self.x_name, Type::new(Anchor::Middle));
    }

    fn draw_legend(&self, figure: &mut Figure) {
        let small = Type::new(Anchor::Start).size(15.0);
        for (k, name) in self.series.iter().enumerate() {
            let y = 92.0 + 27.0 * k as f64;
            mark(figure, (664.0, y), k, LINES[k % LINES.len()]);
            figure.text((680.0, y), name, small);
        }
        if self.limit_name.is_empty() {
            return;
        }
        let y = 92.0 + 27.0 * self.series.len() as f64;
        figure.line(&[(664.0, y - 9.0), (664.0, y + 9.0)], Pen::new(INK, 3.0));
        figure.text((680.0, y), &self.limit_name, small);
    }
}

fn draw_interval(figure: &mut Figure, axes: &Axes, y: f64, series: usize, interval: &Interval) {
    let colour = LINES[series % LINES.len()];
    let place = |value: f64| axes.place(value.log10().clamp(axes.x.0, axes.x.1), 0.0).0;
    let inside = |value: f64| (axes.x.0..=axes.x.1).contains(&value.log10());
    if inside(interval.high) {
        figure.line(&[(place(interval.low), y), (place(interval.high), y)], Pen::new(colour, 2.0));
        let x = place(interval.high);
        figure.line(&[(x, y - 4.0), (x, y + 4.0)], Pen::new(colour, 2.0));
    }
    if inside(interval.value) {
        mark(figure, (place(interval.value), y), series, colour);
    }
    if inside(interval.limit) {
        let x = place(interval.limit);
        figure.line(&[(x, y - 0.3 * ROW), (x, y + 0.3 * ROW)], Pen::new(INK, 3.0));
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::*;

    #[test]
    fn draws_itself_with_rows_that_have_nothing() {
        let interval = |value| Some(Interval { low: 0.0, value, high: 3e-4, limit: 1e-2 });
        let plot = IntervalPlot {
            title: "t".into(),
            note: "n".into(),
            x_name: "rate".into(),
            decades: (-6, 0),
            series: vec!["a".into(), "b".into()],
            limit_name: "nominal".into(),
            rows: vec![
                IntervalRow { name: "one".into(), intervals: vec![interval(1e-4), None] },
                IntervalRow { name: "two & more".into(), intervals: vec![interval(0.0), interval(f64::NAN)] },
            ],
        };
        let svg = plot.svg();
        assert_well_formed(&svg);
        assert!(svg.contains("10⁻⁴") && svg.len() < 10_000, "{svg}");
    }
}
