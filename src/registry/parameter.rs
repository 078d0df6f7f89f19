//! What a model declares of its parameters, and their values.

use super::error::{RegistryError, nearest};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(untagged)]
pub enum Value {
    /// A number.
    Number(f64),
    /// One of a parameter's options.
    Text(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(v) => write!(f, "{v}"),
            Self::Text(v) => f.write_str(v),
        }
    }
}

impl From<f64> for Value {
    fn from(v: f64) -> Self {
        Self::Number(v)
    }
}

impl From<&str> for Value {
    fn from(v: &str) -> Self {
        Self::Text(v.into())
    }
}

/// What values a parameter takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number in `min..=max`.
    Number {
        /// Where none is given.
        default: f64,
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// One of some words.
    Choice {
        /// Where none is given.
        default: String,
        /// All of them.
        options: Vec<String>,
    },
    /// Another registered subject, as a person writes it.
    Subject {
        /// Where none is given.
        default: String,
    },
    /// The path of a file. It must be given.
    File,
}

/// What a parameter means to checks that know its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// As it goes to its minimum, samples gather around the mirror or
    /// refracted directions.
    Roughness,
    /// Relative index of refraction: at 1 nothing is reflected.
    Eta,
}

/// A declared parameter of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// As written in suites and on the command line.
    pub name: String,
    /// Its values.
    pub kind: Kind,
    /// One line.
    pub doc: String,
    /// What it means, where a check can use that.
    pub role: Option<Role>,
    /// It only matters while this other parameter has one of these values.
    pub only_when: Option<(String, Vec<String>)>,
    /// It only matters while this holds of the other parameters.
    pub only_if: Option<Condition>,
    /// It may change nothing, as interpolation does to a constant table.
    pub idle: bool,
}

/// A condition on the parameters of a subject.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    /// As a reader is told: `ks > 0`.
    pub words: &'static str,
    /// Whether it holds.
    pub holds: fn(&Parameters) -> bool,
}

impl PartialEq for Condition {
    /// What reads the same is the same.
    fn eq(&self, other: &Self) -> bool {
        self.words == other.words
    }
}

impl Parameter {
    /// The default; `None` where a value must be given.
    pub fn default(&self) -> Option<Value> {
        match &self.kind {
            Kind::Number { default, .. } => Some(Value::Number(*default)),
            Kind::Choice { default, .. } | Kind::Subject { default } => Some(Value::Text(default.clone())),
            Kind::File => None,
        }
    }

    /// Makes `value`, which it takes, its default.
    pub(super) fn set_default(&mut self, value: &Value) {
        match (&mut self.kind, value) {
            (Kind::Number { default, .. }, Value::Number(v)) => *default = *v,
            (Kind::Choice { default, .. } | Kind::Subject { default }, v) => *default = v.to_string(),
            _ => {}
        }
    }

    /// Whether it matters for a subject with these parameters.
    pub fn applies(&self, parameters: &Parameters) -> bool {
        let chosen =
            |(name, values): &(String, Vec<String>)| values.iter().any(|v| v == parameters.text(name));
        self.only_when.as_ref().is_none_or(chosen) && self.only_if.is_none_or(|c| (c.holds)(parameters))
    }

    /// A value in the form that it has for this parameter: words may look like
    /// numbers.
    pub(super) fn as_declared(&self, value: &Value) -> Value {
        match self.kind {
            Kind::Number { .. } => value.clone(),
            _ => Value::Text(value.to_string()),
        }
    }

    /// Whether the parameter takes this value. A nested subject is only looked up
    /// when it is built.
    pub fn check(&self, value: &Value) -> Result<(), RegistryError> {
        let bad = |expected: String, nearest: Option<String>| RegistryError::BadValue {
            parameter: self.name.clone(),
            value: value.to_string(),
            expected,
            nearest,
        };
        match (&self.kind, value) {
            (Kind::Number { min, max, .. }, Value::Number(v)) if v >= min && v <= max => Ok(()),
            (Kind::Number { min, max, .. }, Value::Number(v)) => {
                let nearest = if v < min { min } else { max };
                Err(bad(format!("a number from {min} to {max}"), v.is_finite().then(|| nearest.to_string())))
            }
            (Kind::Number { min, max, .. }, Value::Text(_)) => {
                Err(bad(format!("a number from {min} to {max}"), None))
            }
            (Kind::Choice { options, .. }, v) => {
                let text = v.to_string();
                if options.contains(&text) {
                    return Ok(());
                }
                let nearest = nearest(&text, options.iter().map(String::as_str));
                Err(bad(format!("one of {}", options.join(", ")), nearest))
            }
            (Kind::Subject { .. }, v) if v.to_string().is_empty() => {
                Err(bad("a subject: NAME or NAME:KEY=VALUE".into(), None))
            }
            (Kind::File, v) if v.to_string().is_empty() => Err(bad("the path of a file".into(), None)),
            (Kind::Subject { .. } | Kind::File, _) => Ok(()),
        }
    }
}

/// A value for each declared parameter of a model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(transparent)]
pub struct Parameters(pub BTreeMap<String, Value>);

impl Parameters {
    /// The number `name`.
    ///
    /// # Panics
    /// If the model did not declare it as a number.
    pub fn number(&self, name: &str) -> f64 {
        match self.0.get(name) {
            Some(Value::Number(v)) => *v,
            other => panic!("the model declares no number `{name}` (found {other:?})"),
        }
    }

    /// The word `name`: an option, a path, or how a nested subject is written.
    ///
    /// # Panics
    /// If the model did not declare it as one of these.
    pub fn text(&self, name: &str) -> &str {
        match self.0.get(name) {
            Some(Value::Text(v)) => v,
            other => panic!("the model declares no word `{name}` (found {other:?})"),
        }
    }
}
