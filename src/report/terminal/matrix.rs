//! Subjects × checks.

use super::super::json::{CheckResult, Report};
use super::super::plots::shortened;
use super::super::wording::direction;
use super::look::{Look, code, indented, line, symbol};
use crate::checks::Verdict;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Characters of a column of the matrix.
const COLUMN: usize = 4;

/// Rows may take this part of a page.
const ROWS: usize = 3;

/// Whether a verdict is one to look at.
fn is_finding(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Fail | Verdict::Error | Verdict::Inconclusive | Verdict::Warn)
}

/// Three letters for a check's column.
pub fn short(check: &str) -> String {
    let known = match check {
        "sanity" => "san",
        "determinism" => "det",
        "goodness-of-fit" => "fit",
        "normalization" => "nrm",
        "support" => "sup",
        "weight" => "wgt",
        "returned-pdf" => "pdf",
        "albedo" => "alb",
        "mis" => "mis",
        "energy" => "nrg",
        "white-furnace" => "fur",
        "reciprocity" => "rec",
        "isotropy" => "iso",
        "discrete-lobes" => "dis",
        "sensitivity" => "sen",
        "reference" => "ref",
        "distribution" => "ndf",
        "fresnel" => "fre",
        "jacobian" => "jac",
        "efficiency" => "eff",
        other => return other.chars().take(3).collect(),
    };
    known.to_string()
}

/// A case is a subject at a direction, with evidence of its own.
pub fn case_of(result: &CheckResult) -> (String, String, String) {
    let wo = result.wo.map_or(String::new(), direction);
    (result.subject.name.clone(), wo, result.evidence.clone().unwrap_or_default())
}

pub fn matrix(text: &mut String, report: &Report, look: Look) {
    let mut columns = report.checks();
    let mut rows: Vec<&str> = Vec::new();
    let mut worst: BTreeMap<(&str, &str), Verdict> = BTreeMap::new();
    let mut cases: BTreeMap<&str, BTreeSet<(String, String, String)>> = BTreeMap::new();
    for result in &report.results {
        let row = result.subject.group();
        if !rows.contains(&row) {
            rows.push(row);
        }
        cases.entry(row).or_default().insert(case_of(result));
        let cell = worst.entry((row, &result.check)).or_insert(Verdict::Skipped);
        *cell = (*cell).max(result.verdict);
    }
    if rows.is_empty() {
        return line(text, "nothing was checked");
    }
    let all = rows.len();
    if look.lines.is_some_and(|lines| all > lines / ROWS) {
        let finding =
            |row: &str| columns.iter().any(|c| worst.get(&(row, *c)).is_some_and(|v| is_finding(*v)));
        rows.retain(|row| finding(row));
    }
    let quiet = all - rows.len();
    let idle = |check: &&str| worst.iter().all(|((_, c), v)| c != check || *v == Verdict::Skipped);
    let skipped: Vec<&str> = columns.iter().copied().filter(|c| look.lines.is_some() && idle(c)).collect();
    columns.retain(|check| !skipped.contains(check));
    let name = |row: &str| format!("{row} ({})", cases[row].len());
    let longest = rows.iter().map(|row| name(row).chars().count()).max().unwrap_or(0).min(30);
    let fitting = ((look.width() - longest) / COLUMN).max(1);
    for band in columns.chunks(fitting) {
        let heads: String = band.iter().map(|check| format!("{:>COLUMN$}", short(check))).collect();
        line(text, &format!("{:longest$}{heads}", ""));
        for row in &rows {
            let mut content = format!("{:longest$}", shortened(&name(row), longest));
            for check in band {
                let cell = match worst.get(&(*row, *check)) {
                    Some(verdict) => look.paint(code(*verdict), &symbol(*verdict).to_string()),
                    None => " ".into(),
                };
                // Under the middle of three letters.
                write!(content, "  {cell} ").expect("a string takes every text");
            }
            line(text, &content);
        }
        if quiet > 0 {
            line(
                text,
                &format!("{quiet} {}rows without a finding", if rows.is_empty() { "" } else { "more " }),
            );
        }
        line(text, "");
    }
    if !skipped.is_empty() {
        indented(text, &format!("skipped everywhere: {}", skipped.join(", ")), 0, look);
        line(text, "");
    }
    let names: Vec<String> = columns.iter().map(|c| format!("{}\u{a0}{c}", short(c))).collect();
    let shapes =
        "✓\u{a0}pass ✗\u{a0}fail ?\u{a0}inconclusive !\u{a0}warn –\u{a0}skipped E\u{a0}error w\u{a0}waived";
    for legend in [shapes.to_string(), names.join(" ")] {
        for part in legend_lines(&legend, look.width()) {
            line(text, &look.paint("2", &part));
        }
    }
}

/// Wraps entries whose words are tied by no-break spaces, and unties them.
fn legend_lines(legend: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for entry in legend.split(' ') {
        let entry = entry.replace('\u{a0}', " ");
        let last = lines.last_mut().expect("there is one from the start");
        if last.is_empty() {
            last.push_str(&entry);
        } else if last.chars().count() + 2 + entry.chars().count() <= width {
            last.push_str("  ");
            last.push_str(&entry);
        } else {
            lines.push(entry);
        }
    }
    lines
}
