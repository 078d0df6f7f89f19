//! Name and parameters to subject: the one place where a model is listed.
//!
//! A model declares its parameters once; `gonio list`, validation, error
//! messages, suites and the `sensitivity` check all read that declaration.

use crate::bsdf::{FresnelFunction, Interface, NormalDistribution, Normals, Subject, SubjectKind};
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

    /// Whether it matters for a subject with these parameters.
    pub fn applies(&self, parameters: &Parameters) -> bool {
        let chosen =
            |(name, values): &(String, Vec<String>)| values.iter().any(|v| v == parameters.text(name));
        self.only_when.as_ref().is_none_or(chosen) && self.only_if.is_none_or(|c| (c.holds)(parameters))
    }

    /// A value in the form that it has for this parameter: words may look like
    /// numbers.
    fn as_declared(&self, value: &Value) -> Value {
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

/// The subjects that a model is made of, by the name of their parameter.
pub struct Parts(BTreeMap<String, Arc<dyn Subject>>);

impl Parts {
    /// The subject `name`.
    ///
    /// # Panics
    /// If the model did not declare it as a subject.
    pub fn subject(&self, name: &str) -> Arc<dyn Subject> {
        self.0.get(name).unwrap_or_else(|| panic!("the model declares no subject `{name}`")).clone()
    }
}

type Build = dyn Fn(&Parameters, &Parts) -> Result<Arc<dyn Subject>, String> + Send + Sync;

/// A registered model: a name, its parameters and how to build it.
#[derive(Clone)]
pub struct Model {
    name: String,
    kind: SubjectKind,
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
        Self::composed(name, doc, move |parameters, _| build(parameters))
    }

    /// As [`new`](Self::new), for a model made of other subjects.
    pub fn composed<S: Subject + 'static>(
        name: impl Into<String>,
        doc: impl Into<String>,
        build: impl Fn(&Parameters, &Parts) -> Result<S, String> + Send + Sync + 'static,
    ) -> Self {
        let build = move |p: &Parameters, parts: &Parts| Ok(Arc::new(build(p, parts)?) as Arc<dyn Subject>);
        Self {
            name: name.into(),
            kind: SubjectKind::Bsdf,
            doc: doc.into(),
            parameters: Vec::new(),
            build: Arc::new(build),
        }
    }

    /// As [`new`](Self::new), for a model whose parameters decide what type of
    /// subject it is.
    pub fn dynamic(
        name: impl Into<String>,
        doc: impl Into<String>,
        build: impl Fn(&Parameters) -> Result<Arc<dyn Subject>, String> + Send + Sync + 'static,
    ) -> Self {
        let build = move |p: &Parameters, _: &Parts| build(p);
        Self {
            name: name.into(),
            kind: SubjectKind::Bsdf,
            doc: doc.into(),
            parameters: Vec::new(),
            build: Arc::new(build),
        }
    }

    /// A distribution of normals. It comes with the parameter `sampling`, which
    /// says whether all normals are drawn or those visible from wo.
    pub fn distribution<D: NormalDistribution + 'static>(
        name: impl Into<String>,
        doc: impl Into<String>,
        build: impl Fn(&Parameters) -> Result<D, String> + Send + Sync + 'static,
    ) -> Self {
        let mut model = Self::new(name, doc, move |p| match p.text("sampling") {
            "visible-normals" => Normals::visible(build(p)?),
            _ => Ok(Normals::all(build(p)?)),
        });
        model.kind = SubjectKind::Distribution;
        model.choice("sampling", &["normals", "visible-normals"], "which normals are drawn")
    }

    /// A Fresnel function.
    pub fn fresnel<F: FresnelFunction + 'static>(
        name: impl Into<String>,
        doc: impl Into<String>,
        build: impl Fn(&Parameters) -> Result<F, String> + Send + Sync + 'static,
    ) -> Self {
        let mut model = Self::new(name, doc, move |p| build(p).map(Interface));
        model.kind = SubjectKind::Fresnel;
        model
    }

    fn declare(mut self, name: &str, kind: Kind, doc: &str) -> Self {
        self.parameters.push(Parameter {
            name: name.into(),
            kind,
            doc: doc.into(),
            role: None,
            only_when: None,
            only_if: None,
            idle: false,
        });
        self
    }

    /// Declares a number in `range`.
    pub fn number(self, name: &str, default: f64, range: std::ops::RangeInclusive<f64>, doc: &str) -> Self {
        self.declare(name, Kind::Number { default, min: *range.start(), max: *range.end() }, doc)
    }

    /// Declares a choice; the first option is the default.
    pub fn choice(self, name: &str, options: &[&str], doc: &str) -> Self {
        let options: Vec<_> = options.iter().map(|o| (*o).to_string()).collect();
        self.declare(name, Kind::Choice { default: options[0].clone(), options }, doc)
    }

    /// Declares another subject, `default` where none is given.
    pub fn subject(self, name: &str, default: &str, doc: &str) -> Self {
        self.declare(name, Kind::Subject { default: default.into() }, doc)
    }

    /// Declares a file, which must be given.
    pub fn file(self, name: &str, doc: &str) -> Self {
        self.declare(name, Kind::File, doc)
    }

    /// The parameter declared last has this meaning.
    pub fn role(mut self, role: Role) -> Self {
        self.parameters.last_mut().expect("a parameter was declared").role = Some(role);
        self
    }

    /// The parameter declared last may change nothing, and `sensitivity` leaves it
    /// alone.
    pub fn idle(mut self) -> Self {
        self.parameters.last_mut().expect("a parameter was declared").idle = true;
        self
    }

    /// The parameter declared last only matters while the choice `parameter`
    /// has one of `values`.
    pub fn only_when(mut self, parameter: &str, values: &[&str]) -> Self {
        self.parameters.last_mut().expect("a parameter was declared").only_when =
            Some((parameter.into(), values.iter().map(|v| (*v).to_string()).collect()));
        self
    }

    /// The parameter declared last only matters while `holds`, in `words`.
    pub fn only_if(mut self, words: &'static str, holds: fn(&Parameters) -> bool) -> Self {
        self.parameters.last_mut().expect("a parameter was declared").only_if =
            Some(Condition { words, holds });
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What its subjects are.
    pub fn kind(&self) -> SubjectKind {
        self.kind
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
        let mut all = BTreeMap::new();
        for (name, value) in given {
            let parameter = self.parameter(name)?;
            parameter.check(value)?;
            all.insert(name.clone(), parameter.as_declared(value));
        }
        for parameter in &self.parameters {
            if !all.contains_key(&parameter.name) {
                let missing = || RegistryError::Missing {
                    model: self.name.clone(),
                    parameter: parameter.name.clone(),
                    doc: parameter.doc.clone(),
                };
                all.insert(parameter.name.clone(), parameter.default().ok_or_else(missing)?);
            }
        }
        Ok(Parameters(all))
    }

    /// Builds the subject, and those that it is made of from `registry`.
    pub fn build(
        &self,
        parameters: &Parameters,
        registry: &Registry,
    ) -> Result<Arc<dyn Subject>, RegistryError> {
        let mut parts = BTreeMap::new();
        for p in self.parameters.iter().filter(|p| matches!(p.kind, Kind::Subject { .. })) {
            let (_, subject) = registry.nested(&p.name, parameters.text(&p.name))?;
            parts.insert(p.name.clone(), subject);
        }
        (self.build)(parameters, &Parts(parts))
            .map_err(|message| RegistryError::Build { model: self.name.clone(), message })
    }

    /// How the subject is written: the name, and the parameters that are not
    /// at their default: `torrance-sparrow:distribution=ggx,alpha=0.1`. A value
    /// that holds a comma or a parenthesis stands in parentheses.
    pub fn spell(&self, parameters: &Parameters) -> String {
        let given: Vec<_> = self
            .parameters
            .iter()
            .filter_map(|p| {
                let value = parameters.0.get(&p.name)?;
                let text = parenthesised(&value.to_string());
                (Some(value) != p.default().as_ref()).then(|| format!("{}={text}", p.name))
            })
            .collect();
        if given.is_empty() { self.name.clone() } else { format!("{}:{}", self.name, given.join(",")) }
    }
}

/// A subject as a person writes it: `NAME` or `NAME:KEY=VALUE,KEY=VALUE`. A value
/// with commas of its own stands in parentheses, as a nested subject's:
/// `blend:first=(lambert:reflectance=0.5,sampling=uniform)`.
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
        let bad = |part: &str| RegistryError::Spelling { text: text.into(), part: part.into() };
        let mut parameters = Vec::new();
        for (_, part) in Self::parts(rest) {
            let (key, value) = part.split_once('=').ok_or_else(|| bad(part))?;
            let inner = value.strip_prefix('(').and_then(|v| v.strip_suffix(')'));
            if !is_balanced(inner.unwrap_or(value)) {
                return Err(RegistryError::Parentheses { text: text.into(), part: part.into() });
            }
            // `nan` and `inf` are words: no parameter takes them as numbers.
            let number = value.parse().ok().filter(|v: &f64| v.is_finite());
            let word = || Value::Text(inner.unwrap_or(value).to_string());
            parameters.push((key.to_string(), number.map_or_else(word, Value::Number)));
        }
        Ok(Self { name: name.to_string(), parameters })
    }
}

impl Spelling {
    /// The parts of what follows `NAME:`, with the place where each starts:
    /// between commas that are not inside of parentheses, empty ones left out.
    pub fn parts(rest: &str) -> Vec<(usize, &str)> {
        let mut depth = 0i32;
        let mut start = 0;
        let mut parts = Vec::new();
        for (at, c) in rest.char_indices().chain([(rest.len(), ',')]) {
            depth += i32::from(c == '(') - i32::from(c == ')');
            if c == ',' && (depth <= 0 || at == rest.len()) {
                parts.push((start, &rest[start..at]));
                start = at + 1;
            }
        }
        parts.retain(|(_, part)| !part.is_empty());
        parts
    }
}

/// The model that files are.
pub const MEASURED: &str = "measured";

/// A value as it stands within the spelling of a subject.
fn parenthesised(text: &str) -> String {
    if text.contains([',', '(', ')']) { format!("({text})") } else { text.into() }
}

/// Whether each parenthesis has its partner.
fn is_balanced(text: &str) -> bool {
    let mut depth = 0;
    text.chars().all(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth >= 0
    }) && depth == 0
}

/// All registered models.
#[derive(Clone, Default)]
pub struct Registry {
    models: Arc<Vec<Model>>,
}

impl Registry {
    /// No model.
    pub fn empty() -> Self {
        Self::default()
    }

    /// The models that come with gonio.
    pub fn builtin() -> Self {
        Self { models: Arc::new(models::all()) }
    }

    /// Adds a model; one of the same name is replaced.
    pub fn register(mut self, model: Model) -> Self {
        let models = Arc::make_mut(&mut self.models);
        models.retain(|m| m.name != model.name);
        models.push(model);
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

    /// Looks up and builds a subject as it is written. A parameter that does not
    /// apply goes back to its default and nested subjects are spelled out, so
    /// that a subject has one spelling.
    pub fn resolve(&self, spelling: &Spelling) -> Result<Resolved, RegistryError> {
        let model = self.model(&spelling.name)?;
        let mut parameters = model.complete(&spelling.parameters)?;
        let applying: Vec<_> = spelling
            .parameters
            .iter()
            .filter(|(name, _)| model.parameter(name).is_ok_and(|p| p.applies(&parameters)))
            .cloned()
            .collect();
        parameters = model.complete(&applying)?;
        for p in model.parameters.iter().filter(|p| matches!(p.kind, Kind::Subject { .. })) {
            let (spelling, _) = self.nested(&p.name, parameters.text(&p.name))?;
            parameters.0.insert(p.name.clone(), Value::Text(spelling));
        }
        let subject = model.build(&parameters, self)?;
        Ok(Resolved { spelling: model.spell(&parameters), parameters, subject })
    }

    /// How the subject in a file is written, where `text` is no model's name but
    /// the path of a file: `measured:file=PATH`.
    pub fn spelling_of_file(&self, text: &str) -> Option<String> {
        let name = text.split_once(':').map_or(text, |(name, _)| name);
        let is_file = self.model(name).is_err() && std::path::Path::new(text).is_file();
        is_file.then(|| format!("{MEASURED}:file={}", parenthesised(text)))
    }

    /// The subject that the parameter `parameter` names, and its one spelling.
    fn nested(&self, parameter: &str, text: &str) -> Result<(String, Arc<dyn Subject>), RegistryError> {
        let resolved = text.parse().and_then(|spelling: Spelling| {
            let kind = self.model(&spelling.name)?.kind;
            if kind != SubjectKind::Bsdf {
                return Err(RegistryError::NotABsdf { name: spelling.name, kind: kind.noun() });
            }
            self.resolve(&spelling)
        });
        let wrong = |e| RegistryError::Nested { parameter: parameter.into(), error: Box::new(e) };
        resolved.map(|r| (r.spelling, r.subject)).map_err(wrong)
    }
}

/// A subject that was looked up and built.
#[derive(Clone)]
pub struct Resolved {
    /// Its one spelling.
    pub spelling: String,
    /// A value for each parameter.
    pub parameters: Parameters,
    /// The subject.
    pub subject: Arc<dyn Subject>,
}

/// A mistake in naming a subject or its parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegistryError {
    /// No such model.
    #[error("no subject is called `{name}`{}{}", and_no_file(.name), did_you_mean(.nearest, .known))]
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
    /// Parentheses without partners.
    #[error(
        "`{part}` in `{text}` has a parenthesis without its partner; write KEY=(NAME:KEY=VALUE,KEY=VALUE)"
    )]
    Parentheses {
        /// The whole text.
        text: String,
        /// The part that is wrong.
        part: String,
    },
    /// A parameter that has no default was not given.
    #[error("`{model}` needs `{parameter}`, {doc}; write {model}:{parameter}=…")]
    Missing {
        /// Which model.
        model: String,
        /// Which parameter.
        parameter: String,
        /// What it is.
        doc: String,
    },
    /// A nested subject is wrong.
    #[error("in `{parameter}`: {error}")]
    Nested {
        /// The parameter that names it.
        parameter: String,
        /// What is wrong with it.
        error: Box<RegistryError>,
    },
    /// A part of BSDFs stands where a BSDF is meant.
    #[error("`{name}` is a {kind} and no BSDF; `gonio list` shows what is")]
    NotABsdf {
        /// As asked for.
        name: String,
        /// What it is.
        kind: &'static str,
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

impl RegistryError {
    /// What is wrong itself, wherever it is nested.
    pub fn innermost(&self) -> &Self {
        match self {
            Self::Nested { error, .. } => error.innermost(),
            _ => self,
        }
    }
}

/// For what looks like the path of a file.
fn and_no_file(name: &str) -> &'static str {
    if name.contains(['/', '.', '\\']) { ", and there is no such file" } else { "" }
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
