//! The whole page.

use super::super::json::{Report, WaiverRow, WaiverState};
use super::super::terminal::symbol;
use super::super::wording::ratio;
use super::changes::{Changed, Changes, Trend};
use super::gather::{Carried, gather};
use super::head::{self, counted};
use super::matrix::{Matrix, matrix};
use super::names;
use super::pack::packed;
use super::scales::scales;
use super::section::{at, section};
use super::subject::{Subject, is_telling, is_wrong, subjects};
use crate::cause::Cause;
use crate::checks::Verdict;
use askama::Template;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::path::Path;

/// The file of the page.
pub const PAGE: &str = "index.html";

/// Bytes of sections that are plain HTML; those beyond are packed, but for their cause.
/// A browser lays out some 5 MB of them a second.
const MOST_PLAIN: usize = 3 << 20;

/// Bytes that a check of a subject takes in the matrix and in a packed section, and each
/// direction of it, measured.
const BYTES_A_CHECK: usize = 300;
const BYTES_A_RESULT: usize = 10;

/// Subjects told at the top; the rest are in the matrix.
const MOST_TOLD: usize = 100;

/// The style of every page: its colours, type and pictures.
pub const STYLE: &str = include_str!("style.css");
const SCRIPTS: [&str; 3] =
    [include_str!("script/cells.js"), include_str!("script/discs.js"), include_str!("script/page.js")];

#[derive(Template)]
#[template(path = "page.html")]
struct Page<'a> {
    report: &'a Report,
    nonce: String,
    verdict: Verdict,
    symbol: char,
    sentence: String,
    counts: Vec<(String, Verdict, &'static str)>,
    facts: Vec<(&'static str, String)>,
    wrong: Vec<Told<'a>>,
    wrong_left: usize,
    unclear: Vec<Told<'a>>,
    unclear_left: usize,
    waivers: Vec<Waiver<'a>>,
    changes: Option<&'a Changes<'a>>,
    groups: Vec<Group<'a>>,
    matrix: Matrix<'a>,
    blocks: Vec<Blocks<'a>>,
    manual: Vec<(&'static str, &'static str, String)>,
    cells: Vec<&'a (String, String)>,
    scales: String,
    style: &'static str,
    script: String,
}

/// A subject at the top of the page.
struct Told<'a> {
    anchor: &'a str,
    name: &'a str,
    verdict: Verdict,
    symbol: char,
    told: String,
    slug: Option<&'a str>,
}

struct Waiver<'a> {
    row: &'a WaiverRow,
    state: &'static str,
    class: &'static str,
    at_most: String,
}

/// Changes of a trend.
struct Group<'a> {
    title: &'static str,
    class: &'static str,
    symbol: char,
    changes: Vec<Linked<'a>>,
}

struct Linked<'a> {
    anchor: String,
    change: &'a Changed<'a>,
}

/// Sections under a heading.
struct Blocks<'a> {
    id: &'static str,
    title: &'static str,
    blocks: Vec<Block<'a>>,
}

impl Blocks<'_> {
    fn has_packed(&self) -> bool {
        self.blocks.iter().any(|b| b.packed.is_some())
    }
}

/// The section of a subject.
struct Block<'a> {
    anchor: &'a str,
    base: &'a str,
    parameters: Vec<&'a str>,
    label: Option<&'a str>,
    verdict: Verdict,
    symbol: char,
    /// What is wrong, in the heading.
    told: Option<&'a str>,
    slug: Option<&'a str>,
    summary: String,
    body: String,
    packed: Option<String>,
}

/// A shape for a verdict.
fn symbol_of(verdict: &Verdict) -> char {
    symbol(*verdict)
}

/// The page as text: a function of the report and the evidence in its folder.
pub fn page(folder: &Path, report: &Report) -> String {
    let changes = report.comparison.as_ref().map(Changes::of);
    let changes = changes.as_ref();
    let columns = report.checks();
    let subjects = subjects(report, &columns);
    let checks: usize = subjects.iter().map(|s| s.checks.len()).sum();
    let words = checks * BYTES_A_CHECK + report.results.len() * BYTES_A_RESULT + MOST_PLAIN;
    let carried = gather(folder, &subjects, words);
    let blocks = blocks(&subjects, &carried, changes);
    let verdict = head::verdict(report);
    let wrong: Vec<&Subject> = subjects.iter().filter(|s| is_wrong(s.verdict)).collect();
    let unclear: Vec<&Subject> =
        subjects.iter().filter(|s| is_telling(s.verdict) && !is_wrong(s.verdict)).collect();
    let page = Page {
        report,
        nonce: nonce(report),
        verdict,
        symbol: symbol(verdict),
        sentence: head::sentence(report, &subjects),
        counts: head::counts(report),
        facts: head::facts(report, &subjects),
        wrong: wrong.iter().take(MOST_TOLD).map(|s| told(s)).collect(),
        wrong_left: wrong.len().saturating_sub(MOST_TOLD),
        unclear: unclear.iter().take(MOST_TOLD).map(|s| told(s)).collect(),
        unclear_left: unclear.len().saturating_sub(MOST_TOLD),
        waivers: waivers(report),
        changes,
        groups: changes.map(|c| groups(c, &subjects)).unwrap_or_default(),
        matrix: matrix(&subjects, &columns, changes),
        blocks,
        manual: manual(report),
        cells: carried.iter().flat_map(|c| &c.cells).collect(),
        scales: scales(),
        style: STYLE,
        script: SCRIPTS.join("\n"),
    };
    page.render().expect("a string takes every text")
}

/// Names the page's own script and style for its policy: nobody who writes a part of the
/// report can know it before the report is whole.
fn nonce(report: &Report) -> String {
    let bytes = serde_json::to_vec(report).unwrap_or_default();
    blake3::hash(&bytes).to_hex()[..32].to_string()
}

/// The slug of a cause that the page holds the manual's page of.
fn slug<'a>(subject: &Subject<'a>) -> Option<&'a str> {
    let slug = subject.found?.cause.as_deref()?;
    Cause::ALL.iter().any(|c| c.slug() == slug).then_some(slug)
}

fn told<'a>(subject: &'a Subject<'a>) -> Told<'a> {
    let worst = subject.checks.iter().max_by_key(|c| c.verdict);
    let first = worst.map(|check| {
        let result = check.results[0];
        format!("{}: {}", check.id, result.reason.as_ref().unwrap_or(&result.message))
    });
    let cause = subject.found.map(|f| f.statement.clone());
    Told {
        anchor: &subject.anchor,
        name: &subject.id.name,
        verdict: subject.verdict,
        symbol: symbol(subject.verdict),
        told: cause.or(first).unwrap_or_default(),
        slug: slug(subject),
    }
}

fn waivers(report: &Report) -> Vec<Waiver<'_>> {
    let mut rows: Vec<Waiver> = report
        .waivers
        .iter()
        .map(|row| {
            let (state, class) = match row.state {
                WaiverState::Used => ("used", "used"),
                WaiverState::Unused => ("unused: nothing failed, delete it", "unused"),
                WaiverState::Expired => ("expired: failures count again", "expired"),
                WaiverState::Exceeded => ("exceeded: a failure is larger", "exceeded"),
            };
            Waiver { row, state, class, at_most: row.at_most.map_or(String::new(), ratio) }
        })
        .collect();
    rows.sort_by_key(|w| w.row.state == WaiverState::Used);
    rows
}

fn groups<'a>(changes: &'a Changes<'a>, subjects: &[Subject]) -> Vec<Group<'a>> {
    let linked = |change: &'a Changed<'a>| {
        let section = subjects.iter().find(|s| change.is_of(s.id));
        let anchor = section.map(|s| names::check_anchor(&s.anchor, &change.of.check));
        Linked { anchor: anchor.unwrap_or_else(|| "subjects-and-checks".into()), change }
    };
    [
        ("What got worse", Trend::Worse),
        ("What is less sure", Trend::LessSure),
        ("What got better", Trend::Better),
    ]
    .map(|(title, trend)| Group {
        title,
        class: trend.class(),
        symbol: trend.symbol(),
        changes: changes.with(trend).map(linked).collect(),
    })
    .into()
}

fn blocks<'a>(
    subjects: &'a [Subject<'a>],
    carried: &'a [Carried],
    changes: Option<&'a Changes<'a>>,
) -> Vec<Blocks<'a>> {
    let bodies: Vec<String> = subjects
        .par_iter()
        .zip(carried)
        .map(|(subject, carried)| {
            section(subject, carried, changes).render().expect("a string takes every text")
        })
        .collect();
    let plain = plain(subjects, &bodies);
    let made: Vec<Block> = subjects
        .par_iter()
        .zip(bodies)
        .zip(plain)
        .map(|((subject, body), plain)| block(subject, body, plain))
        .collect();
    let (telling, passing) = made.into_iter().partition(|b| is_telling(b.verdict));
    vec![
        Blocks { id: "to-look-at", title: "Subjects to look at", blocks: telling },
        Blocks { id: "passing", title: "Subjects that pass", blocks: passing },
    ]
}

/// Whose sections are plain HTML: of what a person should look at, the gravest first.
fn plain(subjects: &[Subject], bodies: &[String]) -> Vec<bool> {
    let mut order: Vec<usize> = (0..subjects.len()).filter(|k| is_telling(subjects[*k].verdict)).collect();
    order.sort_by_key(|k| Reverse(subjects[*k].verdict));
    let mut left = MOST_PLAIN;
    let mut plain = vec![false; subjects.len()];
    for number in order {
        plain[number] = bodies[number].len() <= left;
        left -= if plain[number] { bodies[number].len() } else { 0 };
    }
    plain
}

fn block<'a>(subject: &'a Subject<'a>, body: String, plain: bool) -> Block<'a> {
    let (base, parameters) = names::parts(&subject.id.name);
    let (packed, body) = if plain { (None, body) } else { (Some(packed(body.as_bytes())), String::new()) };
    Block {
        anchor: &subject.anchor,
        base,
        parameters,
        label: subject.id.label.as_deref(),
        verdict: subject.verdict,
        symbol: symbol(subject.verdict),
        told: subject.found.map(|f| f.statement.as_str()),
        slug: slug(subject),
        summary: summary(subject),
        body,
        packed,
    }
}

/// `2 fail, 17 pass, 1 skipped; 6 directions`.
fn summary(subject: &Subject) -> String {
    let mut met: Vec<Verdict> = subject.checks.iter().map(|c| c.verdict).collect();
    met.sort_by(|a, b| b.cmp(a));
    met.dedup();
    let count = |verdict| subject.checks.iter().filter(|c| c.verdict == verdict).count();
    let parts: Vec<String> = met.iter().map(|v| format!("{} {}", count(*v), v.word())).collect();
    let checks = match subject.checks.as_slice() {
        [only] => format!("{} {}", only.id, at(only)),
        _ => format!("checks: {}", parts.join(", ")),
    };
    let measured = match subject.cases.as_slice() {
        [case] if case.wo.is_none() => checks,
        cases => format!("{checks}; {}", counted(cases.len(), "direction")),
    };
    let carried =
        if subject.carried { "; taken over from an earlier report, as nothing changed" } else { "" };
    measured + carried
}

/// Slug, title and text of the manual's pages on causes that are named.
fn manual(report: &Report) -> Vec<(&'static str, &'static str, String)> {
    let named: BTreeSet<&str> = report.diagnoses.iter().filter_map(|d| d.cause.as_deref()).collect();
    let found = Cause::ALL.iter().filter(|c| named.contains(c.slug()));
    found
        .map(|cause| {
            let (title, text) = cause.page().split_once('\n').unwrap_or((cause.page(), ""));
            (cause.slug(), title.trim_start_matches("# "), text.trim().to_string())
        })
        .collect()
}
