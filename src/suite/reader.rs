//! Typed reading of spanned TOML values; what is wrong is noted, not thrown,
//! so that one reading finds every mistake.

use super::mistake::Mistake;
use crate::registry::{Value, nearest};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

pub(crate) type Node<'t> = Spanned<DeValue<'t>>;

/// Collects mistakes while values are read.
#[derive(Default)]
pub(crate) struct Reader {
    pub mistakes: Vec<Mistake>,
}

/// A count as people write it: `1048576`, `1_048_576`, `2^20`.
pub fn count(text: &str) -> Result<u64, String> {
    let plain = text.replace('_', "");
    let number = match plain.split_once('^') {
        Some((base, power)) => {
            let parts = base.parse::<u64>().ok().zip(power.parse().ok());
            parts.map(|(base, power)| base.saturating_pow(power))
        }
        None => plain.parse::<u64>().ok(),
    };
    match number {
        Some(0) => Err("at least 1 sample is needed; type for example 2^18".into()),
        Some(n) if n <= MOST_SAMPLES => Ok(n),
        Some(_) => Err(format!("at most 2^40 samples, not {text}")),
        None => Err(format!("`{text}` is not a count; type for example 2^18 or 1_000_000")),
    }
}

/// Half an hour of a fast subject is 2^35 samples; 2^40 keeps products of
/// counts within u64.
const MOST_SAMPLES: u64 = 1 << 40;

/// A polar angle in degrees.
pub fn polar(theta: f64) -> Result<f64, String> {
    if (0.0..=180.0).contains(&theta) {
        Ok(theta)
    } else {
        Err(format!("{theta}° is not a polar angle; type 0 to 180, over 90 for the back side"))
    }
}

/// An azimuth in degrees.
pub fn azimuth(phi: f64) -> Result<f64, String> {
    if (-360.0..=360.0).contains(&phi) {
        Ok(phi)
    } else {
        Err(format!("{phi}° is not an azimuth; type -360 to 360"))
    }
}

/// A number in (0, 1).
pub fn fraction(x: f64) -> Result<f64, String> {
    if x > 0.0 && x < 1.0 { Ok(x) } else { Err(format!("{x} is not between 0 and 1, ends excluded")) }
}

/// A finite number above 0.
pub fn positive(x: f64) -> Result<f64, String> {
    if x > 0.0 && x < f64::INFINITY { Ok(x) } else { Err(format!("{x} is not a positive number")) }
}

/// "a string", "a list", … for messages.
fn kind(value: &DeValue) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

fn float(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Float(x) => x.as_str().parse().ok(),
        DeValue::Integer(n) => {
            i128::from_str_radix(n.as_str(), n.radix()).ok().map(|n| n as f64).or(Some(f64::INFINITY))
        }
        _ => None,
    }
}

/// The entries of a table in the order of the text.
pub(crate) fn entries<'a, 't>(table: &'a DeTable<'t>) -> Vec<(&'a str, Range<usize>, &'a Node<'t>)> {
    let mut all: Vec<_> = table.iter().map(|(k, v)| (k.get_ref().as_ref(), k.span(), v)).collect();
    all.sort_by_key(|(_, span, _)| span.start);
    all
}

impl Reader {
    pub fn note(&mut self, mistake: Mistake) {
        self.mistakes.push(mistake);
    }

    /// Notes a value that is not `wanted`.
    pub fn wrong_type<T>(&mut self, key: &str, value: &Node, wanted: &str) -> Option<T> {
        let found = kind(value.get_ref());
        self.note(Mistake::new(
            value.span(),
            format!("`{key}` takes {wanted}, not {found}"),
            format!("this is {found}"),
        ));
        None
    }

    /// As [`wrong_type`](Self::wrong_type), where nothing is made of the value.
    pub fn refuse(&mut self, key: &str, value: &Node, wanted: &str) {
        let _: Option<()> = self.wrong_type(key, value, wanted);
    }

    /// Notes an unknown name among `known`.
    pub fn unknown(&mut self, span: Range<usize>, what: &str, name: &str, known: &[&str]) {
        let help = match nearest(name, known.iter().copied()) {
            Some(n) => format!("did you mean `{n}`?"),
            None => format!("there are {}", known.join(", ")),
        };
        self.note(Mistake::new(span, format!("no {what} is called `{name}`"), "unknown").help(help));
    }

    fn ranged<T>(&mut self, key: &str, span: Range<usize>, found: Result<T, String>) -> Option<T> {
        match found {
            Ok(v) => Some(v),
            Err(message) => {
                self.note(Mistake::new(span, format!("`{key}`: {message}"), "out of range"));
                None
            }
        }
    }

    /// A number that `range` accepts.
    pub fn number(&mut self, key: &str, value: &Node, range: fn(f64) -> Result<f64, String>) -> Option<f64> {
        match float(value.get_ref()) {
            Some(x) => self.ranged(key, value.span(), range(x)),
            None => self.wrong_type(key, value, "a number"),
        }
    }

    /// One number or a list of them.
    pub fn numbers(
        &mut self,
        key: &str,
        value: &Node,
        range: fn(f64) -> Result<f64, String>,
    ) -> Option<Vec<f64>> {
        let mut numbers: Vec<f64> = Vec::new();
        for item in self.items(key, value)? {
            let Some(number) = self.number(key, item, range) else { continue };
            if numbers.contains(&number) {
                self.twice(key, item.span(), &number.to_string());
            } else {
                numbers.push(number);
            }
        }
        (!numbers.is_empty()).then_some(numbers)
    }

    /// Notes a value that a list has already.
    pub fn twice(&mut self, key: &str, span: Range<usize>, value: &str) {
        self.note(Mistake::new(span, format!("`{key}` lists {value} twice"), "the second time"));
    }

    /// The items of a list, or the value itself; an empty list is a mistake.
    pub fn items<'a, 't>(&mut self, key: &str, value: &'a Node<'t>) -> Option<Vec<&'a Node<'t>>> {
        let DeValue::Array(list) = value.get_ref() else { return Some(vec![value]) };
        if list.is_empty() {
            let message = format!("`{key}` is an empty list: nothing would be measured");
            let help = "give at least one value, or leave the key out for its default";
            self.note(Mistake::new(value.span(), message, "empty").help(help));
            return None;
        }
        Some(list.iter().collect())
    }

    /// A count of samples: an integer, or text as `2^20`.
    pub fn count(&mut self, key: &str, value: &Node) -> Option<u64> {
        match value.get_ref() {
            DeValue::Integer(n) if n.radix() == 10 => self.ranged(key, value.span(), count(n.as_str())),
            DeValue::Integer(n) => {
                let text = u64::from_str_radix(n.as_str(), n.radix()).map(|n| n.to_string());
                self.ranged(key, value.span(), count(&text.unwrap_or_else(|_| n.to_string())))
            }
            DeValue::String(text) => self.ranged(key, value.span(), count(text)),
            _ => self.wrong_type(key, value, "a whole number, or text such as \"2^20\""),
        }
    }

    /// A seed.
    pub fn seed(&mut self, key: &str, value: &Node) -> Option<u64> {
        let DeValue::Integer(n) = value.get_ref() else {
            return self.wrong_type(key, value, "a whole number");
        };
        // TOML's integers end at 2^63 − 1.
        let seed = u64::from_str_radix(n.as_str(), n.radix());
        self.ranged(key, value.span(), seed.map_err(|_| format!("{n} is not a whole number from 0 on")))
    }

    /// Text that is not empty.
    pub fn text(&mut self, key: &str, value: &Node) -> Option<Spanned<String>> {
        match value.get_ref() {
            DeValue::String(text) if text.trim().is_empty() => {
                self.note(Mistake::new(value.span(), format!("`{key}` is empty"), "empty"));
                None
            }
            DeValue::String(text) => Some(Spanned::new(value.span(), text.to_string())),
            _ => self.wrong_type(key, value, "a string"),
        }
    }

    /// One of `words`.
    pub fn word(&mut self, key: &str, value: &Node, words: &[&'static str]) -> Option<&'static str> {
        let text = self.text(key, value)?;
        let found = words.iter().copied().find(|w| w == text.get_ref());
        if found.is_none() {
            self.unknown(text.span(), &format!("value of `{key}`"), text.get_ref(), words);
        }
        found
    }

    /// The value of a parameter.
    pub fn value(&mut self, key: &str, value: &Node) -> Option<Spanned<Value>> {
        let found = match value.get_ref() {
            DeValue::String(text) => Value::Text(text.to_string()),
            other => match float(other) {
                Some(x) => Value::Number(x),
                None => return self.wrong_type(key, value, "a number or a string, or a list of them"),
            },
        };
        Some(Spanned::new(value.span(), found))
    }
}
