//! Densities against the draws that were counted.

use crate::bsdf::Direction;
use crate::evidence::Evidence;
use crate::statistics::noncentral;

/// Nodes of Gauss and Legendre's rule of four points on [0, 1], ½ ± ½√(3/7 ∓ 2√(6/5)/7), and
/// their weights, ¼ ± √30/72 (Abramowitz and Stegun 1964, 25.4.30). Three would do for leaves
/// of half the size.
const NODES: [f64; 4] =
    [0.069_431_844_202_973_71, 0.330_009_478_207_571_9, 0.669_990_521_792_428_1, 0.930_568_155_797_026_3];
const WEIGHTS: [f64; 4] =
    [0.173_927_422_568_726_93, 0.326_072_577_431_273_07, 0.326_072_577_431_273_07, 0.173_927_422_568_726_93];

/// Nodes of a leaf.
pub(super) const PER_LEAF: usize = NODES.len() * NODES.len();

/// A density that differs by this factor within a leaf is steep. Of an exponential the rule
/// misses 10⁻⁶ there.
const STEEP: f64 = 8.0;

/// Densities fall alike in a leaf whose ln of the steepness differs by less.
const ALIKE: f64 = 0.4;

/// Largest over least value.
fn steepness(values: &[f64]) -> f64 {
    let ends = values.iter().fold((f64::INFINITY, 0.0f64), |(a, b), p| (a.min(*p), b.max(*p)));
    ends.1 / ends.0
}

/// Counts are compared in groups of cells that expect this many, for what is local,
/// and in so many groups, for what is spread out.
const GROUP: f64 = 20.0;
const GROUPS: f64 = 48.0;

/// RMS relative error that the masses of cells may have from this coarse a rule.
const SLACK: f64 = 4e-3;

/// The draws of a case by cell, and where densities are evaluated in each.
#[derive(Clone)]
pub struct Counts {
    /// Continuous samples by leaf, of all attempts.
    pub leaves: Vec<u64>,
    /// Draws that gave none.
    pub others: u64,
    /// Draws in all.
    pub draws: u64,
    /// The subject's own masses, as its cubature found them.
    pub own: Vec<f64>,
    /// [`PER_LEAF`] directions a leaf, and the solid angle that each stands for.
    nodes: Vec<(Direction, f64)>,
    /// What the rule misses of the subject's own masses, by leaf.
    correction: Vec<f64>,
    /// [`steepness`] of the subject's own density, by leaf.
    steepness: Vec<f64>,
    /// The subject's own density at the nodes.
    values: Vec<f64>,
}

/// The subject's own density in a leaf.
pub(super) struct OwnNodes {
    /// Where it was evaluated, and the mass that each place stands for.
    pub nodes: [(Direction, f64); PER_LEAF],
    /// Whether the rule sees its mass well.
    pub seen: bool,
}

/// The rule sees a mass well that it misses by less than this.
const SEEN: f64 = 0.3;

/// Pearson's statistic of some groups.
#[derive(Clone, Copy, Debug, Default)]
struct Pearson {
    x2: f64,
    dof: f64,
}

impl Pearson {
    fn and(self, other: Self) -> Self {
        Self { x2: self.x2 + other.x2, dof: self.dof + other.dof }
    }

    fn ln_p(&self, slack: f64) -> f64 {
        if self.dof < 1.0 {
            return 0.0;
        }
        if !self.x2.is_finite() || self.x2 > 1e6 * self.dof {
            return f64::NEG_INFINITY;
        }
        noncentral::ln_sf(self.x2, self.dof, slack)
    }
}

/// Counts beside what a density predicts.
#[derive(Clone, Copy, Debug, Default)]
pub struct CountTest {
    local: Pearson,
    spread: Pearson,
    /// Noncentrality that the slack of the masses allows.
    slack: f64,
    /// Samples in leaves that were left out, and in all.
    skipped: u64,
    counted: u64,
}

impl CountTest {
    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self {
            local: self.local.and(other.local),
            spread: self.spread.and(other.spread),
            slack: self.slack + other.slack,
            skipped: self.skipped + other.skipped,
            counted: self.counted + other.counted,
        }
    }

    /// ln of the probability of counts this far off: by the smaller of two p-values,
    /// doubled.
    pub fn ln_p(&self) -> f64 {
        let smaller = self.local.ln_p(self.slack).min(self.spread.ln_p(self.slack));
        (smaller + std::f64::consts::LN_2).min(0.0)
    }

    /// ln-likelihood over what chance does to right densities.
    pub fn ln_likelihood(&self) -> f64 {
        (self.ln_p() - USUAL).min(0.0)
    }

    /// Pearson's statistic of the small groups.
    pub fn x2(&self) -> f64 {
        self.local.x2
    }

    /// Whether the density may be right: of hardly any draws it cannot be told.
    pub fn fits(&self) -> bool {
        self.local.dof >= 8.0 && 2 * self.skipped < self.counted.max(1) && self.ln_p() > FITS
    }
}

/// ln of a p-value that is nothing unusual.
const USUAL: f64 = -4.6;

/// ln of the p-value at which a density is given up.
const FITS: f64 = -9.2;

impl Counts {
    /// Of a case in which something was counted; `pdf` is the subject's own.
    pub fn of(evidence: &Evidence, pdf: impl FnOnce(&[Direction]) -> Vec<f64>) -> Option<Self> {
        let partition = evidence.partition.as_ref()?;
        let mut leaves = vec![0; partition.len()];
        let mut draws = 0;
        for attempt in &evidence.draws {
            draws += attempt.samples;
            for (to, n) in leaves.iter_mut().zip(&attempt.counts) {
                *to += n;
            }
        }
        if draws == 0 {
            return None;
        }
        let counted: u64 = leaves.iter().sum();
        let chart = partition.chart();
        let mut nodes = Vec::with_capacity(PER_LEAF * leaves.len());
        for leaf in 0..leaves.len() {
            let cell = partition.leaf_cell(leaf);
            for (s, ws) in NODES.iter().zip(WEIGHTS) {
                for (t, wt) in NODES.iter().zip(WEIGHTS) {
                    let wi = chart.to_direction(cell.at(*s, *t));
                    nodes.push((wi, ws * wt * cell.area() * chart.steradians(wi)));
                }
            }
        }
        let own = evidence.integrals.as_ref().map_or(Vec::new(), |i| i.pdf.clone());
        let (others, none) = (draws - counted, Vec::new);
        let mut counts =
            Self { leaves, others, draws, own, nodes, correction: none(), steepness: none(), values: none() };
        let values = pdf(&counts.directions());
        let by_rule = counts.masses_of(&values, false);
        // Densities in question have the peaks of the subject's own, or other ones.
        let correction = |(own, rule): (&f64, &f64)| {
            let ratio = own / rule;
            if (ratio - 1.0).abs() < SEEN { ratio } else { 1.0 }
        };
        counts.steepness = values.chunks_exact(PER_LEAF).map(steepness).collect();
        counts.correction = counts.own.iter().zip(&by_rule).map(correction).collect();
        counts.values = values;
        Some(counts)
    }

    /// The subject's own density in a leaf.
    pub(super) fn own_nodes(&self, leaf: usize) -> OwnNodes {
        let correction = self.correction.get(leaf).copied().unwrap_or(1.0);
        let node = |k: usize| {
            let (wi, steradians) = self.nodes[PER_LEAF * leaf + k];
            (wi, self.values[PER_LEAF * leaf + k] * steradians * correction)
        };
        let nodes: [(Direction, f64); PER_LEAF] = std::array::from_fn(node);
        let sum: f64 = nodes.iter().map(|n| n.1).sum();
        let seen = self.own.get(leaf).is_none_or(|own| (own / sum - 1.0).abs() < SEEN);
        OwnNodes { nodes, seen }
    }

    /// Where densities are evaluated.
    pub fn directions(&self) -> Vec<Direction> {
        self.nodes.iter().map(|n| n.0).collect()
    }

    /// The subject's own density there.
    pub fn density(&self) -> &[f64] {
        &self.values
    }

    /// Mass of each leaf under a density; NaN where the rule does not see it well: a
    /// border runs through the leaf (the density is NaN at some node, and not at all
    /// of them), or the density falls steeply, and not as the subject's own.
    pub fn masses(&self, mut density: impl FnMut(Direction) -> f64) -> Vec<f64> {
        let values: Vec<f64> = self.nodes.iter().map(|n| density(n.0)).collect();
        self.masses_of(&values, true)
    }

    /// As [`masses`](Self::masses), by the rule where it is steep too: for the search
    /// of a number.
    pub fn rough_masses(&self, mut density: impl FnMut(Direction) -> f64) -> Vec<f64> {
        let values: Vec<f64> = self.nodes.iter().map(|n| density(n.0)).collect();
        self.masses_of(&values, false)
    }

    /// Mass of each leaf from the density's values at [`directions`](Self::directions).
    fn masses_of(&self, values: &[f64], strict: bool) -> Vec<f64> {
        let of_leaf = |(leaf, values): (usize, &[f64])| {
            if values.iter().all(|v| v.is_nan() || *v == 0.0) {
                // Between the nodes there is something.
                let lost = strict && self.own.get(leaf).is_some_and(|m| *m > 0.0);
                return if lost { f64::NAN } else { 0.0 };
            }
            let nodes = &self.nodes[PER_LEAF * leaf..];
            let sum: f64 = values.iter().zip(nodes).map(|(p, (_, w))| p * w).sum();
            let steep = steepness(values);
            let alike = self.steepness.get(leaf).is_some_and(|own| (steep / own).ln().abs() < ALIKE);
            match self.correction.get(leaf) {
                Some(correction) if alike || !strict => sum * correction,
                _ if steep > STEEP && strict && sum * self.draws as f64 > 1.0 => f64::NAN,
                _ => sum,
            }
        };
        values.chunks_exact(PER_LEAF).enumerate().map(of_leaf).collect()
    }

    /// Compares counts with masses; `fitted` numbers were fitted to them. Leaves
    /// without a number are left out, and then the draws without a sample too.
    pub fn test(&self, masses: &[f64], fitted: usize) -> CountTest {
        let n = self.draws as f64;
        let whole = masses.iter().all(|m| m.is_finite());
        let total: f64 = masses.iter().filter(|m| m.is_finite()).sum();
        let group = |size: f64| {
            let mut groups: Vec<(f64, u64)> = Vec::new();
            let mut open = (0.0, 0);
            for (mass, count) in masses.iter().zip(&self.leaves).filter(|(m, _)| m.is_finite()) {
                open.0 += (n * mass).max(0.0);
                open.1 += count;
                if open.0 >= size {
                    groups.push(open);
                    open = (0.0, 0);
                }
            }
            let (mut expected, mut observed) = open;
            let none = n * (1.0 - total);
            if whole && none >= GROUP {
                groups.push((none, self.others));
            } else if whole {
                expected += none.max(0.0);
                observed += self.others;
            }
            let mut test = Pearson::default();
            // What is left over is too little to be compared, unless it is not.
            if expected >= GROUP {
                groups.push((expected, observed));
            } else if observed as f64 > expected + 8.0 * (expected + 1.0).sqrt() + 8.0 {
                test.x2 = (observed as f64 - expected).powi(2) / expected.max(1.0);
                test.dof = 1.0;
            }
            for (expected, observed) in &groups {
                test.x2 += (*observed as f64 - expected).powi(2) / expected;
            }
            test.dof = (test.dof + groups.len() as f64 - 1.0 - fitted as f64).max(0.0);
            if total > 1.0 + 4.0 * SLACK {
                // More than everything is no prediction.
                test.x2 += n * (total - 1.0).powi(2);
            }
            test
        };
        CountTest {
            skipped: masses.iter().zip(&self.leaves).filter(|(m, _)| m.is_nan()).map(|(_, n)| n).sum(),
            counted: self.leaves.iter().sum(),
            local: group(GROUP),
            spread: group((n * total / GROUPS).max(GROUP)),
            slack: n * SLACK * SLACK,
        }
    }
}
