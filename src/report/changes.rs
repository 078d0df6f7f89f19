//! Changes between two reports in words that people read.

use super::wording::{direction, ratio};
use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::comparison::{Change, Place, What};

/// One change in one line: `ggx  goodness-of-fit: pass → fail at θo 60° φo 17° and 3 more directions`.
pub fn in_words(change: &Change) -> String {
    let cause = change.cause.as_ref().map_or(String::new(), |slug| format!(" [{slug}]"));
    format!("{}  {}: {}{}{cause}", change.subject, change.check, what(&change.what), places(&change.places))
}

/// A change in words.
fn what(what: &What) -> String {
    match what {
        What::Verdict { before, after } => {
            format!("{} → {}", before.map_or("not there", Verdict::word), after.word())
        }
        What::Efficiency { before, after } => {
            format!(
                "{} → {} of the draws count ({})",
                ratio(before.0),
                ratio(after.0),
                part(before.0, after.0)
            )
        }
        What::DetectionLimit { before, after } => {
            format!("detection limit {} → {}", ratio(before.0), ratio(after.0))
        }
    }
}

/// A change of a figure as a part of it.
fn part(before: f64, after: f64) -> String {
    format!("{:+.0} %", 100.0 * (after / before - 1.0)).replace('-', "−")
}

fn places(places: &[Place]) -> String {
    let first =
        places.first().and_then(|p| p.wo).map_or(String::new(), |wo| format!(" at {}", direction(wo)));
    let mode = match places.first() {
        Some(Place { transport: Transport::Importance, .. }) => " (importance)",
        _ => "",
    };
    match places.len() {
        0 | 1 => format!("{first}{mode}"),
        2 => format!("{first}{mode} and 1 more direction"),
        n => format!("{first}{mode} and {} more directions", n - 1),
    }
}
