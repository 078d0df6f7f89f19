//! A registered model: its name, its parameters and how it is built.

use super::error::{RegistryError, nearest};
use super::models::Registry;
use super::parameter::{Condition, Kind, Parameter, Parameters, Role, Value};
use super::spelling::parenthesised;
use crate::bsdf::{FresnelFunction, Interface, NormalDistribution, Normals, Subject, SubjectKind};
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

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
    /// Whether it takes parameters that it does not declare.
    any: bool,
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
            any: false,
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
            any: false,
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

    /// Takes over what `other` declares, with `given` as defaults: the subjects of
    /// both are of one kind and have the same parameters.
    ///
    /// # Panics
    /// If `other` does not declare one of `given`, or not with this value.
    pub fn with_parameters_of(mut self, other: &Self, given: &[(String, Value)]) -> Self {
        self.kind = other.kind;
        self.parameters = other.parameters.clone();
        for (name, value) in given {
            let parameter = self.parameters.iter_mut().find(|p| &p.name == name);
            let parameter = parameter.unwrap_or_else(|| panic!("`{}` declares no `{name}`", other.name));
            parameter.check(value).unwrap_or_else(|e| panic!("{e}"));
            parameter.set_default(value);
        }
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

    /// Takes parameters that are not declared, of whatever kind: what it declares is
    /// not known.
    pub(crate) fn with_any_parameter(mut self) -> Self {
        self.any = true;
        self
    }

    /// Whether it takes parameters that it does not declare.
    pub(crate) fn takes_any(&self) -> bool {
        self.any
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
        if self.any {
            return Ok(Parameters(given.iter().cloned().collect()));
        }
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
        // A constructor that panics refuses these parameters, and nothing more.
        let build = AssertUnwindSafe(|| (self.build)(parameters, &Parts(parts)));
        let built = catch_unwind(build).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Err(format!("its constructor panicked: {}", text.unwrap_or("without a word")))
        });
        built.map_err(|message| RegistryError::Build { model: self.name.clone(), message })
    }

    /// How the subject is written: the name, and the parameters that are not
    /// at their default: `torrance-sparrow:distribution=ggx,alpha=0.1`. A value
    /// that holds a comma or a parenthesis stands in parentheses.
    pub fn spell(&self, parameters: &Parameters) -> String {
        if self.any {
            let given = parameters.0.iter().map(|(name, value)| format!("{name}={value}"));
            let given: Vec<String> = given.collect();
            return if given.is_empty() {
                self.name.clone()
            } else {
                format!("{}:{}", self.name, given.join(","))
            };
        }
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
