//! Draws from a subject's sampler, counted in the cells of a partition.

use super::log_weights::{LogWeights, WeightTable};
use super::meter::{Halt, Meter};
use super::setup::Setup;
use super::tally::{Place, Tally};
use crate::bsdf::Figure;
use crate::bsdf::{Direction, Lobe, Precision, Samples};
use crate::sphere::{Partition, sin_cos_turns};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Draws of a block: one random stream each (METHOD §6).
pub const BLOCK: u64 = 4096;

/// One in so many draws of the sampler is matched by a draw of the cosine,
/// for multiple importance sampling.
const PER_LIGHT: u64 = 8;

/// Draws of the cosine in a block, in whole vectors.
const LIGHTS: usize = (BLOCK / PER_LIGHT) as usize;
const _: () = assert!(LIGHTS.is_multiple_of(LANES));

/// More different discrete directions than this are not told apart.
const MOST_DISCRETE: usize = 16;

/// Larger values count as this one, so that sums of squares stay finite.
const LARGEST: f64 = 1e140;

/// Partial sums side by side: two vectors of the widest registers.
const LANES: usize = 8;

/// After so many samples at pdf = 0 no further one is looked at.
const ENOUGH: u64 = 1000;

/// Coarse cells of the table of serial pairs: few, so that a dependence of 2 %
/// shows within 2¹⁸ draws.
pub const SERIAL: usize = 4;

/// A discrete lobe as it was met in the draws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiscreteLobe {
    /// Its direction.
    pub wi: Direction,
    /// Its flags.
    pub lobe: Lobe,
    /// The probability that it claims (`sample.pdf`).
    pub probability: f64,
    /// Its weight per channel.
    pub weight: Vec<f64>,
    /// Times drawn.
    pub count: u64,
    /// Largest relative difference of probability or weight between its draws.
    pub spread: Tally,
}

/// Sums of a bounded quantity over draws.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Number of draws.
    pub count: u64,
    /// Sum per channel.
    pub sum: Vec<f64>,
    /// Sum of squares per channel.
    pub square: Vec<f64>,
    /// Largest over all channels.
    pub largest: Figure,
}

impl Sums {
    fn new(channels: usize) -> Self {
        Self { count: 0, sum: vec![0.0; channels], square: vec![0.0; channels], largest: Figure(0.0) }
    }

    /// Adds a block's sums, which were made apart so that the order of
    /// additions does not depend on who computed what.
    fn append(&mut self, block: &Self) {
        self.count += block.count;
        for (to, from) in self.sum.iter_mut().zip(&block.sum) {
            *to += from;
        }
        for (to, from) in self.square.iter_mut().zip(&block.square) {
            *to += from;
        }
        self.largest = Figure(self.largest.0.max(block.largest.0));
    }

    /// Of rows of `channels` values.
    fn of(rows: &[f64], channels: usize) -> Self {
        let mut sums = Self::new(channels);
        sums.count = (rows.len() / channels) as u64;
        let mut column = Vec::new();
        for c in 0..channels {
            if channels > 1 {
                column.clear();
                column.extend(rows.chunks_exact(channels).map(|row| row[c]));
            }
            let values = if channels > 1 { &column } else { rows };
            let [sum, square, largest] = pulp::Arch::new().dispatch(Summed(values));
            (sums.sum[c], sums.square[c]) = (sum, square);
            sums.largest = Figure(sums.largest.0.max(largest));
        }
        sums
    }

    /// Mean and variance of a channel.
    pub fn moments(&self, channel: usize) -> (f64, f64) {
        let n = self.count.max(1) as f64;
        let mean = self.sum[channel] / n;
        (mean, (self.square[channel] / n - mean * mean).max(0.0))
    }
}

/// Each row of `channels` values times its factor.
fn scale(rows: &mut [f64], channels: usize, factors: &[f64]) {
    pulp::Arch::new().dispatch(|| match channels {
        1 => rows.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor),
        _ => {
            let rows = rows.chunks_exact_mut(channels).zip(factors);
            rows.for_each(|(row, factor)| row.iter_mut().for_each(|value| *value *= factor));
        }
    });
}

/// Sum, sum of squares and maximum, in [`LANES`] partial sums side by side: a single one
/// waits for each addition. A closure of this size is not inlined into pulp's dispatch, and
/// would run without its registers.
struct Summed<'a>(&'a [f64]);

impl pulp::NullaryFnOnce for Summed<'_> {
    type Output = [f64; 3];

    #[inline(always)]
    fn call(self) -> [f64; 3] {
        let (mut sum, mut square, mut largest) = ([0.0; LANES], [0.0; LANES], [0.0f64; LANES]);
        let mut add = |lane: usize, value: f64| {
            let value = if value < LARGEST { value } else { LARGEST };
            sum[lane] += value;
            square[lane] += value * value;
            largest[lane] = if value > largest[lane] { value } else { largest[lane] };
        };
        let (many, rest) = self.0.as_chunks::<LANES>();
        for values in many {
            for (lane, value) in values.iter().enumerate() {
                add(lane, *value);
            }
        }
        for (lane, value) in rest.iter().enumerate() {
            add(lane, *value);
        }
        let total = |lanes: [f64; LANES]| lanes.iter().sum();
        [total(sum), total(square), largest.into_iter().fold(0.0, f64::max)]
    }
}

/// What `samples` draws of one attempt gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Draws {
    /// 0 is the first look, 1 its confirmation with other random numbers.
    pub attempt: u32,
    /// Number of draws.
    pub samples: u64,
    /// Continuous samples by leaf.
    pub counts: Vec<u64>,
    /// Draws without a sample.
    pub none: u64,
    /// Discrete lobes met.
    pub discrete: Vec<DiscreteLobe>,
    /// Draws of discrete directions beyond those told apart.
    pub discrete_overflow: u64,
    /// Samples in cells without pdf: pdf(wi) there must not be 0.
    pub zero_pdf: Tally,
    /// Weights, all draws counted.
    pub weight: Sums,
    /// The heaviest sample.
    pub heaviest: Option<Place>,
    /// The sampler's part of multiple importance sampling with the cosine by
    /// the balance heuristic.
    pub mis_sampler: Sums,
    /// The cosine's part.
    pub mis_cosine: Sums,
    /// Pairs of successive samples in [`SERIAL`]² coarse cells.
    pub serial: Vec<u64>,
    /// Weights by size, of the first attempt.
    #[serde(default, skip_serializing_if = "LogWeights::is_empty")]
    pub log_weights: LogWeights,
}

/// The cosine distribution that MIS is tried with, over the sides where light may leave,
/// as the balance heuristic counts it (Veach and Guibas 1995, eq. 10): its density times its
/// draws over the sampler's, 1/[`PER_LIGHT`]; per unit of cos θ, towards the front and the
/// back.
#[derive(Clone, Copy, Debug)]
pub struct CosineDensity {
    front: f64,
    back: f64,
}

impl CosineDensity {
    /// For the claims of a case.
    pub fn new(setup: &Setup) -> Self {
        let sides = f64::from(u8::from(setup.claims.reflective) + u8::from(setup.claims.transmissive));
        let side = |claimed: bool| if claimed { 1.0 / (PI * sides * PER_LIGHT as f64) } else { 0.0 };
        let (same, other) = (side(setup.claims.reflective), side(setup.claims.transmissive));
        if setup.wo.z > 0.0 { Self { front: same, back: other } } else { Self { front: other, back: same } }
    }

    /// The density at `wi` in sr⁻¹ times draws over the sampler's.
    #[inline(always)]
    pub fn at(&self, wi: Direction) -> f64 {
        if wi.z > 0.0 { self.front * wi.z } else { -self.back * wi.z }
    }
}

/// Directions of that distribution, drawn by `u`, eight at a time.
struct CosineDirections<'a> {
    /// On which side wo is.
    side: f64,
    /// The share of the directions that are on the other side.
    other: f64,
    u: &'a [[f64; 3]],
    directions: &'a mut [Direction],
}

impl<'a> CosineDirections<'a> {
    fn new(setup: &Setup, u: &'a [[f64; 3]], directions: &'a mut [Direction]) -> Self {
        let other = match (setup.claims.reflective, setup.claims.transmissive) {
            (true, true) => 0.5,
            (reflective, _) => f64::from(u8::from(!reflective)),
        };
        Self { side: 1f64.copysign(setup.wo.z), other, u, directions }
    }
}

impl pulp::NullaryFnOnce for CosineDirections<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (u, _) = self.u.as_chunks::<LANES>();
        let (directions, _) = self.directions.as_chunks_mut::<LANES>();
        for (u, d) in u.iter().zip(directions) {
            let [u, turns, choice]: [[f64; LANES]; 3] = [0, 1, 2].map(|c| std::array::from_fn(|k| u[k][c]));
            let (mut x, mut y, mut z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for k in 0..LANES {
                let r = u[k].sqrt();
                let (sin, cos) = sin_cos_turns(turns[k]);
                (x[k], y[k]) = (r * cos, r * sin);
                z[k] = (1.0 - u[k]).sqrt() * if choice[k] < self.other { -self.side } else { self.side };
            }
            for k in 0..LANES {
                d[k] = Direction::new(x[k], y[k], z[k]);
            }
        }
    }
}

/// What counting needs to know of a leaf.
#[derive(Clone, Copy)]
struct LeafCell {
    /// Its coarse cell of the table of serial pairs.
    serial: u8,
    /// There is a pdf, and its mass there is exactly 0.
    empty: bool,
}

/// Scratch space of a block.
#[derive(Default)]
struct Scratch {
    u: Vec<f64>,
    samples: Samples,
    points: Vec<[f64; 2]>,
    leaves: Vec<u32>,
    balance: Vec<f64>,
    serial: Vec<u8>,
    /// Draws of a discrete lobe, or where pdf has no mass.
    unusual: Vec<usize>,
    value: Vec<f64>,
    density: Vec<f64>,
    lights: Vec<Direction>,
}

impl Draws {
    /// No draw yet.
    pub fn new(attempt: u32, leaves: usize, channels: usize) -> Self {
        Self {
            attempt,
            samples: 0,
            counts: vec![0; leaves],
            none: 0,
            discrete: Vec::new(),
            discrete_overflow: 0,
            zero_pdf: Tally::new(0.0),
            weight: Sums::new(channels),
            heaviest: None,
            mis_sampler: Sums::new(channels),
            mis_cosine: Sums::new(channels),
            serial: vec![0; SERIAL * SERIAL],
            log_weights: LogWeights::default(),
        }
    }

    /// Number of continuous samples.
    pub fn continuous(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Number of discrete samples.
    pub fn discrete(&self) -> u64 {
        self.discrete.iter().map(|d| d.count).sum::<u64>() + self.discrete_overflow
    }

    /// Draws on to `samples` in all (whole blocks). `pdf_of_leaf` are the masses
    /// of the leaves: samples where it is exactly 0 are looked at singly.
    pub fn extend(
        &mut self,
        meter: &Meter,
        setup: &Setup,
        partition: &Partition,
        pdf_of_leaf: &[f64],
        samples: u64,
    ) -> Result<(), Halt> {
        let mut scratch = Scratch::default();
        let mut weights = (self.attempt == 0).then(WeightTable::new);
        let none = self.none;
        let serial = serial_cells(partition);
        let has_pdf = meter.description.has.pdf;
        let cell = |(serial, pdf): (u8, &f64)| LeafCell { serial, empty: has_pdf && *pdf == 0.0 };
        let cells: Vec<LeafCell> = serial.into_iter().zip(pdf_of_leaf).map(cell).collect();
        let mut drawn = Ok(());
        while self.samples < samples && drawn.is_ok() {
            drawn = self.block(meter, setup, partition, &cells, &mut scratch, weights.as_mut());
        }
        if let Some(weights) = weights {
            weights.add_to(&mut self.log_weights, self.none - none);
        }
        drawn
    }

    fn block(
        &mut self,
        meter: &Meter,
        setup: &Setup,
        partition: &Partition,
        cells: &[LeafCell],
        scratch: &mut Scratch,
        weights: Option<&mut WeightTable>,
    ) -> Result<(), Halt> {
        let stage = if self.attempt == 0 { "draws" } else { "confirmation" };
        let mut stream = setup.key.with("stage", stage).block(self.samples / BLOCK);
        let Scratch { u, samples, points, leaves, balance, serial, unusual, value, density, lights } =
            scratch;
        u.resize(BLOCK as usize * meter.dimensions(), 0.0);
        stream.fill(meter.coarse_u(), u);
        meter.sample(setup.wo, u, setup.transport, samples)?;

        partition.chart().to_points(&samples.wi, points);
        partition.locate_all(points, leaves);

        let cosine = CosineDensity::new(setup);
        balance.clear();
        if setup.mis {
            balance.extend_from_slice(&samples.pdf);
            // Of no sample, whose weights are 0, it is 0 too.
            let shares = balance.iter_mut().zip(&samples.wi);
            pulp::Arch::new().dispatch(|| {
                shares.for_each(|(p, wi)| *p /= (*p + cosine.at(*wi)).max(f64::MIN_POSITIVE));
            });
        }

        let row = |k: usize| &u[k * meter.dimensions()..(k + 1) * meter.dimensions()];
        serial.resize(samples.len(), 0);
        let (mut continuous, mut valid) = (0, 0);
        unusual.clear();
        for (k, (leaf, lobe)) in leaves.iter().zip(&samples.lobe).enumerate() {
            let leaf = *leaf as usize;
            let cell = cells[leaf];
            let is_continuous = lobe.is_continuous();
            self.counts[leaf] += u64::from(is_continuous);
            serial[continuous] = cell.serial;
            continuous += usize::from(is_continuous);
            valid += usize::from(lobe.is_valid());
            if lobe.is_discrete() || (cell.empty && is_continuous) {
                unusual.push(k);
            }
        }
        self.none += (samples.len() - valid) as u64;
        for &k in &*unusual {
            let (wi, lobe) = (samples.wi[k], samples.lobe[k]);
            if lobe.is_discrete() {
                // No cosine meets it. Without mis there are no shares.
                if let Some(share) = balance.get_mut(k) {
                    *share = 1.0;
                }
                self.add_discrete(setup, wi, lobe, samples.pdf[k], samples.weight_of(k));
            } else if self.zero_pdf.broken < ENOUGH {
                let there = density_near(meter, setup, wi)?;
                self.zero_pdf.look(if there > 0.0 { 0.0 } else { 1.0 }, || {
                    let place = Place::pair(setup.wo, wi).drawn_by(row(k));
                    place.value("pdf", 0.0).value("sample.pdf", samples.pdf[k])
                });
            }
        }
        for [before, after] in serial[..continuous].as_chunks().0 {
            self.serial[usize::from(*before) * SERIAL + usize::from(*after)] += 1;
        }
        let channels = samples.channels;
        if let Some(weights) = weights {
            weights.look(&samples.weight, channels);
        }
        let weight = Sums::of(&samples.weight, channels);
        if weight.largest.0 > self.weight.largest.0 {
            let heaviest = samples.weight.iter().position(|w| w.min(LARGEST) == weight.largest.0);
            self.heaviest = heaviest.map(|at| at / channels).map(|k| {
                let place = Place::pair(setup.wo, samples.wi[k]).drawn_by(row(k));
                place.value("weight", weight.largest.0).value("sample.pdf", samples.pdf[k])
            });
        }
        self.weight.append(&weight);

        if setup.mis {
            scale(&mut samples.weight, channels, balance);
            self.mis_sampler.append(&Sums::of(&samples.weight, channels));
            u.resize(3 * LIGHTS, 0.0);
            lights.resize(LIGHTS, Direction::default());
            stream.fill(false, u);
            pulp::Arch::new().dispatch(CosineDirections::new(setup, u.as_chunks().0, lights));
            meter.eval(setup.wo, lights, setup.transport, value)?;
            meter.pdf(setup.wo, lights, setup.transport, density)?;
            let factor =
                |(p, wi): (&f64, &Direction)| wi.abs_cos_theta() / (PER_LIGHT as f64 * (p + cosine.at(*wi)));
            balance.clear();
            balance.extend(density.iter().zip(lights.iter()).map(factor));
            scale(value, channels, balance);
            self.mis_cosine.append(&Sums::of(value, channels));
        }
        self.samples += BLOCK;
        Ok(())
    }

    fn add_discrete(&mut self, setup: &Setup, wi: Direction, lobe: Lobe, probability: f64, weights: &[f64]) {
        // Directions of one lobe differ by rounding only.
        let (near, tolerance) = match setup.precision {
            Precision::F64 => (1e-9, 1e-9),
            Precision::F32 => (1e-4, 1e-4),
        };
        let known = self.discrete.iter().position(|d| {
            let difference = d.wi - wi;
            difference.dot(difference) < near * near && d.lobe == lobe
        });
        match known {
            Some(k) => {
                let d = &mut self.discrete[k];
                d.count += 1;
                let mut error = super::tally::relative_error(d.probability, probability, 1e-12);
                for (a, b) in d.weight.iter().zip(weights) {
                    error = error.max(super::tally::relative_error(*a, *b, 1e-12));
                }
                d.spread.look(error, || {
                    Place::pair(setup.wo, wi).value("probability", probability).value("first", d.probability)
                });
            }
            None if self.discrete.len() < MOST_DISCRETE => self.discrete.push(DiscreteLobe {
                wi,
                lobe,
                probability,
                weight: weights.to_vec(),
                count: 1,
                spread: Tally::new(tolerance),
            }),
            None => self.discrete_overflow += 1,
        }
    }
}

/// For each leaf one of [`SERIAL`] coarse cells: its ancestor at depth 2 below
/// its hemisphere, so that cells have near-equal mass.
fn serial_cells(partition: &Partition) -> Vec<u8> {
    let mut cell_of_node = vec![0u32; partition.nodes()];
    let mut depth_of_node = vec![0u32; partition.nodes()];
    for node in 0..partition.nodes() {
        if let Some(children) = partition.children(node) {
            for (k, child) in children.into_iter().enumerate() {
                depth_of_node[child] = depth_of_node[node] + 1;
                let split = depth_of_node[child] > 1 && depth_of_node[child] <= 3;
                cell_of_node[child] =
                    if split { 2 * cell_of_node[node] + k as u32 } else { cell_of_node[node] };
            }
        }
    }
    (0..partition.len())
        .map(|leaf| (cell_of_node[partition.leaf_node(leaf)] as usize % SERIAL) as u8)
        .collect()
}

/// The largest pdf at `wi` and within rounding of it, so that a sample on the
/// rim of the support is not taken for one outside of it.
pub fn density_near(meter: &Meter, setup: &Setup, wi: Direction) -> Result<f64, Halt> {
    let step = match setup.precision {
        Precision::F64 => 4.0 * f64::EPSILON,
        Precision::F32 => 4.0 * f64::from(f32::EPSILON),
    };
    let mut around = vec![wi];
    for (dx, dy, dz) in [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)] {
        let d = Direction::new(dx, dy, dz) * step;
        around.extend([(wi + d).normalized(), (wi - d).normalized()]);
    }
    let mut density = Vec::new();
    meter.pdf(setup.wo, &around, setup.transport, &mut density)?;
    Ok(density.into_iter().fold(0.0, f64::max))
}
