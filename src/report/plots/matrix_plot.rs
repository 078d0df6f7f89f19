//! A matrix of marks: rows with names, in groups, by short columns.

use super::colours::{INK, LINES, NOTHING, Rgb, SOFT_INK};
use super::figure::{Anchor, Figure, Pen, Type, shortened};

/// A mark in a cell of the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Nothing was looked at.
    Blank,
    /// Looked at, and nothing seen.
    Quiet,
    /// Seen, as it must be.
    Full,
    /// Seen, as it may be.
    Open,
    /// Told, as it must be.
    Told,
    /// It must not be so.
    Wrong,
}

impl Mark {
    /// Every mark that says something, with what it says.
    const LEGEND: [(Self, &'static str); 5] = [
        (Self::Full, "fails, as it must"),
        (Self::Open, "fails, as it may"),
        (Self::Told, "warns, as it must"),
        (Self::Quiet, "does not fail"),
        (Self::Wrong, "contradicts the label"),
    ];

    fn draw(self, figure: &mut Figure, (x, y): (f64, f64)) {
        let blue = LINES[0];
        match self {
            Self::Blank => {}
            Self::Quiet => figure.dot((x, y), 1.4, SOFT_INK),
            Self::Full => figure.dot((x, y), 5.6, blue),
            Self::Open => figure.circle((x, y), 4.8, Pen::new(blue, 1.8)),
            Self::Told => figure.polygon(&[(x, y - 6.0), (x + 5.6, y + 4.5), (x - 5.6, y + 4.5)], LINES[2]),
            Self::Wrong => {
                let colour: Rgb = LINES[1];
                for s in [-1.0, 1.0] {
                    figure.line(&[(x - 5.0, y - 5.0 * s), (x + 5.0, y + 5.0 * s)], Pen::new(colour, 3.0));
                }
            }
        }
    }
}

/// A row of marks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MatrixRow {
    /// Its group; told where it changes.
    pub group: String,
    /// Its name.
    pub name: String,
    /// A mark a column.
    pub marks: Vec<Mark>,
}

/// The matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MatrixPlot {
    /// The heading.
    pub title: String,
    /// One line that says what to see.
    pub note: String,
    /// Names of the columns, written upwards.
    pub columns: Vec<String>,
    /// The rows, from above.
    pub rows: Vec<MatrixRow>,
}

const ROW: f64 = 17.0;
const COLUMN: f64 = 24.0;
const LEFT: f64 = 440.0;
const TOP: f64 = 232.0;

impl MatrixPlot {
    /// As SVG.
    pub fn svg(&self) -> String {
        let width = LEFT + COLUMN * self.columns.len() as f64 + 24.0;
        let bottom = TOP + ROW * self.rows.len() as f64;
        let mut figure = Figure::new(width, bottom + 24.0, &self.title, &self.note);
        figure.text((20.0, 26.0), &self.title, Type::new(Anchor::Start).size(20.0).bold());
        figure.text((20.0, 54.0), &self.note, Type::new(Anchor::Start).colour(SOFT_INK));
        for (k, (mark, words)) in Mark::LEGEND.into_iter().enumerate() {
            let y = 88.0 + 22.0 * k as f64;
            mark.draw(&mut figure, (30.0, y));
            figure.text((48.0, y), words, Type::new(Anchor::Start).size(15.0));
        }
        let column = |k: usize| LEFT + COLUMN * (k as f64 + 0.5);
        for (k, name) in self.columns.iter().enumerate() {
            figure.text((column(k), TOP - 12.0), name, Type::new(Anchor::Start).size(14.0).upwards());
        }
        let mut group = "";
        for (k, row) in self.rows.iter().enumerate() {
            let y = TOP + ROW * (k as f64 + 0.5);
            if row.group != group {
                group = &row.group;
                let edge = y - 0.5 * ROW;
                figure.line(&[(20.0, edge), (width - 20.0, edge)], Pen::new(INK, 0.8));
                figure.text((20.0, y), group, Type::new(Anchor::Start).size(13.0).bold());
            } else if k % 2 == 1 {
                let (from, to) = ((210.0, y - 0.5 * ROW), (width - 20.0, y - 0.5 * ROW));
                figure.line(&[from, to], Pen::new(NOTHING, 0.8));
            }
            figure.text((LEFT - 10.0, y), &shortened(&row.name, 30), Type::new(Anchor::End).size(13.0));
            for (k, mark) in row.marks.iter().enumerate() {
                mark.draw(&mut figure, (column(k), y));
            }
        }
        figure.line(&[(20.0, bottom), (width - 20.0, bottom)], Pen::new(INK, 0.8));
        figure.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::*;

    #[test]
    fn draws_itself_with_every_mark() {
        let marks = vec![Mark::Blank, Mark::Quiet, Mark::Full, Mark::Open, Mark::Told, Mark::Wrong];
        let row = |name: &str, group: &str| MatrixRow {
            group: group.into(),
            name: name.into(),
            marks: marks.clone(),
        };
        let plot = MatrixPlot {
            title: "t".into(),
            note: "n".into(),
            columns: vec!["a".into(); 6],
            rows: vec![row("one", "g"), row("two & more", "g"), row("three", "h")],
        };
        let svg = plot.svg();
        assert_well_formed(&svg);
        assert!(svg.contains("contradicts") && svg.len() < 15_000, "{}", svg.len());
    }
}
