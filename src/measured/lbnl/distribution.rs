//! One block of a file: light from one side to one side.

use super::klems::{Basis, Matrix};
use super::tree::Tree;
use crate::bsdf::{Direction, Projection, Rectangle};
use crate::sphere::{Chart, Shape};

/// Scattering from one side to one side. Incident directions are given by (x, y) of
/// the way that light goes on, −(x, y) of the direction to its source.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// Over Klems's patches.
    Matrix(Matrix),
    /// Over squares of the projected disc.
    Tree(Tree),
}

/// Directions are moved by this before their cell is looked for. Round angles lie on
/// edges of cells, as all of 30° does on trees, and the normal on a corner; without
/// it such a direction would be in one cell as it comes and not in the opposite one as
/// it goes, and a reciprocal table would not be.
const OFF_EDGE: [f64; 2] = [1.0e-9, 0.6e-9];

/// (x, y) of where light goes.
fn outgoing_at(wi: Direction) -> [f64; 2] {
    [wi.x + OFF_EDGE[0], wi.y + OFF_EDGE[1]]
}

/// (x, y) of the way on of light from `wo`.
fn way_on(wo: Direction) -> [f64; 2] {
    outgoing_at(wo).map(|x| -x)
}

impl Distribution {
    /// The map whose rectangles the outgoing cells are.
    pub fn projection(&self) -> Projection {
        match self {
            Self::Matrix(_) => Projection::Cylindrical,
            Self::Tree(_) => Projection::Concentric,
        }
    }

    /// The azimuth of that map's x axis: rank 3 turns with the incident light.
    pub fn phi0(&self, wo: Direction) -> f64 {
        let [x, y] = way_on(wo);
        if self.turns() { y.atan2(x) } else { 0.0 }
    }

    /// Whether only the difference of azimuths counts.
    pub fn turns(&self) -> bool {
        matches!(self, Self::Tree(tree) if tree.rank() == 3)
    }

    /// The chart of the outgoing cells.
    pub fn chart(&self, wo: Direction) -> Chart {
        let shape = match self.projection() {
            Projection::Concentric => Shape::ProjectedConcentric,
            Projection::Cylindrical => Shape::ProjectedCylindrical,
        };
        Chart::new(self.phi0(wo)).shaped(shape)
    }

    /// f in sr⁻¹ of light that arrives along `wo` and leaves along `wi`.
    pub fn value(&self, wo: Direction, wi: Direction) -> f64 {
        match self {
            Self::Matrix(m) => m.at(m.incident.patch(way_on(wo)), m.outgoing.patch(outgoing_at(wi))),
            Self::Tree(tree) => {
                let [x, y] = outgoing_at(wi);
                let [u, v] = self.chart(wo).to_point(Direction::new(x, y, 1.0));
                let mut point = [0.0; 2];
                let given = self.coordinates(wo, &mut point);
                tree.at(&point[..given], [u, v])
            }
        }
    }

    /// The incident coordinates of a tree; returns how many they are.
    fn coordinates(&self, wo: Direction, point: &mut [f64; 2]) -> usize {
        let [x, y] = way_on(wo);
        match self {
            Self::Tree(tree) if tree.rank() == 3 => {
                point[0] = Tree::radial(x.hypot(y).min(1.0));
                1
            }
            _ => {
                let chart = Chart::new(0.0).shaped(Shape::ProjectedConcentric);
                *point = chart.to_point(Direction::new(x, y, 1.0));
                2
            }
        }
    }

    /// The outgoing cells of light from `wo` with their values, as rectangles of
    /// one unit square.
    pub fn outgoing(&self, wo: Direction) -> Vec<(Rectangle, f64)> {
        match self {
            Self::Matrix(m) => {
                let i = m.incident.patch(way_on(wo));
                let of = |o: usize| m.outgoing.rectangles(o).into_iter().map(move |r| (r, m.at(i, o)));
                (0..m.outgoing.len()).flat_map(of).collect()
            }
            Self::Tree(tree) => {
                let mut point = [0.0; 2];
                let given = self.coordinates(wo, &mut point);
                tree.outgoing(&point[..given])
            }
        }
    }

    /// The number of incident cells, and which `wo` is in: as fine as the finest
    /// cells of a tree.
    pub fn incident(&self, wo: Direction) -> (usize, usize) {
        match self {
            Self::Matrix(m) => (m.incident.patch(way_on(wo)), m.incident.len()),
            Self::Tree(tree) => {
                let side = 1usize << tree.depth();
                let cell = |x: f64| ((x * side as f64) as usize).min(side - 1);
                let mut point = [0.0; 2];
                match self.coordinates(wo, &mut point) {
                    1 => (cell(point[0]), side.div_ceil(2)),
                    _ => (cell(point[0]) * side + cell(point[1]), side * side),
                }
            }
        }
    }

    /// A direction on the front in the middle of an incident cell.
    pub fn incident_middle(&self, cell: usize) -> Direction {
        match self {
            Self::Matrix(m) => {
                let [x, y] = m.incident.middle(cell);
                Direction::new(-x, -y, (1.0 - x * x - y * y).max(0.0).sqrt())
            }
            Self::Tree(tree) => {
                let side = 1usize << tree.depth();
                let middle = |k: usize| (k as f64 + 0.5) / side as f64;
                if tree.rank() == 3 {
                    let sin = (1.0 - 2.0 * middle(cell)).max(0.0);
                    return Direction::new(-sin, 0.0, ((1.0 - sin) * (1.0 + sin)).sqrt());
                }
                let chart = Chart::new(0.0).shaped(Shape::ProjectedConcentric);
                let on = chart.to_direction([middle(cell / side), middle(cell % side)]);
                Direction::new(-on.x, -on.y, on.z)
            }
        }
    }

    /// How its incident cells are named.
    pub fn describe_incident(&self, wo: Direction) -> String {
        let (cell, all) = self.incident(wo);
        match self {
            Self::Matrix(m) => m.incident.describe(cell),
            Self::Tree(tree) if tree.rank() == 3 => format!("ring {} of {all} from the horizon", cell + 1),
            Self::Tree(tree) => {
                let side = 1usize << tree.depth();
                format!("cell {}, {} of {side} × {side}", cell / side + 1, cell % side + 1)
            }
        }
    }

    /// The basis of the outgoing patches, of a matrix.
    pub fn matrix(&self) -> Option<&Matrix> {
        match self {
            Self::Matrix(m) => Some(m),
            Self::Tree(_) => None,
        }
    }

    /// The same with light going the other way, where it can be had.
    pub fn reversed(&self) -> Option<Self> {
        match self {
            Self::Matrix(m) => m.reversed().map(Self::Matrix),
            Self::Tree(tree) => tree.backwards().map(Self::Tree),
        }
    }
}

/// Whether both bases have the same patches.
pub fn same_patches(a: &Basis, b: &Basis) -> bool {
    a.agrees_with(b)
}
