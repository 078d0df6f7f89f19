//! The student's page: one file that needs nothing else, and runs nothing.

use super::super::ItemKind;
use super::feedback::{CauseTold, Feedback, LostItem, titles};
use super::found::Found;
use super::pictures::{Drawn, Shown};
use super::points::{earned, loss, points};
use crate::report::{STYLE, inline};
use askama::Template;

/// What pages of grades have besides the style of every page.
pub const OWN_STYLE: &str = include_str!("style.css");

#[derive(Template)]
#[template(path = "feedback.html")]
struct Page<'a> {
    f: &'a Feedback<'a>,
    nonce: &'a str,
    version: &'static str,
    symbol: char,
    score: String,
    max: String,
    rows: Vec<Row<'a>>,
    causes: Vec<CauseView<'a>>,
    lost: Vec<LostView<'a>>,
    /// Titles of items that could not be measured.
    unmeasured: String,
    unread: Option<&'a str>,
    passed: String,
    style: String,
}

/// An item in the table.
struct Row<'a> {
    title: &'a str,
    points: String,
    kind: String,
    class: &'static str,
    symbol: char,
    word: &'static str,
    /// Its section, if it cost points.
    anchor: Option<String>,
}

struct CauseView<'a> {
    told: &'a CauseTold<'a>,
    anchor: String,
    items: String,
    /// What it shows, and SVG.
    picture: Option<(&'a str, String)>,
    /// Title and text of the manual's page.
    manual: Option<(&'static str, &'static str)>,
}

struct LostView<'a> {
    of: &'a LostItem<'a>,
    anchor: String,
    loss: String,
    /// Anchor and slug.
    causes: Vec<(String, &'a str)>,
    found: Vec<FoundView<'a>>,
    picture: Option<(&'a str, String)>,
}

struct FoundView<'a> {
    of: &'a Found<'a>,
    effect: Option<String>,
    worst: Option<String>,
}

/// The page as text. `nonce` names its own style for its policy.
pub fn page(feedback: &Feedback, drawn: &Drawn, nonce: &str) -> String {
    let is_whole = feedback.lost.is_empty() && feedback.broken.is_none();
    let page = Page {
        f: feedback,
        nonce,
        version: env!("CARGO_PKG_VERSION"),
        symbol: if is_whole { '✓' } else { '✗' },
        score: points(feedback.score),
        max: points(feedback.max),
        rows: rows(feedback),
        causes: feedback.causes.iter().enumerate().map(|(n, cause)| cause_view(n, cause, drawn)).collect(),
        lost: feedback.told().map(|(n, lost)| lost_view(n, lost, feedback, drawn)).collect(),
        unmeasured: titles(&feedback.unmeasured()),
        unread: drawn.unread.as_deref(),
        passed: titles(&feedback.passed()),
        style: format!("{STYLE}{OWN_STYLE}"),
    };
    page.render().expect("a string takes every text")
}

/// Anchors are numbers: names of items and causes may be anything.
fn item_anchor(number: usize) -> String {
    format!("item-{}", number + 1)
}

fn cause_anchor(number: usize) -> String {
    format!("cause-{}", number + 1)
}

fn rows<'a>(feedback: &Feedback<'a>) -> Vec<Row<'a>> {
    let row = |item: &super::feedback::ItemTold<'a>| {
        let at = feedback.told().find(|(_, lost)| lost.item.id == item.id).map(|(number, _)| number);
        let kind = match item.kind {
            ItemKind::Regular => "",
            ItemKind::Bonus => "bonus",
            ItemKind::Penalty => "penalty",
        };
        let marks: Vec<&str> =
            [kind, if item.hidden { "hidden" } else { "" }].into_iter().filter(|m| !m.is_empty()).collect();
        Row {
            title: item.title,
            points: earned(item),
            kind: marks.join(", "),
            class: if item.is_lost { "lost" } else { "earned" },
            symbol: if item.is_lost { '✗' } else { '✓' },
            word: if item.is_lost { "lost" } else { "earned" },
            anchor: at.map(item_anchor),
        }
    };
    feedback.items.iter().map(row).collect()
}

fn shown(picture: &Shown) -> (&str, String) {
    (&picture.title, inline(picture.svg.clone()))
}

fn cause_view<'a>(number: usize, told: &'a CauseTold<'a>, drawn: &'a Drawn) -> CauseView<'a> {
    let manual = told.known().map(|cause| {
        let (title, text) = cause.page().split_once('\n').unwrap_or((cause.page(), ""));
        (title.trim_start_matches("# "), text.trim())
    });
    CauseView {
        told,
        anchor: cause_anchor(number),
        items: titles(&told.items),
        picture: drawn.causes.get(told.slug).map(shown),
        manual,
    }
}

fn lost_view<'a>(
    number: usize,
    of: &'a LostItem<'a>,
    feedback: &'a Feedback<'a>,
    drawn: &'a Drawn,
) -> LostView<'a> {
    let found = |found: &'a Found<'a>| FoundView { of: found, effect: found.effect(), worst: found.worst() };
    LostView {
        of,
        anchor: item_anchor(number),
        loss: loss(&of.item),
        causes: of.causes.iter().map(|n| (cause_anchor(*n), feedback.causes[*n].slug)).collect(),
        found: of.found.iter().map(found).collect(),
        picture: drawn.items.get(of.item.id).map(shown),
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{broken, evidence_in, hostile, report, whole};
    use super::super::pictures::{Desk, drawn};
    use super::*;
    use crate::grading::Grade;
    use std::path::Path;

    const AGAIN: &str = "gonio grade --self rubric.toml .";

    fn of(grade: &Grade, folder: &Path) -> String {
        let feedback = Feedback::of(grade, AGAIN);
        page(
            &feedback,
            &drawn(&mut Desk::new(folder), Some(&report(&["metal:alpha=0.1"])), &feedback),
            "n0nce",
        )
    }

    /// Without the page's own style, and without what pictures say: they escape themselves.
    fn markup(page: &str) -> String {
        let (before, after) = page.split_once("<style ").unwrap();
        let rest = after.split_once("</style>").unwrap().1;
        let texts = rest.split("<svg ").map(|part| part.split_once("</svg>").map_or(part, |p| p.1));
        before.to_string() + &texts.collect::<String>()
    }

    #[test]
    fn a_page_tells_score_items_causes_and_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let page = of(&whole(&evidence_in(folder.path())), folder.path());
        for part in [
            "<h1><span class=\"symbol\" aria-hidden=\"true\">✗</span> 4.17 <span class=\"of\">of 10 points</span>",
            "opened ../rubric.toml (3 times)",
            "<a href=\"#item-2\"><bdi>Title of pdf</bdi></a>",
            "<bdi>Title of secret</bdi></a> <span class=\"kind\">hidden</span>",
            "pdf() lacks the Jacobian 1/(4 wo·h)",
            "costs</dt><dd>“Title of pdf” and “Title of grazing”",
            "<summary>What the manual says: half-vector-jacobian: from half vectors to directions",
            "1.33 points lost",
            "it must give 1.\n\nSee chapter 3",
            "<li><bdi>metal:alpha=0.1 at θo 30° and 60°, φo 17°</bdi></li>",
            "Nothing is wrong with “Title of builds” and “Title of values”.",
            "<code class=\"command\">gonio grade --self rubric.toml .</code>",
        ] {
            assert!(page.contains(part), "no {part}");
        }
        assert_eq!(page.matches("<figure class=\"picture\">").count(), 3, "a cause and two items");
        assert_eq!(page, of(&whole(&evidence_in(folder.path())), folder.path()));
    }

    #[test]
    fn hidden_items_tell_title_points_and_text_alone() {
        let folder = tempfile::tempdir().unwrap();
        let page = of(&whole(&evidence_in(folder.path())), folder.path());
        let section = page.split("Title of secret</bdi> <span class=\"loss\">").nth(1).unwrap();
        let section = section.split_once("</section>").unwrap().0;
        assert_eq!(
            section.trim(),
            "2 points lost</span></h3>\n<p class=\"text\"><bdi>Text of secret.</bdi></p>"
        );
        for part in ["alpha=0.7734", "77°", "a hidden message", "masking"] {
            assert!(!markup(&page).contains(part), "{part}");
        }
    }

    #[test]
    fn what_does_not_build_comes_first() {
        let page = of(&broken(), Path::new("nowhere"));
        let at = |part: &str| page.find(part).unwrap_or_else(|| panic!("no {part}"));
        assert!(at("clang++ ended with 1") < at("unknown type name &#39;flaot&#39;"));
        assert!(at("flaot") < at("id=\"points\""));
        assert!(page.contains("<p>Not measured, as the submission could not be: “Title of pdf”.</p>"));
        assert!(at("<bdi>Title of builds</bdi> <span") < at("Not measured"));
    }

    #[test]
    fn hostile_text_stays_text_everywhere() {
        let folder = tempfile::tempdir().unwrap();
        let broken = hostile(&evidence_in(folder.path()));
        let measured = Grade { broken: None, ..broken.clone() };
        for grade in [broken, measured] {
            let page = of(&grade, folder.path());
            let markup = markup(&page);
            for part in ["<script", "<img", "onload=\"", "<!--", "<i>"] {
                let around = || &markup[markup.find(part).unwrap().saturating_sub(200)..];
                assert!(!markup.contains(part), "{part}: {}", around());
            }
            assert!(
                markup.matches("&#60;/script&#62;&#60;script&#62;x").count() > 20,
                "it is shown as it is"
            );
            assert!(!page.contains("<script") && !page.contains("<img"), "in pictures too");
            assert_eq!(page.contains("<svg "), grade.broken.is_none());
        }
    }

    #[test]
    fn a_policy_lets_no_script_run() {
        let page = of(&broken(), Path::new("nowhere"));
        let policy = page.split_once("content=\"default-src 'none';").unwrap().1.split('"').next().unwrap();
        assert!(
            policy.contains("style-src 'nonce-n0nce'")
                && !policy.contains("script")
                && !policy.contains("unsafe")
        );
        assert_eq!(page.matches(" nonce=\"n0nce\"").count(), 1, "one style");
        assert!(!markup(&page).contains(" style=\""), "the policy forbids styles of elements");
    }

    #[test]
    fn nothing_lost_is_a_short_page() {
        let mut grade = whole("");
        grade.items.truncate(1);
        (grade.score, grade.max) = (1.0, 1.0);
        let page = of(&grade, Path::new("nowhere"));
        assert!(page.contains("✓</span> 1 <span") && page.contains("No points were lost"));
    }
}
