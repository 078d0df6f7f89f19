//! What changed since an earlier report.

use super::super::wording::{direction, ratio};
use super::look::{Look, code, indented, line};
use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::comparison::{Change, Comparison, Place, What};

/// Changes of a kind that are told one by one.
const MOST: usize = 12;

/// Two reports side by side, by themselves.
pub fn comparison(found: &Comparison, look: Look) -> String {
    let mut text = String::new();
    compared(&mut text, found, look);
    text
}

/// As a part of a page.
pub fn compared(text: &mut String, found: &Comparison, look: Look) {
    line(text, "");
    let before = &found.before;
    let heading = format!(
        "compared with the report of {}: {} worse, {} better, {} less sure",
        before.started.split('.').next().unwrap_or_default(),
        found.worse.len(),
        found.better.len(),
        found.less_sure.len(),
    );
    indented(text, &heading, 0, look);
    let lists = [
        ("worse", &found.worse, code(Verdict::Fail)),
        ("better", &found.better, code(Verdict::Pass)),
        ("less sure", &found.less_sure, code(Verdict::Warn)),
    ];
    for (word, list, colour) in lists {
        for change in list.iter().take(MOST) {
            line(text, &format!("{}  {}", look.paint(colour, word), told(change)));
            if word != "better" && !change.message.is_empty() {
                indented(text, &change.message, 4, look);
            }
        }
        if list.len() > MOST {
            line(text, &format!("{word}  and {} more", list.len() - MOST));
        }
    }
    let mut rest = vec![format!("{} the same", found.same)];
    if found.still_failing > 0 {
        rest.push(format!("{} that fail in both", found.still_failing));
    }
    if found.removed_results > 0 {
        rest.push(format!("{} that are no longer measured", found.removed_results));
    }
    indented(text, &rest.join(", "), 0, look);
    for (word, names) in [("new", &found.added), ("gone", &found.removed)] {
        if !names.is_empty() {
            let shown: Vec<&str> = names.iter().take(MOST).map(String::as_str).collect();
            let more = if names.len() > MOST { ", …" } else { "" };
            indented(text, &format!("{word}: {}{more}", shown.join(", ")), 0, look);
        }
    }
}

/// One change in one line: `ggx  goodness-of-fit: pass → fail at θo 60° φo 17° and 3 more directions`.
fn told(change: &Change) -> String {
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
