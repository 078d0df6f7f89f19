//! How often an identity was looked at, how often it was broken, and where
//! it was broken worst.

use crate::bsdf::Direction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A place where something was measured, with the values found there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Place {
    /// The given direction.
    pub wo: Direction,
    /// The other direction, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wi: Option<Direction>,
    /// The random numbers that led there.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub u: Vec<f64>,
    /// What was found, by name.
    pub values: BTreeMap<String, crate::evidence::Figure>,
}

impl Place {
    /// Given `wo` and `wi`.
    pub fn pair(wo: Direction, wi: Direction) -> Self {
        Self { wo, wi: Some(wi), ..Self::default() }
    }

    /// With the random numbers that led there.
    pub fn drawn_by(mut self, u: &[f64]) -> Self {
        self.u = u.to_vec();
        self
    }

    /// With a named value.
    pub fn value(mut self, name: &str, value: f64) -> Self {
        self.values.insert(name.into(), value.into());
        self
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let angles =
            |d: Direction| format!("θ {:.3}°, φ {:.2}°", d.theta().to_degrees(), d.phi().to_degrees());
        write!(f, "wo ({})", angles(self.wo))?;
        if let Some(wi) = self.wi {
            write!(f, ", wi ({})", angles(wi))?;
        }
        if !self.u.is_empty() {
            write!(f, ", u {:?}", self.u)?;
        }
        for (name, value) in &self.values {
            write!(f, ", {name} = {:.6e}", value.0)?;
        }
        Ok(())
    }
}

/// How often an identity was looked at and broken, and the worst place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Times that it was looked at.
    pub checked: u64,
    /// Times that its error was not within the tolerance (NaN is not).
    pub broken: u64,
    /// The largest error; infinite where a value was NaN.
    pub worst: crate::evidence::Figure,
    /// Where that was.
    pub place: Option<Place>,
    /// The tolerance.
    pub tolerance: f64,
}

impl Tally {
    /// Nothing looked at yet.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, ..Self::default() }
    }

    /// Looks once: `error` must be at most the tolerance. The place is only
    /// made when it is the worst so far.
    #[inline]
    pub fn look(&mut self, error: f64, place: impl FnOnce() -> Place) {
        self.checked += 1;
        let within = error <= self.tolerance;
        // Not `error > tolerance`: NaN is broken too.
        if !within {
            self.broken += 1;
        }
        let error = if error.is_nan() { f64::INFINITY } else { error };
        if error > self.worst.0 || self.place.is_none() {
            self.worsen(error, place);
        }
    }

    #[cold]
    fn worsen(&mut self, error: f64, place: impl FnOnce() -> Place) {
        self.worst = error.into();
        self.place = Some(place());
    }

    /// Whether it was broken anywhere.
    pub fn is_broken(&self) -> bool {
        self.broken > 0
    }

    /// The share of looks that found it broken.
    pub fn share(&self) -> f64 {
        self.broken as f64 / self.checked.max(1) as f64
    }

    /// The smallest share of broken places that `checked` independent looks
    /// meet with probability 0.999: 1 − 0.001^(1/n).
    pub fn share_limit(&self) -> f64 {
        -(0.001f64.ln() / self.checked.max(1) as f64).exp_m1()
    }
}

/// The difference of two values that should be equal, relative to the larger;
/// below `floor` in both they count as equal. NaN if either is.
#[inline]
pub fn relative_error(a: f64, b: f64, floor: f64) -> f64 {
    if a == b || (a.abs() <= floor && b.abs() <= floor) {
        return 0.0;
    }
    (a - b).abs() / a.abs().max(b.abs())
}
