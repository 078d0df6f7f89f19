//! Pages of a synthetic report.

use super::super::json::{Allocation, Diagnosis, Report, Summary, WaiverRow, WaiverState};
use super::super::synthetic::{report, result};
use super::blocks::BLOCKS;
use super::*;
use crate::checks::{self, Verdict};
use crate::evidence::Figure;

const EXPECTED: &str = include_str!("expected.txt");

#[test]
fn reads_as_expected() {
    let files = [("report", "reports/default/report.json"), ("html", "reports/default/index.html")];
    let text = summary(&report(), &files, Look { width: 90, colour: false, lines: None });
    assert_eq!(text, EXPECTED, "\n{text}");
}

#[test]
fn colour_adds_nothing_but_colour() {
    let look = Look { width: 90, colour: true, lines: None };
    let text = summary(&report(), &[], look);
    let mut plain = String::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find('\u{1b}') {
        plain.push_str(&rest[..start]);
        let end = start + rest[start..].find('m').unwrap();
        rest = &rest[end + 1..];
    }
    plain.push_str(rest);
    assert_eq!(plain, summary(&report(), &[], Look { colour: false, ..look }));
}

#[test]
fn fifty_failures_stay_readable_and_in_width() {
    let mut report = report();
    for k in 0..50 {
        let name = format!("model-{k}:alpha=0.5");
        for check in checks::all() {
            report.results.push(result(&name, check.id(), 30.0, Verdict::Fail));
        }
    }
    for width in [80, 100, 120] {
        let text = summary(&report, &[], Look { width, colour: false, lines: None });
        let longest = text.lines().filter(|l| !l.contains("$ ")).map(|l| l.chars().count()).max();
        assert!(longest.unwrap() <= width, "{longest:?} of {width}");
        assert_eq!(text.lines().filter(|l| l.contains("$ ")).count(), BLOCKS);
        assert!(text.contains("and more: ") && text.contains("(fail)"));
    }
}

#[test]
fn a_doubtful_cause_has_no_next_and_none_has_no_slug() {
    let found = report().diagnoses.remove(0);
    let doubtful = Diagnosis { confident: false, p_after_repair: Some(Figure(0.0)), ..found };
    let text = doubtful.to_string();
    assert!(text.contains("p = 0: something else may be wrong too") && !text.contains("next"), "{text}");
    let none = Diagnosis {
        cause: None,
        repair: None,
        p_after_repair: None,
        runner_up: None,
        evidence: Vec::new(),
        textbook: None,
        plot: None,
        page: None,
        statement: "none of the explanations fits: energy fails".into(),
        ..doubtful
    };
    assert_eq!(none.to_string(), "    cause: none of the explanations fits: energy fails");
}

#[test]
fn subjects_beyond_the_blocks_have_a_line_each() {
    let mut report = report();
    let found = report.diagnoses[0].clone();
    for k in 0..20 {
        let name = format!("model-{k}");
        report.results.push(result(&name, "energy", 30.0, Verdict::Fail));
        report.diagnoses.push(Diagnosis { subject: name, ..found.clone() });
    }
    let text = summary(&report, &[], Look { width: 90, colour: false, lines: None });
    assert!(text.contains("\nmodel-18: pdf() lacks the factor 1/(4 wo·h) [half-vector-jacobian]\n"));
    assert_eq!(text.matches("half-vector-jacobian]").count(), 2 * BLOCKS);
    let all = diagnoses(&report, Look { width: 90, colour: false, lines: None });
    assert_eq!(all.matches("half-vector-jacobian]").count(), 21);
}

#[test]
fn an_empty_report_says_so() {
    let empty = Report { results: Vec::new(), summary: Summary::default(), ..report() };
    let text = summary(&empty, &[], Look { width: 80, colour: false, lines: None });
    assert!(text.starts_with("nothing was checked\n") && text.contains("0 cases"));
}

#[test]
fn a_screen_shows_what_is_wrong_and_leaves_out_the_rest() {
    let mut report = report();
    for k in 0..60 {
        report.results.push(result(&format!("fine-{k}"), "energy", 30.0, Verdict::Pass));
    }
    let look = Look { width: 100, colour: false, lines: Some(50) };
    let text = summary(&report, &[], look);
    assert!(text.lines().count() <= 50, "{text}");
    assert!(!text.contains("fine-7") && text.contains("61 more rows without a finding"), "{text}");
    assert!(text.contains("skipped everywhere: white-furnace"), "{text}");
    assert!(text.contains("cause: pdf() lacks the factor 1/(4 wo·h) [half-vector-jacobian]"), "{text}");
    for k in 0..60 {
        report.results.push(result(&format!("broken-{k}"), "energy", 30.0, Verdict::Fail));
    }
    let text = summary(&report, &[], look);
    // The matrix must name what fails, however many there are.
    assert!(text.contains("broken-59") && text.contains("more subjects; -v tells all"), "{text}");
}

#[test]
fn waivers_and_budgets_are_told() {
    let waiver = |state| WaiverRow {
        check: "energy".into(),
        subject: "coat".into(),
        because: "a trade".into(),
        until: Some("2026-01-31".into()),
        at_most: Some(0.05),
        state,
        covered: 0,
    };
    use WaiverState::{Exceeded, Expired, Unused, Used};
    let waivers = [Used, Unused, Expired, Exceeded].map(waiver).to_vec();
    let allocation = Some(Allocation { time_s: Some(30.0), samples: vec![1 << 16, 0, 1 << 20] });
    let text = summary(
        &Report { waivers, allocation, ..report() },
        &[],
        Look { width: 120, colour: false, lines: None },
    );
    for part in [
        "unused waiver of energy for coat (a trade): nothing failed that it covers; delete it",
        "expired waiver of energy for coat (a trade): it held until 2026-01-31; failures count again",
        "exceeded waiver of energy for coat (a trade): a failure is larger than 5.00 %",
        "a budget of 30 s gave 65536 to 1048576 draws at most to each of 2 cases; 1 were not begun",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
    assert_eq!(text.matches("waiver of").count(), 3);
}

#[test]
fn what_a_subject_says_is_shown_and_not_obeyed() {
    let mut report = report();
    report.results[4].reason = Some("it said\n::error::all is lost\n\u{1b}[2J".into());
    let text = summary(&report, &[], Look { width: 100, colour: false, lines: None });
    assert!(text.contains("    | ::error::all is lost\n") && !text.contains('\u{1b}'), "{text}");
}
