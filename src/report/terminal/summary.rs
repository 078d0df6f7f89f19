//! The whole page.

use super::super::json::{Allocation, Report, WaiverRow, WaiverState};
use super::super::wording::{range, ratio};
use super::blocks::{blocks, subjects};
use super::comparison::compared;
use super::look::{Look, indented, line};
use super::matrix::{case_of, matrix};
use crate::checks::Verdict;
use std::collections::BTreeSet;

/// The whole summary. `files` are what was written, by name.
pub fn summary(report: &Report, files: &[(&str, &str)], look: Look) -> String {
    let (mut text, mut end) = (String::new(), String::new());
    matrix(&mut text, report, look);
    footer(&mut end, report, files, look);
    match look.lines {
        None => blocks(&mut text, report, look),
        Some(lines) => {
            let taken = text.lines().count() + end.lines().count();
            subjects(&mut text, report, look, lines.saturating_sub(taken));
        }
    }
    text + &end
}

/// What a waiver says of itself where it is not simply used.
fn waiver(row: &WaiverRow) -> Option<String> {
    let about = format!("waiver of {} for {} ({})", row.check, row.subject, row.because);
    let until = row.until.as_deref().unwrap_or_default();
    let most = row.at_most.map(ratio).unwrap_or_default();
    Some(match row.state {
        WaiverState::Used => return None,
        WaiverState::Unused => format!("unused {about}: nothing failed that it covers; delete it"),
        WaiverState::Expired => format!("expired {about}: it held until {until}; failures count again"),
        WaiverState::Exceeded => match most.as_str() {
            "" => format!("exceeded {about}: a failure is not covered"),
            most => format!("exceeded {about}: a failure is larger than {most}"),
        },
    })
}

/// How a budget of time was spent.
fn spent(allocation: &Allocation) -> String {
    let budget = match allocation.time_s {
        Some(seconds) => format!("a budget of {seconds} s gave"),
        None => "the allocation of another run gave".into(),
    };
    let run: Vec<u64> = allocation.samples.iter().copied().filter(|n| *n > 0).collect();
    let draws = match (run.iter().min(), run.iter().max()) {
        (Some(least), Some(most)) if least == most => format!("{least} draws"),
        (Some(least), Some(most)) => format!("{least} to {most} draws"),
        _ => "nothing".into(),
    };
    let left = allocation.samples.len() - run.len();
    let not_begun = if left > 0 { format!("; {left} were not begun") } else { String::new() };
    format!("{budget} {draws} at most to each of {} cases{not_begun}", run.len())
}

fn footer(text: &mut String, report: &Report, files: &[(&str, &str)], look: Look) {
    line(text, "");
    let s = &report.summary;
    let counts: Vec<String> = [
        (s.passed, "passed", "34"),
        (s.failed, "failed", "1;31"),
        (s.errors, "errors", "1;31"),
        (s.inconclusive, "inconclusive", "33"),
        (s.warned, "warned", "33"),
        (s.waived, "waived", "2"),
        (s.skipped, "skipped", "2"),
    ]
    .iter()
    .filter(|(n, word, _)| *n > 0 || *word == "failed")
    .map(|(n, word, code)| look.paint(code, &format!("{n} {word}")))
    .collect();
    line(text, &counts.join(", "));
    if let Some(partial) = &report.partial {
        indented(text, &format!("NOT COMPLETE: {partial}"), 0, look);
    }
    for told in report.waivers.iter().filter_map(waiver) {
        indented(text, &told, 0, look);
    }
    let carried = report.subjects.iter().filter(|s| s.carried).count();
    if carried > 0 {
        let told = format!(
            "{carried} of {} subjects are what they were: their results are taken over from the earlier report",
            report.subjects.len()
        );
        indented(text, &told, 0, look);
    }
    let cases: BTreeSet<_> = report.results.iter().map(case_of).collect();
    let run = format!(
        "{} {} of suite {}, seed {}, {:.1} s; correct subjects fail a run with probability {:e}",
        cases.len(),
        if cases.len() == 1 { "case" } else { "cases" },
        report.suite,
        report.seed,
        report.duration_s,
        report.false_alarm
    );
    indented(text, &run, 0, look);
    // Where chance is involved a limit is an error; elsewhere it is a share.
    let limits = report.results.iter().filter(|r| r.verdict == Verdict::Pass && r.log10_p.is_some());
    let mut limits: Vec<f64> = limits.filter_map(|r| r.detection_limit).map(|l| l.0).collect();
    limits.sort_by(f64::total_cmp);
    if let (Some(least), Some(most)) = (limits.first(), limits.last()) {
        let told = format!("statistical passes had detection limits of {}", range(*least, *most));
        indented(text, &told, 0, look);
    }
    if let Some(allocation) = &report.allocation {
        indented(text, &spent(allocation), 0, look);
    }
    if let Some(comparison) = &report.comparison {
        compared(text, comparison, look);
    }
    let longest = files.iter().map(|f| f.0.chars().count()).max().unwrap_or(0);
    for (name, path) in files {
        line(text, &format!("{name:longest$}  {path}"));
    }
}
