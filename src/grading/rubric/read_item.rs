//! An item of a rubric.

use super::terms::{Credit, Item};
use crate::bsdf::{ClaimsPatch, Transport};
use crate::checks;
use crate::grading::{Hints, ItemKind};
use crate::plugins::Limits;
use crate::registry::{Spelling, nearest};
use crate::suite::toml_reader::{Node, Reader, check_id, claims, entries, set};
use crate::suite::{Mistake, Settings, azimuth, fraction, mebibytes, polar, positive, time_limit};
use std::time::Duration;
use toml::Spanned;
use toml::de::DeValue;

/// What an item takes from the rubric where it says nothing itself.
#[derive(Clone, Debug)]
pub struct Terms {
    settings: Settings,
    theta: Vec<f64>,
    phi: Vec<f64>,
    transport: Transport,
    hints: Hints,
    within: Option<f64>,
}

impl Default for Terms {
    fn default() -> Self {
        // A call that hangs is met a few times in each submission that has one.
        let mut settings = Settings::default();
        settings.limits.call = Duration::from_secs(5);
        // A generic direction, and two towards grazing; an azimuth off the axes.
        Self {
            settings,
            theta: vec![30.0, 60.0, 80.0],
            phi: vec![17.0],
            transport: Transport::Radiance,
            hints: Hints::default(),
            within: None,
        }
    }
}

impl Terms {
    /// What a plugin may take.
    pub fn limits(&self) -> Limits {
        self.settings.limits
    }

    /// Reads a key that the rubric and its items have in common; whether it is one.
    pub fn read(&mut self, reader: &mut Reader, key: &str, value: &Node) -> bool {
        match key {
            "hints" => {
                let word = reader.word(key, value, &["none", "region", "cause", "full"]);
                self.hints = match word {
                    Some("none") => Hints::None,
                    Some("region") => Hints::Region,
                    Some("full") => Hints::Full,
                    _ => Hints::Cause,
                };
            }
            "samples" => set(&mut self.settings.samples, reader.count(key, value)),
            "tolerance" => self.settings.tolerance = reader.number(key, value, fraction),
            "detect" => set(&mut self.settings.detect, reader.number(key, value, positive)),
            "theta" => set(&mut self.theta, reader.numbers(key, value, polar)),
            "phi" => set(&mut self.phi, reader.numbers(key, value, azimuth)),
            "within" => self.within = reader.number(key, value, fraction),
            "transport" => {
                let word = reader.word(key, value, &["radiance", "importance"]);
                self.transport = match word {
                    Some("importance") => Transport::Importance,
                    _ => Transport::Radiance,
                };
            }
            "time_limit" => set(&mut self.settings.time_limit, seconds(reader, key, value)),
            "call_limit" => set(&mut self.settings.limits.call, seconds(reader, key, value)),
            "memory" => {
                let memory = reader.number(key, value, mebibytes);
                set(&mut self.settings.limits.memory, memory.map(|mib| (mib as u64) << 20));
            }
            _ => return false,
        }
        true
    }
}

const ITEM_KEYS: [&str; 20] = [
    "id",
    "title",
    "points",
    "kind",
    "credit",
    "needs",
    "loss",
    "hints",
    "subject",
    "checks",
    "claims",
    "reference",
    "within",
    "theta",
    "phi",
    "transport",
    "samples",
    "tolerance",
    "detect",
    "time_limit",
];

/// Reads an item that follows those of `before`.
pub fn read_item(reader: &mut Reader, node: &Node, terms: &Terms, before: &[Item]) -> Option<Item> {
    let DeValue::Table(table) = node.get_ref() else {
        return reader.wrong_type("item", node, "tables: [[item]]");
    };
    let mistakes = reader.mistakes.len();
    let mut own = terms.clone();
    let (mut id, mut title, mut points, mut reference) = (None, None, None, None);
    let (mut kind, mut credit, mut loss) = (ItemKind::default(), Credit::default(), None);
    let mut held = ClaimsPatch::default();
    let (mut needs, mut subjects, mut checks): (Vec<String>, Vec<String>, Vec<String>) = Default::default();
    for (key, span, value) in entries(table) {
        match key {
            "id" => id = read_id(reader, value, before),
            "title" => title = reader.text(key, value),
            "points" => points = reader.number(key, value, positive),
            "kind" => {
                kind = match reader.word(key, value, &["regular", "bonus", "penalty"]) {
                    Some("bonus") => ItemKind::Bonus,
                    Some("penalty") => ItemKind::Penalty,
                    _ => ItemKind::Regular,
                }
            }
            "credit" => {
                credit = match reader.word(key, value, &["fraction", "whole"]) {
                    Some("whole") => Credit::Whole,
                    _ => Credit::Fraction,
                }
            }
            "loss" => loss = reader.text(key, value).map(Spanned::into_inner),
            "needs" => {
                for item in reader.items(key, value).unwrap_or_default() {
                    let Some(text) = reader.text(key, item) else { continue };
                    if !before.iter().any(|b| b.id == *text.get_ref()) {
                        let known = before.iter().map(|b| b.id.as_str());
                        let help = match nearest(text.get_ref(), known) {
                            Some(n) => format!("did you mean `{n}`?"),
                            None => "an item needs what stands before it".into(),
                        };
                        let message = format!("no item before this one is called `{text}`");
                        reader.note(Mistake::new(text.span(), message, "unknown").help(help));
                    }
                    needs.push(text.into_inner());
                }
            }
            "subject" => {
                for item in reader.items(key, value).unwrap_or_default() {
                    let Some(text) = reader.text(key, item) else { continue };
                    match text.get_ref().parse::<Spelling>() {
                        Err(e) => reader.note(Mistake::of_registry(text.span(), &e)),
                        Ok(_) if subjects.contains(text.get_ref()) => {
                            reader.twice(key, text.span(), &format!("`{text}`"));
                        }
                        Ok(_) => subjects.push(text.into_inner()),
                    }
                }
            }
            "checks" => {
                for item in reader.items(key, value).unwrap_or_default() {
                    if let Some(id) = check_id(reader, key, item) {
                        checks.push(id);
                    }
                }
            }
            "claims" => held = claims(reader, value),
            "reference" => reference = reader.text(key, value).map(Spanned::into_inner),
            _ if !["memory", "call_limit"].contains(&key) && own.read(reader, key, value) => {}
            _ => reader.unknown(span, "key of an [[item]]", key, &ITEM_KEYS),
        }
    }
    // Reports have checks in this order.
    checks.sort_by_key(|id| checks::all().iter().position(|c| c.id() == id));
    checks.dedup();
    let incomplete = |what: &str, help: &str| Some(Mistake::new(node.span(), what, "incomplete").help(help));
    let compares = checks.iter().any(|c| c == "reference");
    let missing = match (&id, points, subjects.is_empty(), checks.is_empty()) {
        (None, ..) => incomplete("an [[item]] without `id`", "add id = \"NAME\", as tables call it"),
        (_, None, ..) => incomplete("an [[item]] without `points`", "add points = NUMBER"),
        (_, _, true, false) => incomplete("checks of no subject", "add subject = [\"MODEL:KEY=VALUE\"]"),
        (_, _, false, true) => incomplete("a subject without checks", "add checks = [\"ID\", …]"),
        _ if compares && reference.is_none() => incomplete(
            "`reference` with nothing to compare with",
            "add reference = \"solution\", or a subject",
        ),
        _ if reference.is_some() && !compares => {
            incomplete("a reference that no check looks at", "add \"reference\" to `checks`")
        }
        _ => None,
    };
    if reader.mistakes.len() == mistakes {
        missing.into_iter().for_each(|mistake| reader.note(mistake));
    }
    let (id, points) = (id?, points?);
    Some(Item {
        title: title.map_or_else(|| id.clone(), Spanned::into_inner),
        id,
        points,
        kind,
        credit,
        hidden: false,
        needs,
        loss,
        hints: own.hints,
        subjects,
        checks,
        claims: held,
        theta: own.theta,
        phi: own.phi,
        transport: own.transport,
        reference,
        within: own.within,
        settings: own.settings,
    })
}

fn read_id(reader: &mut Reader, value: &Node, before: &[Item]) -> Option<String> {
    let id = reader.text("id", value)?;
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    // It is the name of a folder and of a column.
    if !id.get_ref().chars().all(is_plain) {
        let message = format!("`{id}` is no id");
        let help = "letters, digits, - and _: the title is for people";
        reader.note(Mistake::new(id.span(), message, "here").help(help));
        return None;
    }
    if before.iter().any(|b| b.id == *id.get_ref()) {
        reader.note(Mistake::new(id.span(), format!("another item is called `{id}`"), "the second time"));
        return None;
    }
    Some(id.into_inner())
}

/// A time in seconds.
pub fn seconds(reader: &mut Reader, key: &str, value: &Node) -> Option<Duration> {
    reader.number(key, value, time_limit).map(Duration::from_secs_f64)
}
