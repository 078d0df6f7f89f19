//! Grades in a terminal.

use super::super::{Grade, ItemKind};
use super::fairness::Fairness;
use super::feedback::{Feedback, LostItem};
use super::gradebook::{causes_in_words, sorted};
use super::plain;
use super::points::{counted, earned, loss, points};
use super::statistics::{Bug, bugs, middle};
use crate::report::visible::one_line;
use crate::report::wording::wrapped;
use crate::report::{Look, shortened};

/// Characters of an id and of a language at most.
const LONGEST_ID: usize = 24;
const LONGEST_LANGUAGE: usize = 10;

/// Rows below the table: the empty lines, counts, causes and fairness.
const BELOW: usize = 9;

/// Causes that are told below the table.
const MOST_CAUSES: usize = 3;

fn line(text: &mut String, content: &str) {
    text.push_str(content.trim_end());
    text.push('\n');
}

fn paragraph(text: &mut String, content: &str, indent: usize, look: Look) {
    for part in wrapped(content, look.width() - indent) {
        line(text, &format!("{:indent$}{part}", ""));
    }
}

/// The class: a row for each submission, those to look at first where not all fit, and
/// what there is to know of all.
pub fn class(grades: &[Grade], fairness: Fairness, look: Look) -> String {
    let mut text = String::new();
    let grades = sorted(grades);
    if grades.is_empty() {
        line(&mut text, "no submissions were graded");
        return text;
    }
    let rows = look.lines.map_or(usize::MAX, |lines| lines.saturating_sub(BELOW).max(3));
    let shown = shown(&grades, rows);
    table(&mut text, &shown, look);
    if shown.len() < grades.len() {
        let left = grades.len() - shown.len();
        line(&mut text, &look.paint("2", &format!("and {left} more, in gradebook.csv and index.html")));
    }
    line(&mut text, "");
    let count = |is: &dyn Fn(&Grade) -> bool| grades.iter().filter(|g| is(g)).count();
    let n = grades.len();
    let (mean, median) = middle(&grades).unwrap_or_default();
    let max = grades.iter().map(|g| g.max).fold(0.0, f64::max);
    let mut told = vec![
        format!("{n} submission{}", if n == 1 { "" } else { "s" }),
        format!("mean {} and median {} of {}", points(mean), points(median), counted(max)),
        format!("{} with everything", count(&|g| g.broken.is_none() && g.score >= g.max)),
    ];
    for (n, what) in [
        (count(&|g| g.broken.is_some()), "could not be measured"),
        (count(&|g| !g.incidents.is_empty()), "tried what no BRDF needs"),
        (count(&|g| !g.review.is_empty()), "to be reviewed"),
    ] {
        told.extend((n > 0).then(|| format!("{n} {what}")));
    }
    paragraph(&mut text, &told.join(", "), 0, look);
    let bugs: Vec<Bug> = bugs(&grades).into_iter().filter(|bug| !bug.sure.is_empty()).collect();
    if !bugs.is_empty() {
        let most: Vec<String> = bugs
            .iter()
            .take(MOST_CAUSES)
            .map(|bug| format!("{} {}", bug.sure.len(), one_line(bug.slug)))
            .collect();
        let left = bugs.len() - most.len();
        let more = if left > 0 { format!(" and {left} others") } else { String::new() };
        paragraph(&mut text, &format!("most frequent: {}{more}", most.join(", ")), 0, look);
    }
    paragraph(&mut text, &fairness.sentence(), 0, look);
    text
}

/// As many as there are rows for: those to look at before others, in the order of ids.
fn shown<'a>(grades: &[&'a Grade], rows: usize) -> Vec<&'a Grade> {
    if grades.len() <= rows {
        return grades.to_vec();
    }
    let calm =
        |grade: &&Grade| grade.broken.is_none() && grade.incidents.is_empty() && grade.review.is_empty();
    let mut order: Vec<&Grade> = grades.to_vec();
    order.sort_by_key(calm);
    order.truncate(rows);
    order.sort_by(|a, b| a.id.cmp(&b.id));
    order
}

fn table(text: &mut String, grades: &[&Grade], look: Look) {
    let cell = |content: &str, most: usize| shortened(&one_line(content), most);
    let ids: Vec<String> = grades.iter().map(|g| cell(&g.id, LONGEST_ID)).collect();
    let languages: Vec<String> =
        grades.iter().map(|g| cell(g.language.as_deref().unwrap_or("–"), LONGEST_LANGUAGE)).collect();
    let scores: Vec<String> =
        grades.iter().map(|g| format!("{} of {}", points(g.score), points(g.max))).collect();
    let widest = |cells: &[String], head: &str| {
        cells.iter().map(|c| c.chars().count()).max().unwrap_or(0).max(head.chars().count())
    };
    let widths = [widest(&ids, "id"), widest(&languages, "language"), widest(&scores, "score")];
    let head = format!(
        "{:w0$}  {:w1$}  {:>w2$}  what is wrong",
        "id",
        "language",
        "score",
        w0 = widths[0],
        w1 = widths[1],
        w2 = widths[2]
    );
    line(text, &look.paint("1", &head));
    let left = look.width().saturating_sub(widths.iter().sum::<usize>() + 6).max(10);
    for (k, grade) in grades.iter().enumerate() {
        let (told, colour) = told(grade);
        let padding = " ".repeat(widths[2] - scores[k].chars().count());
        line(
            text,
            &format!(
                "{:w0$}  {:w1$}  {padding}{}  {}",
                ids[k],
                languages[k],
                scores[k],
                look.paint(colour, &cell(&told, left)),
                w0 = widths[0],
                w1 = widths[1],
            ),
        );
    }
}

/// What to know of a submission, and its colour.
fn told(grade: &Grade) -> (String, &'static str) {
    let mut parts: Vec<String> = Vec::new();
    if !grade.incidents.is_empty() {
        let what: Vec<&str> = grade.incidents.iter().map(|i| i.what.as_str()).collect();
        parts.push(format!("INCIDENT {}", what.join(", ")));
    }
    parts.extend(grade.broken.as_ref().map(|broken| broken.why.clone()));
    let causes = causes_in_words(grade);
    parts.extend((!causes.is_empty()).then(|| causes.join(", ")));
    let lost: Vec<&str> = grade
        .items
        .iter()
        .filter(|i| i.is_lost() && i.kind != ItemKind::Bonus)
        .map(|i| i.id.as_str())
        .collect();
    if parts.is_empty() && !lost.is_empty() {
        parts.push(format!("lost: {}", lost.join(", ")));
    }
    parts.extend((!grade.review.is_empty()).then(|| "to be reviewed".into()));
    let colour = match () {
        _ if !grade.incidents.is_empty() || grade.broken.is_some() => "1;31",
        _ if !grade.review.is_empty() => "33",
        _ if lost.is_empty() => "34",
        _ => "0",
    };
    match parts.is_empty() {
        true => ("✓".into(), colour),
        false => (parts.join("; "), colour),
    }
}

/// One submission, as its author sees it: items, and what was lost where.
pub fn one(grade: &Grade, again: &str, look: Look) -> String {
    let mut text = String::new();
    let feedback = Feedback::of(grade, again);
    if let Some((why, said)) = &feedback.broken {
        paragraph(&mut text, &format!("{} {}", look.paint("1;31", "✗"), one_line(why)), 0, look);
        for said in said.lines() {
            line(&mut text, &format!("    {said}"));
        }
        line(&mut text, "");
    }
    let points_of: Vec<String> = feedback.items.iter().map(earned).collect();
    let widest = points_of.iter().map(|p| p.chars().count()).max().unwrap_or(0);
    for (item, points) in feedback.items.iter().zip(&points_of) {
        let (symbol, colour) = if item.is_lost { ("✗", "1;31") } else { ("✓", "34") };
        let hidden = if item.hidden { " (hidden)" } else { "" };
        let title = shortened(&one_line(item.title), look.width().saturating_sub(widest + 16));
        let padding = " ".repeat(widest - points.chars().count());
        line(&mut text, &format!("{} {padding}{points}  {title}{hidden}", look.paint(colour, symbol)));
    }
    for (_, lost) in feedback.told() {
        block(&mut text, lost, &feedback, look);
    }
    line(&mut text, "");
    if let Some(incidents) = plain::incidents(&feedback) {
        paragraph(&mut text, &incidents, 0, look);
    }
    line(&mut text, &look.paint("1", &format!("{} of {}", points(feedback.score), counted(feedback.max))));
    text
}

fn block(text: &mut String, lost: &LostItem, feedback: &Feedback, look: Look) {
    let lines = plain::item(lost, &feedback.causes);
    if lines.is_empty() {
        return;
    }
    line(text, "");
    let title = format!("{}: {}", one_line(lost.item.title), loss(&lost.item));
    paragraph(text, &look.paint("1", &title), 0, look);
    for content in lines {
        let indent = 4 + content.len() - content.trim_start().len();
        paragraph(text, content.trim_start(), indent, look);
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{broken, grade, hostile, whole};
    use super::*;

    const LOOK: Look = Look { width: 90, colour: false, lines: None };

    fn fits(text: &str, width: usize) {
        for line in text.lines() {
            assert!(line.chars().count() <= width, "{}: {line}", line.chars().count());
        }
    }

    #[test]
    fn a_class_is_a_table() {
        let mut plain = whole("");
        plain.incidents.clear();
        plain.review.clear();
        plain.id = "9".into();
        let text = class(
            &[whole(""), broken(), plain, Grade { id: "z".into(), ..grade() }],
            Fairness::new(2e-4, 4),
            LOOK,
        );
        let expected = "\
id    language       score  what is wrong
1042  C++       4.17 of 10  INCIDENT opened ../rubric.toml; half-vector-jacobian, masking…
1043  C++           0 of 3  it does not build: clang++ ended with 1
9     C++       4.17 of 10  half-vector-jacobian, masking?
z     C++           0 of 0  ✓

4 submissions, mean 2.08 and median 2.08 of 10 points, 1 with everything, 1 could not be
measured, 1 tried what no BRDF needs, 1 to be reviewed
most frequent: 2 half-vector-jacobian
a correct submission loses a point by chance with probability at most 2e-4; were all 4
correct, any of them would with at most 8e-4; equal seeds make identical code fail
together
";
        assert_eq!(text, expected, "\n{text}");
    }

    #[test]
    fn a_large_class_fits_a_screen_and_shows_whom_to_look_at() {
        let mut all: Vec<Grade> = (0..200).map(|k| Grade { id: format!("{k:03}"), ..grade() }).collect();
        all[150] = Grade { id: "150".into(), ..whole("") };
        let text = class(&all, Fairness::new(2e-4, 200), Look { lines: Some(24), ..LOOK });
        assert!(text.lines().count() <= 24, "{}", text.lines().count());
        assert!(text.contains("INCIDENT") && text.contains("and 185 more, in gradebook.csv"), "{text}");
        assert_eq!(class(&[], Fairness::new(1e-4, 0), LOOK), "no submissions were graded\n");
    }

    #[test]
    fn one_submission_tells_items_and_what_was_lost() {
        let text = one(&whole(""), "", LOOK);
        for part in [
            "✓        1 of 1  Title of builds\n✗     0.67 of 2  Title of pdf\n",
            "✗          −0.5  Title of nan\n",
            "✗        0 of 2  Title of secret (hidden)\n",
            "\nTitle of pdf: 1.33 points lost\n    Integrate your pdf over the hemisphere: it must give 1.\n",
            "    normalization fails: metal:alpha=0.1 at θo 30° and 60°, φo 17°.\n      must hold:",
            "\n4.17 of 10 points\n",
        ] {
            assert!(text.contains(part), "no {part}:\n{text}");
        }
        for part in ["0.7734", "77°", "a hidden message", "masking"] {
            assert!(!text.contains(part), "{part}:\n{text}");
        }
        fits(&text, 90);
    }

    #[test]
    fn terminals_obey_nothing() {
        for width in [80, 120] {
            let look = Look { width, ..LOOK };
            let all = class(&[hostile("")], Fairness::new(1e-4, 1), look) + &one(&hostile(""), "", look);
            assert!(!all.chars().any(|c| c != '\n' && c.is_control()), "{all}");
            fits(&class(&[hostile(""), whole("")], Fairness::new(1e-4, 2), look), width);
        }
    }

    #[test]
    fn colour_adds_nothing_but_colour() {
        let coloured = one(&whole(""), "", Look { colour: true, ..LOOK });
        assert!(coloured.contains("\u{1b}[1;31m✗\u{1b}[0m"));
        let text = class(&[whole("")], Fairness::new(1e-4, 1), Look { colour: true, ..LOOK });
        assert!(text.contains("\u{1b}[1;31mINCIDENT"), "{text}");
    }
}
