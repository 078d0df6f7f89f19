//! The head of a page: the verdict in words, and what the run was.

use super::super::json::Report;
use super::super::wording::range;
use super::subject::{Subject, is_telling, is_wrong};
use crate::checks::Verdict;

/// `1 check`, `2 checks`.
pub fn counted(n: usize, one: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{}\u{a0}{one}{plural}", thousands(n))
}

/// `12 345`, with narrow spaces.
pub fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// The gravest verdict of the run.
pub fn verdict(report: &Report) -> Verdict {
    let s = &report.summary;
    let counts = [
        (s.errors, Verdict::Error),
        (s.failed, Verdict::Fail),
        (s.inconclusive, Verdict::Inconclusive),
        (s.warned, Verdict::Warn),
    ];
    let worst = counts.iter().find(|(n, _)| *n > 0).map(|(_, verdict)| *verdict);
    worst.unwrap_or(if s.passed + s.waived > 0 { Verdict::Pass } else { Verdict::Skipped })
}

/// The verdict in a sentence.
pub fn sentence(report: &Report, subjects: &[Subject]) -> String {
    let s = &report.summary;
    let all = counted(subjects.len(), "subject");
    let wrong = subjects.iter().filter(|s| is_wrong(s.verdict)).count();
    let unclear = subjects.iter().filter(|s| is_telling(s.verdict) && !is_wrong(s.verdict)).count();
    match verdict(report) {
        Verdict::Error | Verdict::Fail => {
            let verb = if s.errors == 0 { "failed" } else { "failed or could not be measured" };
            format!("{} of {all} {verb}", thousands(wrong))
        }
        Verdict::Inconclusive => {
            format!("Nothing failed; {} of {all} could not be decided", thousands(unclear))
        }
        Verdict::Warn => format!("Nothing failed; {} of {all} follow another convention", thousands(unclear)),
        Verdict::Skipped => "Nothing was checked".into(),
        _ if s.waived > 0 => {
            format!("Nothing failed but {} that the suite waives", counted(s.waived, "result"))
        }
        _ => match subjects.len() {
            1 => "The subject passed every check".into(),
            n => format!("All {} subjects passed", thousands(n)),
        },
    }
}

/// Counts of verdicts that are not 0, failures always.
pub fn counts(report: &Report) -> Vec<(String, Verdict, &'static str)> {
    let s = &report.summary;
    [
        (s.failed, Verdict::Fail, "failed"),
        (s.errors, Verdict::Error, "errors"),
        (s.inconclusive, Verdict::Inconclusive, "inconclusive"),
        (s.warned, Verdict::Warn, "warned"),
        (s.waived, Verdict::Waived, "waived"),
        (s.passed, Verdict::Pass, "passed"),
        (s.skipped, Verdict::Skipped, "skipped"),
    ]
    .into_iter()
    .filter(|(n, verdict, _)| *n > 0 || *verdict == Verdict::Fail)
    .map(|(n, verdict, word)| (thousands(n), verdict, word))
    .collect()
}

/// What the run was, as names and values.
pub fn facts(report: &Report, subjects: &[Subject]) -> Vec<(&'static str, String)> {
    let cases = subjects.iter().map(|s| s.cases.len()).sum();
    let mut facts = vec![
        ("measured", format!("{} in {}", counted(subjects.len(), "subject"), counted(cases, "case"))),
        ("seed", report.seed.to_string()),
        (
            "false alarms",
            format!("a run of correct subjects fails with probability {:e}", report.false_alarm),
        ),
    ];
    if let Some(limits) = limits(report) {
        facts.push(("detection limits", format!("{limits} where statistical checks passed")));
    }
    let at = report.started.split('.').next().unwrap_or_default().trim_end_matches('Z').replacen('T', " ", 1);
    if !at.is_empty() {
        facts.push(("started", format!("{at} UTC")));
    }
    facts.push(("took", format!("{:.1} s", report.duration_s)));
    let machine = &report.machine;
    if machine.cores > 0 {
        let cores = counted(machine.cores, "processor");
        facts.push(("machine", format!("{} {}, {cores}", machine.os, machine.arch)));
    }
    facts.push(("gonio", report.gonio.clone()));
    facts
}

/// Smallest and largest detection limit where chance is involved; elsewhere a limit is
/// a share of places.
fn limits(report: &Report) -> Option<String> {
    let passed = report.results.iter().filter(|r| r.verdict == Verdict::Pass && r.log10_p.is_some());
    let mut limits: Vec<f64> = passed.filter_map(|r| r.detection_limit).map(|l| l.0).collect();
    limits.sort_by(f64::total_cmp);
    Some(range(*limits.first()?, *limits.last()?))
}

#[cfg(test)]
mod tests {
    use super::super::super::synthetic::report;
    use super::super::subject::subjects;
    use super::*;

    #[test]
    fn the_verdict_is_a_sentence() {
        let mut report = report();
        let say = |report: &Report| sentence(report, &subjects(report, &report.checks()));
        assert_eq!(say(&report), "1 of 3\u{a0}subjects failed");
        report.results.retain(|r| r.verdict != Verdict::Fail);
        report.summary.failed = 0;
        assert_eq!(say(&report), "Nothing failed; 1 of 2\u{a0}subjects could not be decided");
        report.results.retain(|r| r.verdict != Verdict::Inconclusive);
        report.summary.inconclusive = 0;
        assert_eq!(say(&report), "The subject passed every check");
        report.summary.passed = 0;
        assert_eq!(say(&report), "Nothing was checked");
    }

    #[test]
    fn numbers_are_grouped() {
        assert_eq!(["1", "999", "1\u{202f}000", "12\u{202f}345"], [1, 999, 1000, 12345].map(thousands)[..]);
    }
}
