//! The cell tree: a partition of the sphere into cells of near-equal mass.

use super::chart::{Chart, Point, Shape};
use crate::bsdf::Direction;
use serde::{Deserialize, Serialize};

/// Split positions lie on a grid of 2⁻⁴⁰ of a square's side, so that a tree is
/// saved exactly by integers below 2⁵³.
const GRID: f64 = (1u64 << 40) as f64;

/// The least width of a cell, in steps of the grid: two steps leave room for
/// a split.
pub(super) const NARROWEST: f64 = 2.0 / GRID;

/// Where the pilot has fewer points than this, a cell is not split on their
/// word.
const FEWEST_POINTS: usize = 16;

/// Searches that go down the tree side by side: two vectors of the widest registers.
const SIDE_BY_SIDE: usize = 16;

/// Depths of a [`Descent`]: 256 leaves of a hemisphere lie at 9, 1024 at 11, and tables of
/// 2¹³ entries still stay in the cache.
const DESCENTS: std::ops::RangeInclusive<usize> = 9..=13;

/// A hemisphere in which the pilot has no points is cut into 2⁴ equal cells.
pub(super) const EMPTY_DEPTH: u32 = 4;

/// The nearest place of the grid.
pub(super) fn snap(at: f64) -> f64 {
    (at * GRID).round() / GRID
}

/// A rectangle of the [chart](Chart)'s squares; it never straddles the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Lower corner.
    pub lo: Point,
    /// Upper corner.
    pub hi: Point,
}

impl Cell {
    /// Area in the square; see [`Chart::solid_angle`].
    pub fn area(&self) -> f64 {
        (self.hi[0] - self.lo[0]) * (self.hi[1] - self.lo[1])
    }

    /// Its side along `axis`.
    pub fn width(&self, axis: usize) -> f64 {
        self.hi[axis] - self.lo[axis]
    }

    /// Whether it lies on the front hemisphere.
    pub fn is_front(&self) -> bool {
        self.lo[0] < 1.0
    }

    /// Both parts, cut at `at` across `axis`.
    pub fn split(&self, axis: usize, at: f64) -> [Self; 2] {
        let mut parts = [*self; 2];
        parts[0].hi[axis] = at;
        parts[1].lo[axis] = at;
        parts
    }

    /// The middle of `axis`.
    pub fn middle(&self, axis: usize) -> f64 {
        0.5 * (self.lo[axis] + self.hi[axis])
    }

    /// The point at `s`, `t` in [0,1] of its sides.
    pub fn at(&self, s: f64, t: f64) -> Point {
        [self.lo[0] + s * (self.hi[0] - self.lo[0]), self.lo[1] + t * (self.hi[1] - self.lo[1])]
    }

    /// Whether all that lies within `reach` of `at` along `axis` lies on it.
    pub(super) fn holds(&self, axis: usize, at: f64, reach: f64) -> bool {
        at - reach >= self.lo[axis] && at + reach < self.hi[axis]
    }

    /// Whether it holds the point (lower edges included).
    pub fn contains(&self, p: Point) -> bool {
        (0..2).all(|k| p[k] >= self.lo[k] && p[k] < self.hi[k])
    }
}

/// A node: a split, or a leaf, whose `child` is itself and whose `at` is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    at: f64,
    child: u32,
    axis: u32,
}

/// A partition of the sphere as a binary tree of rectangles in the squares of
/// a [`Chart`]. The root is the sphere; its children are the hemispheres; the
/// rest is cut at medians of a pilot sample, so that leaves have near-equal
/// mass if the pilot's density is right.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Saved", into = "Saved")]
pub struct Partition {
    chart: Chart,
    nodes: Vec<Node>,
    /// The tree in the form in which many points are searched; none of a deep one.
    descent: Option<Descent>,
    /// The cell of each node.
    cells: Vec<Cell>,
    /// Nodes that are leaves, in order.
    leaves: Vec<u32>,
    /// For each node its leaf number, or `u32::MAX`.
    leaf_number: Vec<u32>,
}

impl Partition {
    /// Builds about `leaves` cells (give or take the empty hemisphere's) from a
    /// pilot sample given as points of `chart`.
    pub fn build(chart: Chart, mut pilot: Vec<Point>, leaves: usize) -> Self {
        let mut tree = Self::sphere(chart);
        let front = partition_points(&mut pilot, |p| p[0] < 1.0);
        let total = pilot.len().max(1);
        let (front_points, back_points) = pilot.split_at_mut(front);
        for (node, points) in [(1, front_points), (2, back_points)] {
            if points.len() < FEWEST_POINTS {
                tree.split_evenly(node, EMPTY_DEPTH);
            } else {
                let share = (leaves * points.len()).div_ceil(total);
                tree.split_at_medians(node, points, share);
            }
        }
        tree.number_leaves();
        tree
    }

    /// The hemispheres, without numbers for their leaves.
    pub(super) fn sphere(chart: Chart) -> Self {
        let whole = Cell { lo: [0.0, 0.0], hi: [2.0, 1.0] };
        let mut tree = Self {
            chart,
            nodes: vec![Node { at: f64::INFINITY, child: 0, axis: 0 }],
            descent: None,
            cells: vec![whole],
            leaves: Vec::new(),
            leaf_number: Vec::new(),
        };
        tree.split(0, 0, 1.0);
        tree
    }

    /// Cuts a leaf; returns the first of both children.
    pub(super) fn split(&mut self, node: usize, axis: usize, at: f64) -> usize {
        let child = self.nodes.len();
        self.nodes[node] = Node { at, child: child as u32, axis: axis as u32 };
        for cell in self.cells[node].split(axis, at) {
            let own = self.nodes.len() as u32;
            self.nodes.push(Node { at: f64::INFINITY, child: own, axis: 0 });
            self.cells.push(cell);
        }
        child
    }

    fn split_evenly(&mut self, node: usize, depth: u32) {
        if depth == 0 {
            return;
        }
        let axis = (depth % 2) as usize;
        let middle = snap(self.cells[node].middle(axis));
        let child = self.split(node, axis, middle);
        self.split_evenly(child, depth - 1);
        self.split_evenly(child + 1, depth - 1);
    }

    pub(super) fn split_at_medians(&mut self, node: usize, points: &mut [Point], leaves: usize) {
        if leaves < 2 || points.len() < 2 * FEWEST_POINTS {
            return;
        }
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points.iter() {
            for axis in 0..2 {
                lo[axis] = if p[axis] < lo[axis] { p[axis] } else { lo[axis] };
                hi[axis] = if p[axis] > hi[axis] { p[axis] } else { hi[axis] };
            }
        }
        let wide = usize::from(hi[1] - lo[1] > hi[0] - lo[0]);
        // Many equal directions may leave no room on one axis.
        for axis in [wide, 1 - wide] {
            let at = snap(median(points.iter().map(|p| p[axis])));
            let cell = self.cells[node];
            if at - cell.lo[axis] < NARROWEST || cell.hi[axis] - at < NARROWEST {
                continue;
            }
            let below = partition_points(points, |p| p[axis] < at);
            let child = self.split(node, axis, at);
            let (left, right) = points.split_at_mut(below);
            self.split_at_medians(child, left, leaves / 2);
            self.split_at_medians(child + 1, right, leaves - leaves / 2);
            return;
        }
    }

    /// Must follow all cuts.
    pub(super) fn number_leaves(&mut self) {
        self.leaf_number = vec![u32::MAX; self.nodes.len()];
        self.leaves.clear();
        let mut depth_of = vec![0usize; self.nodes.len()];
        for k in 0..self.nodes.len() {
            match self.children(k) {
                Some([left, right]) => {
                    depth_of[left] = depth_of[k] + 1;
                    depth_of[right] = depth_of[k] + 1;
                }
                None => {
                    self.leaf_number[k] = self.leaves.len() as u32;
                    self.leaves.push(k as u32);
                }
            }
        }
        let depth = depth_of.into_iter().max().unwrap_or(0);
        let depth = depth.max(*DESCENTS.start());
        self.descent = DESCENTS.contains(&depth).then(|| Descent::new(self, depth));
    }

    /// The chart of its cells.
    pub fn chart(&self) -> &Chart {
        &self.chart
    }

    /// Number of leaves.
    pub fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Never: a partition has at least two leaves.
    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Number of nodes; 0 is the root, 1 the front and 2 the back hemisphere.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Both children of a node, or `None` of a leaf. Children have larger
    /// numbers than their parent.
    pub fn children(&self, node: usize) -> Option<[usize; 2]> {
        let child = self.nodes[node].child as usize;
        (child != node).then_some([child, child + 1])
    }

    /// The cell of a node.
    pub fn node_cell(&self, node: usize) -> Cell {
        self.cells[node]
    }

    /// The cell of a leaf.
    pub fn leaf_cell(&self, leaf: usize) -> Cell {
        self.cells[self.leaves[leaf] as usize]
    }

    /// The node of a leaf.
    pub fn leaf_node(&self, leaf: usize) -> usize {
        self.leaves[leaf] as usize
    }

    /// The same tree with the marked leaves cut into 2⁴ equal cells: where a
    /// pdf has mass that no pilot point stands for.
    pub fn refined(&self, marked: &[bool]) -> Self {
        let mut tree = Self::sphere(self.chart);
        // Nodes come in the order in which a saved tree is read, and so leaves have the
        // numbers that they have then: counts are saved by them.
        let mut open = vec![(0, 0)];
        while let Some((node, copy)) = open.pop() {
            if let Some([left, right]) = self.children(node) {
                let split = self.nodes[node];
                let child = if node == 0 { 1 } else { tree.split(copy, split.axis as usize, split.at) };
                open.extend([(right, child + 1), (left, child)]);
            } else if marked[self.leaf_number[node] as usize] {
                let cell = self.cells[node];
                if (0..2).all(|k| cell.width(k) > 16.0 * NARROWEST) {
                    tree.split_evenly(copy, EMPTY_DEPTH);
                }
            }
        }
        tree.number_leaves();
        tree
    }

    /// The leaf that holds a point.
    pub fn locate(&self, p: Point) -> usize {
        let mut node = 0;
        while let Some([left, right]) = self.children(node) {
            let split = self.nodes[node];
            node = if p[split.axis as usize] >= split.at { right } else { left };
        }
        self.leaf_number[node] as usize
    }

    /// The leaf that holds a direction.
    pub fn locate_direction(&self, d: Direction) -> usize {
        self.locate(self.chart.to_point(d))
    }

    /// The leaves of many points: as [`locate`](Self::locate), but searched side by
    /// side, so that the searches overlap.
    pub fn locate_all(&self, points: &[Point], leaves: &mut Vec<u32>) {
        leaves.clear();
        let Some(descent) = &self.descent else {
            leaves.extend(points.iter().map(|p| self.locate(*p) as u32));
            return;
        };
        leaves.resize(points.len(), 0);
        match descent.depth {
            9 => descent.search::<{ 1 << 9 }>(points, leaves),
            10 => descent.search::<{ 1 << 10 }>(points, leaves),
            11 => descent.search::<{ 1 << 11 }>(points, leaves),
            12 => descent.search::<{ 1 << 12 }>(points, leaves),
            _ => descent.search::<{ 1 << 13 }>(points, leaves),
        }
    }

    /// Sums over leaves for each node, leaves' own values at the leaves.
    pub fn sum_up<T: Copy + std::ops::Add<Output = T>>(&self, of_leaves: &[T]) -> Vec<T> {
        let mut of_nodes: Vec<T> = self
            .leaf_number
            .iter()
            .map(|&leaf| of_leaves[if leaf == u32::MAX { 0 } else { leaf as usize }])
            .collect();
        for node in (0..self.nodes.len()).rev() {
            if let Some([left, right]) = self.children(node) {
                of_nodes[node] = of_nodes[left] + of_nodes[right];
            }
        }
        of_nodes
    }
}

/// The tree filled up to equal depth, as a heap: node k has the children 2k and
/// 2k + 1, so that a step down loads one number. What is below a leaf splits nothing.
#[derive(Clone, Debug, PartialEq)]
struct Descent {
    depth: usize,
    /// Bits of each split's position. Positions lie on [`GRID`], so that the lowest
    /// bit is free to hold the axis.
    splits: Vec<u64>,
    /// The leaf at each place of the last level.
    leaves: Vec<u32>,
}

impl Descent {
    fn new(tree: &Partition, depth: usize) -> Self {
        let mut descent =
            Self { depth, splits: vec![f64::INFINITY.to_bits(); 1 << depth], leaves: vec![0; 1 << depth] };
        descent.fill(tree, 0, 1, 0);
        descent
    }

    /// Puts the subtree of `node` at place `k`, which lies at `depth`.
    fn fill(&mut self, tree: &Partition, node: usize, k: usize, depth: usize) {
        if let Some([left, right]) = tree.children(node) {
            let split = tree.nodes[node];
            self.splits[k] = split.at.to_bits() | u64::from(split.axis);
            self.fill(tree, left, 2 * k, depth + 1);
            self.fill(tree, right, 2 * k + 1, depth + 1);
        } else {
            // Nothing splits from here on: every way down ends on the left.
            self.leaves[(k << (self.depth - depth)) & ((1 << self.depth) - 1)] = tree.leaf_number[node];
        }
    }

    /// As [`Partition::locate_all`], for tables of `LEN` entries: a length that the
    /// compiler knows spares a check of bounds a level.
    fn search<const LEN: usize>(&self, points: &[Point], leaves: &mut [u32]) {
        let splits: &[u64; LEN] = self.splits.as_array().expect("the length of this depth");
        let of_place = self.leaves.as_array().expect("the length of this depth");
        pulp::Arch::new().dispatch(Search { splits, of_place, points, leaves });
    }
}

/// Arguments of [`Descent::search`].
struct Search<'a, const LEN: usize> {
    splits: &'a [u64; LEN],
    of_place: &'a [u32; LEN],
    points: &'a [Point],
    leaves: &'a mut [u32],
}

impl<const LEN: usize> Search<'_, LEN> {
    /// Arrays and plain loops over them are what the compiler makes vectors of.
    #[inline(always)]
    fn leaves<const N: usize>(&self, points: &[Point; N]) -> [u32; N] {
        let (mut u, mut v) = ([0.0; N], [0.0; N]);
        for k in 0..N {
            [u[k], v[k]] = points[k];
        }
        let mut at = [1u64; N];
        for _ in 0..LEN.ilog2() {
            for k in 0..N {
                let split = self.splits[at[k] as usize % LEN];
                let value = if split & 1 == 1 { v[k] } else { u[k] };
                at[k] = 2 * at[k] + u64::from(value >= f64::from_bits(split & !1));
            }
        }
        let mut leaves = [0; N];
        for k in 0..N {
            leaves[k] = self.of_place[at[k] as usize % LEN];
        }
        leaves
    }
}

impl<const LEN: usize> pulp::NullaryFnOnce for Search<'_, LEN> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let all = std::mem::take(&mut self.leaves);
        let (many, rest) = self.points.as_chunks::<SIDE_BY_SIDE>();
        let (to_many, to_rest) = all.as_chunks_mut::<SIDE_BY_SIDE>();
        for (points, leaves) in many.iter().zip(to_many) {
            *leaves = self.leaves(points);
        }
        for (point, leaf) in rest.iter().zip(to_rest) {
            [*leaf] = self.leaves(&[*point]);
        }
    }
}

/// The upper median of values that are not negative: their bits are ordered as they are.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    // −0 has a sign.
    let mut bits: Vec<u64> = values.map(|value| (value + 0.0).to_bits()).collect();
    let half = bits.len() / 2;
    f64::from_bits(*bits.select_nth_unstable(half).1)
}

/// Moves the points for which `first` holds to the front; returns their number. Each moves,
/// as it were: a branch would be told wrong half of the time.
pub(super) fn partition_points(points: &mut [Point], first: impl Fn(&Point) -> bool) -> usize {
    let mut count = 0;
    for k in 0..points.len() {
        let is_first = first(&points[k]);
        points.swap(k, count);
        count += usize::from(is_first);
    }
    count
}

/// The saved form: cos and sin of the chart's azimuth, its shape, and in preorder −1 for a leaf or 2·at·2⁴⁰ + axis
/// for a split.
#[derive(Serialize, Deserialize)]
struct Saved {
    x_axis: [f64; 2],
    #[serde(default, skip_serializing_if = "is_default")]
    shape: Shape,
    preorder: Vec<i64>,
}

fn is_default(shape: &Shape) -> bool {
    *shape == Shape::default()
}

impl From<Partition> for Saved {
    fn from(tree: Partition) -> Self {
        let mut preorder = Vec::with_capacity(tree.nodes());
        let mut open = vec![0];
        while let Some(node) = open.pop() {
            match tree.children(node) {
                None => preorder.push(-1),
                Some([left, right]) => {
                    let split = tree.nodes[node];
                    preorder.push(2 * (split.at * GRID) as i64 + i64::from(split.axis));
                    open.extend([right, left]);
                }
            }
        }
        Self { x_axis: tree.chart.x_axis(), shape: tree.chart.shape(), preorder }
    }
}

impl TryFrom<Saved> for Partition {
    type Error = String;

    fn try_from(saved: Saved) -> Result<Self, String> {
        let mut tree = Self::sphere(Chart::with_x_axis(saved.x_axis).shaped(saved.shape));
        let mut open = vec![0usize];
        let mut codes = saved.preorder.iter();
        while let Some(node) = open.pop() {
            let code = *codes.next().ok_or("the cell tree ends early")?;
            if code < 0 {
                continue;
            }
            let (axis, at) = ((code & 1) as usize, (code >> 1) as f64 / GRID);
            let cell = tree.cells[node];
            let child = if node == 0 {
                if (axis, at) != (0, 1.0) {
                    return Err("the cell tree does not start with the hemispheres".into());
                }
                1
            } else {
                if !(at > cell.lo[axis] && at < cell.hi[axis]) {
                    return Err(format!("the cell tree has a split at {at} outside of {cell:?}"));
                }
                tree.split(node, axis, at)
            };
            open.extend([child + 1, child]);
        }
        if codes.next().is_some() {
            return Err("the cell tree has nodes to spare".into());
        }
        tree.number_leaves();
        Ok(tree)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::streams::{Stream, StreamKey};

    fn random(n: usize, seed: u64) -> Vec<Point> {
        let mut stream: Stream = StreamKey::new(seed).block(0);
        (0..n)
            .map(|_| {
                let (a, b) = (stream.next_f64(), stream.next_f64());
                // Dense at a corner, as a narrow lobe is.
                [a.powi(6), b * b]
            })
            .collect()
    }

    #[test]
    fn leaves_have_near_equal_mass() {
        let tree = Partition::build(Chart::new(0.3), random(1 << 15, 1), 1024);
        let mut counts = vec![0u64; tree.len()];
        for p in random(1 << 18, 2) {
            counts[tree.locate(p)] += 1;
        }
        // 1024 leaves of the front and 16 of the empty back.
        assert_eq!(tree.len(), 1024 + 16);
        let mean = (1 << 18) as f64 / 1024.0;
        let front: Vec<_> =
            (0..tree.len()).filter(|&l| tree.leaf_cell(l).is_front()).map(|l| counts[l] as f64).collect();
        // A leaf holds 32 pilot points, ±18 %: five deviations and the count's own noise.
        assert!(front.iter().all(|c| (c / mean - 1.0).abs() < 1.4), "{front:?}");
        assert_eq!(tree.sum_up(&counts)[0], 1 << 18);
    }

    #[test]
    fn cells_tile_the_sphere() {
        let tree = Partition::build(Chart::new(0.3), random(1 << 12, 1), 256);
        let area: f64 = (0..tree.len()).map(|l| tree.leaf_cell(l).area()).sum();
        assert!((area - 2.0).abs() < 1e-12);
        for p in random(1000, 3) {
            assert!(tree.leaf_cell(tree.locate(p)).contains(p));
        }
    }

    /// Shallower and deeper than a descent, as deep as each, and on the splits themselves.
    #[test]
    fn many_are_found_where_each_is() {
        let tree = |pilot, leaves| Partition::build(Chart::new(0.3), pilot, leaves);
        let usual = tree(random(1 << 15, 1), 1024);
        let once = usual.refined(&vec![true; usual.len()]);
        let trees = [
            (tree(vec![], 1024), Some(9)),
            (tree(random(1 << 13, 1), 256), Some(9)),
            (tree(random(1 << 14, 1), 512), Some(10)),
            (usual, Some(11)),
            (tree(random(1 << 16, 1), 2048), Some(12)),
            (tree(random(1 << 17, 1), 4096), Some(13)),
            (once, None),
        ];
        for (tree, depth) in trees {
            assert_eq!(tree.descent.as_ref().map(|d| d.depth), depth);
            let corners = (0..tree.len()).map(|l| tree.leaf_cell(l).lo);
            let points: Vec<_> = random(1001, 3).into_iter().chain(corners).chain([[1.0, 1.0]]).collect();
            let mut leaves = Vec::new();
            tree.locate_all(&points, &mut leaves);
            let each: Vec<_> = points.iter().map(|p| tree.locate(*p) as u32).collect();
            assert_eq!(leaves, each);
        }
    }

    #[test]
    fn survives_equal_points_and_none() {
        for points in [vec![], vec![[0.25, 0.75]; 5000], vec![[1.5, 0.5]; 3]] {
            let tree = Partition::build(Chart::new(0.0), points, 1024);
            assert!(tree.len() >= 17 && tree.len() < 200, "{}", tree.len());
        }
    }

    #[test]
    fn is_saved_exactly() {
        let built = Partition::build(Chart::new(2.3), random(1 << 12, 1), 256);
        let some: Vec<bool> = (0..built.len()).map(|leaf| leaf % 7 == 3).collect();
        let refined = built.refined(&some);
        assert!(refined.len() > built.len());
        for tree in [built, refined] {
            let text = serde_json::to_string(&tree).unwrap();
            let again: Partition = serde_json::from_str(&text).unwrap();
            assert_eq!(tree.len(), again.len());
            for p in random(2000, 9) {
                assert_eq!(tree.locate(p), again.locate(p), "counts are saved by a leaf's number");
                assert_eq!(tree.leaf_cell(tree.locate(p)), again.leaf_cell(again.locate(p)));
            }
            assert_eq!(text, serde_json::to_string(&again).unwrap());
        }
    }

    #[test]
    fn refuses_a_broken_tree() {
        for text in [r#"{"x_axis":[1,0],"preorder":[]}"#, r#"{"x_axis":[1,0],"preorder":[3,-1,-1]}"#] {
            assert!(serde_json::from_str::<Partition>(text).is_err(), "{text}");
        }
    }
}
