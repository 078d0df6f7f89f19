//! By which powers of cosines the draws differ from pdf().
//!
//! ln(observed/pdf) = c + Σ b ln x, over the leaves of several cases, by the largest
//! Poisson likelihood: each count is weighted by the inverse of the variance that is
//! predicted for it. A leaf expects the integral of pdf eᶜ Π xᵇ by the rule of
//! [`Counts`], and no logarithm of a count is taken: neither few counts nor the size
//! of a leaf makes a bias, and an empty leaf counts as any other. Leaves are left out
//! for what pdf() is there, never for what was counted: where it is 0, and where the
//! rule misses its mass by far. χ² is of groups of leaves that expect enough.

use super::counts::{Counts, PER_LEAF};
use super::parts::{At, Parts};
use crate::bsdf::{Direction, Samples, Subject, Transport};
use crate::engine::CaseResult;
use crate::evidence::Evidence;
use crate::statistics::streams::StreamKey;

/// What powers are fitted of, as seen from wo's side.
pub const BASES: [&str; 5] = ["cos θh", "wo·h", "cos θi", "sin θh", "cos θo"];

/// Different cos θo that a fit takes: at the normal wo·h is cos θh, and of one wo its
/// own terms are constants.
pub const FEWEST_WO: usize = 4;

/// χ² groups leaves until they expect this many.
const GROUP: f64 = 10.0;

/// Steps of the fit at most; it ends where the next one is worth this much of ln L.
const STEPS: usize = 60;
const SETTLED: f64 = 1e-4;

/// Fitted numbers this many standard errors from 0 are something.
const SIGNIFICANT: f64 = 3.5;

/// A fit explains the counts that leaves a χ² per degree of freedom of 1, this much
/// more for what masses are off by, and its own standard deviation so many times.
const SLACK: f64 = 0.05;
const DEVIATIONS: f64 = 3.0;

/// Factors in code have whole exponents: so far off, or [`DEVIATIONS`].
const WHOLE: f64 = 0.1;

/// A fitted number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// The number.
    pub value: f64,
    /// Its standard error, by the Poisson variance alone.
    pub error: f64,
}

impl Fitted {
    fn differs(self) -> bool {
        self.value.abs() > SIGNIFICANT * self.error
    }

    /// Whether it may be a whole number.
    pub fn is_whole(self) -> bool {
        (self.value - self.value.round()).abs() < WHOLE.max(DEVIATIONS * self.error).min(0.3)
    }
}

/// As −1.386(4): the error in units of the last digit.
impl std::fmt::Display for Fitted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = (-self.error.log10()).ceil().clamp(0.0, 5.0) as usize;
        // 0.0096 would be ten units.
        let unit = |d: usize| (self.error * 10f64.powi(d as i32)).round();
        let digits = if unit(digits) >= 10.0 && digits > 0 { digits - 1 } else { digits };
        let text = format!("{:.digits$}({:.0})", self.value, unit(digits).max(1.0));
        f.write_str(&text.replace('-', "−"))
    }
}

/// What is free besides the exponents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// One number.
    One,
    /// A number for each wo, and then no power of cos θo.
    EachWo,
}

/// A fit.
#[derive(Clone, Debug)]
pub struct Regression {
    /// c, or c of each case.
    pub constants: Vec<Fitted>,
    /// Powers of [`BASES`]; `None` of those that were not fitted.
    pub exponents: [Option<Fitted>; 5],
    /// Pearson's statistic of groups of leaves.
    pub x2: f64,
    /// Groups less fitted numbers.
    pub dof: f64,
    numbers: Vec<f64>,
}

impl Regression {
    /// χ² per degree of freedom.
    pub fn reduced(&self) -> f64 {
        self.x2 / self.dof
    }

    /// Whether it explains the counts.
    pub fn explains(&self) -> bool {
        self.reduced() < 1.0 + SLACK + DEVIATIONS * (2.0 / self.dof).sqrt()
    }

    /// Whether it explains the counts by a factor as code has them.
    pub fn is_factor(&self) -> bool {
        self.explains() && self.exponents.iter().flatten().all(|e| e.is_whole())
    }
}

/// A leaf: its case, what was counted, and what pdf() makes expect.
struct Leaf {
    case: usize,
    count: f64,
    ln_expected: f64,
    /// Mean and covariance of ln x.
    mean: [f64; 5],
    covariance: [[f64; 5]; 5],
    /// Kept where ln x varies too much for these two to tell the integral.
    nodes: Option<Box<[Node; PER_LEAF]>>,
}

/// Variance of ln x up to which two moments do: what is left out is of the third.
const FLAT: f64 = 0.02;

/// What pdf() makes expect at a node, and the logarithms of [`BASES`].
#[derive(Clone, Copy, Default)]
struct Node {
    expected: f64,
    ln: [f64; 5],
}

impl Leaf {
    fn new(case: usize, count: u64, nodes: [Node; PER_LEAF]) -> Self {
        let expected: f64 = nodes.iter().map(|n| n.expected).sum();
        let mut mean = [0.0; 5];
        let mut covariance = [[0.0; 5]; 5];
        for node in &nodes {
            (0..5).for_each(|i| mean[i] += node.expected / expected * node.ln[i]);
        }
        for node in &nodes {
            let off: [f64; 5] = std::array::from_fn(|i| node.ln[i] - mean[i]);
            for i in 0..5 {
                (0..5).for_each(|j| covariance[i][j] += node.expected / expected * off[i] * off[j]);
            }
        }
        let flat = (0..5).all(|i| covariance[i][i] < FLAT);
        let nodes = if flat { None } else { Some(Box::new(nodes)) };
        Self { case, count: count as f64, ln_expected: expected.ln(), mean, covariance, nodes }
    }

    /// ln of what it expects with these powers, and the mean of ln x then.
    fn with(&self, b: &[f64; 5]) -> (f64, [f64; 5]) {
        let Some(nodes) = &self.nodes else {
            let shift: [f64; 5] = std::array::from_fn(|i| dot(&self.covariance[i], b));
            let ln = self.ln_expected + dot(&self.mean, b) + 0.5 * dot(&shift, b);
            return (ln, std::array::from_fn(|i| self.mean[i] + shift[i]));
        };
        let (mut sum, mut mean) = (0.0, [0.0; 5]);
        for node in nodes.iter().filter(|n| n.expected > 0.0) {
            let here = node.expected * dot(&node.ln, b).exp();
            sum += here;
            (0..5).for_each(|i| mean[i] += here * node.ln[i]);
        }
        (sum.ln(), mean.map(|m| m / sum))
    }
}

/// The leaves of several cases, in reflection.
#[derive(Default)]
pub struct Pooled {
    leaves: Vec<Leaf>,
    cos_o: Vec<f64>,
    counted: u64,
    left_out: u64,
}

impl Pooled {
    /// Of cases, whether they failed or not, with this many draws of its own of each:
    /// a run stops to draw where it has seen enough.
    pub fn of(cases: &[&CaseResult], draws: u64) -> Self {
        let mut pooled = Self::default();
        for case in cases {
            let Some(evidence) = &case.evidence else { continue };
            let subject = &*case.case.subject;
            let pdf = |wi: &[Direction]| {
                let mut out = vec![f64::NAN; wi.len()];
                // What is not returned stays NaN, and its leaf out.
                let _ = subject.pdf(evidence.wo, wi, evidence.transport, &mut out);
                out
            };
            if let Some(mut counts) = Counts::of(evidence, pdf) {
                draw(&mut counts, evidence, subject, draws);
                pooled.add(evidence.wo, &counts);
            }
        }
        pooled
    }

    /// One more case.
    pub fn add(&mut self, wo: Direction, counts: &Counts) {
        let parts = Parts::default();
        let case = self.cos_o.len();
        self.cos_o.push(wo.abs_cos_theta());
        for (leaf, count) in counts.leaves.iter().enumerate() {
            let own = counts.own_nodes(leaf);
            // The fifth node is the middle.
            if !own.nodes[0].0.same_side(wo) {
                continue;
            }
            self.counted += count;
            let node = |(wi, mass): (Direction, f64)| {
                let at = At::new(&parts, wo, wi, Transport::Radiance);
                let half = at.half()?;
                let sin_h = half.m.x.hypot(half.m.y);
                let ln = [half.m.z, half.cos_o, at.cos_i(), sin_h, at.cos_o()].map(f64::ln);
                let expected = mass * counts.draws as f64;
                let sound = ln.iter().all(|l| l.is_finite()) && expected >= 0.0 && expected.is_finite();
                sound.then_some(Node { expected, ln })
            };
            let mut nodes = [Node::default(); PER_LEAF];
            let known = own.nodes.into_iter().zip(&mut nodes).all(|(from, to)| {
                let found = node(from);
                *to = found.unwrap_or_default();
                found.is_some()
            });
            if own.seen && known && nodes.iter().any(|n| n.expected > 0.0) {
                self.leaves.push(Leaf::new(case, *count, nodes));
            } else {
                self.left_out += count;
            }
        }
    }

    /// What was drawn on wo's side.
    pub fn counted(&self) -> u64 {
        self.counted
    }

    /// Whether a case has this cos θo.
    pub(super) fn has(&self, wo: Direction) -> bool {
        self.cos_o.iter().any(|c| (c - wo.abs_cos_theta()).abs() < 1e-6)
    }

    /// Different cos θo.
    pub fn directions(&self) -> usize {
        let mut cos: Vec<f64> = self.cos_o.clone();
        cos.sort_by(f64::total_cmp);
        cos.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        cos.len()
    }

    /// The share of what was drawn on wo's side that lies in leaves that were left out.
    pub fn left_out(&self) -> f64 {
        self.left_out as f64 / self.counted.max(1) as f64
    }

    /// Fits all exponents; `None` of fewer than [`FEWEST_WO`] wo, and where two of the
    /// bases are proportional everywhere.
    pub fn fit(&self, constant: Constant) -> Option<Regression> {
        if self.directions() < FEWEST_WO {
            return None;
        }
        self.fit_of(constant, [true, true, true, true, constant == Constant::One], None)
    }

    /// Fits again without exponents that are nothing.
    pub fn pruned(&self, constant: Constant) -> Option<Regression> {
        let mut fit = self.fit(constant)?;
        for _ in 0..2 {
            let free = fit.exponents.map(|e| e.is_some_and(Fitted::differs));
            if free == fit.exponents.map(|e| e.is_some()) {
                break;
            }
            let start = fit.exponents.map(|e| e.map_or(0.0, |e| e.value));
            fit = self.fit_of(constant, free, Some((&fit.numbers, start)))?;
        }
        Some(fit)
    }

    fn fit_of(
        &self,
        constant: Constant,
        free: [bool; 5],
        start: Option<(&[f64], [f64; 5])>,
    ) -> Option<Regression> {
        let constants = if constant == Constant::One { 1 } else { self.cos_o.len() };
        let column = |leaf: &Leaf| if constant == Constant::One { 0 } else { leaf.case };
        let bases: Vec<usize> = (0..5).filter(|k| free[*k]).collect();
        let n = constants + bases.len();
        let mut numbers = vec![0.0; n];
        match start {
            Some((before, exponents)) => {
                numbers[..constants].copy_from_slice(&before[..constants]);
                bases.iter().zip(&mut numbers[constants..]).for_each(|(k, to)| *to = exponents[*k]);
            }
            None => {
                let mut sums = vec![(0.0, 0.0); constants];
                for leaf in &self.leaves {
                    let sum = &mut sums[column(leaf)];
                    sum.0 += leaf.count;
                    sum.1 += leaf.ln_expected.exp();
                }
                for (to, (count, expected)) in numbers.iter_mut().zip(sums) {
                    *to = (count.max(0.5) / expected).ln();
                }
            }
        }
        let mut state = self.score(&numbers, constants, &bases, &column);
        for _ in 0..STEPS {
            let inverse = inverted(&state.information)?;
            let step: Vec<f64> = inverse.iter().map(|row| dot(row, &state.gradient)).collect();
            if !step.iter().all(|s| s.is_finite()) {
                return None;
            }
            if dot(&step, &state.gradient) < SETTLED {
                break;
            }
            let mut shorter = 1.0;
            loop {
                let next: Vec<f64> = numbers.iter().zip(&step).map(|(a, s)| a + shorter * s).collect();
                let there = self.score(&next, constants, &bases, &column);
                if there.ln_likelihood >= state.ln_likelihood {
                    (numbers, state) = (next, there);
                    break;
                }
                shorter *= 0.5;
                if shorter < 1e-6 {
                    return None;
                }
            }
        }
        let inverse = inverted(&state.information)?;
        let fitted = |k: usize| Fitted { value: numbers[k], error: inverse[k][k].sqrt() };
        let mut exponents = [None; 5];
        bases.iter().enumerate().for_each(|(j, k)| exponents[*k] = Some(fitted(constants + j)));
        let (x2, groups) = self.pearson(&state.expected);
        let dof = groups as f64 - n as f64;
        let constants = (0..constants).map(fitted).collect();
        (dof >= 1.0).then_some(Regression { constants, exponents, x2, dof, numbers })
    }

    /// ln-likelihood of numbers, with its first derivatives and the mean of the second.
    fn score(
        &self,
        numbers: &[f64],
        constants: usize,
        bases: &[usize],
        column: &dyn Fn(&Leaf) -> usize,
    ) -> Score {
        let n = numbers.len();
        let mut score = Score {
            ln_likelihood: 0.0,
            gradient: vec![0.0; n],
            information: vec![vec![0.0; n]; n],
            expected: Vec::with_capacity(self.leaves.len()),
        };
        let mut powers = [0.0; 5];
        bases.iter().zip(&numbers[constants..]).for_each(|(k, b)| powers[*k] = *b);
        for leaf in &self.leaves {
            let c = column(leaf);
            let (ln, all) = leaf.with(&powers);
            let ln = ln + numbers[c];
            let expected = ln.exp();
            let mut mean = [0.0; 5];
            bases.iter().zip(&mut mean).for_each(|(k, to)| *to = all[*k]);
            score.expected.push(expected);
            score.ln_likelihood += leaf.count * ln - expected;
            let off = leaf.count - expected;
            score.gradient[c] += off;
            score.information[c][c] += expected;
            for i in 0..bases.len() {
                score.gradient[constants + i] += off * mean[i];
                score.information[constants + i][c] += expected * mean[i];
                for j in 0..=i {
                    score.information[constants + i][constants + j] += expected * mean[i] * mean[j];
                }
            }
        }
        for i in 0..n {
            for j in 0..i {
                score.information[j][i] = score.information[i][j];
            }
        }
        score
    }

    /// Pearson's statistic, and of how many groups.
    fn pearson(&self, expected: &[f64]) -> (f64, usize) {
        let (mut x2, mut groups) = (0.0, 0);
        for case in 0..self.cos_o.len() {
            let mut open = (0.0, 0.0);
            // Leaves follow each other as they lie in the partition.
            for (leaf, expected) in self.leaves.iter().zip(expected).filter(|(l, _)| l.case == case) {
                open.0 += expected;
                open.1 += leaf.count;
                if open.0 >= GROUP {
                    x2 += (open.1 - open.0) * (open.1 - open.0) / open.0;
                    groups += 1;
                    open = (0.0, 0.0);
                }
            }
            // What is left expects less than a group; its χ² has the right mean still.
            if open.0 > 1.0 {
                x2 += (open.1 - open.0) * (open.1 - open.0) / open.0;
                groups += 1;
            }
        }
        (x2, groups)
    }

    /// What the counts say of pdf(), in words; `None` where nothing can be fitted.
    pub fn words(&self) -> Option<String> {
        let one = self.pruned(Constant::One)?;
        let of = |fit: &Regression| {
            let wo = self.directions();
            format!("reduced χ² {} over {wo} θ of wo", rounded(fit.reduced()))
        };
        let lost = match self.left_out() {
            share if share > 0.01 => format!(", without the {:.0} % drawn where pdf() is 0", 100.0 * share),
            _ => String::new(),
        };
        let each = || self.pruned(Constant::EachWo).filter(Regression::is_factor);
        let each = if one.is_factor() { None } else { each() };
        if let Some(each) = each {
            let mut by_wo: Vec<(f64, Fitted)> =
                self.cos_o.iter().copied().zip(each.constants.iter().copied()).collect();
            by_wo.sort_by(|a, b| b.0.total_cmp(&a.0));
            let at = |k: usize| {
                let (cos, c) = by_wo[k];
                format!("{c} at {:.0}°", cos.acos().to_degrees())
            };
            let terms = match sum(None, &each.exponents) {
                none if none == "0" => "c(θo)".to_string(),
                terms => format!("c(θo) {}", signed(&terms)),
            };
            let range = format!("c from {} to {}", at(0), at(by_wo.len() - 1));
            return Some(format!("log(observed/pdf) = {terms}, {}; {range}{lost}", of(&each)));
        }
        if one.explains() {
            let constant = Some(one.constants[0]).filter(|c| c.differs());
            let terms = sum(constant, &one.exponents);
            return Some(format!("log(observed/pdf) = {terms}, {}{lost}", of(&one)));
        }
        Some(format!(
            "observed/pdf is no product of powers of {}: {}{lost}",
            BASES.join(", "),
            of(&self.fit(Constant::One)?)
        ))
    }
}

/// Counts this many new draws in place of those of the run.
fn draw(counts: &mut Counts, evidence: &Evidence, subject: &dyn Subject, draws: u64) {
    const BLOCK: u64 = 4096;
    let Some(partition) = &evidence.partition else { return };
    let (channels, d) = (evidence.description.channels.len().max(1), evidence.description.dimensions.max(1));
    let key = StreamKey::new(0)
        .with("subject", evidence.description.key(&evidence.subject))
        .with("stage", "regression");
    let key = key.with("wo", &format!("{:x} {:x}", evidence.wo.x.to_bits(), evidence.wo.z.to_bits()));
    (counts.leaves, counts.draws) = (vec![0; partition.len()], 0);
    let mut u = vec![0.0; BLOCK as usize * d];
    let mut samples = Samples::default();
    for block in 0..draws.div_ceil(BLOCK) {
        key.block(block).fill(false, &mut u);
        samples.clear(channels);
        if subject.sample(evidence.wo, &u, evidence.transport, &mut samples).is_err() {
            break;
        }
        counts.draws += BLOCK;
        for (wi, lobe) in samples.wi.iter().zip(&samples.lobe) {
            if lobe.is_valid() && !lobe.is_discrete() && wi.is_finite() {
                counts.leaves[partition.locate_direction(*wi)] += 1;
            }
        }
    }
    counts.others = counts.draws - counts.leaves.iter().sum::<u64>();
}

/// χ² by degrees of freedom: two digits.
pub fn rounded(reduced: f64) -> String {
    if reduced < 9.95 { format!("{reduced:.1}") } else { format!("{reduced:.0}") }
}

/// Terms with their signs between them, "0" for none.
fn sum(constant: Option<Fitted>, exponents: &[Option<Fitted>; 5]) -> String {
    let mut terms: Vec<String> = constant.iter().map(Fitted::to_string).collect();
    for (name, b) in BASES.iter().zip(exponents) {
        if let Some(b) = b {
            let term = format!("{b} log {name}");
            terms.push(if terms.is_empty() { term } else { signed(&term) });
        }
    }
    if terms.is_empty() { "0".into() } else { terms.join(" ") }
}

/// With a sign that stands apart.
fn signed(term: &str) -> String {
    match term.strip_prefix('−') {
        Some(rest) => format!("− {rest}"),
        None => format!("+ {term}"),
    }
}

struct Score {
    ln_likelihood: f64,
    gradient: Vec<f64>,
    information: Vec<Vec<f64>>,
    expected: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The inverse of a symmetric matrix; `None` where it is singular: a pivot that is
/// next to nothing of its diagonal.
fn inverted(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut a = matrix.to_vec();
    let mut b: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for i in 0..n {
        let pivot = a[i][i];
        if !(pivot > 1e-10 * matrix[i][i]) {
            return None;
        }
        for rows in [&mut a, &mut b] {
            rows[i].iter_mut().for_each(|v| *v /= pivot);
        }
        for k in (0..n).filter(|k| *k != i) {
            let factor = a[k][i];
            for rows in [&mut a, &mut b] {
                let from = rows[i].clone();
                rows[k].iter_mut().zip(&from).for_each(|(to, v)| *to -= factor * v);
            }
        }
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_tell_their_errors() {
        let text = |value, error| Fitted { value, error }.to_string();
        assert_eq!(text(-1.3863, 0.0042), "−1.386(4)");
        assert_eq!(text(-1.3863, 0.0096), "−1.39(1)");
        assert_eq!(text(0.5, 0.2), "0.5(2)");
        assert_eq!(text(12.3, 3.0), "12(3)");
        let b = |value| Some(Fitted { value, error: 0.01 });
        let terms = sum(b(-1.39), &[None, b(-1.0), None, b(0.5), None]);
        assert_eq!(terms, "−1.39(1) − 1.00(1) log wo·h + 0.50(1) log sin θh");
        assert_eq!(sum(None, &[None; 5]), "0");
    }

    #[test]
    fn matrices_are_inverted_or_singular() {
        let inverse = inverted(&[vec![4.0, 2.0], vec![2.0, 3.0]]).unwrap();
        assert!((inverse[0][0] - 0.375).abs() < 1e-12 && (inverse[0][1] + 0.25).abs() < 1e-12);
        assert!(inverted(&[vec![1.0, 1.0], vec![1.0, 1.0]]).is_none());
    }
}
