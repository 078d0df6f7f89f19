//! Feedback as Markdown.

use super::feedback::{CauseTold, Feedback, LostItem, titles};
use super::plain;
use super::points::{counted, earned, loss, points};
use crate::report::formats::markdown_text::{code, fenced, plain as own, text};

/// The whole feedback; without pictures, so that it is one text.
pub fn markdown(feedback: &Feedback) -> String {
    let mut parts =
        vec![format!("# {} of {}", points(feedback.score), counted(feedback.max)), about(feedback)];
    if let Some((why, said)) = &feedback.broken {
        parts.push(format!("**It could not be measured:** {}", text(why)));
        parts.extend((!said.is_empty()).then(|| fenced("text", said)));
    }
    parts.extend(plain::incidents(feedback).map(|told| text(&told)));
    if !feedback.causes.is_empty() {
        parts.push("## What is wrong".into());
        parts.extend(feedback.causes.iter().map(cause));
    }
    if !feedback.lost.is_empty() {
        parts.push("## Where points were lost".into());
        parts.extend(feedback.told().map(|(_, lost)| item(lost, &feedback.causes)));
        let unmeasured = feedback.unmeasured();
        parts.extend((!unmeasured.is_empty()).then(|| {
            format!("Not measured, as the submission could not be: {}.", own(&titles(&unmeasured)))
        }));
    }
    parts.push(format!("## Points\n\n{}", table(feedback)));
    parts.push(again(feedback));
    parts.join("\n\n") + "\n"
}

fn about(feedback: &Feedback) -> String {
    let language = feedback.language.map_or(String::new(), |l| format!(", {}", text(l)));
    format!("{}, submission {}{language}.", own(feedback.rubric), code(feedback.id))
}

/// The rubric's text: its lines and addresses stay.
fn rubric_text(loss: &str) -> String {
    loss.trim().lines().map(own).collect::<Vec<_>>().join("\n")
}

fn item(lost: &LostItem, causes: &[CauseTold]) -> String {
    let mut parts = vec![format!("### {}: {}", own(lost.item.title), loss(&lost.item))];
    parts.extend(lost.item.text.map(rubric_text));
    parts
        .extend(lost.unmet.map(|title| format!("Not scored, as {} earned nothing.", own(&titles(&[title])))));
    let mut lines: Vec<String> = lost.count.iter().map(|count| format!("- {count}")).collect();
    for found in &lost.found {
        let places: Vec<String> = found.places.iter().map(|p| text(p)).collect();
        lines.push(format!("- **{}** {}: {}", text(found.check), found.verb, places.join("; ")));
        lines.extend(found.hypothesis.map(|what| format!("  - must hold: {}", text(what))));
        let facts = [Some(found.clearest.message.clone()), found.effect(), found.worst()];
        let facts: Vec<String> = facts.iter().flatten().map(|fact| text(fact)).collect();
        lines.push(format!("  - clearest for {}: {}", text(&found.at), facts.join("; ")));
    }
    let names: Vec<String> = lost.causes.iter().map(|n| code(causes[*n].slug)).collect();
    lines.extend((!names.is_empty()).then(|| format!("- cause: {}, above", names.join(", "))));
    parts.extend((!lines.is_empty()).then(|| lines.join("\n")));
    parts.join("\n\n")
}

fn cause(cause: &CauseTold) -> String {
    let slug = match cause.address() {
        Some(page) => format!("[{}]({page})", cause.slug),
        None => code(cause.slug),
    };
    let several = cause.statements.len() > 1;
    let mut lines: Vec<String> = cause
        .statements
        .iter()
        .map(|(statement, subjects)| match several {
            true => format!("- {}: **{}**", text(&subjects.join(", ")), text(statement)),
            false => format!("**{}** ({slug})\n", text(statement)),
        })
        .collect();
    if several {
        lines.insert(0, format!("{slug}:\n"));
    } else {
        let subjects = cause.statements.first().map(|(_, subjects)| subjects.join(", ")).unwrap_or_default();
        lines.push(format!("- subject: {}", text(&subjects)));
    }
    lines.push(format!("- costs {}", own(&titles(&cause.items))));
    lines.extend(cause.repair.map(|repair| format!("- repair: {}", text(repair))));
    lines.extend(cause.evidence.iter().map(|since| format!("- since: {}", text(since))));
    lines.extend(cause.known().map(|known| format!("- more: {}", code(&format!("gonio explain {known}")))));
    lines.join("\n")
}

fn table(feedback: &Feedback) -> String {
    let mut lines = vec!["| | item | points |".to_string(), "|---|---|---:|".into()];
    lines.extend(feedback.items.iter().map(|item| {
        let hidden = if item.hidden { " (hidden)" } else { "" };
        format!(
            "| {} | {}{hidden} | {} |",
            if item.is_lost { '✗' } else { '✓' },
            own(item.title),
            earned(item)
        )
    }));
    lines.push(format!("| | **all** | **{} of {}** |", points(feedback.score), points(feedback.max)));
    lines.join("\n")
}

fn again(feedback: &Feedback) -> String {
    let but = if feedback.has_hidden() { "\n\nHidden items are not part of it." } else { "" };
    format!(
        "To see it yourself, type in the folder of your submission:\n\n{}{but}",
        fenced("sh", feedback.again)
    )
}

/// Markdown as a cell of a gradebook. Some show it as HTML (Moodle's feedback comments):
/// what would be a tag there is an entity, which Markdown knows as well.
pub fn as_cell(markdown: &str) -> String {
    let mut out = String::new();
    let mut rest = markdown.chars();
    while let Some(c) = rest.next() {
        match c {
            '\\' => match rest.next() {
                Some(escaped @ ('<' | '>' | '&')) => out.push_str(entity(escaped)),
                Some(other) => out.extend(['\\', other]),
                None => out.push('\\'),
            },
            '<' => out.push_str(entity(c)),
            _ => out.push(c),
        }
    }
    out
}

fn entity(c: char) -> &'static str {
    match c {
        '<' => "&lt;",
        '>' => "&gt;",
        _ => "&amp;",
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Grade;
    use super::super::examples::{broken, hostile, whole};
    use super::*;

    fn of(grade: &Grade) -> String {
        markdown(&Feedback::of(grade, "gonio grade --self rubric.toml ."))
    }

    #[test]
    fn says_the_same_as_the_page() {
        let text = of(&whole(""));
        for part in [
            "# 4.17 of 10 points\n",
            "Assignment 2: a rough metal, submission `1042`, C++.",
            "\n**pdf() lacks the Jacobian 1/(4 wo·h) of reflection about the half vector** ([half-vector-jacobian](https://",
            "- costs “Title of pdf” and “Title of grazing”",
            "- repair: divide the density of h by 4 wo·h",
            "### Title of pdf: 1.33 points lost\n\nIntegrate your pdf over the hemisphere: it must give 1.\n\nSee chapter 3, and https://example.org/x\\_y.",
            "- **normalization** fails: metal:alpha=0.1 at θo 30° and 60°, φo 17°",
            "Not scored, as “Title of pdf” earned nothing.",
            "### Title of nan: 0.5 points taken\n\nText of nan.\n\n###",
            "### Title of secret: 2 points lost\n\nText of secret.\n\n",
            "| ✗ | Title of secret (hidden) | 0 of 2 |",
            "| ✓ | Title of values | 3 of 3 |",
            "```sh\ngonio grade --self rubric.toml .\n```",
        ] {
            assert!(text.contains(part), "no {part}:\n{text}");
        }
    }

    #[test]
    fn what_does_not_build_is_told_with_the_compilers_words() {
        let text = of(&broken());
        assert!(text.contains("**It could not be measured:** it does not build"), "{text}");
        assert!(
            text.contains("\n\nNot measured, as the submission could not be: “Title of pdf”.\n"),
            "{text}"
        );
        assert!(text.contains("```text\nbrdf.cpp:3:1: error: unknown type name 'flaot'\n"), "{text}");
    }

    #[test]
    fn hostile_text_opens_nothing() {
        opens_nothing(&of(&hostile("")));
        opens_nothing(&of(&Grade { broken: None, ..hostile("") }));
    }

    fn opens_nothing(text: &str) {
        let mut fence: Option<String> = None;
        for line in text.lines() {
            let ticks: String = line.chars().take_while(|c| *c == '`').collect();
            match &fence {
                Some(open) if line == open => fence = None,
                None if ticks.len() > 2 && !line.trim_start_matches('`').contains('`') => fence = Some(ticks),
                None if !line.contains("````") => {
                    assert!(!line.replace("\\<", "").contains('<'), "{line}");
                    assert!(!line.replace("\\]", "").contains("](j"), "{line}");
                    let own = line.starts_with('|') || line.starts_with('#');
                    assert!(own || !line.trim_start().starts_with(['|', '#']), "{line}");
                }
                _ => {}
            }
        }
        assert!(fence.is_none(), "a fence is not closed");
    }

    #[test]
    fn a_cell_has_no_tag_and_reads_the_same() {
        assert_eq!(as_cell(r"a \<b\> \& \\\<i> `x<y` \* \"), r"a &lt;b&gt; &amp; \\&lt;i> `x&lt;y` \* \");
        let cell = as_cell(&of(&hostile("")));
        assert!(!cell.contains('<'), "{cell}");
    }
}
