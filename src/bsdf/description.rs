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

/// What a subject is, and with that which checks can say something of it.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum SubjectKind {
    /// A BSDF.
    #[default]
    Bsdf,
    /// A microfacet distribution of normals with its masking; in place of wi
    /// stand normals.
    Distribution,
    /// A reflectance by angle, without directions.
    Fresnel,
}

impl SubjectKind {
    /// Whether it is measured at given directions; what is not is measured once.
    pub fn has_directions(self) -> bool {
        self != Self::Fresnel
    }

    /// As it is written in lists.
    pub fn word(self) -> &'static str {
        match self {
            Self::Bsdf => "BSDF",
            Self::Distribution => "distribution",
            Self::Fresnel => "Fresnel",
        }
    }

    /// As it stands in a sentence after an article.
    pub fn noun(self) -> &'static str {
        match self {
            Self::Bsdf => "BSDF",
            Self::Distribution => "distribution of normals",
            Self::Fresnel => "Fresnel function",
        }
    }
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

/// What a subject that looks its values up in a table says of that table.
///
/// Between its nodes such a subject is only as smooth as its interpolation, so
/// integrals treat the errors of different cells as independent, and it equals
/// another subject only as far as its nodes resolve that one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Table {
    /// Share in [0, 1] of the table within reach that holds no data and counts as 0:
    /// energy is a lower bound then.
    pub missing: f64,
}

/// An identity that the very form of a subject guarantees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ByConstruction {
    /// The id of the check that could not fail.
    pub check: String,
    /// Why not.
    pub because: String,
}

/// What a subject says of itself, before anything is measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Description {
    /// The name in reports.
    pub name: String,
    /// What it is.
    #[serde(default)]
    pub kind: SubjectKind,
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
    /// Identities that its form guarantees: checks of them are skipped, for the
    /// reason given here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_construction: Vec<ByConstruction>,
    /// What keys its random numbers in place of how it is written, which for a plugin
    /// is a path: the same plugin is measured alike wherever it lies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// What a probe found to contradict the conventions that it declares.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contradictions: Vec<String>,
    /// Its table, if its values come from one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
}

impl Description {
    /// A subject with one channel called `value`, three random numbers, f64,
    /// all three functions and the default claims.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            kind: SubjectKind::Bsdf,
            channels: vec!["value".into()],
            dimensions: 3,
            precision: Precision::F64,
            has: Has::default(),
            claims: Claims::default(),
            by_construction: Vec::new(),
            key: None,
            contradictions: Vec::new(),
            table: None,
        }
    }

    /// What keys the random numbers of a subject that is written so.
    pub fn key<'a>(&'a self, spelling: &'a str) -> &'a str {
        self.key.as_deref().unwrap_or(spelling)
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

    /// With this precision.
    pub fn precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        self
    }

    /// With an identity that its form guarantees, because of this.
    pub fn by_construction(mut self, check: &str, because: &str) -> Self {
        self.by_construction.push(ByConstruction { check: check.into(), because: because.into() });
        self
    }

    /// With values that come from a table.
    pub fn table(mut self, table: Table) -> Self {
        self.table = Some(table);
        self
    }
}
