//! What a plugin says of its models, as it is read.

use super::conventions::Conventions;
use super::instance::Fault;
use crate::bsdf::{ClaimsPatch, Description, Has, MAX_CHANNELS, Precision, RandomNumbers};
use crate::registry::{Model, Parameters, Role, nearest};
use serde::Deserialize;
use serde_json::Value as Json;

/// The version of the protocol that gonio speaks.
pub const PROTOCOL: u64 = 1;

/// The answer to `describe` without a handle.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hello {
    protocol: u64,
    /// Whether several instances of the plugin may run at once.
    #[serde(default = "yes")]
    pub parallel: bool,
    /// Its models.
    pub models: Vec<ModelDescription>,
    /// Bytes that follow in a frame: none.
    #[serde(default, rename = "bytes")]
    _bytes: u64,
}

fn yes() -> bool {
    true
}

/// What a plugin says of a model and, where parameters matter, of one subject.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelDescription {
    /// Its name.
    #[serde(default)]
    pub name: String,
    /// One line.
    #[serde(default)]
    pub doc: String,
    channels: Option<Vec<String>>,
    dimensions: Option<usize>,
    precision: Option<Precision>,
    has: Option<Vec<HasFunction>>,
    #[serde(default)]
    claims: ClaimsPatch,
    conventions: Option<Conventions>,
    #[serde(default)]
    parameters: Vec<ParameterDescription>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum HasFunction {
    Eval,
    Pdf,
    Sample,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, tag = "type", rename_all = "lowercase")]
enum ParameterDescription {
    Number {
        name: String,
        default: f64,
        min: f64,
        max: f64,
        #[serde(default)]
        doc: String,
        role: Option<ParameterRole>,
        #[serde(default)]
        idle: bool,
    },
    Choice {
        name: String,
        options: Vec<String>,
        default: Option<String>,
        #[serde(default)]
        doc: String,
        #[serde(default)]
        idle: bool,
    },
    File {
        name: String,
        #[serde(default)]
        doc: String,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ParameterRole {
    Roughness,
    Eta,
}

/// Reads the answer to `describe`.
pub fn hello(text: &str) -> Result<Hello, Fault> {
    let bad = |why: String| Fault::Ended(format!("its description is wrong: {why}"));
    let hello: Hello = read(text).map_err(bad)?;
    if hello.protocol != PROTOCOL {
        return Err(bad(format!("it speaks protocol {}, gonio speaks {PROTOCOL}", hello.protocol)));
    }
    if hello.models.is_empty() {
        return Err(bad("it has no models".into()));
    }
    for (k, model) in hello.models.iter().enumerate() {
        model.check().map_err(|why| bad(format!("model `{}`: {why}", model.name)))?;
        if hello.models[..k].iter().any(|m| m.name == model.name) {
            return Err(bad(format!("two models are called `{}`", model.name)));
        }
    }
    Ok(hello)
}

/// JSON of a known shape; the message says what is wrong and where.
fn read<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|e| {
        let line = text.lines().nth(e.line().saturating_sub(1)).unwrap_or("");
        let start = (0..=e.column().saturating_sub(40)).rev().find(|at| line.is_char_boundary(*at));
        let near: String = line[start.unwrap_or(0)..].chars().take(60).collect();
        format!("{e}, near `{near}`")
    })
}

impl ModelDescription {
    fn check(&self) -> Result<(), String> {
        let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return Err("a name has letters, digits, and - _ . only".into());
        }
        self.check_traits()?;
        let mut names: Vec<&str> = Vec::new();
        for parameter in &self.parameters {
            let name = parameter.name();
            if name.is_empty() || !name.chars().all(plain) {
                return Err(format!("the parameter `{name}` needs a name of letters, digits, and - _ ."));
            }
            if names.contains(&name) {
                return Err(format!("two parameters are called `{name}`"));
            }
            names.push(name);
            parameter.check()?;
        }
        Ok(())
    }

    /// What a subject of this model is, called `name`; `own` is what the plugin says
    /// of this very one.
    pub fn describe(&self, name: &str, own: Option<&str>) -> Result<(Description, Conventions), Fault> {
        let own: Self = match own {
            Some(text) => {
                read(text).and_then(|own: Self| own.check_traits().map(|()| own)).map_err(|why| {
                    Fault::Refused(format!("what it describes of `{}` is wrong: {why}", self.name))
                })?
            }
            None => Self::default(),
        };
        let has = own.has.as_ref().or(self.has.as_ref()).map_or_else(Has::default, |has| Has {
            eval: has.contains(&HasFunction::Eval),
            pdf: has.contains(&HasFunction::Pdf),
            sample: has.contains(&HasFunction::Sample),
        });
        let channels = own.channels.as_ref().or(self.channels.as_ref()).cloned();
        let description = Description::new(name)
            .channels(channels.unwrap_or_else(|| vec!["value".into()]))
            .dimensions(own.dimensions.or(self.dimensions).unwrap_or(3))
            .precision(own.precision.or(self.precision).unwrap_or_default())
            .has(has)
            .claims(|claims| *claims = own.claims.over(self.claims.over(*claims)));
        Ok((description, own.conventions.or(self.conventions).unwrap_or_default()))
    }

    /// Whether its draws come from a generator of its own.
    pub fn draws_by_itself(&self) -> bool {
        self.claims.rng == Some(RandomNumbers::Internal)
    }

    /// Declares the parameters on `model`.
    pub fn declare(&self, mut model: Model) -> Model {
        for parameter in &self.parameters {
            model = match parameter {
                ParameterDescription::Number { name, default, min, max, doc, role, .. } => {
                    let model = model.number(name, *default, *min..=*max, doc);
                    match role {
                        Some(ParameterRole::Roughness) => model.role(Role::Roughness),
                        Some(ParameterRole::Eta) => model.role(Role::Eta),
                        None => model,
                    }
                }
                ParameterDescription::Choice { name, options, default, doc, .. } => {
                    let mut options: Vec<&str> = options.iter().map(String::as_str).collect();
                    if let Some(first) = options.iter().position(|o| Some(*o) == default.as_deref()) {
                        options.swap(0, first);
                    }
                    model.choice(name, &options, doc)
                }
                ParameterDescription::File { name, doc } => model.file(name, doc),
            };
            if parameter.is_idle() {
                model = model.idle();
            }
        }
        model
    }

    fn check_traits(&self) -> Result<(), String> {
        if let Some(channels) = &self.channels
            && !(1..=MAX_CHANNELS).contains(&channels.len())
        {
            return Err(format!("{} channels; a subject has 1 to {MAX_CHANNELS}", channels.len()));
        }
        // A random number a dimension and row is a buffer of 8 MiB then.
        if self.dimensions.is_some_and(|d| d > 256) {
            return Err(format!("{} dimensions of u; at most 256", self.dimensions.unwrap_or(0)));
        }
        match self.claims.eta {
            Some(eta) if !(eta > 0.0 && eta.is_finite()) => {
                Err(format!("the claim eta = {eta} is not an index"))
            }
            _ => Ok(()),
        }
    }
}

impl ParameterDescription {
    fn name(&self) -> &str {
        match self {
            Self::Number { name, .. } | Self::Choice { name, .. } | Self::File { name, .. } => name,
        }
    }

    fn is_idle(&self) -> bool {
        matches!(self, Self::Number { idle: true, .. } | Self::Choice { idle: true, .. })
    }

    fn check(&self) -> Result<(), String> {
        match self {
            Self::Number { name, default, min, max, .. } => {
                if !(min <= default && default <= max && min.is_finite() && max.is_finite()) {
                    return Err(format!("the default {default} of `{name}` is not from {min} to {max}"));
                }
            }
            Self::Choice { name, options, default, .. } => {
                if options.is_empty() {
                    return Err(format!("`{name}` has no options"));
                }
                if let Some(default) = default.as_ref().filter(|d| !options.contains(d)) {
                    return Err(format!("the default `{default}` of `{name}` is none of its options"));
                }
            }
            Self::File { .. } => {}
        }
        Ok(())
    }
}

impl Hello {
    /// The names of the models, and what they are.
    pub fn names(&self) -> Vec<(String, String)> {
        self.models.iter().map(|m| (m.name.clone(), m.doc.clone())).collect()
    }

    /// The model that `wanted` names; the only one where it names none.
    pub fn model(&self, file: &str, wanted: Option<&str>) -> Result<&ModelDescription, String> {
        let names: Vec<&str> = self.models.iter().map(|m| m.name.as_str()).collect();
        match wanted {
            None if names.len() == 1 => Ok(&self.models[0]),
            None => {
                Err(format!("has {} models: write {file}#{}", names.len(), names.join(&format!(", {file}#"))))
            }
            Some(name) => self.models.iter().find(|m| m.name == name).ok_or_else(|| {
                match nearest(name, names.iter().copied()) {
                    Some(n) => format!("has no model `{name}`; did you mean `{n}`?"),
                    None => format!("has no model `{name}`; there are {}", names.join(", ")),
                }
            }),
        }
    }
}

/// Parameters as `create` takes them.
pub fn parameters_json(parameters: &Parameters) -> String {
    serde_json::to_string(&Json::Object(
        parameters.0.iter().map(|(name, value)| (name.clone(), serde_json::json!(value))).collect(),
    ))
    .unwrap_or_else(|_| "{}".into())
}
