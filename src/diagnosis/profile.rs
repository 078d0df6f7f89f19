//! The counts over what pdf() predicts, along the plane of incidence.

use super::counts::Counts;
use super::textbook::Textbook;
use super::view::{Seen, View};
use crate::bsdf::Direction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Leaves are near the plane whose middle is within so many degrees of it.
const NEAR: f64 = 8.0;

/// Degrees of a bin, and how many bins may be taken together to expect enough.
const BIN: f64 = 3.0;
const MOST_BINS: usize = 5;
const ENOUGH: f64 = 16.0;

/// Leaves near the plane with similar θ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bin {
    /// The mean θ in degrees, below 0 on the side of wo; beyond 90 it is transmitted.
    pub theta_deg: f64,
    /// What was counted.
    pub observed: f64,
    /// What pdf() predicts.
    pub expected: f64,
}

impl Bin {
    /// Observed over expected, and its standard error.
    pub fn ratio(&self) -> (f64, f64) {
        (self.observed / self.expected, self.observed.max(1.0).sqrt() / self.expected)
    }
}

/// Along the plane of incidence of one wo.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Profile {
    /// The given direction.
    pub wo: Direction,
    /// By θ.
    pub bins: Vec<Bin>,
    /// What a claim about pdf() predicts: the right density over pdf(), by θ.
    pub predicted: Vec<(f64, f64)>,
}

impl Profile {
    /// Of a case; `book` has the right density where the claim predicts one.
    pub(super) fn of(view: &View, seen: &Seen, counts: &Counts, book: Option<&Textbook>) -> Option<Self> {
        let wo = seen.wo;
        let (sin, cos) = wo.phi().sin_cos();
        let side = wo.z.signum();
        // Away from wo, and up on its side.
        let theta = |wi: Direction| (-(wi.x * cos + wi.y * sin)).atan2(side * wi.z).to_degrees();
        let count = (360.0 / BIN) as usize;
        let mut fine = vec![Bin::default(); count];
        for (leaf, observed) in counts.leaves.iter().enumerate() {
            let own = counts.own_nodes(leaf);
            let wi = own.middle;
            if (wi.y * cos - wi.x * sin).abs() > NEAR.to_radians().sin() {
                continue;
            }
            let (theta, expected) = (theta(wi), counts.own[leaf] * counts.draws as f64);
            let bin = &mut fine[(((theta + 180.0) / BIN) as usize).min(count - 1)];
            bin.theta_deg += theta * expected;
            bin.expected += expected;
            bin.observed += *observed as f64;
        }
        let mut bins = Vec::new();
        let (mut open, mut of) = (Bin::default(), 0);
        for bin in fine {
            of += 1;
            open.theta_deg += bin.theta_deg;
            open.expected += bin.expected;
            open.observed += bin.observed;
            if open.expected >= ENOUGH || of == MOST_BINS {
                if open.expected >= 1.0 {
                    bins.push(Bin { theta_deg: open.theta_deg / open.expected, ..open });
                }
                (open, of) = (Bin::default(), 0);
            }
        }
        let ends = (bins.first()?.theta_deg.floor() as i32, bins.last()?.theta_deg.ceil() as i32);
        let mut predicted = Vec::new();
        if let Some(book) = book {
            let at = |degrees: i32| {
                let (s, c) = f64::from(degrees).to_radians().sin_cos();
                Direction::new(-s * cos, -s * sin, c * side)
            };
            let wi: Vec<Direction> = (ends.0..=ends.1).map(at).collect();
            let told = view.pdf(wo, &wi, seen.transport);
            let ratio = |(wi, told): (&Direction, f64)| book.pdf(wo, *wi) / told;
            let ratios = wi.iter().zip(told).map(ratio);
            predicted = (ends.0..=ends.1).map(f64::from).zip(ratios).collect();
            predicted.retain(|(_, r)| r.is_finite() && *r > 0.0);
        }
        (bins.len() >= 6).then_some(Self { wo, bins, predicted })
    }
}
