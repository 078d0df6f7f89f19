//! Sums over a whole table: what each incident patch gives back, and how far it is
//! from reciprocal.

use super::distribution::same_patches;
use super::table::{Side, Table};
use crate::bsdf::{Direction, Rectangle};
use std::f64::consts::PI;

/// Smaller values are not compared, as in Radiance's `checkBSDF`, in sr⁻¹.
const FEWEST: f64 = 1e-4;

/// What `checkBSDF` adds to the denominator of a relative difference.
const TINY: f64 = 1e-6;

/// The flux that leaves of light from one incident patch, or finest incident cell.
#[derive(Clone, Debug, PartialEq)]
pub struct IncidentFlux {
    /// The middle of the patch, as seen from the surface.
    pub wo: Direction,
    /// Its name in the table.
    pub patch: String,
    /// Σ f Λ over reflected light.
    pub reflected: f64,
    /// Σ f Λ over transmitted light.
    pub transmitted: f64,
}

impl IncidentFlux {
    /// Both together.
    pub fn total(&self) -> f64 {
        self.reflected + self.transmitted
    }
}

/// |f(a, b) − f(b, a)| / max over pairs of patches, as `checkBSDF` reports it of
/// matrices: pairs of which either value is at most 10⁻⁴ sr⁻¹ do not count, and the
/// mean is over pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetry {
    /// Least.
    pub least: f64,
    /// Mean.
    pub mean: f64,
    /// Most.
    pub most: f64,
    /// Pairs compared.
    pub pairs: usize,
}

/// ∫ f cos over cells, which are rectangles of a square of π sr of projected solid
/// angle.
pub(super) fn flux(cells: &[(Rectangle, f64)]) -> f64 {
    let term = |(r, f): &(Rectangle, f64)| f * PI * (r.hi[0] - r.lo[0]) * (r.hi[1] - r.lo[1]);
    cells.iter().map(term).sum()
}

impl Table {
    /// What leaves of light that arrives along `wo`: (reflected, transmitted).
    pub fn flux_from(&self, wo: Direction) -> (f64, f64) {
        let Some(from) = Side::of(wo) else { return (0.0, 0.0) };
        let to = |to| self.distribution(from, to).map_or(0.0, |d| flux(&d.outgoing(wo)));
        (to(from), to(from.opposite()))
    }

    /// The flux of every incident patch of a side. Where reflection and transmission
    /// have different incident patches, those of the finer one.
    pub fn incident_fluxes(&self, from: Side) -> Vec<IncidentFlux> {
        let up = Direction::NORMAL;
        let finest = self.scattered(from).map(|(_, d)| d).max_by_key(|d| d.incident(up).1);
        let Some(finest) = finest else { return Vec::new() };
        let of = |cell: usize| {
            let middle = finest.incident_middle(cell);
            let wo = if from == Side::Front { middle } else { middle.flipped() };
            let (reflected, transmitted) = self.flux_from(wo);
            IncidentFlux { wo, patch: finest.describe_incident(wo), reflected, transmitted }
        };
        (0..finest.incident(up).1).map(of).collect()
    }

    /// The asymmetry of the matrices of light from `from` to `to` and back; `None`
    /// where the file has no matrix of both.
    pub fn asymmetry(&self, from: Side, to: Side) -> Option<Asymmetry> {
        let forth = self.distribution(from, to)?.matrix()?;
        let back = self.distribution(to, from)?.matrix()?;
        if !same_patches(&forth.incident, &back.outgoing) || !same_patches(&forth.outgoing, &back.incident) {
            return None;
        }
        let mut found = Asymmetry { least: f64::INFINITY, mean: 0.0, most: 0.0, pairs: 0 };
        for i in 0..forth.incident.len() {
            for o in 0..forth.outgoing.len() {
                let (a, b) =
                    (forth.at(i, o), back.at(back.incident.opposite(o)?, back.outgoing.opposite(i)?));
                if a > FEWEST && b > FEWEST {
                    let error = (a - b).abs() / (a.max(b) + TINY);
                    found.least = found.least.min(error);
                    found.most = found.most.max(error);
                    found.mean += error;
                    found.pairs += 1;
                }
            }
        }
        if found.pairs == 0 {
            return Some(Asymmetry { least: 0.0, ..found });
        }
        found.mean /= found.pairs as f64;
        Some(found)
    }

    /// The largest |f(wo, wi) − f(wi, wo)| / max over the middles of the finest cells
    /// of a side and those of both sides, `most` pairs at most.
    pub(super) fn largest_asymmetry(&self, most: usize) -> f64 {
        let mut all: Vec<Direction> = Vec::new();
        let turning = Side::BOTH.into_iter().flat_map(|s| self.scattered(s)).any(|(_, d)| d.turns());
        for from in Side::BOTH {
            for (_, d) in self.scattered(from) {
                let middles = (0..d.incident(Direction::NORMAL).1).map(|cell| d.incident_middle(cell));
                all.extend(middles.map(|m| if from == Side::Front { m } else { m.flipped() }));
            }
        }
        // Odd, so that no column of the grid is passed over.
        let step = ((all.len() * all.len()) / most.max(1)) | 1;
        let pair = |k: usize| {
            let (a, b) = (all[k / all.len()], all[k % all.len()]);
            // Rank 3 has its middles at one azimuth: generic turns show the others.
            let b = if turning { b.rotated(k as f64) } else { b };
            let (forth, back) = (self.value(a, b), self.value(b, a));
            let largest = forth.max(back);
            if largest > 0.0 { (forth - back).abs() / largest } else { 0.0 }
        };
        (0..all.len() * all.len()).step_by(step).map(pair).fold(0.0, f64::max)
    }
}
