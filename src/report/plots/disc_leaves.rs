//! What is drawn of each cell, and which part of the disc is worth a picture.

use super::disc_frame::Window;
use crate::evidence::Evidence;
use crate::sphere::{Partition, Point};

/// Residuals are clipped here, in standard deviations.
pub const CLIP: f64 = 5.0;

/// A leaf with fewer expected counts is not judged by its residual.
pub const FEWEST: f64 = 5.0;

/// A window holds this share of the mass, and is drawn if its half-width is
/// below [`ZOOM_BELOW`].
pub const SHARE: f64 = 0.98;
pub const ZOOM_BELOW: f64 = 0.25;

/// Per leaf, what is drawn.
pub struct Leaves {
    /// Samples per steradian and draw.
    pub observed: Option<Vec<f64>>,
    /// Mass per steradian.
    pub expected: Option<Vec<f64>>,
    /// (O − E)/√E; NaN where too little is expected.
    pub residual: Option<Vec<f64>>,
    /// Share of samples and of pdf.
    pub shares: Vec<(f64, f64)>,
}

impl Leaves {
    pub fn of(evidence: &Evidence, partition: &Partition) -> Option<Self> {
        let integrals = evidence.integrals.as_ref()?;
        let draws = evidence.draws.first().filter(|d| d.samples > 0);
        let fits =
            integrals.pdf.len() == partition.len() && draws.is_none_or(|d| d.counts.len() == partition.len());
        if !fits {
            return None;
        }
        let steradians = |leaf: usize| partition.chart().solid_angle(&partition.leaf_cell(leaf));
        let per_leaf = |of: &dyn Fn(usize) -> f64| (0..partition.len()).map(of).collect::<Vec<f64>>();
        let n = draws.map_or(0.0, |d| d.samples as f64);
        let share = |leaf: usize| draws.map_or(0.0, |d| d.counts[leaf] as f64 / n);
        let has_pdf = evidence.description.has.pdf;
        let mass = |leaf: usize| if has_pdf { integrals.pdf[leaf].max(0.0) } else { 0.0 };
        Some(Self {
            observed: draws.map(|_| per_leaf(&|leaf| share(leaf) / steradians(leaf))),
            expected: has_pdf.then(|| per_leaf(&|leaf| mass(leaf) / steradians(leaf))),
            residual: (has_pdf && n > 0.0)
                .then(|| per_leaf(&|leaf| residual(n * share(leaf), n * mass(leaf)))),
            shares: (0..partition.len()).map(|leaf| (share(leaf), mass(leaf))).collect(),
        })
    }
}

/// Pearson's residual. Where fewer than [`FEWEST`] are expected it is NaN,
/// unless so many came that no such expectation explains them.
pub fn residual(observed: f64, expected: f64) -> f64 {
    if expected >= FEWEST {
        return (observed - expected) / expected.sqrt();
    }
    let surplus = (observed - expected) / expected.max(1.0).sqrt();
    if surplus >= CLIP { surplus } else { f64::NAN }
}

/// Whether a hemisphere has any count or mass.
pub fn is_met(partition: &Partition, leaves: &Leaves, front: bool) -> bool {
    let side = (0..partition.len()).filter(|leaf| partition.leaf_cell(*leaf).is_front() == front);
    side.map(|leaf| leaves.shares[leaf]).any(|(observed, expected)| observed > 0.0 || expected > 0.0)
}

/// The square that holds [`SHARE`] of a hemisphere's samples and pdf, if it is
/// small; else the whole disc. A cell's mass is taken to lie where the cell is
/// nearest to the middle: the outer cells of a lobe are large, and nearly empty
/// but for their inner edge.
pub fn window(partition: &Partition, leaves: &Leaves, front: bool) -> Window {
    const PARTS: usize = 8;
    let chart = partition.chart();
    let mut cells: Vec<(Vec<Point>, f64)> = Vec::new();
    for leaf in 0..partition.len() {
        let cell = partition.leaf_cell(leaf);
        let weight = leaves.shares[leaf].0 + leaves.shares[leaf].1;
        if cell.is_front() == front && weight > 0.0 {
            let part = |i: usize| i as f64 / PARTS as f64;
            let grid = (0..(PARTS + 1) * (PARTS + 1)).map(|k| (k % (PARTS + 1), k / (PARTS + 1)));
            let place = |(i, j)| {
                // The corner of a front cell at the squares' seam is a back direction.
                let [u, v] = cell.at(part(i), part(j));
                let u = if front { u.min(1.0 - f64::EPSILON) } else { u };
                chart.to_disc(chart.to_direction([u, v]))
            };
            cells.push((grid.map(place).collect(), weight));
        }
    }
    let total: f64 = cells.iter().map(|c| c.1).sum();
    let quantile = |share: f64, key: &dyn Fn(&[Point]) -> f64| {
        let mut keys: Vec<(f64, f64)> = cells.iter().map(|(p, weight)| (key(p), *weight)).collect();
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        let reached = keys.iter().find(|(_, weight)| {
            sum += weight;
            sum >= share * total
        });
        reached.map_or(1.0, |k| k.0)
    };
    let middle = PARTS / 2 * (PARTS + 2);
    let centre = [0, 1].map(|k| quantile(0.5, &|p| p[middle][k]));
    let distance = |p: &Point| (p[0] - centre[0]).abs().max((p[1] - centre[1]).abs());
    let half = 1.2 * quantile(SHARE, &|p| p.iter().map(distance).fold(f64::INFINITY, f64::min));
    if half > 0.0 && half < ZOOM_BELOW { Window { centre, half } } else { Window::WHOLE }
}

/// Leaves of which a part can be seen.
pub fn in_sight(partition: &Partition, window: &Window, front: bool) -> Vec<bool> {
    const GRID: usize = 128;
    let chart = partition.chart();
    let mut seen: Vec<bool> = (0..partition.len())
        .map(|leaf| {
            let middle = chart.to_direction(partition.leaf_cell(leaf).at(0.5, 0.5));
            (middle.z > 0.0) == front && window.holds(chart.to_disc(middle))
        })
        .collect();
    for k in 0..GRID * GRID {
        let part = |i: usize| window.half * (2.0 * (i as f64 + 0.5) / GRID as f64 - 1.0);
        let at = [window.centre[0] + part(k % GRID), window.centre[1] + part(k / GRID)];
        if let Some(d) = chart.from_disc(at, front) {
            seen[partition.locate_direction(d)] = true;
        }
    }
    seen
}
