//! Partitions and cubature along the cells of a function with jumps.

use super::breaks::{Breaks, clipped, cuts};
use super::chart::Point;
use super::cubature::{Marker, Patch, cut};
use super::partition::{Cell, EMPTY_DEPTH, NARROWEST, Partition, partition_points};

impl Partition {
    /// As [`build`](Self::build), in the chart of `breaks`, and with leaves that are
    /// parts of its cells or unions of whole ones, as far as straight cuts go.
    pub fn build_along(breaks: &Breaks, mut pilot: Vec<Point>, leaves: usize) -> Self {
        let mut tree = Self::sphere(breaks.chart());
        let front = partition_points(&mut pilot, |p| p[0] < 1.0);
        let total = pilot.len().max(1);
        let (front_points, back_points) = pilot.split_at_mut(front);
        for (node, points) in [(1, front_points), (2, back_points)] {
            let cells = clipped(breaks.cells(), &tree.node_cell(node));
            let share = (leaves * points.len()).div_ceil(total).max(1 << EMPTY_DEPTH);
            tree.split_along(node, &cells, points, share);
        }
        tree.number_leaves();
        tree
    }

    /// Splits where no cell is crossed, best into halves of equal mass, until a
    /// leaf is in one cell.
    fn split_along(&mut self, node: usize, cells: &[Cell], points: &mut [Point], leaves: usize) {
        if leaves < 2 {
            return;
        }
        let whole = self.node_cell(node);
        // Where there are no points, area decides.
        let weight = |below: usize, area: f64| below as f64 + area / whole.area();
        let all = weight(points.len(), whole.area());
        let mut best: Option<(f64, usize, f64)> = None;
        for axis in 0..2 {
            let places = cuts(cells, axis);
            let mut counts = vec![0usize; places.len() + 1];
            for p in points.iter() {
                counts[places.partition_point(|at| *at <= p[axis])] += 1;
            }
            let mut below = 0;
            for (at, count) in places.iter().zip(counts) {
                below += count;
                let left = weight(below, whole.split(axis, *at)[0].area());
                let balance = left.min(all - left);
                let room = at - whole.lo[axis] >= NARROWEST && whole.hi[axis] - at >= NARROWEST;
                if room && best.is_none_or(|(b, _, _)| balance > b) {
                    best = Some((balance, axis, *at));
                }
            }
        }
        let Some((_, axis, at)) = best else {
            return self.split_at_medians(node, points, leaves);
        };
        let child = self.split(node, axis, at);
        let below = partition_points(points, |p| p[axis] < at);
        let (left, right) = points.split_at_mut(below);
        let left_weight = weight(left.len(), self.node_cell(child).area());
        let left_leaves = ((leaves as f64 * left_weight / all).round() as usize).clamp(1, leaves - 1);
        for (k, points, leaves) in [(child, left, left_leaves), (child + 1, right, leaves - left_leaves)] {
            let inside = clipped(cells, &self.node_cell(k));
            self.split_along(k, &inside, points, leaves);
        }
    }
}

/// The leaves' patches cut until each lies in one of `cells`.
pub(super) fn within(
    partition: &Partition,
    cells: &[Cell],
    of_leaf: Vec<Patch>,
    markers: &[Marker],
) -> Vec<Patch> {
    // The cells of each leaf, found on the way down the tree.
    let mut cells_of: Vec<Vec<Cell>> = vec![Vec::new(); partition.len()];
    let mut open = vec![(0, clipped(cells, &partition.node_cell(0)))];
    let mut at_nodes: Vec<Option<Vec<Cell>>> = vec![None; partition.nodes()];
    while let Some((node, cells)) = open.pop() {
        match partition.children(node) {
            Some(children) => {
                open.extend(children.map(|child| (child, clipped(&cells, &partition.node_cell(child)))));
            }
            None => at_nodes[node] = Some(cells),
        }
    }
    for (leaf, cells) in cells_of.iter_mut().enumerate() {
        *cells = at_nodes[partition.leaf_node(leaf)].take().unwrap_or_default();
    }
    let mut single = Vec::new();
    let mut open: Vec<_> = of_leaf.into_iter().zip(cells_of).collect();
    while let Some((patch, cells)) = open.pop() {
        if cells.len() < 2 {
            single.push(patch);
            continue;
        }
        let middle = |places: Vec<f64>| places.get(places.len() / 2).copied();
        let clean = [0, 1].into_iter().find_map(|axis| Some((axis, middle(cuts(&cells, axis))?)));
        // Where each straight cut crosses cells, along any inner edge.
        let inner = |axis: usize| {
            let edge = |c: &Cell| c.lo[axis];
            cells.iter().map(edge).find(|at| *at > patch.cell.lo[axis]).map(|at| (axis, at))
        };
        let Some((axis, at)) = clean.or_else(|| inner(0)).or_else(|| inner(1)) else {
            single.push(patch);
            continue;
        };
        for half in cut(patch, markers, axis, at) {
            let inside = clipped(&cells, &half.cell);
            open.push((half, inside));
        }
    }
    single
}

#[cfg(test)]
mod tests {
    use super::super::cubature::{Goal, Patches, integrate_on};
    use super::*;
    use crate::bsdf::{Direction, NativeCells, Projection, Rectangle};
    use crate::statistics::streams::{Stream, StreamKey};
    use std::f64::consts::PI;

    /// The front in these cells, the back in one.
    fn breaks(projection: Projection, front: &[[f64; 4]]) -> Breaks {
        let rectangle = |[u0, v0, u1, v1]: [f64; 4]| Rectangle { lo: [u0, v0], hi: [u1, v1] };
        let cells = front.iter().chain(&[[1.0, 0.0, 2.0, 1.0]]).map(|c| rectangle(*c)).collect();
        Breaks::new(&NativeCells { projection, phi0: 0.7, cells, given: String::new() })
    }

    /// Rings of 1, 4 and 5 cells.
    fn rings() -> Breaks {
        let ring = |n: usize, v0: f64, v1: f64| {
            (0..n).map(move |k| [k as f64 / n as f64, v0, (k + 1) as f64 / n as f64, v1])
        };
        let cells: Vec<_> = ring(1, 0.0, 0.1).chain(ring(4, 0.1, 0.55)).chain(ring(5, 0.55, 1.0)).collect();
        breaks(Projection::Cylindrical, &cells)
    }

    /// Five cells that no straight line parts.
    fn pinwheel() -> Breaks {
        let cells = [
            [0.0, 0.0, 0.7, 0.3],
            [0.7, 0.0, 1.0, 0.7],
            [0.3, 0.7, 1.0, 1.0],
            [0.0, 0.3, 0.3, 1.0],
            [0.3, 0.3, 0.7, 0.7],
        ];
        breaks(Projection::Concentric, &cells)
    }

    fn pilot(n: usize) -> Vec<Point> {
        let mut stream: Stream = StreamKey::new(1).block(0);
        (0..n).map(|_| [stream.next_f64().powi(3), stream.next_f64()]).collect()
    }

    #[test]
    fn leaves_are_of_whole_cells_or_within_one() {
        for leaves in [8, 64, 1024] {
            let tree = Partition::build_along(&rings(), pilot(1 << 14), leaves);
            for leaf in (0..tree.len()).map(|l| tree.leaf_cell(l)) {
                let inside = clipped(rings().cells(), &leaf);
                let whole = inside.iter().all(|c| rings().cells().contains(c));
                assert!(inside.len() == 1 || whole, "{leaf:?}");
            }
            let area: f64 = (0..tree.len()).map(|l| tree.leaf_cell(l).area()).sum();
            assert!((area - 2.0).abs() < 1e-12);
            let text = serde_json::to_string(&tree).unwrap();
            assert_eq!(serde_json::from_str::<Partition>(&text).unwrap(), tree);
        }
    }

    /// f cos, f a different constant in each cell of the front: exact to rounding in
    /// one pass of the rule over the cells.
    #[test]
    fn integrals_over_cells_are_exact() {
        for breaks in [rings(), pinwheel()] {
            let front: Vec<Cell> = breaks.cells().iter().filter(|c| c.is_front()).copied().collect();
            let value = |wi: Direction| {
                let p = breaks.chart().to_point(wi);
                front.iter().position(|c| c.contains(p)).map_or(0.0, |k| (1 + k * k) as f64)
            };
            let exact: f64 = front.iter().enumerate().map(|(k, c)| (1 + k * k) as f64 * PI * c.area()).sum();
            let tree = Partition::build_along(&breaks, pilot(1 << 12), 64);
            let goal = Goal {
                components: 1,
                controlled: 0,
                draws: 1 << 20,
                mass: 1e-9,
                value: 1e-9,
                evaluations: 1 << 20,
                independent: false,
                horizon: 0.0,
            };
            let patches = Patches::new(Some(&breaks), &tree, &[], &[], 0.0);
            let (result, _) = integrate_on(patches, &tree, 0, &[], &goal, |wi, out| {
                wi.iter().zip(out).for_each(|(wi, out)| *out = value(*wi) * wi.abs_cos_theta());
                Ok::<_, ()>(())
            })
            .unwrap();
            let (total, error) = result.total(0);
            assert!(result.converged && (total / exact - 1.0).abs() < 1e-11, "{total} {exact}");
            assert!(error < 1e-10 * exact);
            // Some 80 leaves, a few cells in each.
            assert!(result.evaluations < 4000, "{}", result.evaluations);
        }
    }
}
