//! index.html: the class, for the teacher.

use super::super::{Grade, ItemKind};
use super::files::{self, appeals, feedback_page, file_name};
use super::gradebook::{causes_in_words, sorted};
use super::page::OWN_STYLE;
use super::points::{counted, percent, points};
use super::statistics::{self, bins, bugs, items, middle, unexplained};
use super::write::Class;
use crate::cause::Cause;
use crate::report::formats::manual::cause_page;
use crate::report::{Bars, STYLE, inline};
use askama::Template;
use std::collections::BTreeSet;

/// The file of the overview.
pub const INDEX: &str = "index.html";

const SCRIPT: &str = include_str!("class.js");

/// Bins of the histogram of scores.
const BINS: f64 = 20.0;

#[derive(Template)]
#[template(path = "class.html")]
struct Page<'a> {
    title: &'a str,
    nonce: String,
    version: &'static str,
    sentence: String,
    /// Class, number and what is counted.
    counts: Vec<(&'static str, String, String)>,
    fairness: String,
    review: Vec<Told<'a>>,
    incidents: Vec<Told<'a>>,
    broken: Vec<Told<'a>>,
    histogram: String,
    items: Vec<ItemView<'a>>,
    bugs: Vec<Bug<'a>>,
    unexplained: Vec<Link<'a>>,
    names: Vec<&'a str>,
    submissions: Vec<Row<'a>>,
    style: String,
    script: &'static str,
}

/// The page of a submission, and what it is called.
type Link<'a> = (String, &'a str);

/// A submission and what there is to say of it.
struct Told<'a> {
    page: String,
    id: &'a str,
    what: Vec<String>,
}

struct ItemView<'a> {
    title: &'a str,
    kind: String,
    points: String,
    mean: String,
    lost: usize,
    unmet: usize,
}

struct Bug<'a> {
    count: usize,
    unsure: usize,
    slug: &'a str,
    page: Option<String>,
    statement: &'a str,
    who: Vec<Link<'a>>,
    /// Of whom it is not certain.
    perhaps: Vec<Link<'a>>,
}

struct Row<'a> {
    page: String,
    id: &'a str,
    names: Vec<&'a str>,
    language: &'a str,
    score: String,
    percent: String,
    causes: Vec<String>,
    marks: String,
    folder: String,
    appeals: Option<String>,
}

/// The page of a submission, from here.
fn page_of(grade: &Grade) -> String {
    files::link(&feedback_page(&grade.id))
}

fn link(grade: &Grade) -> Link<'_> {
    (page_of(grade), &grade.id)
}

/// The page as text: equal grades in any order give equal text.
pub fn class_page(class: &Class) -> String {
    let grades = sorted(class.grades);
    let names: BTreeSet<&str> = grades.iter().flat_map(|g| g.names.keys()).map(String::as_str).collect();
    let names: Vec<&str> = names.into_iter().filter(|name| tells(name, &grades)).collect();
    let told = |what: &dyn Fn(&Grade) -> Vec<String>| -> Vec<Told> {
        let all = grades.iter().map(|grade| Told { page: page_of(grade), id: &grade.id, what: what(grade) });
        all.filter(|t| !t.what.is_empty()).collect()
    };
    let page = Page {
        title: class.title,
        nonce: nonce(&grades),
        version: env!("CARGO_PKG_VERSION"),
        sentence: sentence(&grades),
        counts: counts(&grades),
        fairness: fairness(class),
        review: told(&|grade| grade.review.clone()),
        incidents: told(&|grade| grade.incidents.iter().map(incident).collect()),
        broken: told(&|grade| grade.broken.iter().map(|b| b.why.clone()).collect()),
        histogram: histogram(&grades),
        items: items(&grades).iter().map(item).collect(),
        bugs: bugs(&grades).iter().map(bug).collect(),
        unexplained: unexplained(&grades).into_iter().map(link).collect(),
        submissions: grades.iter().map(|grade| row(grade, &names)).collect(),
        names,
        style: format!("{STYLE}{OWN_STYLE}"),
        script: SCRIPT,
    };
    page.render().expect("a string takes every text")
}

/// Whether a named part says more than the id.
fn tells(name: &str, grades: &[&Grade]) -> bool {
    grades.iter().any(|grade| grade.names.get(name).is_some_and(|value| *value != grade.id))
}

/// Nobody who writes a part of a grade can know it before all are there.
fn nonce(grades: &[&Grade]) -> String {
    let bytes = serde_json::to_vec(grades).unwrap_or_default();
    blake3::hash(&bytes).to_hex()[..32].to_string()
}

fn sentence(grades: &[&Grade]) -> String {
    let n = grades.len();
    let all = format!("{n} submission{}", if n == 1 { "" } else { "s" });
    let max = grades.iter().map(|g| g.max).fold(0.0, f64::max);
    match middle(grades) {
        None => "No submissions".into(),
        Some((mean, median)) => {
            format!(
                "{all}: {} of {} in the mean, {} in the median",
                points(mean),
                counted(max),
                points(median)
            )
        }
    }
}

fn counts(grades: &[&Grade]) -> Vec<(&'static str, String, String)> {
    let count = |is: &dyn Fn(&Grade) -> bool| grades.iter().filter(|g| is(g)).count();
    [
        ("pass", count(&|g| g.broken.is_none() && g.score >= g.max), "with everything"),
        ("fail", count(&|g| g.broken.is_some()), "could not be measured"),
        ("inconclusive", count(&|g| !g.incidents.is_empty()), "tried what no BRDF needs"),
        ("inconclusive", count(&|g| !g.review.is_empty()), "to be reviewed"),
    ]
    .map(|(class, n, what)| (class, n.to_string(), what.to_string()))
    .into()
}

fn fairness(class: &Class) -> String {
    let sentence = class.fairness.sentence();
    let mut letters = sentence.chars();
    letters
        .next()
        .map_or(String::new(), |first| first.to_uppercase().chain(letters).collect::<String>() + ".")
}

pub fn incident(incident: &super::super::Incident) -> String {
    match incident.times {
        0 | 1 => incident.what.clone(),
        times => format!("{} ({times} times)", incident.what),
    }
}

fn histogram(grades: &[&Grade]) -> String {
    let max = grades.iter().map(|g| g.max).fold(0.0, f64::max);
    let width = Bars::width_of(max, BINS);
    let bars = Bars {
        title: "Scores".into(),
        facts: format!("{} submissions, bins of {}", grades.len(), counted(width)),
        names: ["points".into(), "submissions".into()],
        width,
        counts: bins(grades, max, width),
    };
    inline(bars.svg())
}

fn item<'a>(of: &statistics::ItemStatistics<'a>) -> ItemView<'a> {
    let kind = match of.item.kind {
        ItemKind::Regular => "",
        ItemKind::Bonus => "bonus",
        ItemKind::Penalty => "penalty",
    };
    let marks = [kind, if of.item.hidden { "hidden" } else { "" }];
    ItemView {
        title: &of.item.title,
        kind: marks.into_iter().filter(|m| !m.is_empty()).collect::<Vec<_>>().join(", "),
        points: points(of.item.points),
        mean: points(of.mean),
        lost: of.lost,
        unmet: of.unmet,
    }
}

fn bug<'a>(of: &statistics::Bug<'a>) -> Bug<'a> {
    let statistics::Bug { slug, sure, unsure } = of;
    let known = Cause::ALL.into_iter().find(|cause| cause.slug() == *slug);
    let all = || sure.iter().chain(unsure).copied();
    let said = all().flat_map(|grade| &grade.diagnoses).find(|d| d.cause.as_deref() == Some(slug));
    Bug {
        count: sure.len(),
        unsure: unsure.len(),
        slug,
        page: cause_page(slug),
        statement: match known {
            Some(cause) => cause.statement(),
            None => said.map_or("", |found| found.statement.as_str()),
        },
        who: sure.iter().copied().map(link).collect(),
        perhaps: unsure.iter().copied().map(link).collect(),
    }
}

fn row<'a>(grade: &'a Grade, names: &[&'a str]) -> Row<'a> {
    let marks = [
        (grade.broken.is_some(), "not measured"),
        (!grade.incidents.is_empty(), "incidents"),
        (!grade.review.is_empty(), "review"),
    ];
    let has_lost = grade.items.iter().any(|item| item.is_lost());
    Row {
        page: page_of(grade),
        id: &grade.id,
        names: names.iter().map(|name| grade.names.get(*name).map_or("", String::as_str)).collect(),
        language: grade.language.as_deref().unwrap_or(""),
        score: points(grade.score),
        percent: format!("{:.0}", percent(grade)),
        causes: causes_in_words(grade),
        marks: marks.iter().filter(|m| m.0).map(|m| m.1).collect::<Vec<_>>().join(", "),
        folder: files::link(&format!("submissions/{}", file_name(&grade.id))),
        appeals: has_lost.then(|| files::link(&appeals(&grade.id))),
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::{broken, grade, hostile, whole};
    use super::super::fairness::Fairness;
    use super::*;

    fn of(grades: &[Grade]) -> String {
        let fairness = Fairness::new(2e-4, grades.len());
        class_page(&Class { title: "Assignment 2", grades, fairness, exports: &[], again: "" })
    }

    #[test]
    fn tells_scores_items_bugs_and_who_to_look_at() {
        let page = of(&[broken(), whole("")]);
        for part in [
            "<h1>2 submissions: 2.08 of 10 points in the mean, 2.08 in the median</h1>",
            "<li class=\"fail\"><b>1</b> could not be measured</li>",
            "with probability at most 2e-4; were all 2 correct, any of them would with at most 4e-4; equal seeds",
            "<a href=\"feedback/1042.html\"><bdi>1042</bdi></a>: <bdi>albedo could not decide at θo 77°</bdi>",
            "opened ../rubric.toml (3 times)",
            "<a href=\"feedback/1043.html\"><bdi>1043</bdi></a>: <bdi>it does not build: clang++ ended with 1</bdi>",
            "<bdi>Title of pdf</bdi></th><td class=\"number\">2</td><td class=\"number\">0.33</td><td class=\"number\">1</td><td class=\"number\">0</td>",
            "<bdi>Title of grazing</bdi> <span class=\"kind\">bonus</span>",
            "docs/causes/half-vector-jacobian.md\">half-vector-jacobian</a></th><td>pdf() is the density of the half vector",
            "<th scope=\"col\">name</th>",
            "<a href=\"submissions/1042/grade.json\">grade</a> <a href=\"appeals/1042/\">appeals</a>",
            "1 from 4 to 4.5",
        ] {
            assert!(page.contains(part), "no {part}");
        }
        assert!(!page.contains("<th scope=\"col\">number</th>"), "it is the id");
        assert_eq!(page, of(&[whole(""), broken()]), "in any order");
    }

    #[test]
    fn a_class_of_nobody_is_a_page() {
        assert!(of(&[]).contains("<h1>No submissions</h1>"));
    }

    #[test]
    fn hostile_text_stays_text_everywhere() {
        let page = of(&[hostile(""), Grade { id: "a/../\"b".into(), ..grade() }]);
        let (before, after) = page.split_once("<style ").unwrap();
        let markup = before.to_string() + after.split_once("</style>").unwrap().1;
        let markup = markup.split_once("<script nonce").unwrap().0;
        for part in ["<script", "<img", "onload=\"", "<!--"] {
            assert!(
                !markup.contains(part),
                "{part}: {}",
                &markup[markup.find(part).unwrap().saturating_sub(200)..]
            );
        }
        assert!(markup.matches("&#60;/script&#62;&#60;script&#62;x").count() > 10, "it is shown as it is");
        assert!(!markup.contains("href=\"feedback/a/"), "names of files are tame");
    }

    #[test]
    fn a_policy_lets_nothing_in_but_the_page_itself() {
        let page = of(&[whole("")]);
        let nonce = page.split_once("script-src 'nonce-").unwrap().1.split('\'').next().unwrap();
        assert_eq!(page.matches(&format!(" nonce=\"{nonce}\"")).count(), 2, "one style, one script");
        assert!(page.contains("default-src 'none'") && !page.contains("unsafe"));
        assert!(!of(&[broken()]).contains(nonce), "another class has another");
    }
}
