//! What changed since an earlier report.

use super::super::changes::in_words;
use super::look::{Look, code, indented, line};
use crate::checks::Verdict;
use crate::comparison::Comparison;

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
            line(text, &format!("{}  {}", look.paint(colour, word), in_words(change)));
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
