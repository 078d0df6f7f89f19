//! What a subject says of itself.

use super::{Claims, MAX_CHANNELS};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The floating-point precision in which a subject computes. Tolerances follow
/// from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// 24 bits of mantissa.
    F32,
    /// 53 bits of mantissa.
    #[default]
    F64,
}

/// Which of the three functions a subject has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Has {
    /// The value.
    pub eval: bool,
    /// The density.
    pub pdf: bool,
    /// The sampler.
    pub sample: bool,
}

impl Default for Has {
    fn default() -> Self {
        Self { eval: true, pdf: true, sample: true }
    }
}

/// What a subject says of itself, before anything is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Description {
    /// The name in reports.
    pub name: String,
    /// Names of the channels, 1 to 16: `r g b`, or wavelengths.
    pub channels: Vec<String>,
    /// How many random numbers `sample` reads.
    pub dimensions: usize,
    /// In which it computes.
    pub precision: Precision,
    /// Which functions it has.
    pub has: Has,
    /// What it promises.
    pub claims: Claims,
    /// Whether its sampler and pdf follow its values only as far as a table's
    /// resolution goes: the tolerance is that of tables then (METHOD §3), not of
    /// `precision`. A sampler that is exact on its table needs none of it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tabulated: bool,
}

impl Description {
    /// A subject with one channel called `value`, three random numbers, f64,
    /// all three functions and the default claims.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            channels: vec!["value".into()],
            dimensions: 3,
            precision: Precision::F64,
            has: Has::default(),
            claims: Claims::default(),
            tabulated: false,
        }
    }

    /// With channels of these names (1 to 16 of them).
    pub fn channels<S: Into<String>>(mut self, names: impl IntoIterator<Item = S>) -> Self {
        self.channels = names.into_iter().map(Into::into).collect();
        assert!(
            (1..=MAX_CHANNELS).contains(&self.channels.len()),
            "a subject has 1 to {MAX_CHANNELS} channels, not {}",
            self.channels.len()
        );
        self
    }

    /// With `dimensions` random numbers a sample.
    pub fn dimensions(mut self, dimensions: usize) -> Self {
        self.dimensions = dimensions;
        self
    }

    /// With claims changed by `change`.
    pub fn claims(mut self, change: impl FnOnce(&mut Claims)) -> Self {
        change(&mut self.claims);
        self
    }

    /// With these functions.
    pub fn has(mut self, has: Has) -> Self {
        self.has = has;
        self
    }

    /// With a sampler that is as fine as a table is.
    pub fn tabulated(mut self) -> Self {
        self.tabulated = true;
        self
    }

    /// With this precision.
    pub fn precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }
}
