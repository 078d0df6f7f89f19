//! A report as Markdown: the verdict first, then what to do.

use super::findings::{Finding, findings, place};
use super::manual::cause_page;
use super::markdown_text::{Block, cell, code, fenced, joined, text};
use super::site::Site;
use crate::checks::Verdict;
use crate::comparison::Comparison;
use crate::report::changes::in_words;
use crate::report::json::{CheckResult, Diagnosis, Report, WaiverRow, WaiverState};
use crate::report::terminal::{short, symbol};
use crate::report::wording::facts;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Rows of a table that is still read.
const ROWS: usize = 40;

/// The whole file; with `pictures` where they lie beside it.
pub fn markdown(report: &Report, site: &Site, pictures: bool) -> String {
    joined(&blocks(report, site, pictures))
}

/// Its parts.
pub fn blocks(report: &Report, site: &Site, pictures: bool) -> Vec<Block> {
    let found = findings(report, site);
    let mut blocks = vec![Block::new(headline(report)), Block::new(about(report))];
    blocks.extend(report.partial.as_ref().map(|p| Block::new(format!("**NOT COMPLETE**: {}", text(p)))));
    blocks.extend(table(report, site).map(Block::new));
    blocks.extend(report.comparison.as_ref().map(|c| Block::new(changes(c))));
    let (known, new): (Vec<&Finding>, _) = found.iter().filter(|f| f.is_wrong()).partition(|f| f.is_known());
    blocks.extend(new.into_iter().map(|f| Block::finding(section(f, pictures))));
    if !known.is_empty() {
        blocks.push(Block::new("## As in the baseline"));
        blocks.extend(known.into_iter().map(|f| Block::finding(item(f))));
    }
    for (title, verdicts) in
        [("Not decided", &[Verdict::Warn, Verdict::Inconclusive][..]), ("Accepted", &[Verdict::Waived])]
    {
        let of: Vec<_> = found.iter().filter(|f| verdicts.contains(&f.verdict)).collect();
        if !of.is_empty() {
            blocks.push(Block::new(format!("## {title}")));
            blocks.extend(of.into_iter().map(|f| Block::finding(item(f))));
        }
    }
    let idle: Vec<String> = report.waivers.iter().filter_map(waiver).collect();
    if !idle.is_empty() {
        blocks.push(Block::new(format!("## Waivers to look at\n\n{}", idle.join("\n"))));
    }
    blocks
}

fn counted(n: usize, one: &str, several: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { several })
}

/// The verdict.
fn headline(report: &Report) -> String {
    let subjects = |of: &[Verdict]| -> usize {
        let named = report.results.iter().filter(|r| of.is_empty() || of.contains(&r.verdict));
        named.map(|r| (&r.subject.name, &r.subject.label)).collect::<BTreeSet<_>>().len()
    };
    let (all, errors, failing) = (subjects(&[]), subjects(&[Verdict::Error]), subjects(&[Verdict::Fail]));
    let unclear = subjects(&[Verdict::Inconclusive, Verdict::Warn]);
    let of_all = |n: usize| format!("{n} of {}", counted(all, "subject", "subjects"));
    let tail = if unclear > 0 { format!(", {unclear} not decided") } else { String::new() };
    let verdict = match (all, errors, failing) {
        (0, ..) => "– nothing was checked".into(),
        (_, 0, 0) => format!("✓ no failure in {}{tail}", counted(all, "subject", "subjects")),
        (_, 0, _) => format!("✗ {} wrong{tail}", of_all(failing)),
        (_, _, 0) => format!("E {} could not be measured{tail}", of_all(errors)),
        _ => format!("✗ {} wrong, {errors} could not be measured{tail}", of_all(failing)),
    };
    format!("# {verdict}")
}

/// Of which run.
fn about(report: &Report) -> String {
    let s = &report.summary;
    let counts: Vec<String> = [
        (s.passed, "passed"),
        (s.failed, "failed"),
        (s.errors, "errors"),
        (s.inconclusive, "inconclusive"),
        (s.warned, "warned"),
        (s.waived, "waived"),
        (s.skipped, "skipped"),
    ]
    .iter()
    .filter(|(n, word)| *n > 0 || *word == "failed")
    .map(|(n, word)| format!("{n} {word}"))
    .collect();
    format!(
        "Suite {}, seed {}, gonio {}, {:.1} s: {}.",
        code(&report.suite),
        report.seed,
        text(&report.gonio),
        report.duration_s,
        counts.join(", ")
    )
}

/// Subjects and checks; of many subjects those with trouble.
fn table(report: &Report, site: &Site) -> Option<String> {
    let columns = report.checks();
    let mut rows: Vec<&str> = Vec::new();
    let mut met: BTreeSet<&str> = BTreeSet::new();
    let mut worst: BTreeMap<(&str, &str), Verdict> = BTreeMap::new();
    let mut troubled: BTreeSet<&str> = BTreeSet::new();
    for result in &report.results {
        let row = result.subject.group();
        if met.insert(row) {
            rows.push(row);
        }
        let cell = worst.entry((row, &result.check)).or_insert(Verdict::Skipped);
        *cell = (*cell).max(result.verdict);
        if !matches!(result.verdict, Verdict::Pass | Verdict::Skipped) {
            troubled.insert(row);
        }
    }
    if rows.is_empty() {
        return None;
    }
    let all = rows.len();
    if all > ROWS {
        rows.retain(|row| troubled.contains(row));
        rows.truncate(ROWS);
    }
    let heads: String = columns.iter().map(|check| format!(" {} |", text(&short(check)))).collect();
    let mut lines = vec![format!("| |{heads}"), format!("|---|{}", ":-:|".repeat(columns.len()))];
    for row in &rows {
        let mut line = format!("| {} |", cell(&site.portable(row)));
        for check in &columns {
            let shape = worst.get(&(*row, *check)).map_or(' ', |verdict| symbol(*verdict));
            write!(line, " {shape} |").expect("a string takes every text");
        }
        lines.push(line);
    }
    let mut legend = String::from("✓ pass, ✗ fail, ? inconclusive, ! warn, – skipped, E error, w waived. ");
    let names: Vec<String> = columns.iter().map(|c| format!("{} {}", text(&short(c)), text(c))).collect();
    legend += &names.join(", ");
    let mut table = if rows.is_empty() { String::new() } else { lines.join("\n") + "\n\n" };
    if rows.len() < all {
        let left_out =
            [(troubled.len() - rows.len(), "with trouble"), (all - troubled.len(), "without trouble")];
        let told: Vec<String> = left_out
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(n, which)| format!("{} {which}", counted(*n, "more row", "more rows")))
            .collect();
        table += &format!("Not in this table: {}.\n\n", told.join(" and "));
    }
    table += &format!("<sub>{legend}.</sub>");
    Some(table)
}

/// Everything about a subject that fails, or that could not be measured.
fn section(finding: &Finding, pictures: bool) -> String {
    let lead = finding.lead();
    let mut parts = vec![format!("## {} {}", symbol(finding.verdict), code(&finding.name))];
    if finding.verdict == Verdict::Error {
        let why = lead.reason.as_ref().unwrap_or(&lead.message);
        // What a program said last keeps its lines.
        parts.push(match why.trim().contains('\n') {
            true => format!("It could not be measured:\n\n{}", fenced("text", why)),
            false => format!("It could not be measured: {}", text(why)),
        });
    }
    parts.extend(finding.diagnosis.map(|found| diagnosis(found, pictures)));
    if finding.verdict == Verdict::Fail {
        let checks = finding.checks();
        let lines = checks.iter().map(|check| {
            let of: Vec<&CheckResult> =
                finding.results.iter().copied().filter(|r| r.check == *check).collect();
            evidence(&of)
        });
        parts.push(lines.collect::<Vec<_>>().join("\n"));
    }
    if let Some(path) = lead.plot.as_ref().filter(|path| pictures && is_plain(path)) {
        parts.push(format!("![{} at {}]({path})", text(&lead.check), text(&place(lead))));
    }
    parts.push(fenced("sh", &lead.command));
    parts.join("\n\n")
}

/// A path that Markdown takes as it is, of a file below.
fn is_plain(path: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./".contains(c);
    path.chars().all(plain) && !path.starts_with('/') && !path.split('/').any(|part| part == "..")
}

fn diagnosis(found: &Diagnosis, pictures: bool) -> String {
    let slug = found.cause.as_ref().map_or(String::new(), |slug| match cause_page(slug) {
        Some(page) => format!(" ([{slug}]({page}))"),
        None => format!(" ({})", code(slug)),
    });
    let mut lines = vec![format!("**cause**: {}{slug}", text(&found.statement))];
    lines.extend(found.repair.as_ref().map(|repair| format!("**repair**: {}", text(repair))));
    lines.extend(found.evidence.iter().map(|since| format!("**since**: {}", text(since))));
    // What is not certain names its rival.
    lines
        .extend(found.runner_up.iter().filter(|_| found.confident).map(|o| format!("**next**: {}", text(o))));
    if let Some(path) = found.plot.as_ref().filter(|path| pictures && is_plain(path)) {
        lines.push(format!("![counts over pdf]({path})"));
    }
    // Each on a line of its own.
    lines.join("  \n")
}

/// What changed since the baseline.
fn changes(found: &Comparison) -> String {
    let mut lines = vec![format!("## Since the report of {}\n", text(&found.before.started))];
    for (word, list) in [("worse", &found.worse), ("better", &found.better), ("less sure", &found.less_sure)]
    {
        lines.extend(list.iter().take(ROWS).map(|c| format!("- **{word}**: {}", text(&in_words(c)))));
        if list.len() > ROWS {
            lines.push(format!("- **{word}**: and {} more", list.len() - ROWS));
        }
    }
    for (word, names) in [("new", &found.added), ("gone", &found.removed)] {
        if !names.is_empty() {
            let shown: Vec<String> = names.iter().take(ROWS).map(|name| code(name)).collect();
            let more = if names.len() > ROWS { ", …" } else { "" };
            lines.push(format!("- **{word}**: {}{more}", shown.join(", ")));
        }
    }
    lines.push(format!("- {} results are the same, {} fail in both", found.same, found.still_failing));
    lines.join("\n")
}

/// A check that fails: at how many directions, and what the clearest shows.
fn evidence(results: &[&CheckResult]) -> String {
    let clearest = results[0];
    let at = place(clearest);
    let at = if at.is_empty() { String::new() } else { format!(" at {}", text(&at)) };
    let more = match results.len() {
        1 => String::new(),
        n => format!(" (and {})", counted(n - 1, "more case", "more cases")),
    };
    let facts: Vec<String> = facts(clearest).iter().map(|fact| text(fact)).collect();
    format!("- **{}**{at}{more}: {}", text(&clearest.check), facts.join("; "))
}

/// A line about what is not decided, or accepted.
fn item(finding: &Finding) -> String {
    let n = finding.results.len();
    let cases = if n > 1 { format!(" ({n} cases)") } else { String::new() };
    format!("- {} {}: {}{cases}", symbol(finding.verdict), code(&finding.name), text(&finding.headline()),)
}

/// A line about a waiver that does not do what it was written for.
fn waiver(row: &WaiverRow) -> Option<String> {
    let what = match row.state {
        WaiverState::Used => return None,
        WaiverState::Unused => "covers no failure: delete it".to_string(),
        WaiverState::Expired => {
            format!("expired on {}: failures count again", row.until.as_deref().map(text).unwrap_or_default())
        }
        WaiverState::Exceeded => "does not cover a failure that is larger than it allows".to_string(),
    };
    Some(format!("- {} of {} ({}) {what}", code(&row.check), code(&row.subject), text(&row.because)))
}

#[cfg(test)]
mod tests {
    use super::super::examples::{hostile, report, site};
    use super::*;

    fn whole(report: &Report) -> String {
        markdown(report, &site(), true)
    }

    #[test]
    fn the_verdict_comes_first_and_what_to_do_follows() {
        let text = whole(&report());
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "# ✗ 1 of 3 subjects wrong, 1 not decided");
        assert_eq!(
            lines[2],
            "Suite `default`, seed 1, gonio 0.1.0, 12.3 s: 2 passed, 2 failed, 1 inconclusive, 1 skipped."
        );
        assert_eq!(lines[4], "| | fit | alb | fur |");
        assert_eq!(lines[6], "| `lambert` | ✓ |   | – |");
        assert_eq!(lines[7], "| `ggx` | ✗ | ? |   |");
        for part in [
            "## ✗ `ggx:alpha=0.5`\n",
            "**cause**: pdf() lacks the factor 1/(4 wo·h) ([half-vector-jacobian](https://",
            "\n**repair**: divide by 4 wo·h",
            "- **goodness-of-fit** at θo 60° φo 17° (and 1 more case): √D = 1.20 % (1.10 to 1.31 %)",
            "```sh\ngonio check ggx:alpha=0.5 --theta 60 --phi 17 --seed 1\n```",
            "- ? `ggx:alpha=0.01`: albedo could not decide: would only have seen an error of 5 %",
        ] {
            assert!(text.contains(part), "{part}:\n{text}");
        }
    }

    #[test]
    fn headlines_say_what_happened() {
        let mut found = report();
        let head = |report: &Report| headline(report);
        found.results[2].verdict = Verdict::Error;
        assert_eq!(head(&found), "# ✗ 1 of 3 subjects wrong, 1 could not be measured, 1 not decided");
        found.results[3].verdict = Verdict::Error;
        assert_eq!(head(&found), "# E 1 of 3 subjects could not be measured, 1 not decided");
        found.results.retain(|r| r.subject.name == "lambert");
        assert_eq!(head(&found), "# ✓ no failure in 1 subject");
        found.results.clear();
        assert_eq!(head(&found), "# – nothing was checked");
        assert!(table(&found, &site()).is_none());
    }

    #[test]
    fn large_reports_show_rows_with_trouble_and_count_the_others() {
        let mut report = report();
        for k in 0..60 {
            let mut result = report.results[0].clone();
            result.subject.name = format!("model-{k}:a=1");
            report.results.push(result);
        }
        let text = table(&report, &site()).unwrap();
        assert!(
            text.contains("| `ggx` |") && !text.contains("model-7") && !text.contains("lambert"),
            "{text}"
        );
        assert!(text.contains("Not in this table: 61 more rows without trouble.\n"), "{text}");
        report.results.iter_mut().for_each(|r| r.verdict = Verdict::Fail);
        let text = table(&report, &site()).unwrap();
        assert!(text.contains(": 22 more rows with trouble.\n") && text.contains("model-7"), "{text}");
    }

    #[test]
    fn waivers_that_do_nothing_are_told() {
        let mut report = report();
        let row = |state| WaiverRow {
            check: "mis".into(),
            subject: "x".into(),
            because: "a|b".into(),
            until: Some("2026-01-01".into()),
            at_most: None,
            state,
            covered: 0,
        };
        report.waivers = vec![row(WaiverState::Used), row(WaiverState::Unused), row(WaiverState::Expired)];
        let text = whole(&report);
        let told: Vec<&str> = text.split("## Waivers to look at\n\n").nth(1).unwrap().lines().collect();
        assert_eq!(
            told,
            [
                r"- `mis` of `x` (a\|b) covers no failure: delete it",
                r"- `mis` of `x` (a\|b) expired on 2026-01-01: failures count again",
            ]
        );
    }

    #[test]
    fn pictures_are_shown_in_the_file_and_only_from_below() {
        let mut report = report();
        report.results[3].plot = Some("plots/a.svg".into());
        assert!(whole(&report).contains("(plots/a.svg)"));
        assert!(!markdown(&report, &site(), false).contains("plots/a.svg"));
        for path in ["../x.svg", "/x.svg", "a) <b>", "https://x"] {
            report.results[3].plot = Some(path.into());
            assert!(!whole(&report).contains("!["), "{path}");
        }
    }

    #[test]
    fn hostile_text_opens_nothing() {
        let text = whole(&hostile());
        let mut fence: Option<String> = None;
        for line in text.lines() {
            let ticks: String = line.chars().take_while(|c| *c == '`').collect();
            match &fence {
                Some(open) if line == open => fence = None,
                None if ticks.len() > 2 => fence = Some(ticks),
                // Outside of code.
                None if !line.contains("``") => {
                    let html = line.replace("\\<", "").replace("<sub>", "").replace("</sub>", "");
                    assert!(!html.contains('<'), "{line}");
                }
                _ => {}
            }
        }
        assert!(fence.is_none(), "a fence is not closed");
        let heads = text.lines().filter(|l| l.starts_with("## ")).count();
        assert_eq!(heads, 4, "an error, a failure, what is not decided, what is accepted:\n{text}");
    }
}
