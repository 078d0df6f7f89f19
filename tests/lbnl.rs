//! Tables in WINDOW's XML against what Radiance reads from the same files, and
//! measured by every check. `tests/data/lbnl/make.py` makes the files and
//! `reference.json` with pyradiance; `compare.py` there compares with checkBSDF.

use gonio::bsdf::{ClaimsPatch, Direction, Subject, Transport};
use gonio::checks::Verdict;
use gonio::engine::{CaseResult, Options, run};
use gonio::evidence::Company;
use gonio::measured::lbnl::{Measured, Side, Table, read};
use gonio::suite::{Case, Plan, Settings};
use serde_json::Value;
use std::sync::Arc;
use std::time::Duration;

const FILES: [&str; 4] = ["blind_klems_quarter", "glass_klems_full", "panel_tree3", "blind_tree4"];

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/tests/data/lbnl/{name}.xml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn table(name: &str) -> Table {
    read(&bytes(name)).unwrap()
}

fn reference(name: &str, of: &str) -> Vec<Vec<f64>> {
    let path = format!("{}/tests/data/lbnl/reference.json", env!("CARGO_MANIFEST_DIR"));
    let all: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    serde_json::from_value(all[name][of].clone()).unwrap()
}

fn direction(theta_deg: f64, phi_deg: f64) -> Direction {
    Direction::from_angles(theta_deg.to_radians(), phi_deg.to_radians())
}

/// Radiance changes what it looks up by up to 3e-4, and makes floats of it.
fn is_near(own: f64, theirs: f64) -> bool {
    (own - theirs).abs() <= 1e-3 * theirs.abs() + 2e-6
}

#[test]
fn values_are_those_that_radiance_reads() {
    for name in FILES {
        let table = table(name);
        let (mut positive, mut most) = (0, 0.0f64);
        for row in reference(name, "values") {
            let (wo, wi) = (direction(row[0], row[1]), direction(row[2], row[3]));
            // Radiance looks for missing transmission of rank 3 and matrices backwards.
            let own = table.value(wo, wi);
            assert!(is_near(own, row[4]), "{name} {row:?}: {own}");
            positive += usize::from(own > 0.0);
            most = most.max(own);
        }
        assert!(positive > 20 || name == "glass_klems_full", "{name}: {positive} values say something");
    }
}

#[test]
fn fluxes_are_those_that_radiance_sums() {
    for name in FILES {
        let table = table(name);
        for row in reference(name, "fluxes") {
            let (reflected, transmitted) = table.flux_from(direction(row[0], row[1]));
            let near = is_near(reflected, row[2]) && is_near(transmitted, row[3]);
            assert!(near, "{name} {row:?}: {reflected} {transmitted}");
        }
    }
}

fn measure(
    subject: Arc<dyn Subject>,
    name: &str,
    angles: &[f64],
    phi_deg: f64,
    claims: ClaimsPatch,
) -> Vec<CaseResult<'static>> {
    let case = |theta: &f64| {
        Arc::new(Case {
            group: name.into(),
            spelling: name.into(),
            source: None,
            subject: subject.clone(),
            parameters: Default::default(),
            theta_deg: *theta,
            phi_deg,
            transport: Transport::Importance,
            claims: claims.clone(),
            waivers: Vec::new(),
            company: Company::default(),
            reference: None,
            checks: Vec::new(),
            settings: Settings {
                samples: 1 << 18,
                time_limit: Duration::from_secs(60),
                ..Settings::default()
            },
        })
    };
    let cases = angles.iter().map(case).collect();
    let plan = Plan { suite: "test".into(), seed: 1, false_alarm: 1e-6, share: None, cases };
    run(&plan, &Options::default(), &mut |_| {}).cases
}

/// Every check, at angles that lie on edges of patches (75° of Klems full, 30° of
/// rank 3) and elsewhere: nothing fails, nothing is undecided, and the integrals are
/// the tables' own sums to rounding.
#[test]
fn every_check_passes_and_integrals_are_exact() {
    for name in FILES {
        let subject = Arc::new(Measured::new(table(name)));
        let angles = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0, 91.0, 105.0, 150.0, 180.0];
        for result in measure(subject.clone(), name, &angles, 137.0, ClaimsPatch::default()) {
            let case = result.case.label();
            for f in &result.findings {
                let fine = matches!(f.outcome.verdict, Verdict::Pass | Verdict::Skipped);
                assert!(fine, "{case} {}: {}", f.check, f.outcome.message);
            }
            let evidence = result.evidence.unwrap();
            let integrals = evidence.integrals.unwrap();
            let (reflected, transmitted) = subject.table().flux_from(evidence.wo);
            let (albedo, error) = integrals.albedo(0);
            let exact = reflected + transmitted;
            assert!((albedo - exact).abs() <= 1e-9 * exact, "{case}: {albedo} {exact}");
            assert!((integrals.mass().0 - 1.0).abs() < 1e-9, "{case}: {:?}", integrals.mass());
            assert!(error < 1e-9, "{case}: {error}");
            assert!(integrals.evaluations < 100_000, "{case}: {}", integrals.evaluations);
        }
    }
}

/// A file that gives back more than it gets fails energy, and the message names the
/// patch and the largest of all.
#[test]
fn energy_is_judged_by_incident_patch() {
    let text = String::from_utf8(bytes("blind_klems_quarter")).unwrap();
    // The value of straight transmission from patch 2 of 41.
    let brighter = text.replacen(" 3.054 ", " 30.54 ", 1);
    assert_ne!(text, brighter);
    let table = read(brighter.as_bytes()).unwrap();
    let fluxes = table.incident_fluxes(Side::Back);
    let most = fluxes.iter().max_by(|a, b| a.total().total_cmp(&b.total())).unwrap();
    assert!(most.patch.starts_with("patch 2 of 41 of LBNL/Klems Quarter (θ 9° to 27°"), "{}", most.patch);
    let (theta, phi) = (most.wo.theta().to_degrees(), most.wo.phi().to_degrees());
    let subject = Arc::new(Measured::new(table));
    let energy = |theta, phi| {
        let mut results = measure(subject.clone(), "bright", &[theta], phi, ClaimsPatch::default());
        let mut findings = results.remove(0).findings;
        findings.retain(|f| f.check == "energy");
        findings.remove(0).outcome
    };
    let outcome = energy(theta, phi);
    assert_eq!(outcome.verdict, Verdict::Fail);
    let flux = most.total();
    assert!(flux > 1.5 && outcome.message.contains(&format!("flux {flux:.5}")), "{}", outcome.message);
    assert!(outcome.message.contains("back incident patch 2 of 41"), "{}", outcome.message);
    // Elsewhere it passes, and says where it would not.
    let outcome = energy(150.0, 100.0);
    assert_eq!(outcome.verdict, Verdict::Pass);
    let place = format!("the most flux, {flux:.5}, leaves of back patch 2 of 41");
    assert!(outcome.message.contains(&place), "{}", outcome.message);
}

/// A table that is not reciprocal does not claim to be, and fails where a suite
/// claims it; a reciprocal one claims it and passes.
#[test]
fn reciprocity_is_claimed_by_the_data() {
    let blind = Arc::new(Measured::new(table("blind_klems_quarter")));
    assert!(!blind.describe().claims.reciprocal);
    let claims = ClaimsPatch { reciprocal: Some(true), ..Default::default() };
    let results = measure(blind, "blind", &[60.0], 137.0, claims);
    let found = results[0].findings.iter().find(|f| f.check == "reciprocity").unwrap();
    assert_eq!(found.outcome.verdict, Verdict::Fail, "{}", found.outcome.message);
    // Light backwards through glass is light forwards.
    let glass = Arc::new(Measured::new(table("glass_klems_full")));
    assert!(glass.describe().claims.reciprocal);
    assert!(!glass.table().notes.is_empty());
}

/// Transmission that is missing is the other one with light going backwards, of rank 4
/// as of matrices; a table of that and of symmetric reflection claims reciprocity,
/// and the check agrees.
#[test]
fn missing_transmission_is_had_backwards() {
    let text = String::from_utf8(bytes("blind_tree4")).unwrap();
    let block = text.find("Transmission Back").unwrap();
    let (from, to) = (
        text[..block].rfind("<WavelengthData>").unwrap(),
        block + text[block..].find("</WavelengthData>").unwrap(),
    );
    let one_way = format!("{}{}", &text[..from], &text[to + "</WavelengthData>".len()..]);
    let (whole, half) = (table("blind_tree4"), read(one_way.as_bytes()).unwrap());
    assert!(half.notes[0].contains("Transmission Back is missing"), "{:?}", half.notes);
    for row in reference("blind_tree4", "values") {
        let (wo, wi) = (direction(row[0], row[1]), direction(row[2], row[3]));
        if wo.z > 0.0 && wi.z < 0.0 {
            assert_eq!(half.value(wo, wi), whole.value(wi, wo));
        }
    }
    let subject = Arc::new(Measured::new(half));
    assert!(subject.describe().claims.reciprocal);
    // Angles on edges of its cells, on their axes, and on the corner at the normal.
    let mut results =
        measure(subject.clone(), "one way", &[0.0, 30.0, 75.0, 105.0], 137.0, ClaimsPatch::default());
    results.extend(measure(subject, "one way", &[30.0, 150.0], 0.0, ClaimsPatch::default()));
    for result in results {
        for f in &result.findings {
            let fine = matches!(f.outcome.verdict, Verdict::Pass | Verdict::Skipped);
            assert!(fine, "{} {}: {}", result.case.label(), f.check, f.outcome.message);
            assert!(f.check != "reciprocity" || f.outcome.verdict == Verdict::Pass);
        }
    }
}
