//! Feedback as plain text, for systems that show nothing else.

use super::feedback::{CauseTold, Feedback, LostItem, titles};
use super::points::{counted, points};
use crate::report::visible::{one_line, visible};

/// What is said of a lost item, by lines.
pub fn item(lost: &LostItem, causes: &[CauseTold]) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(text) = lost.item.text {
        lines.extend(visible(text.trim()).lines().map(String::from));
    }
    if !lost.is_measured {
        lines.push("Not measured, as the submission could not be.".into());
    } else if let Some(title) = lost.unmet {
        lines.push(format!("Not scored, as “{}” earned nothing.", one_line(title)));
    }
    lines.extend(lost.count.as_ref().map(|count| format!("{count}.")));
    for found in &lost.found {
        let places: Vec<String> = found.places.iter().map(|p| one_line(p)).collect();
        lines.push(format!("{} {}: {}.", one_line(found.check), found.verb, places.join("; ")));
        lines.extend(found.hypothesis.map(|what| format!("  must hold: {what}")));
        lines.push(format!("  clearest for {}: {}", one_line(&found.at), one_line(&found.clearest.message)));
        lines.extend(found.effect().map(|effect| format!("  {}", one_line(&effect))));
        lines.extend(found.worst().map(|worst| format!("  {}", one_line(&worst))));
    }
    for cause in lost.causes.iter().map(|n| &causes[*n]) {
        lines.extend(self::cause(cause));
    }
    lines
}

/// What is said of a cause, by lines.
fn cause(cause: &CauseTold) -> Vec<String> {
    let slug = one_line(cause.slug);
    let mut lines: Vec<String> = cause
        .statements
        .iter()
        .map(|(statement, subjects)| {
            format!("Cause for {}: {} [{slug}]", one_line(&subjects.join(", ")), one_line(statement))
        })
        .collect();
    lines.extend(cause.repair.map(|repair| format!("  repair: {}", one_line(repair))));
    lines.extend(cause.evidence.iter().map(|since| format!("  since: {}", one_line(since))));
    lines.extend(cause.address().map(|page| format!("  more: gonio explain {slug}, or {page}")));
    lines
}

/// What is said of the whole submission, by paragraphs.
pub fn summary(feedback: &Feedback) -> Vec<String> {
    let mut parts = vec![format!("{} of {}.", points(feedback.score), counted(feedback.max))];
    if let Some((why, said)) = &feedback.broken {
        parts.push(format!("It could not be measured: {}", one_line(why)));
        parts.extend((!said.is_empty()).then(|| said.clone()));
    }
    parts.extend(incidents(feedback));
    let passed = feedback.passed();
    if !passed.is_empty() {
        parts.push(format!("Passed: {}.", one_line(&titles(&passed))));
    }
    parts.push(again(feedback));
    parts
}

/// What was tried that no BRDF needs.
pub fn incidents(feedback: &Feedback) -> Option<String> {
    let all: Vec<String> = feedback.incidents.iter().map(|i| one_line(i)).collect();
    (!all.is_empty()).then(|| {
        format!(
            "The submission tried what no BRDF needs, without effect: {}. Your teacher is told the same.",
            all.join("; ")
        )
    })
}

/// How a student sees the same.
pub fn again(feedback: &Feedback) -> String {
    let but = if feedback.has_hidden() { "; hidden items are not part of it" } else { "" };
    format!("To see it yourself, type in the folder of your submission: {}{but}", feedback.again)
}

#[cfg(test)]
mod tests {
    use super::super::examples::{HOSTILE, broken, hostile, whole};
    use super::*;

    #[test]
    fn an_item_says_what_is_wrong_where_and_why() {
        let grade = whole("evidence/case-0003.json.gz");
        let feedback = Feedback::of(&grade, "gonio grade --self rubric.toml .");
        let pdf = feedback.lost.iter().find(|lost| lost.item.id == "pdf").unwrap();
        let text = item(pdf, &feedback.causes).join("\n");
        for part in [
            "Integrate your pdf over the hemisphere: it must give 1.\n\nSee chapter 3",
            "2 of 6 cases passed.",
            "normalization fails: metal:alpha=0.1 at θo 30° and 60°, φo 17°.",
            "  must hold: ∫pdf = P(valid continuous sample)",
            "  worst at θi 28.65° φi 194.8°: expected = 34.9825, observed = 858",
            "Cause for metal:alpha=0.1: pdf() lacks the Jacobian",
            "[half-vector-jacobian]",
            "gonio explain half-vector-jacobian",
        ] {
            assert!(text.contains(part), "{part}:\n{text}");
        }
    }

    #[test]
    fn a_summary_begins_with_the_score() {
        let grade = whole("");
        let text = summary(&Feedback::of(&grade, "gonio grade --self rubric.toml .")).join("\n");
        assert!(text.starts_with("4.17 of 10 points."), "{text}");
        assert!(text.contains("Passed: “Title of builds” and “Title of values”."), "{text}");
        assert!(text.contains("while it was measured: opened ../rubric.toml (3 times)"));
        assert!(text.contains("gonio grade --self rubric.toml .; hidden items are not part of it"));
        let broken = broken();
        let text = summary(&Feedback::of(&broken, "")).join("\n");
        assert!(text.contains("clang++ ended with 1\nbrdf.cpp:3:1: error"), "{text}");
    }

    #[test]
    fn nothing_invisible_is_left_of_hostile_text() {
        let grade = hostile("");
        let feedback = Feedback::of(&grade, "");
        let mut lines = summary(&feedback);
        lines.extend(feedback.lost.iter().flat_map(|lost| item(lost, &feedback.causes)));
        let text = lines.join("\n");
        assert!(HOSTILE.contains('\u{1b}') && HOSTILE.contains('\u{202e}'));
        assert!(!text.chars().any(|c| c != '\n' && c.is_control()) && !text.contains('\u{202e}'), "{text}");
    }
}
