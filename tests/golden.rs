//! What the code produces is what was committed: `reports/seed/report.json`.

use assert_cmd::Command;
use serde_json::{Map, Value};
use std::path::Path;

/// What regenerates the committed report.
const REGENERATE: &str = "cargo run --release -- run -o reports/seed";

/// Relative difference that other processors and maths libraries may make.
const TOLERANCE: f64 = 1e-9;

/// Fields that differ from run to run.
const TIMES: [&str; 3] = ["started", "duration_s", "machine"];

/// The first difference, by its path. Integers, strings and the rest must be
/// equal, floats nearly.
fn difference(path: &str, old: &Value, new: &Value) -> Option<String> {
    let told = || Some(format!("{path} was {} and is {}", short(old), short(new)));
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => object_difference(path, a, b),
        (Value::Array(a), Value::Array(b)) => {
            let pairs = a.iter().zip(b).enumerate();
            let inner = |(k, (a, b))| difference(&format!("{path}[{k}]"), a, b);
            let length = || {
                (a.len() != b.len()).then(|| format!("{path} had {} entries and has {}", a.len(), b.len()))
            };
            // The first that differs tells more than their number.
            pairs.map(inner).find_map(|d| d).or_else(length)
        }
        (Value::Number(a), Value::Number(b)) if a.is_f64() && b.is_f64() => {
            let (x, y) = (a.as_f64()?, b.as_f64()?);
            if (x - y).abs() <= TOLERANCE * x.abs().max(y.abs()) { None } else { told() }
        }
        _ if old == new => None,
        _ => told(),
    }
}

fn object_difference(path: &str, old: &Map<String, Value>, new: &Map<String, Value>) -> Option<String> {
    let at = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    for (key, value) in old {
        let Some(other) = new.get(key) else { return Some(format!("{} is gone", at(key))) };
        if let Some(found) = difference(&at(key), value, other) {
            return Some(found);
        }
    }
    new.keys().find(|key| !old.contains_key(*key)).map(|key| format!("{} is new", at(key)))
}

fn short(value: &Value) -> String {
    let text = value.to_string();
    if text.chars().count() > 200 { text.chars().take(200).chain(['…']).collect() } else { text }
}

/// A report without times and the digest of the program, and which result a path such as `results[3]` means.
fn timeless(text: &str) -> Value {
    let mut report: Value = serde_json::from_str(text).expect("a report is JSON");
    for field in TIMES {
        let taken = report.as_object_mut().expect("a report is an object").remove(field);
        assert!(taken.is_some(), "no `{field}`: not a report");
    }
    for subject in report["subjects"].as_array_mut().expect("subjects") {
        assert!(subject.as_object_mut().expect("a subject").remove("digest").is_some());
    }
    report
}

/// In words, what a path in `results` is about.
fn about(path: &str, report: &Value) -> String {
    let index = path.strip_prefix("results[").and_then(|p| p.split(']').next()?.parse::<usize>().ok());
    let Some(row) = index.and_then(|k| report["results"].get(k)) else { return String::new() };
    let wo = &row["wo"];
    format!(
        " ({} of {} at θ = {}°, φ = {}°)",
        row["check"].as_str().unwrap_or("?"),
        row["subject"]["name"].as_str().unwrap_or("?"),
        wo["theta_deg"],
        wo["phi_deg"]
    )
}

#[test]
fn the_seed_suite_gives_what_was_committed() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/seed/report.json");
    let committed = std::fs::read_to_string(&file)
        .unwrap_or_else(|e| panic!("{}: {e}; make it with: {REGENERATE}", file.display()));
    let committed = timeless(&committed);
    let folder = tempfile::tempdir().unwrap();
    // Through the binary, as it was made; pictures are named in the report.
    let run = Command::new(env!("CARGO_BIN_EXE_gonio"))
        .current_dir(folder.path())
        .args(["run", "-o", "seed", "--quiet"])
        .output()
        .unwrap();
    let written = std::fs::read_to_string(folder.path().join("seed/report.json"));
    let written = written.unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&run.stderr)));
    let produced = timeless(&written);
    if let Some(found) = difference("", &committed, &produced) {
        let path = found.split(' ').next().unwrap_or_default();
        panic!(
            "reports/seed/report.json is not what the code produces: {found}{}\n\
             If that is meant, make it again and look at the difference: {REGENERATE}",
            about(path, &committed)
        );
    }
}

#[test]
fn the_comparison_sees_every_kind_of_difference_and_names_its_place() {
    let old = serde_json::json!({
        "summary": { "passed": 3 },
        "results": [{ "verdict": "pass", "p": 0.25, "samples": 4096, "log10_p": "-Infinity", "worst": null }]
    });
    let with = |change: &dyn Fn(&mut Value)| {
        let mut new = old.clone();
        change(&mut new);
        difference("", &old, &new).unwrap_or_default()
    };
    assert_eq!(with(&|_| ()), "");
    assert_eq!(with(&|v| v["results"][0]["p"] = (0.25 * (1.0 + 5e-10)).into()), "");
    type Change<'a> = &'a dyn Fn(&mut Value);
    let cases: [(Change, &str); 8] = [
        (&|v| v["results"][0]["p"] = 0.250_000_001.into(), "results[0].p was 0.25 and is 0.250000001"),
        (&|v| v["results"][0]["p"] = (-0.25).into(), "results[0].p was 0.25 and is -0.25"),
        (&|v| v["summary"]["passed"] = 4.into(), "summary.passed was 3 and is 4"),
        (&|v| v["results"][0]["verdict"] = "fail".into(), "results[0].verdict was \"pass\" and is \"fail\""),
        (&|v| v["results"][0]["log10_p"] = (-4.0).into(), "results[0].log10_p was \"-Infinity\" and is -4.0"),
        (&|v| v["results"][0]["worst"] = 1.into(), "results[0].worst was null and is 1"),
        (&|v| v["results"].as_array_mut().unwrap().clear(), "results had 1 entries and has 0"),
        (&|v| v["partial"] = "time was up".into(), "partial is new"),
    ];
    for (change, message) in cases {
        assert_eq!(with(change), message);
    }
    let gone = with(&|v| {
        v.as_object_mut().unwrap().remove("summary");
    });
    assert_eq!(gone, "summary is gone");
}
