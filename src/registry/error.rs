//! Mistakes in naming a subject, each with what to type next.

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
