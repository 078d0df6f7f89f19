//! All models by name, and subjects made of them.

use super::error::{RegistryError, nearest};
use super::model::Model;
use super::parameter::{Kind, Parameters, Value};
use super::spelling::{Spelling, parenthesised};
use crate::bsdf::{Subject, SubjectKind};
use crate::diagnosis::{Explanation, Textbook, View};
use crate::plugins::{Limits, Named, Plugins};
use crate::{models, mutants};
use std::borrow::Cow;
use std::sync::Arc;

/// The model that files are.
pub const MEASURED: &str = "measured";

/// All registered models.
#[derive(Clone, Default)]
pub struct Registry {
    models: Arc<Vec<Model>>,
    /// Found by their names, but not listed.
    hidden: Option<fn(&str) -> Option<Model>>,
    /// Explanations of failures besides those that come with gonio.
    explanations: Vec<Arc<dyn Explanation>>,
    /// Models of plugins, opened where they are named.
    plugins: Arc<Plugins>,
}

impl Registry {
    /// No model.
    pub fn empty() -> Self {
        Self::default()
    }

    /// The models that come with gonio, and its mutants, which are not listed.
    pub fn builtin() -> Self {
        Self { models: Arc::new(models::all()), hidden: Some(mutants::model), ..Self::default() }
    }

    /// Adds a model; one of the same name is replaced.
    pub fn register(mut self, model: Model) -> Self {
        let models = Arc::make_mut(&mut self.models);
        models.retain(|m| m.name() != model.name());
        models.push(model);
        self
    }

    /// Adds an explanation of failures, which competes with those that come with
    /// gonio wherever a subject is diagnosed.
    ///
    /// ```
    /// use gonio::cause::Cause;
    /// use gonio::diagnosis::{Claim, Textbook, View};
    /// use gonio::registry::Registry;
    ///
    /// /// Our old shaders return a density of 1 wherever they have none.
    /// fn placeholder(view: &View, _: Option<&Textbook>) -> Vec<Claim> {
    ///     if view.cases.iter().flat_map(|case| &case.points).any(|point| point.pdf != 1.0) {
    ///         return Vec::new();
    ///     }
    ///     vec![Claim::new(Cause::ConstantFactor, "pdf() is the placeholder 1", "write pdf()")]
    /// }
    ///
    /// let registry = Registry::builtin().explanation(placeholder);
    /// assert_eq!(registry.explanations().len(), 1);
    /// ```
    pub fn explanation(mut self, explanation: impl Explanation + 'static) -> Self {
        self.explanations.push(Arc::new(explanation));
        self
    }

    /// The explanations that were added.
    pub fn explanations(&self) -> Vec<Box<dyn Explanation>> {
        let boxed = |shared: &Arc<dyn Explanation>| -> Box<dyn Explanation> {
            let shared = shared.clone();
            Box::new(move |view: &View, book: Option<&Textbook>| shared.claims(view, book))
        };
        self.explanations.iter().map(boxed).collect()
    }

    /// With these limits for plugins; those that were opened are opened anew.
    pub fn limited(&self, limits: &Limits) -> Self {
        let same = self.plugins.limits() == limits;
        let plugins = if same { self.plugins.clone() } else { Arc::new(Plugins::new(*limits)) };
        Self { plugins, ..self.clone() }
    }

    /// The models of a plugin that has several, each as it is written and what it is.
    pub fn models_of_plugin(&self, name: &str) -> Option<Vec<(String, String)>> {
        if self.models.iter().any(|m| m.name() == name) {
            return None;
        }
        let models = self.plugins.models(name)?;
        Some(models.into_iter().map(|(model, doc)| (format!("{name}#{model}"), doc)).collect())
    }

    /// All models that are listed.
    pub fn models(&self) -> impl Iterator<Item = &Model> {
        self.models.iter()
    }

    /// The model `name`.
    pub fn model(&self, name: &str) -> Result<Cow<'_, Model>, RegistryError> {
        let listed = self.models.iter().find(|m| m.name() == name).map(Cow::Borrowed);
        let found = listed.or_else(|| self.hidden.and_then(|find| find(name)).map(Cow::Owned));
        if let (None, Some(plugin)) = (&found, self.plugins.model(name)) {
            let wrong = |message| RegistryError::Build { model: name.into(), message };
            return plugin.map(Cow::Owned).map_err(wrong);
        }
        found.ok_or_else(|| RegistryError::UnknownModel {
            name: name.into(),
            nearest: nearest(name, self.models.iter().map(Model::name)),
            known: self.models().map(|m| m.name().to_string()).collect(),
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
            .filter(|(name, _)| {
                model.takes_any() || model.parameter(name).is_ok_and(|p| p.applies(&parameters))
            })
            .cloned()
            .collect();
        parameters = model.complete(&applying)?;
        for p in model.parameters().iter().filter(|p| matches!(p.kind, Kind::Subject { .. })) {
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
        let is_file = std::path::Path::new(text).is_file() && Named::of(name).is_none();
        (is_file && self.model(name).is_err()).then(|| format!("{MEASURED}:file={}", parenthesised(text)))
    }

    /// The subject that the parameter `parameter` names, and its one spelling.
    pub(super) fn nested(
        &self,
        parameter: &str,
        text: &str,
    ) -> Result<(String, Arc<dyn Subject>), RegistryError> {
        let resolved = text.parse().and_then(|spelling: Spelling| {
            let kind = self.model(&spelling.name)?.kind();
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
