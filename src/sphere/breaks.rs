//! Lines along which a function has jumps, and cuts that follow them.

use super::chart::{Chart, Shape};
use super::partition::{Cell, snap};
use crate::bsdf::{Direction, NativeCells, Projection};

/// Cells of a chart within which a function is smooth.
#[derive(Clone, Debug, PartialEq)]
pub struct Breaks {
    chart: Chart,
    cells: Vec<Cell>,
}

impl Breaks {
    /// The cells that a subject declares, their edges moved onto the grid on which
    /// partitions are saved (by 2⁻⁴¹ at most).
    pub fn new(native: &NativeCells) -> Self {
        let shape = match native.projection {
            Projection::Concentric => Shape::ProjectedConcentric,
            Projection::Cylindrical => Shape::ProjectedCylindrical,
        };
        let cells = native.cells.iter().map(|c| Cell { lo: c.lo.map(snap), hi: c.hi.map(snap) }).collect();
        Self { chart: Chart::new(native.phi0).shaped(shape), cells }
    }

    /// The chart whose rectangles the cells are.
    pub fn chart(&self) -> Chart {
        self.chart
    }

    /// The cells.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Whether a direction is within `distance` of an edge of its cell, in units of
    /// the square's side: so near, rounding decides on which side it is.
    pub fn is_edge(&self, d: Direction, distance: f64) -> bool {
        let p = self.chart.to_point(d);
        let near = |c: &Cell| {
            (0..2).all(|k| p[k] >= c.lo[k] - distance && p[k] <= c.hi[k] + distance)
                && (0..2).any(|k| (p[k] - c.lo[k]).abs() <= distance || (p[k] - c.hi[k]).abs() <= distance)
        };
        self.cells.iter().any(near)
    }
}

/// The parts of `cells` inside of `whole`.
pub(super) fn clipped(cells: &[Cell], whole: &Cell) -> Vec<Cell> {
    let mut inside = Vec::new();
    for c in cells {
        let lo = [0, 1].map(|k| c.lo[k].max(whole.lo[k]));
        let hi = [0, 1].map(|k| c.hi[k].min(whole.hi[k]));
        if lo[0] < hi[0] && lo[1] < hi[1] {
            inside.push(Cell { lo, hi });
        }
    }
    inside
}

/// Places along `axis`, in order, where a straight cut crosses none of `cells`,
/// which tile a rectangle.
pub(super) fn cuts(cells: &[Cell], axis: usize) -> Vec<f64> {
    let mut spans: Vec<(f64, f64)> = cells.iter().map(|c| (c.lo[axis], c.hi[axis])).collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut reach = f64::INFINITY;
    let mut found = Vec::new();
    for (lo, hi) in spans {
        if lo >= reach {
            found.push(lo);
            reach = hi;
        }
        reach = if reach.is_finite() { reach.max(hi) } else { hi };
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cuts_cross_no_cell() {
        let cell = |u0, v0, u1, v1| Cell { lo: [u0, v0], hi: [u1, v1] };
        // A brick wall: rows may be parted, columns not.
        let wall = [
            cell(0.0, 0.0, 0.5, 0.5),
            cell(0.5, 0.0, 1.0, 0.5),
            cell(0.0, 0.5, 0.25, 1.0),
            cell(0.25, 0.5, 1.0, 1.0),
        ];
        assert_eq!(cuts(&wall, 1), [0.5]);
        assert_eq!(cuts(&wall, 0), [0.0; 0]);
        let row = clipped(&wall, &cell(0.1, 0.6, 0.9, 0.9));
        assert_eq!(row, [cell(0.1, 0.6, 0.25, 0.9), cell(0.25, 0.6, 0.9, 0.9)]);
        assert_eq!(cuts(&row, 0), [0.25]);
    }
}
