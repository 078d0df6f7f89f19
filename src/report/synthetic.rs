//! A report made up for tests.

use super::json::{
    AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectId, Summary, WoAngles,
};
use crate::bsdf::{Claims, Direction};
use crate::checks::{Effect, Verdict};
use crate::evidence::{Evaluations, Figure, Place};
use crate::registry::Parameters;

/// A result of a check at φ = 17° with these.
pub fn result(name: &str, check: &str, theta_deg: f64, verdict: Verdict) -> CheckResult {
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
/// A small report with one of each that matters.
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
        message: "samples are off pdf by 1.20 % RMS on 64 cells; shape passes: a factor of wo alone".into(),
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
