//! How a subject is written.

use super::error::RegistryError;
use super::parameter::Value;

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

/// A value as it stands within the spelling of a subject.
pub(super) fn parenthesised(text: &str) -> String {
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
