//! Samples follow pdf.

use super::outcome::{
    Check, Effect, Judgement, Outcome, POWER, Terms, Verdict, needs_determinism, needs_functions,
};
use crate::bsdf::Description;
use crate::evidence::{Draws, Evidence, Integrals, Measurement, Place};
use crate::sphere::Partition;
use crate::statistics::multiscale::{
    Cell, Haar, MIN_EXPECTED, Pooled, Tree, haar_largest, haar_levels, level_cut, pearson,
};
use crate::statistics::smooth::{self, Class, Ordered};
use crate::statistics::{binomial, chi_square, effect, noncentral};

/// A single cell may be off by this many times the RMS tolerance: the local
/// guard that keeps an error of half a small cell from hiding in an RMS
/// (METHOD §3).
const GUARD: f64 = 5.0;

/// The part of a look's share that the two sums along the density spend, where pdf has more
/// than one density; depths and guard divide the rest. It costs each of ten depths 1 % in the
/// error that they see (at a false alarm of 10⁻⁶ and 95 % power). Did each sum get as much as
/// a depth, a wrong roughness would take 4 % more samples, and at 0.01 7 % more.
const ALONG: f64 = 0.25;

/// p-values this near to 1 say that samples are more even than chance allows.
const TOO_EVEN: f64 = 1e-6;

/// Draws fall into cells as ∫pdf says, draws without a continuous sample being
/// a cell of their own ("raw"); and so do the continuous ones among each
/// other ("shape"). Pearson's X² on the cell tree cut at every depth, and a
/// [smooth test](smooth) along the density, each against a non-central χ² of the
/// tolerance, so that only an error certainly larger fails; and a binomial guard
/// on each node.
pub struct GoodnessOfFit;

/// The tree of cells below a root that also holds the draws without a
/// continuous sample.
struct Cells {
    children: Vec<Option<(usize, usize)>>,
    mass: Vec<f64>,
    counts: Vec<u64>,
}

/// Nodes of the partition follow these two: all draws, and the draws without
/// a continuous sample.
const OUTER: usize = 2;

impl Cells {
    /// Z may be off by `slack`, which may be more than all of 1 − Z: within it, as
    /// many draws are expected to come without a continuous sample as did.
    fn new(partition: &Partition, masses: &[f64], draws: &Draws, slack: f64) -> Self {
        let inner_mass = partition.sum_up(masses);
        let inner_counts = partition.sum_up(&draws.counts);
        // A block that failed half way may be counted already.
        let without = draws.samples.saturating_sub(inner_counts[0]);
        let told = inner_mass[0];
        let met = without as f64 / draws.samples.max(1) as f64;
        let rest = met.clamp((1.0 - told - slack).max(0.0), (1.0 - told + slack).max(0.0));
        // Exactly 1 without slack.
        let scale = if slack > 0.0 && told > slack {
            ((1.0 - rest) / told).clamp(1.0 - slack / told, 1.0 + slack / told)
        } else {
            1.0
        };
        let inner_mass: Vec<f64> = inner_mass.iter().map(|m| m * scale).collect();
        let mut children = vec![Some((1, OUTER)), None];
        let mut mass = vec![inner_mass[0] + rest, rest];
        let mut counts = vec![draws.samples, without];
        for node in 0..partition.nodes() {
            children.push(partition.children(node).map(|[l, r]| (l + OUTER, r + OUTER)));
        }
        mass.extend(inner_mass);
        counts.extend(inner_counts);
        Self { children, mass, counts }
    }

    fn raw(&self) -> Option<Pooled> {
        let tree = Tree::new(&self.children, &self.mass, &self.counts).ok()?;
        Some(tree.pool(self.counts[0] as f64, MIN_EXPECTED))
    }

    fn shape(&self) -> Option<Pooled> {
        let children: Vec<_> =
            self.children[OUTER..].iter().map(|c| c.map(|(l, r)| (l - OUTER, r - OUTER))).collect();
        let tree = Tree::new(&children, &self.mass[OUTER..], &self.counts[OUTER..]).ok()?;
        Some(tree.pool_shape(MIN_EXPECTED))
    }
}

/// Pearson's X² and degrees of freedom of the tree cut at each depth that
/// differs from the one above.
fn levels(tree: &Pooled) -> Vec<(f64, f64)> {
    (1..=tree.depth()).map(|d| pearson(&tree.counts(&level_cut(tree, d)))).filter(|l| l.1 > 0.0).collect()
}

/// The leaves by their density per steradian. Continuous samples among each other: a draw
/// without one has no density, and the mass is tested apart.
fn along_density(partition: &Partition, masses: &[f64], draws: &Draws) -> Vec<Class> {
    let leaf = |(k, (mass, observed)): (usize, (&f64, &u64))| {
        let density = mass / partition.chart().solid_angle(&partition.leaf_cell(k));
        Ordered { density, mass: *mass, observed: *observed }
    };
    smooth::classes(masses.iter().zip(&draws.counts).enumerate().map(leaf).collect())
}

/// What a sum of squares looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scale {
    /// The tree cut at a depth.
    Cells,
    /// Functions of the density's rank.
    Density,
}

/// A sum of squares that is χ² under the null.
#[derive(Clone, Copy, Debug)]
struct Level {
    scale: Scale,
    x2: f64,
    dof: f64,
    /// ln of the part of a share that it spends.
    ln_part: f64,
}

/// Shares out between the depths, the sums along the density, and `others` of which each
/// gets as much as a depth. Returns ln of that too.
fn share_out(depths: &[(f64, f64)], along: &[(f64, f64)], others: usize) -> (Vec<Level>, f64) {
    let rest: f64 = if along.is_empty() { 1.0 } else { 1.0 - ALONG };
    let of_depth = rest.ln() - ((depths.len() + others).max(1) as f64).ln();
    let of_density = (ALONG / along.len().max(1) as f64).ln();
    let level = |scale, ln_part| move |&(x2, dof): &(f64, f64)| Level { scale, x2, dof, ln_part };
    let depths = depths.iter().map(level(Scale::Cells, of_depth));
    (depths.chain(along.iter().map(level(Scale::Density, of_density))).collect(), of_depth)
}

/// p at ε = 0: the smallest over the levels, each over its part.
fn least_ln_p(depths: &[(f64, f64)], along: &[(f64, f64)]) -> f64 {
    let (levels, _) = share_out(depths, along, 0);
    levels.iter().map(|l| chi_square::ln_sf(l.x2, l.dof) - l.ln_part).fold(0.0, f64::min)
}

/// What samples are held against pdf by, with the first of them.
fn first_draws(evidence: &Evidence) -> Option<(&Partition, &Integrals, &Draws)> {
    Some((evidence.partition.as_ref()?, evidence.integrals.as_ref()?, evidence.draws.first()?))
}

/// The ε = 0 p-values of the levels' own sums of z², which are independent of
/// each other and uniform under the null: what calibration looks at. From
/// the first draws.
pub fn level_p_values(evidence: &Evidence) -> Vec<f64> {
    let Some((partition, integrals, draws)) = first_draws(evidence) else { return Vec::new() };
    let Some(tree) = Cells::new(partition, &integrals.pdf, draws, 0.0).shape() else { return Vec::new() };
    // A level with few terms is discrete where counts are small; 20 per cell and
    // a few cells make it smooth.
    haar_levels(&tree.haar())
        .iter()
        .filter(|(_, dof)| *dof >= 1.0)
        .map(|(s, dof)| chi_square::sf(*s, *dof))
        .collect()
}

/// The ε = 0 p-values along the density, of degree 1 and of the higher ones together,
/// which are independent of each other (not of those of levels) and uniform under the
/// null. From the first draws.
pub fn density_p_values(evidence: &Evidence) -> Vec<f64> {
    let Some((partition, integrals, draws)) = first_draws(evidence) else { return Vec::new() };
    let z = smooth::components(&along_density(partition, &integrals.pdf, draws));
    let (line, rest) = z.split_at(z.len().min(1));
    [line, rest]
        .into_iter()
        .filter(|z| !z.is_empty())
        .map(|z| chi_square::sf(z.iter().map(|z| z * z).sum(), z.len() as f64))
        .collect()
}

/// ln p of the first draws at ε = 0, all tests of samples against pdf together: the
/// smallest over the levels of the tree and along the density, the mass, and draws where
/// pdf is 0 (which no chance explains), each over its part. What a test without tolerance
/// sees.
pub fn strict_ln_p(evidence: &Evidence) -> Option<f64> {
    let (partition, integrals, draws) = first_draws(evidence)?;
    if draws.zero_pdf.is_broken() {
        return Some(f64::NEG_INFINITY);
    }
    let along = smooth::nested(&smooth::components(&along_density(partition, &integrals.pdf, draws)));
    let levels = least_ln_p(&levels(&Cells::new(partition, &integrals.pdf, draws, 0.0).raw()?), &along);
    let ((mass, error), valid) = (integrals.mass(), draws.continuous());
    let mass = if mass - error > 1.0 {
        f64::NEG_INFINITY
    } else {
        let mass = mass.min(1.0);
        (binomial::ln_tail_beyond(valid, draws.samples, mass, mass) + 2f64.ln()).min(0.0)
    };
    Some((levels.min(mass) + 2f64.ln()).min(0.0))
}

/// √D of the told masses against `true_masses`, those that samples really follow,
/// on the tree cut at each depth, with the number of cells: how wrong pdf is,
/// seen with the cells that `draws` made.
pub fn true_effects(evidence: &Evidence, true_masses: &[f64]) -> Vec<(f64, f64)> {
    let Some((partition, integrals, draws)) = first_draws(evidence) else { return Vec::new() };
    let told = Cells::new(partition, &integrals.pdf, draws, 0.0);
    let Some(tree) = told.raw() else { return Vec::new() };
    let right = Cells::new(partition, true_masses, draws, 0.0);
    let at = |depth: u32| {
        let cells = level_cut(&tree, depth);
        let term = |k: &usize| {
            let node = tree.nodes[*k].node;
            let (p, q) = (told.mass[node], right.mass[node]);
            if p > 0.0 { (q - p) * (q - p) / p } else { 0.0 }
        };
        (cells.len() as f64, cells.iter().map(term).sum::<f64>().sqrt())
    };
    (1..=tree.depth()).map(at).collect()
}

/// Where a node lies, for a sentence.
fn region(partition: &Partition, node: usize) -> String {
    if node < OUTER {
        return "without a continuous sample".into();
    }
    let cell = partition.node_cell(node - OUTER);
    let centre = partition.chart().to_direction(cell.at(0.5, 0.5));
    format!(
        "around θ = {:.1}°, φ = {:.0}°",
        centre.theta().to_degrees(),
        centre.phi().to_degrees().rem_euclid(360.0).round().abs()
    )
}

/// The split that deviates most, in words.
fn deviation(partition: &Partition, tree: &Pooled, h: &Haar) -> String {
    let side = |k: usize| region(partition, tree.nodes[k].node);
    let (more, less) = if h.z > 0.0 { (h.left, h.right) } else { (h.right, h.left) };
    format!("too many {} and too few {} by {:.1} σ", side(more), side(less), h.z.abs())
}

impl Check for GoodnessOfFit {
    fn id(&self) -> &'static str {
        "goodness-of-fit"
    }

    fn hypothesis(&self) -> &'static str {
        "samples follow pdf, no-sample cell included; raw and shape-only"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Masses, Measurement::Draws]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, false, true, true)?;
        needs_determinism(description)
    }

    fn is_statistical(&self) -> bool {
        true
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let (Some(partition), Some(integrals)) = (&evidence.partition, &evidence.integrals) else {
            return Judgement::Missing;
        };
        if let Err(reason) = integrals.masses_reliable() {
            return Outcome::inconclusive(reason).into();
        }
        let Some(draws) = evidence.draws.get(terms.attempt) else { return Judgement::Missing };
        if draws.continuous() == 0 && integrals.mass().0 == 0.0 {
            let reason = "there is no continuous lobe: pdf is 0 everywhere and no continuous sample came";
            return Outcome::skipped(reason).into();
        }
        let slack = integrals.slack(terms.mean_tolerance);
        against(evidence, partition, (&integrals.pdf, slack), draws, terms)
    }
}

/// Judges draws against the masses of the leaves, the subject's own or those
/// of a reference, and by how much their sum may be off.
pub(super) fn against(
    evidence: &Evidence,
    partition: &Partition,
    (masses, slack): (&[f64], f64),
    draws: &Draws,
    terms: &Terms,
) -> Judgement {
    let n = draws.samples;
    let cells = Cells::new(partition, masses, draws, slack);
    let undistributed = || Outcome::inconclusive("the integrals of pdf are not a distribution over cells");
    let Some(raw) = cells.raw() else { return undistributed().into() };
    let raw_levels = levels(&raw);
    let classes = along_density(partition, masses, draws);
    let z = smooth::components(&classes);
    let along = smooth::nested(&z);
    let (tests, ln_depth) = share_out(&raw_levels, &along, 1);
    let lambda = n as f64 * terms.tolerance * terms.tolerance;
    // With a mass P told and Q met, D of the shape is at most P/Q² times D of all draws, by which
    // its n·Q samples are multiplied.
    let lambda_of_shape = lambda * cells.mass[OUTER] * n as f64 / draws.continuous().max(1) as f64;
    let smallest = MIN_EXPECTED / n as f64;
    let ln_p_of = |level: &Level| {
        let &Level { scale, x2, dof, ln_part } = level;
        if scale == Scale::Density {
            return noncentral::ln_sf(x2, dof, lambda_of_shape) - ln_part;
        }
        // Where the error may sit in one small cell, the normal bound decides.
        let beyond = x2 > effect::normal_bound(dof, n, terms.tolerance, smallest, terms.ln_tail + ln_part);
        let ln_p = noncentral::ln_sf(x2, dof, lambda);
        (if beyond { ln_p } else { ln_p.max(terms.ln_tail + ln_part + 1.0) }) - ln_part
    };
    let worst_level =
        tests.into_iter().map(|level| (level, ln_p_of(&level))).min_by(|a, b| a.1.total_cmp(&b.1));
    let guard = guard(&raw, n, terms) - ln_depth;
    let ln_p = worst_level.map_or(0.0, |(_, ln_p)| ln_p).min(guard).min(0.0);
    let fails = ln_p < terms.ln_tail;
    if let (false, Some(next)) = (fails, terms.next) {
        return Judgement::More(next);
    }

    let strict = Cells::new(partition, masses, draws, 0.0);
    let (Some(strict), Some(shape)) = (strict.raw(), strict.shape()) else {
        return undistributed().into();
    };
    let shape_levels = levels(&shape);
    let (scale, x2, dof) = worst_level.map_or((Scale::Cells, 0.0, 0.0), |(l, _)| (l.scale, l.x2, l.dof));
    let own_effect = effect::root_d(x2, dof.max(1.0), n);
    let (shape_p, raw_p) = (least_ln_p(&shape_levels, &along), least_ln_p(&levels(&strict), &along));
    let outcome = Outcome {
        certain: false,
        effect: Some(Effect::interval("RMS relative cell error √D", own_effect, terms.tolerance)),
        ln_p: Some(ln_p),
        ln_threshold: Some(terms.ln_tail),
        samples: n,
        ..Outcome::new(Verdict::Pass, String::new())
    };
    if fails {
        let largest = haar_largest(&raw.haar());
        let place = largest.map(|h| deviation(partition, &raw, &h)).unwrap_or_default();
        let worst = worst_cell(evidence, partition, &raw);
        let strict = format!("at ε = 0, p = {} raw and {} for the shape alone", power(raw_p), power(shape_p));
        let seen = match scale {
            Scale::Cells => format!("on {:.0} cells", dof + 1.0),
            Scale::Density => along_words(&classes, &z),
        };
        let message = format!(
            "samples are off pdf by {} RMS ({} to {}) {seen}; {place}; {strict}",
            percent(own_effect.0),
            percent(own_effect.1),
            percent(own_effect.2),
        );
        return Outcome { verdict: Verdict::Fail, message, worst, ..outcome }.into();
    }
    // The depth whose limit is best, and that limit: the error it is told for is one that cells
    // see, not only one that follows the density.
    let limit = raw_levels
        .iter()
        .map(|(_, dof)| {
            let threshold =
                effect::guarded_threshold(*dof, n, terms.tolerance, smallest, terms.ln_tail + ln_depth);
            (effect::detection_limit(*dof, n, threshold, POWER), dof + 1.0)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let (limit, limit_cells) = limit.unwrap_or((f64::INFINITY, 0.0));
    let even = if chi_square_lower(&shape_levels) < TOO_EVEN {
        "; samples are more even than chance: stratified, or u is ignored?"
    } else {
        ""
    };
    let message = format!(
        "samples follow pdf: p = {:.2} raw, {:.2} shape (ε = 0); an error of {} RMS on {limit_cells:.0} cells would have been seen{even}",
        raw_p.exp(),
        shape_p.exp(),
        percent(limit)
    );
    terms.settle(Outcome { message, detection_limit: Some(limit), ..outcome })
}

/// What the samples do along the density.
fn along_words(classes: &[Class], z: &[f64]) -> String {
    let amount = |excess: f64| {
        let direction = if excess < 0.0 { "few" } else { "many" };
        format!("{} too {direction}", percent(excess.abs()))
    };
    let Some(split) = smooth::largest_split(classes) else { return "along the density".into() };
    // A straight line is a width; what bends is another lobe.
    let of_line = z[0] * z[0] > 0.5 * z.iter().map(|z| z * z).sum::<f64>();
    let meaning = match (of_line, z[0] > 0.0) {
        (false, _) => "",
        (true, true) => ": the lobe is narrower than pdf says, or the narrow one of several drawn too often",
        (true, false) => ": the lobe is wider than pdf says, or the wide one of several drawn too often",
    };
    format!(
        "along the density, {} where pdf is highest ({:.0} % of all) and {} elsewhere{meaning}",
        amount(split.above),
        100.0 * split.share,
        amount(split.below)
    )
}

/// The cell that deviates most, with its counts.
fn worst_cell(evidence: &Evidence, partition: &Partition, tree: &Pooled) -> Option<Place> {
    let deviation = |c: &&Cell| (c.observed as f64 - c.expected) / c.expected.sqrt();
    let leaves = tree.nodes.iter().filter(|c| c.children.is_none() && c.node >= OUTER);
    let worst = leaves.max_by(|a, b| deviation(a).abs().total_cmp(&deviation(b).abs()))?;
    let cell = partition.node_cell(worst.node - OUTER);
    let wi = partition.chart().to_direction(cell.at(0.5, 0.5));
    let place = Place::pair(evidence.wo, wi).value("observed", worst.observed as f64);
    Some(place.value("expected", worst.expected).value("σ", deviation(&worst)))
}

/// The local guard: the smallest ln p, over all nodes, of a count were the
/// node's mass off by [`GUARD`] tolerances; corrected for their number.
fn guard(tree: &Pooled, n: u64, terms: &Terms) -> f64 {
    let slack = GUARD * terms.tolerance;
    let mut worst = 0.0f64;
    for cell in tree.nodes.iter().skip(1) {
        let p = cell.expected / n as f64;
        let (low, high) = (p * (1.0 - slack), (p * (1.0 + slack)).min(1.0));
        let share = cell.observed as f64 / n as f64;
        let beyond = (share - high).max(low - share) * n as f64;
        // Within three deviations no tail survives the correction for hundreds of nodes.
        if beyond <= 3.0 * (cell.expected * (1.0 - p)).sqrt() {
            continue;
        }
        worst = worst.min(binomial::ln_tail_beyond(cell.observed, n, low, high));
    }
    (worst + (2.0 * tree.nodes.len() as f64).ln()).min(0.0)
}

/// The probability of even smaller sums than seen at the finest level.
fn chi_square_lower(levels: &[(f64, f64)]) -> f64 {
    levels.last().map_or(1.0, |(x2, dof)| noncentral::cdf(*x2, *dof, 0.0))
}

/// As people read small probabilities.
fn power(ln_p: f64) -> String {
    if ln_p > -7.0 {
        format!("{:.3}", ln_p.exp())
    } else {
        format!("10^{:.0}", ln_p / std::f64::consts::LN_10)
    }
}

/// As people read small ratios.
fn percent(ratio: f64) -> String {
    format!("{:.2} %", 100.0 * ratio)
}
