//! Name and parameters to subject: the one place where a model is listed.
//!
//! A model declares its parameters once; `gonio list`, validation, error
//! messages, suites and the `sensitivity` check all read that declaration.

use crate::bsdf::Subject;
use crate::models;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

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
}

impl Parameter {
    /// The default.
    pub fn default(&self) -> Value {
        match &self.kind {
            Kind::Number { default, .. } => Value::Number(*default),
            Kind::Choice { default, .. } => Value::Text(default.clone()),
        }
    }

    /// Whether it matters for a subject with these parameters.
    pub fn applies(&self, parameters: &Parameters) -> bool {
        self.only_when.as_ref().is_none_or(|(name, values)| values.iter().any(|v| v == parameters.text(name)))
    }

    fn check(&self, value: &Value) -> Result<(), RegistryError> {
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

    /// The word `name`.
    ///
    /// # Panics
    /// If the model did not declare it as a choice.
    pub fn text(&self, name: &str) -> &str {
        match self.0.get(name) {
            Some(Value::Text(v)) => v,
            other => panic!("the model declares no choice `{name}` (found {other:?})"),
        }
    }
}

type Build = dyn Fn(&Parameters) -> Result<Arc<dyn Subject>, String> + Send + Sync;

/// A registered model: a name, its parameters and how to build it.
#[derive(Clone)]
pub struct Model {
    name: String,
    doc: String,
    parameters: Vec<Parameter>,
    build: Arc<Build>,
}

impl Model {
    /// A model called `name`, described in one line, without parameters yet.
    pub fn new<S: Subject + 'static>(
        name: impl Into<String>,
        doc: impl Into<String>,
        build: impl Fn(&Parameters) -> Result<S, String> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            doc: doc.into(),
            parameters: Vec::new(),
            build: Arc::new(move |p| Ok(Arc::new(build(p)?) as Arc<dyn Subject>)),
        }
    }

    /// Declares a number in `range`.
    pub fn number(
        mut self,
        name: &str,
        default: f64,
        range: std::ops::RangeInclusive<f64>,
        doc: &str,
    ) -> Self {
        self.parameters.push(Parameter {
            name: name.into(),
            kind: Kind::Number { default, min: *range.start(), max: *range.end() },
            doc: doc.into(),
            role: None,
            only_when: None,
        });
        self
    }

    /// Declares a choice; the first option is the default.
    pub fn choice(mut self, name: &str, options: &[&str], doc: &str) -> Self {
        self.parameters.push(Parameter {
            name: name.into(),
            kind: Kind::Choice {
                default: options[0].into(),
                options: options.iter().map(|o| (*o).to_string()).collect(),
            },
            doc: doc.into(),
            role: None,
            only_when: None,
        });
        self
    }

    /// The parameter declared last has this meaning.
    pub fn role(mut self, role: Role) -> Self {
        self.parameters.last_mut().expect("a parameter was declared").role = Some(role);
        self
    }

    /// The parameter declared last only matters while the choice `parameter`
    /// has one of `values`.
    pub fn only_when(mut self, parameter: &str, values: &[&str]) -> Self {
        self.parameters.last_mut().expect("a parameter was declared").only_when =
            Some((parameter.into(), values.iter().map(|v| (*v).to_string()).collect()));
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its line of documentation.
    pub fn doc(&self) -> &str {
        &self.doc
    }

    /// Its parameters in the order of declaration.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The declared parameter `name`.
    pub fn parameter(&self, name: &str) -> Result<&Parameter, RegistryError> {
        self.parameters.iter().find(|p| p.name == name).ok_or_else(|| RegistryError::UnknownParameter {
            model: self.name.clone(),
            parameter: name.into(),
            nearest: nearest(name, self.parameters.iter().map(|p| p.name.as_str())),
            known: self.parameters.iter().map(|p| p.name.clone()).collect(),
        })
    }

    /// All parameters, from those given and the defaults of the others.
    pub fn complete(&self, given: &[(String, Value)]) -> Result<Parameters, RegistryError> {
        let mut all: BTreeMap<_, _> = self.parameters.iter().map(|p| (p.name.clone(), p.default())).collect();
        for (name, value) in given {
            let parameter = self.parameter(name)?;
            parameter.check(value)?;
            // An option may look like a number.
            let word = matches!(parameter.kind, Kind::Choice { .. }).then(|| Value::Text(value.to_string()));
            all.insert(name.clone(), word.unwrap_or_else(|| value.clone()));
        }
        Ok(Parameters(all))
    }

    /// Builds the subject.
    pub fn build(&self, parameters: &Parameters) -> Result<Arc<dyn Subject>, RegistryError> {
        (self.build)(parameters).map_err(|message| RegistryError::Build { model: self.name.clone(), message })
    }

    /// How the subject is written: the name, and the parameters that are not
    /// at their default: `torrance-sparrow:distribution=ggx,alpha=0.1`.
    pub fn spell(&self, parameters: &Parameters) -> String {
        let given: Vec<_> = self
            .parameters
            .iter()
            .filter_map(|p| {
                let value = parameters.0.get(&p.name)?;
                (*value != p.default()).then(|| format!("{}={value}", p.name))
            })
            .collect();
        if given.is_empty() { self.name.clone() } else { format!("{}:{}", self.name, given.join(",")) }
    }
}

/// A subject as a person writes it: `NAME` or `NAME:KEY=VALUE,KEY=VALUE`.
#[derive(Clone, Debug, PartialEq)]
pub struct Spelling {
    /// The name of a registered model.
    pub name: String,
    /// Parameters that are given.
    pub parameters: Vec<(String, Value)>,
}

impl std::str::FromStr for Spelling {
    type Err = RegistryError;

    fn from_str(text: &str) -> Result<Self, RegistryError> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let mut parameters = Vec::new();
        for pair in rest.split(',').filter(|p| !p.is_empty()) {
            let Some((key, value)) = pair.split_once('=') else {
                return Err(RegistryError::Spelling { text: text.into(), part: pair.into() });
            };
            // `nan` and `inf` are words: no parameter takes them as numbers.
            let number = value.parse().ok().filter(|v: &f64| v.is_finite());
            let value = number.map_or_else(|| Value::Text(value.to_string()), Value::Number);
            parameters.push((key.to_string(), value));
        }
        Ok(Self { name: name.to_string(), parameters })
    }
}

/// All registered models.
#[derive(Clone, Default)]
pub struct Registry {
    models: Vec<Model>,
}

impl Registry {
    /// No model.
    pub fn empty() -> Self {
        Self::default()
    }

    /// The models that come with gonio.
    pub fn builtin() -> Self {
        Self { models: models::all() }
    }

    /// Adds a model; one of the same name is replaced.
    pub fn register(mut self, model: Model) -> Self {
        self.models.retain(|m| m.name != model.name);
        self.models.push(model);
        self
    }

    /// All models.
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The model `name`.
    pub fn model(&self, name: &str) -> Result<&Model, RegistryError> {
        self.models.iter().find(|m| m.name == name).ok_or_else(|| RegistryError::UnknownModel {
            name: name.into(),
            nearest: nearest(name, self.models.iter().map(Model::name)),
            known: self.models.iter().map(|m| m.name.clone()).collect(),
        })
    }
}

/// A mistake in naming a subject or its parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegistryError {
    /// No such model.
    #[error("no subject is called `{name}`{}", did_you_mean(.nearest, .known))]
    UnknownModel {
        /// As asked for.
        name: String,
        /// The closest that exists.
        nearest: Option<String>,
        /// All.
        known: Vec<String>,
    },
    /// No such parameter.
    #[error("`{model}` has no parameter `{parameter}`{}", did_you_mean(.nearest, .known))]
    UnknownParameter {
        /// Of which model.
        model: String,
        /// As asked for.
        parameter: String,
        /// The closest that exists.
        nearest: Option<String>,
        /// All.
        known: Vec<String>,
    },
    /// A value that the parameter does not take.
    #[error("`{parameter}` = `{value}` is not {expected}{}", suggestion(.nearest))]
    BadValue {
        /// Which parameter.
        parameter: String,
        /// As given.
        value: String,
        /// What it takes.
        expected: String,
        /// The closest that it takes.
        nearest: Option<String>,
    },
    /// Not NAME:KEY=VALUE,…
    #[error("`{part}` in `{text}` is not KEY=VALUE; write NAME:KEY=VALUE,KEY=VALUE")]
    Spelling {
        /// The whole text.
        text: String,
        /// The part that is wrong.
        part: String,
    },
    /// The parameters do not go together.
    #[error("`{model}` cannot be built: {message}")]
    Build {
        /// Which model.
        model: String,
        /// Why.
        message: String,
    },
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
}

fn did_you_mean(nearest: &Option<String>, known: &[String]) -> String {
    match nearest {
        Some(n) => format!("; did you mean `{n}`?"),
        None if known.is_empty() => "; there are none".into(),
        None => format!("; there are {}", known.join(", ")),
    }
}

/// The known word closest to `word`, if one is close enough to be meant.
pub fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<String> {
    known
        .map(|k| {
            let likeness = strsim::jaro_winkler(&word.to_lowercase(), &k.to_lowercase());
            let part = k.contains(word) || word.contains(k);
            (k, if part { likeness.max(0.8) } else { likeness })
        })
        // 0.75 keeps typing slips and drops unrelated words.
        .filter(|(_, likeness)| *likeness >= 0.75)
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(k, _)| k.to_string())
}
