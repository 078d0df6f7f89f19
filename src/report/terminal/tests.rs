//! Pages of a synthetic report.

use super::super::json::{
    AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectId, Summary, WoAngles,
};
use super::blocks::BLOCKS;
use super::*;
use crate::bsdf::{Claims, Direction};
use crate::checks::{self, Effect, Verdict};
use crate::evidence::{Evaluations, Figure, Place};
use crate::registry::Parameters;

fn result(name: &str, check: &str, theta_deg: f64, verdict: Verdict) -> CheckResult {
    CheckResult {
        subject: SubjectId {
            name: name.into(),
            label: None,
            parameters: Parameters::default(),
            claims: Claims::default(),
        },
        check: check.into(),
        wo: Some(WoAngles { theta_deg, phi_deg: 17.0 }),
        transport: Default::default(),
        verdict,
        effect: None,
        p_value: None,
        log10_p: None,
        threshold: None,
        attempts: Vec::new(),
        channel: None,
        samples: 262_144,
        evaluations: Evaluations::default(),
        detection_limit: None,
        message: "all is well".into(),
        reason: None,
        worst: None,
        command: format!("gonio check {name} --theta {theta_deg} --phi 17 --seed 1"),
        evidence: None,
        plot: None,
        waived_because: None,
    }
}

/// A report with one of everything.
pub fn report() -> Report {
    let attempt = |seed: &str, log10_p: f64| AttemptRow {
        seed: seed.into(),
        samples: 1 << 18,
        log10_p: log10_p.into(),
    };
    let wo = Direction::from_angles(1.0, 0.3);
    let wi = Direction::from_angles(0.5, 3.4);
    let fit = |theta, value: f64| CheckResult {
        effect: Some(Effect::interval("√D", (value, value - 0.001, value + 0.0011), 0.003)),
        log10_p: Some(Figure(-60.5)),
        p_value: Some(Figure(0.0)),
        threshold: Some(Figure(1e-5)),
        attempts: vec![attempt("1", -34.2), attempt("1/confirmation", -60.5)],
        message: "samples are off pdf by 1.20 % RMS on 64 cells; shape passes: a factor of wo alone"
            .into(),
        worst: Some(Place::pair(wo, wi).value("σ", 12.31)),
        ..result("ggx:alpha=0.5", "goodness-of-fit", theta, Verdict::Fail)
    };
    let passed = |theta, limit: f64| CheckResult {
        log10_p: Some(Figure(-0.2)),
        detection_limit: Some(Figure(limit)),
        ..result("lambert", "goodness-of-fit", theta, Verdict::Pass)
    };
    let unsure = CheckResult {
        reason: Some("would only have seen an error of 5 %".into()),
        message: "found 0.5 ± 0.1, cubature 0.55".into(),
        ..result("ggx:alpha=0.01", "albedo", 85.0, Verdict::Inconclusive)
    };
    Report {
        schema_version: SCHEMA_VERSION,
        gonio: "0.1.0".into(),
        suite: "default".into(),
        seed: 1,
        false_alarm: 0.01,
        started: "2026-01-01T00:00:00Z".into(),
        duration_s: 12.34,
        machine: Machine { os: "linux".into(), arch: "x86_64".into(), cores: 2 },
        partial: None,
        summary: Summary { passed: 2, failed: 2, inconclusive: 1, skipped: 1, ..Summary::default() },
        results: vec![
            passed(0.0, 0.0031),
            passed(60.0, 0.028),
            fit(30.0, 0.008),
            fit(60.0, 0.012),
            unsure,
            result("lambert", "white-furnace", 0.0, Verdict::Skipped),
        ],
        subjects: Vec::new(),
        waivers: Vec::new(),
        allocation: None,
        comparison: None,
        diagnoses: vec![Diagnosis {
            profile: None,
            subject: "ggx:alpha=0.5".into(),
            cause: Some("half-vector-jacobian".into()),
            confident: true,
            statement: "pdf() lacks the factor 1/(4 wo·h)".into(),
            repair: Some("divide by 4 wo·h".into()),
            p_after_repair: Some(Figure(0.43)),
            runner_up: Some("pdf() is 4 times too large [constant-factor], 812.0 nats behind".into()),
            evidence: vec!["this fits 12 cells of 64".into()],
            textbook: Some("torrance-sparrow".into()),
            plot: None,
            page: Some("docs/causes/half-vector-jacobian.md".into()),
        }],
    }
}

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
