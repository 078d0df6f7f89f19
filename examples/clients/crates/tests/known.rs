//! The verdicts that are known of the two crates, on a small part of the suite.
//! That this builds at all says that they still install.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Runs known.toml and returns its report.
fn report() -> Value {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO_BIN_EXE_gonio-clients-crates"))
        .args(["run", "--format", "json", "--plots", "none"])
        .arg(here.join("tests/known.toml"))
        .current_dir(env!("CARGO_TARGET_TMPDIR"))
        .output()
        .expect("the command runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "some checks fail, and nothing worse happens\n{told}");
    serde_json::from_slice(&output.stdout).expect("a report in JSON")
}

/// Subjects with their checks of one verdict.
fn with_verdict(report: &Value, verdict: &str) -> BTreeSet<String> {
    let results = report["results"].as_array().expect("results");
    let of = |r: &Value| format!("{} {}", r["subject"]["name"].as_str().unwrap(), r["check"].as_str().unwrap());
    results.iter().filter(|r| r["verdict"] == verdict).map(of).collect()
}

fn lines(text: &str) -> BTreeSet<String> {
    text.lines().map(|line| line.trim().to_string()).filter(|line| !line.is_empty()).collect()
}

#[test]
fn verdicts_are_the_known_ones() {
    let report = report();
    assert_eq!(with_verdict(&report, "fail"), lines(include_str!("known-failures.txt")));
    assert_eq!(with_verdict(&report, "error"), BTreeSet::new());
    let passed = report["summary"]["passed"].as_u64().unwrap();
    assert!(passed >= 100, "only {passed} checks passed");
}
