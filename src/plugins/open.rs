//! From a name to the model of a plugin.

use super::description::{ModelDescription, parameters_json};
use super::limits::Limits;
use super::plugin::Plugin;
use super::route::Named;
use super::sandbox::Sandbox;
use super::subject::{Broken, Foreign};
use crate::bsdf::{Subject, SubjectError};
use crate::registry::Model;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

type Opened = Result<Arc<Plugin>, String>;

/// The plugins that were opened, each once.
#[derive(Default)]
pub struct Plugins {
    limits: Limits,
    opened: Mutex<HashMap<String, Opened>>,
}

impl Plugins {
    /// None yet; they will have these limits.
    pub fn new(limits: Limits) -> Self {
        Self { limits, opened: Mutex::default() }
    }

    /// What plugins may take.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The model that `name` names, FILE, FILE#MODEL or a command; `None` if it names
    /// no plugin. A plugin that cannot be opened has a model too, whose subjects say
    /// why: it must not keep others from being measured.
    pub fn model(&self, name: &str) -> Option<Result<Model, String>> {
        let (file, wanted) = match name.rsplit_once('#') {
            // A word of a command may begin with #.
            Some((file, model)) if !file.ends_with(char::is_whitespace) && Named::of(file).is_some() => {
                (file, Some(model))
            }
            _ => (name, None),
        };
        let plugin = match self.opened(file, &Named::of(file)?) {
            Ok(plugin) => plugin,
            Err(why) => return Some(Ok(broken(name, why))),
        };
        Some(match plugin.hello.model(file, wanted) {
            Ok(description) => Ok(model_of(&plugin, description, name, true)),
            Err(why) => Err(format!("`{file}` {why}")),
        })
    }

    /// The models of the plugin `file` and what they are, where it has several.
    pub fn models(&self, file: &str) -> Option<Vec<(String, String)>> {
        let plugin = self.opened(file, &Named::of(file)?).ok()?;
        Some(plugin.hello.names()).filter(|names| names.len() > 1)
    }

    fn opened(&self, file: &str, named: &Named) -> Opened {
        let mut all = self.opened.lock().unwrap_or_else(PoisonError::into_inner);
        all.entry(file.into()).or_insert_with(|| self.open(file, named)).clone()
    }

    fn open(&self, file: &str, named: &Named) -> Opened {
        let opened =
            named.route(&self.limits, None).and_then(|route| Plugin::open(file, route, &self.limits));
        opened.map(Arc::new).map_err(|fault| fault.to_string())
    }
}

/// The models that a plugin offers, each called as it calls them; a process is in `sandbox`.
/// They are held to the conventions that they declare: what contradicts them is a mistake.
///
/// # Errors
/// Why it cannot be opened.
pub fn offered(named: &Named, limits: &Limits, sandbox: &Arc<Sandbox>) -> Result<Vec<Model>, String> {
    let opened = named.route(limits, Some(sandbox)).and_then(|route| Plugin::open("it", route, limits));
    let plugin = Arc::new(opened.map_err(|fault| fault.to_string())?);
    Ok(plugin.hello.models.iter().map(|model| model_of(&plugin, model, &model.name, false)).collect())
}

/// A model of a plugin, which is called so; its conventions are `probed`.
fn model_of(plugin: &Arc<Plugin>, description: &ModelDescription, name: &str, probed: bool) -> Model {
    let (plugin, declaring, called) = (plugin.clone(), description.clone(), name.to_string());
    let model = Model::dynamic(name, description.doc.clone(), move |parameters| {
        let made = Foreign::create(&plugin, &declaring, parameters_json(parameters), probed);
        Ok(match made {
            Ok(subject) => Arc::new(subject) as Arc<dyn Subject>,
            Err(why) => Arc::new(Broken { name: called.clone(), why }),
        })
    });
    description.declare(model)
}

/// The model of a plugin that cannot be opened.
fn broken(name: &str, why: String) -> Model {
    let called = name.to_string();
    Model::new(name, "a plugin that cannot be opened", move |_| {
        Ok(Broken { name: called.clone(), why: SubjectError::Broken(why.clone()) })
    })
    .with_any_parameter()
}
