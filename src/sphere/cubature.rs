//! Adaptive cubature over the leaves of a partition.

use super::along::within;
use super::breaks::Breaks;
use super::chart::{Chart, Point, Shape};
use super::genz_malik::{NODES, Rule};
use super::partition::{Cell, Partition, partition_points};
use crate::bsdf::Direction;

/// A place where the integrand is known to be at least this large.
#[derive(Clone, Copy, Debug)]
pub struct Marker {
    /// Where.
    pub at: Point,
    /// How far around it, in units of the square, the integrand may be as large:
    /// patches within that are held to the marker too.
    pub reach: f64,
    /// The first component there (the pdf).
    pub density: f64,
    /// The sum of the controlled components there (f·|cos θi|).
    pub value: f64,
}

impl Marker {
    /// The corners of what it reaches, on its own side.
    fn corners(&self) -> [Point; 4] {
        let [u, v] = self.at;
        let side = if u < 1.0 { 0.0 } else { 1.0 };
        let u = [u - self.reach, u + self.reach].map(|u| u.clamp(side, side + 1.0 - 1e-12));
        let v = [v - self.reach, v + self.reach].map(|v| v.clamp(0.0, 1.0));
        [[u[0], v[0]], [u[0], v[1]], [u[1], v[0]], [u[1], v[1]]]
    }
}

/// What is asked of a cubature.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Components of the integrand: the pdf, then `controlled` values, then
    /// others that are integrated along without steering the refinement.
    pub components: usize,
    /// How many components after the first steer the refinement.
    pub controlled: usize,
    /// Number of draws N that the cells' masses p with errors e will be compared with:
    /// Σ N e²/p ≤ 0.1 keeps the size of a χ² test within 8 % of nominal at 10⁻⁹.
    pub draws: u64,
    /// Largest error of the total mass, relative to it.
    pub mass: f64,
    /// Largest error of the controlled totals, relative to them.
    pub value: f64,
    /// Stop at this many evaluations of the integrand.
    pub evaluations: u64,
    /// Whether the errors of different patches are independent, as those of an
    /// integrand whose kinks or steps lie closer than patches are: then their sum
    /// is three times the root of the sum of their squares. The goal of the values
    /// may then be missed: their errors are told.
    pub independent: bool,
    /// Values may change within this cosine of the horizon, as they do where wo is so
    /// near to it: cells at the horizon are halved towards it until they are as
    /// narrow. No node of a wide one lies there, and both rules would agree.
    pub horizon: f64,
}

impl Goal {
    /// The error of a sum, of the errors of its parts: of their sum, and of the sum
    /// of their squares.
    fn sum_of(&self, sum: f64, squares: f64) -> f64 {
        if self.independent { sum.min(3.0 * squares.sqrt()) } else { sum }
    }

    /// The share of an allowed error that each of `parts` may have.
    fn share(&self, parts: usize) -> f64 {
        let parts = parts as f64;
        if self.independent { 1.0 / parts.min(3.0 * parts.sqrt()) } else { 1.0 / parts }
    }
}

/// N Σ e²/p that cells may have, see [`Goal::draws`].
const NONCENTRALITY: f64 = 0.1;

/// A cell is halved until its pilot points span this share of it on both
/// axes: then no lobe that the pilot has seen is narrower than the rule sees.
const FILL: f64 = 1.0 / 3.0;

/// Nothing that carries flux changes nearer to the horizon than this cosine.
const NEAREST_HORIZON: f64 = 1e-5;

/// The same for half of the points: of 8 even ones, half lie in so little once in
/// a hundred cells.
const CROWDED: f64 = 1.0 / 30.0;

/// Fewer pilot points than this say nothing of a lobe's width.
const TELLING: usize = 8;

/// Cells are halved at most so often; 2⁻⁵⁰ of a square is far below the
/// narrowest lobe that f64 holds.
const DEEPEST: u32 = 100;

/// Splits that a disagreement between pilot counts and mass may cause in a
/// row: each is only a suspicion, and a wrong sampler would go on for ever.
const SUSPICION: u32 = 6;

/// Integrals of each component over each leaf.
#[derive(Clone, Debug)]
pub struct LeafIntegrals {
    /// Number of components.
    pub components: usize,
    /// `values[leaf * components + c]`.
    pub values: Vec<f64>,
    /// Estimates of the absolute errors, likewise.
    pub errors: Vec<f64>,
    /// Estimates of the errors of the totals, per component.
    pub total_errors: Vec<f64>,
    /// The largest value met at any node, per component.
    pub largest: Vec<f64>,
    /// Directions that were evaluated.
    pub evaluations: u64,
    /// Whether the goals were reached.
    pub converged: bool,
    /// The cells that the rule was applied to, within which the integrand is
    /// smooth as far as it could tell.
    pub patches: Vec<Cell>,
}

impl LeafIntegrals {
    /// The total of a component and its error estimate.
    pub fn total(&self, component: usize) -> (f64, f64) {
        let total = self.values.iter().skip(component).step_by(self.components).sum();
        (total, self.total_errors[component])
    }
}

/// One cell of the cubature.
pub(super) struct Patch {
    leaf: u32,
    pub(super) cell: Cell,
    depth: u32,
    suspicion: u32,
    axis: u8,
    pilot: Vec<Point>,
    /// Numbers of the markers that reach it.
    markers: Vec<u32>,
    /// Largest pdf, and largest sum of controlled values, at its nodes.
    seen: [f64; 2],
    /// The same of its markers.
    marked: [f64; 2],
}

impl Patch {
    fn look_at(&mut self, markers: &[Marker]) {
        self.marked = self.markers.iter().fold([0.0; 2], |most, m| {
            let Marker { density, value, .. } = markers[*m as usize];
            [most[0].max(density), most[1].max(value)]
        });
    }
}

/// Integrates `f` over each leaf of `partition`: Genz and Malik's rule of
/// degree 7 with its embedded degree 5, halving patches where the rules
/// differ, where pilot points or markers say that the rule may have missed a
/// lobe, and where the pilot's counts disagree with the mass.
///
/// An error-driven rule alone would report zero with certainty where all its
/// nodes miss a narrow lobe; the estimates of error are not bounds, and pilot
/// and markers are what makes them trustworthy. A wrong pilot only costs
/// evaluations.
///
/// `f` gets directions and fills a row of `components` values for each.
pub fn integrate<E>(
    partition: &Partition,
    pilot: &[Point],
    markers: &[Marker],
    goal: &Goal,
    f: impl FnMut(&[Direction], &mut [f64]) -> Result<(), E>,
) -> Result<LeafIntegrals, E> {
    let patches = Patches::new(None, partition, pilot, markers, goal.horizon);
    integrate_on(patches, partition, pilot.len(), markers, goal, f).map(|(integrals, _)| integrals)
}

/// The patches that a cubature ended with, from where that of another function goes on.
pub struct Patches(Vec<Patch>);

impl Patches {
    /// The leaves of `partition`, graded towards the pilot points and the horizon; of a
    /// function with jumps cut along the cells of `breaks`, where they are those of the
    /// partition's chart.
    pub fn new(
        breaks: Option<&Breaks>,
        partition: &Partition,
        pilot: &[Point],
        markers: &[Marker],
        horizon: f64,
    ) -> Self {
        let cells = breaks.filter(|b| b.chart() == *partition.chart()).map_or(&[][..], Breaks::cells);
        Self(first_patches(partition, cells, pilot, markers, horizon))
    }

    /// Points of the pilot by leaf, of which there are `leaves`.
    pub fn pilot(&self, leaves: usize) -> Vec<u64> {
        let mut found = vec![0; leaves];
        self.0.iter().for_each(|patch| found[patch.leaf as usize] += patch.pilot.len() as u64);
        found
    }

    /// The same, whatever the pilot found: its counts say nothing of the next function.
    pub fn without_pilot(mut self) -> Self {
        self.0.iter_mut().for_each(|patch| patch.pilot.clear());
        self
    }
}

/// As [`integrate`], from `patches` on, which hold the points of a pilot of `pilot_size`
/// and the numbers of `markers`; with the patches that it ends with.
pub fn integrate_on<E>(
    patches: Patches,
    partition: &Partition,
    pilot_size: usize,
    markers: &[Marker],
    goal: &Goal,
    mut f: impl FnMut(&[Direction], &mut [f64]) -> Result<(), E>,
) -> Result<(LeafIntegrals, Patches), E> {
    let Patches(mut todo) = patches;
    todo.iter_mut().for_each(|patch| patch.seen = [0.0; 2]);
    let mut done: Vec<Patch> = Vec::new();
    // Values and errors of `done`, `components` each.
    let (mut values, mut errors): (Vec<f64>, Vec<f64>) = Default::default();
    let mut largest = vec![0.0; goal.components];
    let mut evaluations = 0;
    let pilot_size = pilot_size as f64;
    loop {
        evaluations += (todo.len() * NODES) as u64;
        evaluate(partition, &mut todo, goal, &mut f, &mut values, &mut errors, &mut largest)?;
        todo.iter_mut().for_each(|patch| patch.look_at(markers));
        done.append(&mut todo);
        let mut split = to_split(&done, &values, &errors, partition, goal, pilot_size);
        if 2 * evaluations >= goal.evaluations {
            // The rest is for what must be reached.
            split.iter_mut().filter(|s| **s == Split::Wanted).for_each(|s| *s = Split::No);
        }
        let converged = !split.contains(&Split::Needed);
        if !split.iter().any(|s| *s != Split::No) || evaluations >= goal.evaluations {
            let mut result = LeafIntegrals {
                components: goal.components,
                values: vec![0.0; partition.len() * goal.components],
                errors: vec![0.0; partition.len() * goal.components],
                total_errors: vec![0.0; goal.components],
                largest,
                evaluations,
                converged,
                patches: done.iter().map(|patch| patch.cell).collect(),
            };
            let mut squares = vec![0.0; result.errors.len()];
            for (k, patch) in done.iter().enumerate() {
                let (from, to) = (k * goal.components, patch.leaf as usize * goal.components);
                for c in 0..goal.components {
                    result.values[to + c] += values[from + c];
                    result.errors[to + c] += errors[from + c];
                    squares[to + c] += errors[from + c] * errors[from + c];
                }
            }
            for c in 0..goal.components {
                let sum = |v: &[f64]| v.iter().skip(c).step_by(goal.components).sum();
                result.total_errors[c] = goal.sum_of(sum(&result.errors), sum(&squares));
            }
            for (error, squares) in result.errors.iter_mut().zip(squares) {
                *error = goal.sum_of(*error, squares);
            }
            return Ok((result, Patches(done)));
        }
        // Patches that stay move forward; the others are halved.
        let mut kept = 0;
        let mut stay = Vec::with_capacity(done.len());
        for (k, patch) in done.drain(..).enumerate() {
            if split[k] != Split::No {
                let suspicion = u32::from(split[k] == Split::Suspected);
                todo.extend(halve(Patch { suspicion: patch.suspicion + suspicion, ..patch }, markers));
                continue;
            }
            let (from, to) = (k * goal.components, kept * goal.components);
            values.copy_within(from..from + goal.components, to);
            errors.copy_within(from..from + goal.components, to);
            kept += 1;
            stay.push(patch);
        }
        done = stay;
        values.truncate(kept * goal.components);
        errors.truncate(kept * goal.components);
    }
}

/// The leaves, cut along the edges of `cells` and graded towards their pilot
/// points.
fn first_patches(
    partition: &Partition,
    cells: &[Cell],
    pilot: &[Point],
    markers: &[Marker],
    horizon: f64,
) -> Vec<Patch> {
    let mut of_leaf: Vec<Patch> = (0..partition.len())
        .map(|leaf| Patch {
            leaf: leaf as u32,
            cell: partition.leaf_cell(leaf),
            depth: 0,
            suspicion: 0,
            axis: 0,
            pilot: Vec::new(),
            markers: Vec::new(),
            seen: [0.0; 2],
            marked: [0.0; 2],
        })
        .collect();
    let mut leaves = Vec::new();
    let count = |leaves: &[u32]| {
        let mut counts = vec![0; partition.len()];
        leaves.iter().for_each(|leaf| counts[*leaf as usize] += 1);
        counts
    };
    partition.locate_all(pilot, &mut leaves);
    for (of_leaf, points) in of_leaf.iter_mut().zip(count(&leaves)) {
        of_leaf.pilot.reserve(points);
    }
    for (p, leaf) in pilot.iter().zip(&leaves) {
        of_leaf[*leaf as usize].pilot.push(*p);
    }
    // Most lie in one leaf with all that they reach.
    let places: Vec<Point> = markers.iter().map(|m| m.at).collect();
    partition.locate_all(&places, &mut leaves);
    for (of_leaf, markers) in of_leaf.iter_mut().zip(count(&leaves)) {
        of_leaf.markers.reserve(markers);
    }
    let mut across: Vec<u32> = Vec::new();
    for (k, (marker, leaf)) in markers.iter().zip(&leaves).enumerate() {
        let of_leaf = &mut of_leaf[*leaf as usize];
        if (0..2).all(|axis| of_leaf.cell.holds(axis, marker.at[axis], marker.reach)) {
            of_leaf.markers.push(k as u32);
        } else {
            across.push(k as u32);
        }
    }
    let corners: Vec<Point> = across.iter().flat_map(|m| markers[*m as usize].corners()).collect();
    partition.locate_all(&corners, &mut leaves);
    for (marker, leaves) in across.iter().zip(leaves.as_chunks_mut::<4>().0) {
        leaves.sort_unstable();
        for (k, leaf) in leaves.iter().enumerate() {
            if k == 0 || *leaf != leaves[k - 1] {
                of_leaf[*leaf as usize].markers.push(*marker);
            }
        }
    }
    let mut graded = Vec::with_capacity(of_leaf.len());
    let mut open = if cells.is_empty() { of_leaf } else { within(partition, cells, of_leaf, markers) };
    while let Some(mut patch) = open.pop() {
        let axis = unfilled_axis(&patch).or_else(|| axis_to_horizon(partition.chart(), &patch.cell, horizon));
        match axis {
            Some(axis) if patch.depth < DEEPEST => {
                patch.axis = axis;
                open.extend(halve(patch, markers));
            }
            _ => graded.push(patch),
        }
    }
    graded
}

/// The axis that leads to the horizon, where a cell that lies at it is wider than
/// the cosine `horizon`. Other charts than that of equal area are those of tables.
fn axis_to_horizon(chart: &Chart, cell: &Cell, horizon: f64) -> Option<u8> {
    if chart.shape() != Shape::EqualArea {
        return None;
    }
    // |cos θ| = 1 − r², and r = 1 is half of a square's side off its middle.
    let width = 0.25 * horizon.max(NEAREST_HORIZON);
    let lies_at = |axis: usize| cell.lo[axis].fract() == 0.0 || cell.hi[axis].fract() == 0.0;
    (0..2).find(|axis| horizon > 0.0 && lies_at(*axis) && cell.width(*axis) > width).map(|axis| axis as u8)
}

/// The axis on which the pilot points span the least share of the patch, if
/// that is too little; so too if half of them do, as at the end of a long cell
/// that a few others fill.
fn unfilled_axis(patch: &Patch) -> Option<u8> {
    let points = patch.pilot.len();
    if points < TELLING {
        return None;
    }
    let least = |spans: [f64; 2], fill: f64| {
        let axis = usize::from(spans[1] < spans[0]);
        (spans[axis] < fill).then_some(axis as u8)
    };
    let whole = [0, 1].map(|axis| {
        let ends = patch.pilot.iter().map(|p| (p[axis], p[axis]));
        let (lo, hi) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        (hi - lo) / patch.cell.width(axis)
    });
    least(whole, FILL).or_else(|| least([0, 1].map(|axis| crowd(patch, axis)), CROWDED))
}

/// The shortest part of an axis that holds half of the pilot points; infinite where it
/// is surely not shorter than [`CROWDED`].
fn crowd(patch: &Patch, axis: usize) -> f64 {
    // What is no longer than a bin lies in one or two neighbours.
    const BINS: usize = 1 + (1.0 / CROWDED) as usize;
    let (half, width) = (patch.pilot.len().div_ceil(2), patch.cell.width(axis));
    let mut bins = [0usize; BINS];
    let per_bin = 1.0 / (width * CROWDED);
    for p in &patch.pilot {
        bins[((p[axis] - patch.cell.lo[axis]) * per_bin) as usize % BINS] += 1;
    }
    if bins.windows(2).all(|pair| pair[0] + pair[1] < half) {
        return f64::INFINITY;
    }
    let mut at: Vec<f64> = patch.pilot.iter().map(|p| p[axis]).collect();
    at.sort_unstable_by(f64::total_cmp);
    let spans = at.iter().zip(&at[half - 1..]).map(|(a, b)| b - a);
    spans.fold(f64::INFINITY, f64::min) / width
}

/// Both halves of a patch across its axis, one deeper.
fn halve(patch: Patch, markers: &[Marker]) -> [Patch; 2] {
    let axis = usize::from(patch.axis);
    let at = patch.cell.middle(axis);
    cut(Patch { depth: patch.depth + 1, ..patch }, markers, axis, at)
}

/// Both parts of a patch, cut at `at` across `axis`.
pub(super) fn cut(patch: Patch, markers: &[Marker], axis: usize, at: f64) -> [Patch; 2] {
    // The left part keeps the memory.
    let mut left_pilot = patch.pilot;
    let below = partition_points(&mut left_pilot, |p| p[axis] < at);
    let right_pilot = left_pilot.split_off(below);
    let mut left_markers = patch.markers;
    let ends = |k: u32| {
        let Marker { at, reach, .. } = markers[k as usize];
        [at[axis] - reach, at[axis] + reach]
    };
    let right_markers = left_markers.iter().copied().filter(|k| ends(*k)[1] >= at).collect();
    left_markers.retain(|k| ends(*k)[0] < at);
    let [left, right] = patch.cell.split(axis, at);
    let half = |cell, pilot, markers| Patch {
        leaf: patch.leaf,
        cell,
        depth: patch.depth,
        suspicion: patch.suspicion,
        axis: 1 - axis as u8,
        pilot,
        markers,
        seen: [0.0; 2],
        marked: [0.0; 2],
    };
    [half(left, left_pilot, left_markers), half(right, right_pilot, right_markers)]
}

/// Applies the rule to each patch and appends its values and errors.
fn evaluate<E>(
    partition: &Partition,
    todo: &mut [Patch],
    goal: &Goal,
    f: &mut impl FnMut(&[Direction], &mut [f64]) -> Result<(), E>,
    values: &mut Vec<f64>,
    errors: &mut Vec<f64>,
    largest: &mut [f64],
) -> Result<(), E> {
    let rule = Rule::new();
    let chart = partition.chart();
    let (mut points, mut directions) = (Vec::new(), Vec::new());
    let mut rows = Vec::new();
    // 256 patches are 4352 directions: enough for any transport.
    for patches in todo.chunks_mut(256) {
        points.clear();
        for patch in patches.iter() {
            points.extend(rule.points().iter().map(|&[s, t]| patch.cell.at(s, t)));
        }
        directions.clear();
        chart.to_directions(&points, &mut directions);
        rows.clear();
        rows.resize(directions.len() * goal.components, 0.0);
        f(&directions, &mut rows)?;
        let nodes = rows.chunks_exact(NODES * goal.components).zip(directions.chunks_exact(NODES));
        for (patch, (rows, directions)) in patches.iter_mut().zip(nodes) {
            // What the chart's measure adds to the integrand; 1 on one of equal area.
            let mut stretch = [1.0; NODES];
            stretch.iter_mut().zip(directions).for_each(|(s, d)| *s = chart.stretch(*d));
            let unit = chart.unit() * patch.cell.area();
            for c in 0..goal.components {
                let node = |k: usize| rows[k * goal.components + c];
                let (value, error) = rule.apply(|k| node(k) * stretch[k]);
                values.push(value * unit);
                errors.push(error * unit);
                let top = (0..NODES).map(node).fold(0.0, f64::max);
                largest[c] = largest[c].max(top);
            }
            let steering = |k: usize| {
                let row = &rows[k * goal.components..][..goal.components];
                [row[0], row[1..1 + goal.controlled].iter().sum::<f64>()]
            };
            let longer = u8::from(patch.cell.width(1) > patch.cell.width(0));
            patch.axis = rule
                .rougher_axis(|k| steering(k)[0] * stretch[k], |k| steering(k)[1] * stretch[k])
                .unwrap_or(longer);
            for k in 0..NODES {
                let s = steering(k);
                patch.seen = [patch.seen[0].max(s[0]), patch.seen[1].max(s[1])];
            }
        }
    }
    Ok(())
}

/// What becomes of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Split {
    /// It stays.
    No,
    /// The pilot found other than the rule says: worth a look, but a wrong pilot
    /// must not keep the cubature from its goals.
    Suspected,
    /// A goal is not reached with it that may be missed at the cap of evaluations.
    Wanted,
    /// A goal is not reached with it.
    Needed,
}

/// Which patches are to be halved.
fn to_split(
    patches: &[Patch],
    values: &[f64],
    errors: &[f64],
    partition: &Partition,
    goal: &Goal,
    pilot_size: f64,
) -> Vec<Split> {
    let leaves = partition.len();
    let n = goal.components;
    let steering = 1 + goal.controlled;
    let mut total = vec![0.0; steering];
    // Sums of errors, and of their squares.
    let mut total_error = vec![(0.0, 0.0); steering];
    let mut mass = vec![0.0; leaves];
    let mut mass_error = vec![(0.0, 0.0); leaves];
    let add = |sums: &mut (f64, f64), error: f64| *sums = (sums.0 + error, sums.1 + error * error);
    for (k, patch) in patches.iter().enumerate() {
        for c in 0..steering {
            total[c] += values[k * n + c];
            add(&mut total_error[c], errors[k * n + c]);
        }
        mass[patch.leaf as usize] += values[k * n];
        add(&mut mass_error[patch.leaf as usize], errors[k * n]);
    }
    let combined = |sums: Vec<(f64, f64)>| -> Vec<f64> {
        sums.iter().map(|(sum, squares)| goal.sum_of(*sum, *squares)).collect()
    };
    let (total_error, mass_error) = (combined(total_error), combined(mass_error));
    // An error below rounding of the whole cannot be reduced.
    let allowed = |c: usize| {
        let relative = if c == 0 { goal.mass } else { goal.value };
        (relative * total[c].abs()).max(1e-14)
    };
    let cell_term = |leaf: usize| {
        let floor = 1e-3 / goal.draws as f64;
        goal.draws as f64 * mass_error[leaf] / mass[leaf].max(floor)
    };
    let cell_sum: f64 = (0..leaves).map(|l| cell_term(l) * mass_error[l]).sum();
    let share = goal.share(patches.len());
    patches
        .iter()
        .enumerate()
        .map(|(k, patch)| {
            if patch.depth >= DEEPEST {
                return Split::No;
            }
            let error = &errors[k * n..];
            let by_cell =
                cell_sum > NONCENTRALITY && cell_term(patch.leaf as usize) * error[0] > NONCENTRALITY * share;
            let off = |c: usize| total_error[c] > allowed(c) && error[c] > allowed(c) * share;
            let (by_mass, by_value) = (off(0), (1..steering).any(off));
            let by_marker = (0..2).any(|k| {
                let missed = patch.marked[k] > 3.0 * patch.seen[k];
                let counts = |allowed| patch.marked[k] * partition.chart().solid_angle(&patch.cell) > allowed;
                missed && counts(if k == 0 { allowed(0) } else { (1..steering).map(allowed).sum() })
            });
            let expected = values[k * n] * pilot_size;
            let found = patch.pilot.len() as f64;
            let by_pilot = patch.suspicion < SUSPICION
                && (found - expected).abs() > 5.0 * found.max(expected).max(0.0).sqrt() + 5.0;
            if by_cell || by_mass || by_marker || by_value && !goal.independent {
                Split::Needed
            } else if by_value {
                Split::Wanted
            } else if by_pilot {
                Split::Suspected
            } else {
                Split::No
            }
        })
        .collect()
}

#[cfg(test)]
#[path = "cubature_tests.rs"]
mod tests;
