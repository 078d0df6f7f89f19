//! What an entry claims and waives.

use super::file::check_id;
use super::mistake::Mistake;
use super::plan::Waiver;
use super::reader::{Node, Reader, entries, positive};
use crate::bsdf::ClaimsPatch;
use jiff::civil::Date;
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;
use toml::de::DeValue;

/// The claims of an entry.
pub(crate) fn claims(reader: &mut Reader, value: &Node) -> ClaimsPatch {
    let mut patch = ClaimsPatch::default();
    let DeValue::Table(table) = value.get_ref() else {
        let wanted = "a table as { reciprocal = false }";
        return reader.wrong_type("claims", value, wanted).unwrap_or_default();
    };
    for (name, span, value) in entries(table) {
        let json = match value.get_ref() {
            DeValue::Boolean(b) => serde_json::Value::from(*b),
            DeValue::String(s) => serde_json::Value::from(s.as_ref()),
            DeValue::Integer(_) | DeValue::Float(_) => {
                reader.number(name, value, positive).map_or(serde_json::Value::Null, Into::into)
            }
            _ => serde_json::Value::Null,
        };
        if let Err(mistake) = set_claim(&mut patch, (name, span), (json, value.span())) {
            reader.note(mistake);
        }
    }
    patch
}

/// Sets the claim `name` to a value, both with their places.
pub fn set_claim(
    patch: &mut ClaimsPatch,
    (name, span): (&str, Range<usize>),
    (value, value_span): (serde_json::Value, Range<usize>),
) -> Result<(), Mistake> {
    if !ClaimsPatch::NAMES.contains(&name) {
        let mut reader = Reader::default();
        reader.unknown(span, "claim", name, &ClaimsPatch::NAMES);
        return Err(reader.mistakes.remove(0));
    }
    let mut all = serde_json::to_value(&*patch).unwrap_or_default();
    let shown = value.to_string();
    all[name] = value;
    match ClaimsPatch::deserialize(all) {
        Ok(found) => *patch = found,
        Err(e) => {
            let message = format!("the claim `{name}` cannot be {shown}");
            return Err(Mistake::new(value_span, message, "not a value of this claim").help(e.to_string()));
        }
    }
    if patch.eta.is_some_and(|eta| !(eta > 0.0 && eta < f64::INFINITY)) {
        let message = "the claim `eta` is an index of refraction over another, above 0";
        return Err(Mistake::new(value_span, message, "out of range"));
    }
    Ok(())
}

/// The waivers of an entry, as of `today`.
pub(super) fn waivers(reader: &mut Reader, value: &Node, today: Date) -> Vec<Waiver> {
    let mut all: Vec<Waiver> = Vec::new();
    for item in reader.items("waive", value).unwrap_or_default() {
        let DeValue::Table(table) = item.get_ref() else {
            reader.refuse("waive", item, "{ check = \"ID\", because = \"REASON\" }");
            continue;
        };
        let mut waiver = Waiver::default();
        let mut missing = vec!["check", "because"];
        let mistakes = reader.mistakes.len();
        for (key, span, value) in entries(table) {
            missing.retain(|m| *m != key);
            match key {
                "check" => waiver.check = check_id(reader, key, value).unwrap_or_default(),
                "because" => {
                    waiver.because = reader.text(key, value).map(Spanned::into_inner).unwrap_or_default();
                }
                "subject" => waiver.subject = reader.text(key, value).map(Spanned::into_inner),
                "until" => {
                    waiver.until = date(reader, value);
                    waiver.expired = waiver.until.is_some_and(|day| day < today);
                }
                "at_most" => waiver.at_most = reader.number(key, value, positive),
                _ => reader.unknown(span, "key of a waiver", key, &WAIVER_KEYS),
            }
        }
        if let Some(key) = missing.first() {
            let message = format!("a waiver without `{key}`");
            let help = "write { check = \"ID\", because = \"why its failure is meant\" }";
            reader.note(Mistake::new(item.span(), message, "incomplete").help(help));
        }
        if reader.mistakes.len() == mistakes {
            all.push(waiver);
        }
    }
    all
}

const WAIVER_KEYS: [&str; 5] = ["check", "because", "subject", "until", "at_most"];

/// A day, as a TOML date or as text.
fn date(reader: &mut Reader, value: &Node) -> Option<Date> {
    let text = match value.get_ref() {
        DeValue::Datetime(day) => day.to_string(),
        DeValue::String(text) => text.to_string(),
        _ => return reader.wrong_type("until", value, "a day as 2027-01-31"),
    };
    let day = text.parse();
    if day.is_err() {
        let message = format!("`{text}` is no day");
        reader.note(Mistake::new(value.span(), message, "not a day").help("write until = 2027-01-31"));
    }
    day.ok()
}
