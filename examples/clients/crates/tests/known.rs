//! The verdicts that are known of the two crates, on a small part of the suite.
//! That this builds at all says that they still install.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Runs known.toml and returns its report.
fn report() -> Value {
    let suite = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/known.toml");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("known");
    let output = Command::new(env!("CARGO_BIN_EXE_gonio-clients-crates"))
        .args(["run", "--format", "json", "--plots", "none", "--out"])
        .args([&folder, &suite])
        .output()
        .expect("the command runs");
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "some subjects panic, and nothing worse happens\n{told}");
    serde_json::from_slice(&output.stdout).expect("a report in JSON")
}

/// What neither passed nor was skipped, as `verdict subject check`.
fn outcomes(report: &Value) -> BTreeSet<String> {
    let results = report["results"].as_array().expect("results");
    let word = |value: &Value| value.as_str().expect("a word").to_string();
    let line = |r: &Value| [&r["verdict"], &r["subject"]["name"], &r["check"]].map(word).join(" ");
    results.iter().filter(|r| r["verdict"] != "pass" && r["verdict"] != "skipped").map(line).collect()
}

#[test]
fn verdicts_are_the_known_ones() {
    let report = report();
    let found = outcomes(&report);
    let known: BTreeSet<_> = include_str!("known.txt").lines().map(String::from).collect();
    let news: Vec<_> = found.difference(&known).collect();
    let gone: Vec<_> = known.difference(&found).collect();
    assert!(news.is_empty() && gone.is_empty(), "new: {news:#?}\nno longer: {gone:#?}");
    assert!(report["summary"]["passed"].as_u64() > Some(200), "{}", report["summary"]);
}
