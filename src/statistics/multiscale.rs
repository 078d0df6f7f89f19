//! Goodness of fit on a binary tree of cells, at every scale.
//!
//! Given a node's total, its left child's count is binomial and independent of every other such
//! split, so z = (n_L − n π)/√(n π (1−π)) with π = p_L/(p_L+p_R) are uncorrelated with unit
//! variance, and sums of z² are χ²: a smooth test in the Haar wavelet basis that also says where.
//! The tree comes as plain arrays; what its cells are is the caller's business.

use thiserror::Error;

/// Smallest expected count of a cell, at which Pearson's tails are within 20 % of nominal to 1e-5.
pub const MIN_EXPECTED: f64 = 20.0;

/// Largest relative difference between a node's mass and the sum of its children's.
const ADDITIVE: f64 = 1e-6;

/// Why arrays are not a tree.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TreeError {
    /// The slices differ in length, or are empty.
    #[error("nodes, masses and counts must have the same length, at least one")]
    Length,
    /// Children must come after their parent, and each only once.
    #[error("node {0}: its children must be two later nodes that no other node has")]
    Children(usize),
    /// A mass that is negative, NaN, infinite, or not the sum of the children's.
    #[error("node {0}: its mass must be finite, not negative and the sum of its children's")]
    Mass(usize),
    /// A count that is not the sum of the children's.
    #[error("node {0}: its count must be the sum of its children's")]
    Count(usize),
}

/// A validated binary tree: node 0 is the root.
#[derive(Clone, Copy, Debug)]
pub struct Tree<'a> {
    children: &'a [Option<(usize, usize)>],
    mass: &'a [f64],
    counts: &'a [u64],
}

impl<'a> Tree<'a> {
    /// `children[v]` are the indices of v's left and right child (after v), or none for a leaf;
    /// `mass[v]` is ∫pdf over it; `counts[v]` the number of samples in it.
    pub fn new(
        children: &'a [Option<(usize, usize)>],
        mass: &'a [f64],
        counts: &'a [u64],
    ) -> Result<Self, TreeError> {
        let n = children.len();
        if n == 0 || mass.len() != n || counts.len() != n {
            return Err(TreeError::Length);
        }
        let mut taken = vec![false; n];
        for (v, pair) in children.iter().enumerate() {
            if !(mass[v] >= 0.0 && mass[v] < f64::INFINITY) {
                return Err(TreeError::Mass(v));
            }
            let Some((l, r)) = *pair else { continue };
            if l <= v || r <= v || l >= n || r >= n || l == r || taken[l] || taken[r] {
                return Err(TreeError::Children(v));
            }
            (taken[l], taken[r]) = (true, true);
            let gap = (mass[l] + mass[r] - mass[v]).abs();
            if gap.is_nan() || gap > ADDITIVE * mass[v] {
                return Err(TreeError::Mass(v));
            }
            if counts[l].checked_add(counts[r]) != Some(counts[v]) {
                return Err(TreeError::Count(v));
            }
        }
        Ok(Tree { children, mass, counts })
    }

    /// Pools the tree for a test of shape: expected counts add to the samples it holds.
    pub fn pool_shape(&self, min_expected: f64) -> Pooled {
        let scale = if self.mass[0] > 0.0 { self.counts[0] as f64 / self.mass[0] } else { 0.0 };
        self.pool(scale, min_expected)
    }

    /// Pools the tree with expected count = `scale` × mass: the number of draws, if the masses are
    /// probabilities. What is left out of the tree (no sample, discrete lobes) is the caller's.
    pub fn pool(&self, scale: f64, min_expected: f64) -> Pooled {
        let mut pooled = Pooled { nodes: Vec::new() };
        pooled.reduce(self, scale, min_expected, 0, 0);
        pooled
    }
}

/// A node of the pooled tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The node of the original tree it stands for.
    pub node: usize,
    /// Number of splits above it.
    pub depth: u32,
    /// Children in the pooled tree.
    pub children: Option<(usize, usize)>,
    /// Expected count.
    pub expected: f64,
    /// Samples found.
    pub observed: u64,
    /// Original nodes too light to stand alone, counted in with this cell though they lie beside
    /// it. Listed at the leaf that took them; counted in its ancestors too.
    pub absorbed: Vec<usize>,
}

/// A tree in which both sides of every split expect enough samples.
///
/// A split with one light side is no split: the light side's mass and samples are counted in with
/// the lighter cells of the heavy side, where samples that do not belong there show most, and the
/// heavy side stays resolved, however deep in otherwise empty cells it lies. Which splits are
/// used depends on masses and total only, never on where the samples fell, so that the statistics
/// keep their distributions.
#[derive(Clone, Debug, PartialEq)]
pub struct Pooled {
    /// Node 0 is the root; children follow their parent.
    pub nodes: Vec<Cell>,
}

impl Pooled {
    fn reduce(&mut self, tree: &Tree, scale: f64, least: f64, mut v: usize, depth: u32) -> usize {
        let mut light = Vec::new();
        let split = loop {
            let Some((l, r)) = tree.children[v] else { break None };
            match (scale * tree.mass[l] >= least, scale * tree.mass[r] >= least) {
                (true, true) => break Some((l, r)),
                (false, false) => break None,
                (true, false) => (v, _) = (l, light.push(r)),
                (false, true) => (v, _) = (r, light.push(l)),
            }
        };
        let index = self.nodes.len();
        self.nodes.push(Cell {
            node: v,
            depth,
            children: None,
            expected: scale * tree.mass[v],
            observed: tree.counts[v],
            absorbed: Vec::new(),
        });
        if let Some((l, r)) = split {
            let left = self.reduce(tree, scale, least, l, depth + 1);
            let right = self.reduce(tree, scale, least, r, depth + 1);
            self.nodes[index].children = Some((left, right));
        }
        for w in light {
            self.absorb(index, w, scale * tree.mass[w], tree.counts[w]);
        }
        index
    }

    fn absorb(&mut self, mut at: usize, node: usize, expected: f64, observed: u64) {
        loop {
            self.nodes[at].expected += expected;
            self.nodes[at].observed += observed;
            let Some((l, r)) = self.nodes[at].children else { break };
            at = if self.nodes[l].expected <= self.nodes[r].expected { l } else { r };
        }
        self.nodes[at].absorbed.push(node);
    }

    /// Number of splits on the longest path.
    pub fn depth(&self) -> u32 {
        self.nodes.iter().map(|cell| cell.depth).max().unwrap_or(0)
    }

    /// (observed, expected) of the given nodes, for [`pearson`].
    pub fn counts(&self, cut: &[usize]) -> Vec<(u64, f64)> {
        cut.iter().map(|&v| (self.nodes[v].observed, self.nodes[v].expected)).collect()
    }

    /// The standardised left count of every split, in node order. A node without samples says
    /// nothing and is left out.
    pub fn haar(&self) -> Vec<Haar> {
        let split = |cell: &Cell| {
            let (l, r) = cell.children?;
            let share = self.nodes[l].expected / (self.nodes[l].expected + self.nodes[r].expected);
            let n = cell.observed as f64;
            let z = (self.nodes[l].observed as f64 - n * share) / (n * share * (1.0 - share)).sqrt();
            (n > 0.0).then_some(Haar { node: cell.node, left: l, right: r, depth: cell.depth, z })
        };
        self.nodes.iter().filter_map(split).collect()
    }
}

/// Indices of the pooled nodes that make up the tree cut at `depth`: nodes at that depth and
/// shallower leaves, in tree order. Every sample is in exactly one of them.
pub fn level_cut(tree: &Pooled, depth: u32) -> Vec<usize> {
    let in_cut = |cell: &Cell| cell.depth == depth || (cell.depth < depth && cell.children.is_none());
    (0..tree.nodes.len()).filter(|&v| in_cut(&tree.nodes[v])).collect()
}

/// Pearson's X² = Σ (O − E)²/E and its degrees of freedom, cells − 1.
///
/// For expected counts that add to the observed ones. A cell with E = 0 makes X² infinite if it
/// holds a sample, and otherwise does not count.
pub fn pearson(cells: &[(u64, f64)]) -> (f64, f64) {
    let (mut x2, mut used) = (0.0, 0u32);
    for &(observed, expected) in cells {
        if expected == 0.0 {
            x2 += if observed > 0 { f64::INFINITY } else { 0.0 };
            continue;
        }
        let difference = observed as f64 - expected;
        x2 += difference * difference / expected;
        used += 1;
    }
    (x2, f64::from(used.saturating_sub(1)))
}

/// One split of the pooled tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haar {
    /// The split node in the original tree.
    pub node: usize,
    /// Its left child in the pooled tree.
    pub left: usize,
    /// Its right child in the pooled tree.
    pub right: usize,
    /// Its depth in the pooled tree.
    pub depth: u32,
    /// Standardised excess on the left; mean 0 and variance 1 under the null.
    pub z: f64,
}

/// Σz² of the splits of each depth with their number: independent χ² under the null.
pub fn haar_levels(splits: &[Haar]) -> Vec<(f64, f64)> {
    let levels = splits.iter().map(|s| s.depth as usize + 1).max().unwrap_or(0);
    let mut sums = vec![(0.0, 0.0); levels];
    for split in splits {
        let (sum, dof) = &mut sums[split.depth as usize];
        *sum += split.z * split.z;
        *dof += 1.0;
    }
    sums
}

/// The split with the largest |z|. Its two-sided normal p must be multiplied by their number.
pub fn haar_largest(splits: &[Haar]) -> Option<Haar> {
    splits.iter().copied().max_by(|a, b| a.z.abs().total_cmp(&b.z.abs()))
}

#[cfg(test)]
#[path = "multiscale_tests.rs"]
mod tests;
