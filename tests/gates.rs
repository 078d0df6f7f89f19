//! What a gate needs: baselines, waivers, budgets of time, and runs of what changed.

mod common;

use common::desk::{Desk, Done};
use common::tools::tools;
use serde_json::Value;
use std::process::Command;

/// Compiles tests/data/plugins/changing.c into a desk, before or after its fix.
fn compile(desk: &Desk, fixed: bool) {
    tools();
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/plugins/changing.c");
    let include = concat!("-I", env!("CARGO_MANIFEST_DIR"), "/include");
    let mut compiler = Command::new("cc");
    compiler.args(["-O2", "-shared", "-fPIC", include, source, "-lm", "-o"]).arg(desk.path("changing.so"));
    if fixed {
        compiler.arg("-DFIXED");
    }
    assert!(compiler.status().unwrap().success());
}

const CHANGING: &str = "[suite]\nname = 'changing'\ntheta = [30, 60]\nphi = 17\nsamples = 65_536\ndetect = 0.1\n\
    [[subject]]\nlibrary = './changing.so'\npart = ['left', 'right', 'third', 'sound']\n\
    [[subject]]\nuse = 'lambert'\n";

fn kinds(list: &Value) -> Vec<(String, String, String)> {
    let text = |v: &Value| v.as_str().unwrap().to_string();
    let all = list.as_array().unwrap().iter();
    all.map(|c| (text(&c["subject"]), text(&c["check"]), text(&c["what"]["kind"]))).collect()
}

fn expected(rows: &[(&str, &str, &str)]) -> Vec<(String, String, String)> {
    rows.iter()
        .map(|(part, check, kind)| (format!("./changing.so:part={part}"), (*check).into(), (*kind).into()))
        .collect()
}

/// A fix that turned two failures into passes and cost one subject a fifth of its
/// efficiency shows just that.
#[test]
fn a_comparison_shows_what_a_fix_did_and_nothing_else() {
    let desk = Desk::new();
    desk.write("changing.toml", CHANGING);
    compile(&desk, false);
    desk.gonio("run changing.toml -o before").ends(1);
    compile(&desk, true);
    let after = desk.gonio("run changing.toml -o after --baseline before/report.json");
    after.ends(1).says("1 worse, 2 better, 0 less sure").says("80.00 % of the draws count (−20 %)");
    let comparison = &desk.report("after")["comparison"];
    assert_eq!(kinds(&comparison["worse"]), expected(&[("third", "efficiency", "efficiency")]));
    let better = [("left", "energy", "verdict"), ("right", "reciprocity", "verdict")];
    assert_eq!(kinds(&comparison["better"]), expected(&better));
    assert_eq!(comparison["less_sure"].as_array().unwrap().len(), 0);
    assert_eq!(
        (&comparison["added"], &comparison["removed"]),
        (&Value::from(Vec::<u8>::new()), &Value::from(Vec::<u8>::new()))
    );

    // The same by itself, and the other way round.
    desk.gonio("diff before after").ends(1).says("1 worse, 2 better");
    let back = desk.gonio("diff after before --format json");
    back.ends(1);
    let back: Value = serde_json::from_str(&back.out).unwrap();
    assert_eq!(kinds(&back["worse"]), expected(&better));
    assert_eq!(kinds(&back["better"]), expected(&[("third", "efficiency", "efficiency")]));
    // Nothing new against itself, though it fails: known failures do not fail a gate.
    compile(&desk, false);
    desk.gonio("run changing.toml -o again --baseline before")
        .ends(0)
        .says("0 worse, 0 better")
        .says("4 that fail in both");
}

#[test]
fn a_first_run_without_its_baseline_is_explained() {
    let desk = Desk::new();
    desk.write(
        "s.toml",
        "[suite]\ntheta = 30\nphi = 17\nsamples = 16_384\ndetect = 0.1\n[[subject]]\nuse = 'lambert'\n",
    );
    desk.gonio("run s.toml -o out --baseline main/report.json")
        .ends(0)
        .says("no report at main/report.json yet");
    assert!(desk.report("out").get("comparison").is_none());
    // What is there and is no report is a mistake.
    desk.write("bad.json", "{}").gonio("run s.toml -o out --baseline bad.json").ends(2).says("not a report");
}

fn waived(day: &str, most: &str) -> String {
    format!(
        "[suite]\ntheta = 60\nphi = 17\nsamples = 16_384\ndetect = 0.1\nchecks = ['energy', 'reciprocity']\n\
         [[subject]]\nlibrary = './changing.so'\npart = ['left', 'sound']\n\
         waive = [{{ check = 'energy', because = 'known', subject = './changing.so:part=left'{day}{most} }}]\n"
    )
}

#[test]
fn a_waiver_covers_what_it_names_and_no_more() {
    let desk = Desk::new();
    compile(&desk, false);
    let run = |suite: String| -> (Done, String) {
        desk.write("s.toml", &suite);
        let done = desk.gonio("run s.toml -o out");
        let state = desk.report("out")["waivers"][0]["state"].as_str().unwrap().to_string();
        (done, state)
    };
    let (done, state) = run(waived("", ""));
    assert_eq!(state, "used", "{}", done.ends(0).err);
    let (done, state) = run(waived(", until = 2099-12-31", ", at_most = 0.2"));
    assert_eq!(state, "used", "{}", done.ends(0).err);
    let (done, state) = run(waived(", until = 2026-01-01", ""));
    assert_eq!(state, "expired", "{}", done.ends(1).says("it held until 2026-01-01").err);
    // A tenth more leaves than arrives.
    let (done, state) = run(waived("", ", at_most = 0.05"));
    assert_eq!(state, "exceeded", "{}", done.ends(1).says("larger than 5.00 %").err);
    let (done, state) = run(waived("", "").replace("part=left'", "part=right'"));
    assert_eq!(state, "unused", "{}", done.ends(1).says("delete it").err);
    // Of a check that is not run nothing can be said; of a subject that is not there it can.
    desk.write("s.toml", &waived("", "")).gonio("run s.toml -o out --check reciprocity").ends(0);
    assert!(desk.report("out").get("waivers").is_none());
    let (_, state) = run(waived("", "").replace("part=left'", "part=lefft'"));
    assert_eq!(state, "unused");
    desk.write("s.toml", &waived(", until = '31.12.2099'", ""))
        .gonio("run s.toml")
        .ends(2)
        .says("write until = 2027-01-31");
    desk.write("s.toml", &waived(", til = 3", "")).gonio("run s.toml").ends(2).says("until");
}

const BUDGETED: &str = "[suite]\nname = 'budgeted'\ntheta = [0, 30, 60]\nphi = [17, 137]\n\
    [[subject]]\nuse = 'lambert'\nreflectance = [0.2, 0.8]\n[[subject]]\nuse = 'torrance-sparrow'\nalpha = [0.1, 0.5]\n";

/// The allocation is all that a run with a budget has of the clock.
#[test]
fn a_budget_of_time_is_spent_and_can_be_followed_bit_for_bit() {
    let desk = Desk::new();
    desk.write("s.toml", BUDGETED);
    desk.gonio("run s.toml -o timed --time 6s")
        .ends(0)
        .says("a budget of 6 s gave")
        .says("had detection limits of");
    let timed = desk.report("timed");
    let samples: Vec<u64> =
        timed["allocation"]["samples"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    assert_eq!(samples.len(), 24);
    assert!(samples.iter().all(|n| n % 4096 == 0), "{samples:?}");
    // Other tests take their part of the machine; a unit test holds the plan to its budget.
    let taken = timed["duration_s"].as_f64().unwrap();
    assert!(taken > 2.0 && samples.iter().any(|n| *n > 1 << 16), "{taken} s: {samples:?}");
    desk.gonio("run s.toml -o again --allocation timed --threads 1").ends(0);
    let again = desk.report("again");
    assert_eq!(again["results"], timed["results"]);
    assert_eq!(again["allocation"]["samples"], timed["allocation"]["samples"]);
    // Its commands reproduce a case with the same draws.
    let first = |r: &&Value| r["check"] == "goodness-of-fit" && r["verdict"] != "skipped";
    let row = timed["results"].as_array().unwrap().iter().find(first).unwrap();
    let drawn = samples.iter().find(|n| **n > 0).unwrap();
    assert!(row["command"].as_str().unwrap().contains(&format!("--samples {drawn}")), "{row}");
    desk.gonio("run quick -o other --allocation timed").ends(2).says("run the same suite");
    desk.gonio("run s.toml -o other --time soon").ends(2).says("30s or 5m");
}

/// Too little time is no pass: what was not begun is skipped, in sight.
#[test]
fn what_time_does_not_reach_is_told() {
    let desk = Desk::new();
    desk.write("s.toml", BUDGETED);
    let run = desk.gonio("run s.toml -o short --time 0.05 --threads 1");
    run.says("NOT COMPLETE: time was up");
    let report = desk.report("short");
    let samples = report["allocation"]["samples"].as_array().unwrap();
    let begun = samples.iter().filter(|n| **n != 0).count();
    assert!(begun < 24, "{samples:?}");
    let rows = report["results"].as_array().unwrap();
    let late = rows.iter().filter(|r| r["message"] == "time was up before this case");
    let cases: std::collections::BTreeSet<String> =
        late.map(|r| format!("{} {}", r["subject"]["name"], r["wo"])).collect();
    assert_eq!(cases.len(), 24 - begun);
    desk.gonio("run s.toml -o short --time 0.05 --threads 1 --strict").ends(1);
}

#[test]
fn only_what_changed_is_measured_again() {
    let desk = Desk::new();
    desk.write("changing.toml", CHANGING);
    compile(&desk, false);
    desk.gonio("run changing.toml -o main").ends(1);
    let before = desk.report("main");
    // Nothing changed: nothing is measured, and what failed still fails.
    let same = desk.gonio("run changing.toml -o same --changed-since main");
    same.ends(1).says("5 of 5 subjects are what they were");
    let report = desk.report("same");
    let plain = |mut report: Value| {
        for row in report["results"].as_array_mut().unwrap() {
            row["plot"].take();
        }
        report["results"].take()
    };
    assert_eq!(plain(report.clone()), plain(before.clone()));
    assert_eq!(report["diagnoses"], before["diagnoses"]);
    assert_eq!(desk.files("same/evidence"), desk.files("main/evidence"));

    // Evidence that cannot be drawn again is an error, and loses nothing.
    let damaged = desk.path("same/evidence/case-0000.json.gz");
    std::fs::write(&damaged, "not gzip").unwrap();
    desk.gonio("run changing.toml -o kept --changed-since same").ends(5).says("case-0000");
    assert_eq!(plain(desk.report("kept")), plain(before.clone()));

    // The plugin changed: its subjects are measured, the built-in one is not.
    compile(&desk, true);
    let next = desk.gonio("run changing.toml -o main --changed-since main");
    next.ends(0).says("1 of 5 subjects are what they were");
    let carried: Vec<bool> = desk.report("main")["subjects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|s| s.get("carried").is_some())
        .collect();
    assert_eq!(carried, [false, false, false, false, true]);
    // How it is measured is a part of what it depends on.
    let sharper = desk.gonio("run changing.toml -o main --changed-since main --samples 2^15");
    assert!(!sharper.ends(0).err.contains("are what they were"));
    desk.gonio("run changing.toml -o new --changed-since nowhere").ends(0).says("everything is measured");
}
