//! Mistakes in a suite, with their places in its text.

use crate::registry::RegistryError;
use miette::{Diagnostic, NamedSource, SourceSpan};
use std::ops::Range;

/// One mistake in a suite.
#[derive(Clone, Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
pub struct Mistake {
    /// What is wrong.
    pub message: String,
    /// Where, in bytes of the text.
    #[label("{label}")]
    pub span: SourceSpan,
    /// In a word, at the place.
    pub label: String,
    /// What to type.
    #[help]
    pub help: Option<String>,
}

impl Mistake {
    /// A mistake at `span`.
    pub fn new(span: Range<usize>, message: impl Into<String>, label: impl Into<String>) -> Self {
        Self { message: message.into(), span: span.into(), label: label.into(), help: None }
    }

    /// With what to type instead.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// What the registry says of a name or value at `span`.
    pub fn of_registry(span: Range<usize>, error: &RegistryError) -> Self {
        let label = match error.innermost() {
            RegistryError::UnknownModel { .. } => "no such subject",
            RegistryError::UnknownParameter { .. } => "no such parameter",
            RegistryError::BadValue { .. } => "not a value of this parameter",
            RegistryError::Spelling { .. } => "not NAME:KEY=VALUE,…",
            RegistryError::Parentheses { .. } => "no partner",
            RegistryError::Missing { .. } => "something is missing",
            RegistryError::Build { .. } | RegistryError::Nested { .. } => "cannot be built",
            RegistryError::NotABsdf { .. } => "no BSDF",
        };
        let text = error.to_string();
        match text.rsplit_once("; ") {
            Some((message, help)) if !matches!(error.innermost(), RegistryError::Build { .. }) => {
                Self::new(span, message, label).help(help)
            }
            _ => Self::new(span, text, label),
        }
    }

    /// The line in `text`, counted from 1.
    pub fn line(&self, text: &str) -> usize {
        let bytes = text.as_bytes();
        1 + bytes[..self.span.offset().min(bytes.len())].iter().filter(|b| **b == b'\n').count()
    }
}

/// All mistakes of a suite.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{source_name} has {}", counted(.mistakes.len()))]
pub struct SuiteError {
    source_name: String,
    #[source_code]
    code: NamedSource<String>,
    /// In the order of the text.
    #[related]
    pub mistakes: Vec<Mistake>,
}

fn counted(mistakes: usize) -> String {
    if mistakes == 1 { "a mistake".into() } else { format!("{mistakes} mistakes") }
}

impl SuiteError {
    /// Mistakes in `text`, which comes from `name`.
    pub fn new(name: &str, text: &str, mut mistakes: Vec<Mistake>) -> Self {
        mistakes.sort_by_key(|m| m.span.offset());
        let code = NamedSource::new(name, text.to_string());
        Self { source_name: name.into(), code, mistakes }
    }

    /// The mistakes as `line: message (help)`, for plain text.
    pub fn lines(&self) -> Vec<String> {
        let text = self.code.inner();
        let help = |m: &Mistake| m.help.as_ref().map(|h| format!(" ({h})")).unwrap_or_default();
        self.mistakes.iter().map(|m| format!("{}: {}{}", m.line(text), m.message, help(m))).collect()
    }
}
