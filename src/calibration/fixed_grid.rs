//! The fixed-grid χ² test of renderers, as a baseline for gonio's own.
//!
//! The recipe is one, in two sizes: Nori's (W. Jakob, `src/chi2test.cpp` over his
//! header `hypothesis.h`) and pbrt-v4's (`src/pbrt/bsdfs_test.cpp`, the same
//! routines in single precision). It is stated anew here from reading those:
//!
//! - the whole sphere in a fixed grid of latitude × longitude;
//! - counts of samples by cell. What is no sample, is discrete or has no weight in
//!   any channel is left out, and lacks in the sum as it lacks in the integral;
//! - expected counts by adaptive Simpson quadrature, latitude inside of longitude,
//!   each to 1e-6 and at most six halvings ([`simpson`]): at least 25 evaluations
//!   a cell, at most 66 049. A lobe between those 25 points is not seen;
//! - cells below 5 expected are pooled, from the smallest, until the pool has 5;
//! - more than N/10⁵ samples in one cell with expected count 0 reject at once. Fewer
//!   do not count at all, in however many cells;
//! - Pearson's statistic against χ² with one degree of freedom less than cells; none
//!   left rejects too;
//! - p < 0.01 rejects, Šidák-corrected for the number of tests that are run.
//!
//! Where this differs: everything is in double precision, as far as the subject is
//! (in single precision pbrt's integrals add 0.004 at most to the mean statistic of a
//! GGX, a million samples, α from 0.01 to 0.5); tails are those of [`chi_square::sf`],
//! theirs are 1 − cdf; a negative expected count rejects in both, as in the newest
//! `hypothesis.h` (pbrt's copy pools it); discrete samples are left out in both, where
//! Nori counts them and so rejects; samples that claim pdf 0 count in both, where pbrt
//! drops them.

use super::simpson::{self, Node};
use crate::bsdf::{Direction, Precision, Samples, Subject, SubjectError, Transport};
use crate::evidence::{BLOCK, Figure, Meter, guarded};
use crate::statistics::chi_square;
use crate::statistics::streams::StreamKey;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Share of the samples that one cell with expected count 0 may hold, for the sake
/// of rounding (both recipes).
const STRAY: f64 = 1e-5;

/// Lines of latitude that are integrated together: at most 128 new points each in a
/// level, which keeps a batch below 3 MB.
const LINES: usize = 1024;

/// In what cells are equally high.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Spacing {
    /// cos θ, from −1 to 1: cells of equal solid angle.
    CosTheta,
    /// θ, from 0 to π: cells that shrink towards the poles.
    Theta,
}

/// A fixed-grid χ² test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedGrid {
    /// Whose recipe it is.
    pub name: &'static str,
    /// Cells in latitude.
    pub theta: usize,
    /// Cells in longitude.
    pub phi: usize,
    /// How latitude is divided.
    pub spacing: Spacing,
    /// Cells with a smaller expected count are pooled.
    pub pooling: f64,
    /// A smaller p-value rejects, of a single test.
    pub significance: f64,
    /// Samples that the recipe draws by default.
    pub samples: u64,
    /// Directions wo, drawn at random, that the recipe tests a BSDF at: for these
    /// the significance is corrected by [`sidak`].
    pub tests: u32,
}

/// Nori's: 10 × 20 cells of equal solid angle, 5000 samples a cell.
pub const NORI: FixedGrid = FixedGrid {
    name: "nori",
    theta: 10,
    phi: 20,
    spacing: Spacing::CosTheta,
    pooling: 5.0,
    significance: 0.01,
    samples: 1_000_000,
    tests: 5,
};

/// pbrt-v4's: 80 × 160 cells of equal angles.
pub const PBRT: FixedGrid =
    FixedGrid { name: "pbrt-v4", theta: 80, phi: 160, spacing: Spacing::Theta, ..NORI };

/// Both.
pub const RECIPES: [FixedGrid; 2] = [NORI, PBRT];

/// The significance of each of `tests` independent tests of which one or more
/// rejects with probability `significance` (Z. Šidák 1967): 1 − (1 − α)^(1/n).
pub fn sidak(significance: f64, tests: u32) -> f64 {
    -libm::expm1(libm::log1p(-significance) / f64::from(tests.max(1)))
}

/// What the recipe makes of the pdf at one wo.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    /// Probability of each cell, longitude running fastest; not always right.
    pub probability: Vec<f64>,
    /// Values of pdf that it took.
    pub evaluations: u64,
}

/// Samples by cell.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Observed {
    /// Those that count, in the order of [`Expected::probability`].
    pub counts: Vec<u64>,
    /// All draws.
    pub samples: u64,
}

/// What a test said.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridOutcome {
    /// Whether p is below the significance of a single test; among `n` tests compare
    /// `p_value` with [`sidak`].
    pub rejected: bool,
    /// The p-value; 0 where the recipe rejects without one.
    pub p_value: f64,
    /// Pearson's statistic over the cells that were looked at.
    pub statistic: Figure,
    /// Degrees of freedom; 0 where the recipe rejects without a p-value.
    pub dof: usize,
    /// Draws.
    pub samples: u64,
    /// Values of pdf.
    pub evaluations: u64,
    /// Why it was rejected without a p-value.
    pub reason: Option<String>,
}

impl FixedGrid {
    /// Tests `subject`, given `wo`, with `samples` draws. Random numbers are those
    /// of `key` under the name of the recipe; it should tell subjects and directions
    /// apart, or their outcomes depend on each other.
    ///
    /// # Errors
    /// Where the subject panics or fails.
    pub fn test(
        &self,
        subject: &dyn Subject,
        wo: Direction,
        transport: Transport,
        samples: u64,
        key: &StreamKey,
    ) -> Result<GridOutcome, SubjectError> {
        let expected = self.expect(subject, wo, transport)?;
        let observed = self.observe(subject, wo, transport, samples, key)?;
        Ok(self.compare(&expected, &observed))
    }

    /// The probabilities of the cells. They need no random numbers, so that many
    /// seeds can share them.
    ///
    /// # Errors
    /// Where the subject panics or fails.
    pub fn expect(
        &self,
        subject: &dyn Subject,
        wo: Direction,
        transport: Transport,
    ) -> Result<Expected, SubjectError> {
        // For its protection from panics.
        Meter::describe(subject)?;
        let mut probability = Vec::with_capacity(self.theta * self.phi);
        let mut evaluations = 0;
        let (mut wi, mut density) = (Vec::new(), Vec::new());
        let meridians: Vec<[f64; 2]> = (0..self.phi).map(|j| self.longitudes(j)).collect();
        for row in 0..self.theta {
            let latitudes = self.latitudes(row);
            let mut line_integrals = |lines: &[Node]| {
                simpson::integrate(&vec![latitudes; lines.len()], |nodes| {
                    wi.clear();
                    wi.extend(nodes.iter().map(|n| self.spacing.direction(n.x, lines[n.interval].x)));
                    density.clear();
                    density.resize(wi.len(), 0.0);
                    guarded("pdf", || subject.pdf(wo, &wi, transport, &mut density))?;
                    evaluations += wi.len() as u64;
                    Ok(nodes.iter().zip(&density).map(|(n, p)| p * self.spacing.measure(n.x)).collect())
                })
            };
            probability.extend(simpson::integrate(&meridians, |lines| {
                let mut integrals = Vec::with_capacity(lines.len());
                for lines in lines.chunks(LINES) {
                    integrals.extend(line_integrals(lines)?);
                }
                Ok(integrals)
            })?);
        }
        Ok(Expected { probability, evaluations })
    }

    /// Counts `samples` draws by cell.
    ///
    /// # Errors
    /// Where the subject panics or fails.
    pub fn observe(
        &self,
        subject: &dyn Subject,
        wo: Direction,
        transport: Transport,
        samples: u64,
        key: &StreamKey,
    ) -> Result<Observed, SubjectError> {
        let description = Meter::describe(subject)?;
        let (channels, dimensions) = (description.channels.len(), description.dimensions.max(1));
        let key = key.with("fixed grid", self.name);
        let mut counts = vec![0; self.theta * self.phi];
        let (mut u, mut drawn) = (Vec::new(), Samples::default());
        for block in 0..samples.div_ceil(BLOCK) {
            let rows = BLOCK.min(samples - block * BLOCK) as usize;
            u.resize(rows * dimensions, 0.0);
            key.block(block).fill(description.precision == Precision::F32, &mut u);
            drawn.clear(channels);
            guarded("sample", || subject.sample(wo, &u, transport, &mut drawn))?;
            if drawn.len() != rows {
                return Err(SubjectError::WrongLength {
                    function: "sample",
                    expected: rows,
                    got: drawn.len(),
                });
            }
            for (k, wi) in drawn.wi.iter().enumerate() {
                let black = drawn.weight_of(k).iter().all(|w| *w == 0.0);
                if drawn.lobe[k].is_continuous() && !black {
                    counts[self.cell(*wi)] += 1;
                }
            }
        }
        Ok(Observed { counts, samples })
    }

    /// Compares what was expected with what was observed.
    pub fn compare(&self, expected: &Expected, observed: &Observed) -> GridOutcome {
        let samples = observed.samples as f64;
        let mut cells: Vec<(f64, f64)> = expected
            .probability
            .iter()
            .zip(&observed.counts)
            .map(|(p, count)| (samples * p, *count as f64))
            .collect();
        cells.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut pool, mut pool_observed) = (0.0, 0.0);
        let (mut statistic, mut terms) = (0.0, 0usize);
        let mut reason = None;
        let mut add = |expected: f64, observed: f64| {
            statistic += (observed - expected) * (observed - expected) / expected;
            terms += 1;
        };
        for (expected, observed) in cells {
            if expected < 0.0 {
                reason.get_or_insert(format!("{expected} samples expected in a cell"));
            } else if expected == 0.0 {
                if observed > STRAY * samples {
                    reason.get_or_insert(format!("{observed} samples in a cell where none is expected"));
                }
            } else if expected < self.pooling || (pool > 0.0 && pool < self.pooling) {
                pool += expected;
                pool_observed += observed;
            } else {
                add(expected, observed);
            }
        }
        if pool > 0.0 {
            add(pool, pool_observed);
        }
        if terms < 2 {
            reason.get_or_insert(format!("{terms} cells leave no degree of freedom"));
        }
        let mut dof = terms.saturating_sub(1);
        let mut p_value = chi_square::sf(statistic, dof as f64);
        if p_value.is_nan() {
            reason.get_or_insert(format!("the statistic is {statistic}"));
        }
        if reason.is_some() {
            (dof, p_value) = (0, 0.0);
        }
        GridOutcome {
            rejected: p_value < self.significance,
            p_value,
            statistic: statistic.into(),
            dof,
            samples: observed.samples,
            evaluations: expected.evaluations,
            reason,
        }
    }

    /// The cell of a direction. One that is not finite falls somewhere, as theirs do.
    fn cell(&self, wi: Direction) -> usize {
        let row = match self.spacing {
            Spacing::CosTheta => 0.5 * (wi.z + 1.0) * self.theta as f64,
            Spacing::Theta => wi.z.clamp(-1.0, 1.0).acos() / PI * self.theta as f64,
        };
        let phi = wi.phi();
        let column = (if phi < 0.0 { phi + TAU } else { phi }) / TAU * self.phi as f64;
        (row as usize).min(self.theta - 1) * self.phi + (column as usize).min(self.phi - 1)
    }

    /// Where a row begins and ends, in cos θ or θ.
    fn latitudes(&self, row: usize) -> [f64; 2] {
        match self.spacing {
            Spacing::CosTheta => [row, row + 1].map(|i| -1.0 + 2.0 * i as f64 / self.theta as f64),
            // Rounded as in single precision: pbrt's edge at the horizon lies 4e-8
            // below it by that, where a reflecting pdf is 0. In double precision it
            // would lie above, and the row below be expected to hold up to 24 samples
            // of a million of a GGX, with no cell left where none is expected.
            Spacing::Theta => [row, row + 1].map(|i| f64::from(i as f32 * (PI as f32 / self.theta as f32))),
        }
    }

    /// Where a column begins and ends, in radians.
    fn longitudes(&self, column: usize) -> [f64; 2] {
        [column, column + 1].map(|j| j as f64 * TAU / self.phi as f64)
    }
}

impl Spacing {
    /// The direction at a latitude (cos θ or θ) and a longitude.
    fn direction(self, latitude: f64, phi: f64) -> Direction {
        match self {
            Self::Theta => Direction::from_angles(latitude, phi),
            Self::CosTheta => {
                let sin = (1.0 - latitude * latitude).sqrt();
                Direction::new(sin * phi.cos(), sin * phi.sin(), latitude)
            }
        }
    }

    /// Solid angle per latitude and longitude: 1 or sin θ.
    fn measure(self, latitude: f64) -> f64 {
        match self {
            Self::CosTheta => 1.0,
            Self::Theta => latitude.sin(),
        }
    }
}

#[cfg(test)]
#[path = "fixed_grid_tests.rs"]
mod tests;
