//! The counts over what pdf() predicts, along the plane of incidence.

use super::textbook::Textbook;
use super::view::{Seen, View};
use crate::bsdf::Direction;
use crate::evidence::{Evidence, Plane, Stretch, Strip};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Fewer bins are no curve.
const FEWEST: usize = 6;

/// Places of a prediction: one a degree where nothing is narrow.
const PLACES: f64 = 180.0;

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
    /// What was counted in a case, with no prediction; `None` where that is no curve.
    pub fn counted(evidence: &Evidence) -> Option<Self> {
        if !evidence.description.has.pdf {
            return None;
        }
        let strips = Plane::strips(evidence)?;
        let told = strips.iter().filter(|s| s.ratio().is_some());
        let bin = |s: &Strip| Bin { theta_deg: s.degrees, observed: s.observed, expected: s.expected };
        let bins: Vec<Bin> = told.map(bin).collect();
        (bins.len() >= FEWEST).then_some(Self { wo: evidence.wo, bins, predicted: Vec::new() })
    }

    /// Of a case; `book` has the right density where the claim predicts one.
    pub(super) fn of(view: &View, seen: &Seen, book: Option<&Textbook>) -> Option<Self> {
        let counted = Self::counted(seen.evidence)?;
        let Some(book) = book else { return Some(counted) };
        let plane = Plane::of(seen.wo);
        let stretch = counted.stretch();
        let [first, last] = [counted.bins.first()?, counted.bins.last()?].map(|b| stretch.place(b.theta_deg));
        let step = (stretch.place(180.0) - stretch.place(-180.0)) / (2.0 * PLACES);
        let places = (0..).map(|k| first + f64::from(k) * step).take_while(|t| *t <= last + step);
        let degrees: Vec<f64> = places.map(|t| stretch.angle(t)).collect();
        let wi: Vec<Direction> = degrees.iter().map(|x| plane.direction(*x)).collect();
        let told = view.pdf(seen.wo, &wi, seen.transport);
        let ratio = |(wi, told): (&Direction, f64)| book.pdf(seen.wo, *wi) / told;
        let ratios = wi.iter().zip(told).map(ratio);
        let mut predicted: Vec<(f64, f64)> = degrees.iter().copied().zip(ratios).collect();
        predicted.retain(|(_, r)| r.is_finite() && *r > 0.0);
        Some(Self { predicted, ..counted })
    }

    /// The axis on which its bins are seen.
    pub fn stretch(&self) -> Stretch {
        Stretch::of(self.bins.iter().map(|b| (b.theta_deg, b.observed + b.expected)))
    }
}
