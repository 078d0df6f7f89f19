//! What is wrong, in full.

use super::super::json::{CheckResult, Diagnosis, Report};
use super::super::wording::{direction, facts, probability};
use super::look::{Look, code, indented, line, symbol, told};
use crate::checks::Verdict;
use std::collections::{BTreeMap, BTreeSet};

/// Kinds of failure that are told in full; of the others only the number.
pub const BLOCKS: usize = 10;

/// What was counted is hardly chance below this, which has two reasons.
const UNLIKELY: f64 = 1e-6;
const DOUBT: &str = ": something else may be wrong too, or cells were integrated too coarsely";

/// Results that a person should look at, those of one subject, check and
/// verdict together, the clearest of each first.
fn kinds(report: &Report) -> Vec<Vec<&CheckResult>> {
    let told = [Verdict::Error, Verdict::Fail, Verdict::Inconclusive, Verdict::Warn];
    let mut kinds: Vec<Vec<&CheckResult>> = Vec::new();
    for verdict in told {
        for result in report.results.iter().filter(|r| r.verdict == verdict) {
            let same = |kind: &&mut Vec<&CheckResult>| {
                let first = kind[0];
                first.verdict == verdict
                    && first.check == result.check
                    && first.subject.name == result.subject.name
            };
            match kinds.iter_mut().find(same) {
                Some(kind) => kind.push(result),
                None => kinds.push(vec![result]),
            }
        }
    }
    // A largest effect names the clearest; where there is none the first stays.
    let size = |r: &CheckResult| r.effect.as_ref().map_or(0.0, |e| (e.value.0 / e.tolerance.0).abs());
    for kind in &mut kinds {
        kind.sort_by(|a, b| size(b).total_cmp(&size(a)));
    }
    kinds
}

/// What is wrong with each subject, in about so many lines.
pub fn subjects(text: &mut String, report: &Report, look: Look, lines: usize) {
    let kinds = kinds(report);
    let mut subjects: Vec<(&str, Vec<&Vec<&CheckResult>>)> = Vec::new();
    for kind in &kinds {
        let name = &kind[0].subject.name;
        match subjects.iter_mut().find(|(known, _)| known == name) {
            Some((_, of)) => of.push(kind),
            None => subjects.push((name, vec![kind])),
        }
    }
    let mut told = String::new();
    for (k, (name, kinds)) in subjects.iter().enumerate() {
        let mut one = String::new();
        subject(&mut one, name, kinds, report, look);
        let used = told.lines().count() + one.lines().count();
        if k > 0 && used > lines {
            let left = subjects.len() - k;
            let more = format!("and {left} more {}; -v tells all, the report too", plural(left, "subject"));
            line(&mut one, "");
            told.push_str(&format!("\n{more}\n"));
            break;
        }
        told.push_str(&one);
    }
    text.push_str(&told);
}

fn plural(n: usize, word: &str) -> String {
    if n == 1 { word.into() } else { format!("{word}s") }
}

/// A subject in a few lines: which checks, the cause, and the command of the clearest.
fn subject(text: &mut String, name: &str, kinds: &[&Vec<&CheckResult>], report: &Report, look: Look) {
    line(text, "");
    let worst = kinds[0][0].verdict;
    let of_worst: Vec<_> = kinds.iter().filter(|kind| kind[0].verdict == worst).collect();
    let checks: Vec<&str> = of_worst.iter().map(|kind| kind[0].check.as_str()).collect();
    let directions = of_worst.iter().map(|kind| kind.len()).max().unwrap_or(0);
    let verdict = look.paint(code(worst), &format!("{} {}", symbol(worst), worst.word()));
    line(text, &format!("{verdict}  {}", look.paint("1", name)));
    let at = format!("{} at {directions} {}", checks.join(", "), plural(directions, "direction"));
    indented(text, &at, 4, look);
    let first = kinds[0][0];
    match report.diagnoses.iter().find(|d| d.subject == name) {
        Some(found) => {
            told(text, "cause", &named(found), look);
            if let Some(repair) = &found.repair {
                told(text, "repair", repair, look);
            }
        }
        None => indented(text, first.reason.as_ref().unwrap_or(&first.message), 4, look),
    }
    line(text, &format!("    $ {}", first.command));
}

pub fn blocks(text: &mut String, report: &Report, look: Look) {
    let kinds = kinds(report);
    let mut told = BTreeSet::new();
    for kind in kinds.iter().take(BLOCKS) {
        line(text, "");
        let subject = &kind[0].subject.name;
        let first = matches!(kind[0].verdict, Verdict::Error | Verdict::Fail) && told.insert(subject);
        let found = report.diagnoses.iter().find(|d| first && d.subject == *subject);
        block(text, kind, found, look);
    }
    if kinds.len() > BLOCKS {
        let mut counts: BTreeMap<(Verdict, &str), usize> = BTreeMap::new();
        for kind in &kinds[BLOCKS..] {
            *counts.entry((kind[0].verdict, &kind[0].check)).or_default() += kind.len();
        }
        line(text, "");
        let parts: Vec<String> = counts
            .iter()
            .rev()
            .map(|((verdict, check), n)| format!("{n} {check} ({})", verdict.word()))
            .collect();
        indented(text, &format!("and more: {}; all are in the report", parts.join(", ")), 0, look);
    }
    for found in report.diagnoses.iter().filter(|d| !told.contains(&d.subject)).take(BLOCKS) {
        indented(text, &format!("{}: {}", found.subject, named(found)), 0, look);
    }
}

/// What is wrong with each failing subject, by itself.
pub fn diagnoses(report: &Report, look: Look) -> String {
    let mut text = String::new();
    for found in &report.diagnoses {
        line(&mut text, &look.paint("1", &found.subject));
        let of = |r: &&CheckResult| r.subject.name == found.subject;
        diagnosis(&mut text, found, report.results.iter().find(of), look);
    }
    text
}

/// The statement with the slug, unless it has that already.
fn named(found: &Diagnosis) -> String {
    match found.cause.as_ref().map(|slug| format!("[{slug}]")) {
        Some(slug) if !found.statement.contains(&slug) => format!("{} {slug}", found.statement),
        _ => found.statement.clone(),
    }
}

impl std::fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = String::new();
        diagnosis(&mut text, self, None, Look { width: 100, colour: false, lines: None });
        f.write_str(text.trim_end())
    }
}

/// `result` is one of the subject's: its command begins with the program.
fn diagnosis(text: &mut String, found: &Diagnosis, result: Option<&CheckResult>, look: Look) {
    told(text, "cause", &named(found), look);
    if let Some(repair) = &found.repair {
        told(text, "repair", repair, look);
    }
    for evidence in &found.evidence {
        told(text, "since", evidence, look);
    }
    if let Some(model) = &found.textbook {
        told(text, "taken for", model, look);
    }
    if let Some(p) = found.p_after_repair {
        let more = if p.0 < UNLIKELY { DOUBT } else { "" };
        told(text, "after the repair", &format!("p = {}{more}", probability(p.0.log10())), look);
    }
    // What is not certain names its rival.
    if let Some(other) = found.runner_up.as_ref().filter(|_| found.confident) {
        told(text, "next", other, look);
    }
    if let Some(slug) = &found.cause {
        let program = result.and_then(|r| r.command.split(' ').next()).unwrap_or("gonio");
        told(text, "more", &format!("{program} explain {slug}"), look);
    }
}

fn block(text: &mut String, kind: &[&CheckResult], found: Option<&Diagnosis>, look: Look) {
    let result = kind[0];
    let verdict =
        look.paint(code(result.verdict), &format!("{} {}", symbol(result.verdict), result.verdict.word()));
    let wo = result.wo.map_or(String::new(), |wo| format!("  {}", direction(wo)));
    let more = match kind.len() {
        1 => String::new(),
        2 => "  (and 1 more direction)".into(),
        n => format!("  (and {} more directions)", n - 1),
    };
    line(text, &format!("{verdict}  {}  {}{wo}{more}", result.subject.name, look.paint("1", &result.check)));
    for fact in facts(result) {
        indented(text, &fact, 4, look);
    }
    if let Some(found) = found {
        diagnosis(text, found, Some(result), look);
    }
    // Whole, so that it can be copied.
    line(text, &format!("    $ {}", result.command));
}
