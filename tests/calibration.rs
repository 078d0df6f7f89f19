//! The instrument's measurement of itself: what it counts, and that it goes on where it
//! was interrupted.

mod common;

use assert_cmd::cargo::cargo_bin;
use common::measuring::case;
use common::{Bug, Ggx};
use gonio::calibration::{Effort, Event, FalseAlarms, Identity, Part, Progress, Scope, Unfinished, Work};
use gonio::checks::Verdict;
use gonio::engine::Finding;
use gonio::registry::Registry;
use gonio::suite::Case;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

const PROGRESS: &str = "progress.jsonl";

fn built_in(spelling: &str, theta: f64) -> Arc<Case<'static>> {
    let subject = Registry::builtin().resolve(&spelling.parse().unwrap()).unwrap().subject;
    Arc::new(case(spelling, subject, theta, 1 << 14))
}

fn correct() -> Vec<Arc<Case<'static>>> {
    vec![
        built_in("lambert", 30.0),
        built_in("torrance-sparrow:alpha=0.3", 60.0),
        built_in("dielectric", 45.0),
        built_in("rough-plastic", 30.0),
    ]
}

fn scope(cases: Vec<Arc<Case<'static>>>, seeds: u64, raised: f64, default: f64) -> Scope {
    Scope { suite: "test".into(), cases, seeds, raised, default }
}

/// Measures in a folder, on so many threads, telling of each step.
fn measure(
    folder: &Path,
    scope: &Scope,
    threads: usize,
    stop: Arc<AtomicBool>,
    observe: &(dyn Fn(Event) + Sync),
) -> Result<FalseAlarms, Unfinished> {
    let progress = Progress::open(folder, &Identity::new("test"), stop)?;
    let work = Work::new(Effort::Quick, 1, Some(threads), &progress, observe).unwrap();
    FalseAlarms::measure(scope, &work)
}

fn measured(scope: &Scope) -> FalseAlarms {
    let folder = tempfile::tempdir().unwrap();
    measure(folder.path(), scope, 2, Arc::default(), &|_| {}).unwrap()
}

/// Every byte that is written of a result, but for times.
fn bytes(alarms: &FalseAlarms) -> String {
    let mut all = serde_json::to_string_pretty(alarms).unwrap() + &alarms.markdown();
    all.extend(alarms.pictures().into_iter().map(|p| p.path + &p.svg));
    all
}

fn is_fail(finding: &Finding) -> bool {
    finding.outcome.verdict == Verdict::Fail
}

fn is_suspected(finding: &Finding) -> bool {
    finding.attempts.len() > 1 || is_fail(finding)
}

// -------------------------------------------------------------- what is counted

#[test]
fn correct_subjects_have_no_false_alarm_and_their_p_values_are_uniform() {
    let found = measured(&scope(correct(), 6, 1e-2, 1e-6));
    assert_eq!(found.errors(), [""; 0]);
    assert_eq!((found.in_all.runs, found.left_out, found.alarms.len()), (24, 0, 0));
    assert!(found.p_values.count > 100, "{:?}", found.p_values);
    // Two of each run with a continuous lobe.
    assert_eq!(found.density_p_values.count, 2 * 18);
    // The dielectric has discrete lobes alone, and lambert none.
    let runs: BTreeMap<&str, u64> = found.checks.iter().map(|c| (c.check.as_str(), c.runs)).collect();
    assert_eq!((runs["sanity"], runs["discrete-lobes"], runs["goodness-of-fit"]), (24, 6, 18));
    let tests = |check: &str| found.checks.iter().find(|c| c.check == check).unwrap().tests;
    assert_eq!((tests("sanity"), tests("goodness-of-fit")), (0, 18));
}

#[test]
fn a_planted_false_alarm_is_counted_as_what_it_is() {
    let planted = Arc::new(case("planted", Arc::new(Ggx::new(0.3, Bug::PdfFactor(1.05))), 30.0, 1 << 14));
    let mut cases = correct();
    cases.insert(1, planted);
    let found = measured(&scope(cases, 3, 1e-2, 1e-6));
    let fails = |check: &str| found.checks.iter().find(|c| c.check == check).unwrap().fails.count;
    assert_eq!((fails("normalization"), fails("goodness-of-fit")), (3, 3));
    assert_eq!((fails("determinism"), fails("support"), fails("reciprocity")), (0, 0, 0));
    assert_eq!((found.in_all.fails.count, found.in_all.default_fails.count), (3, 3));
    assert_eq!((found.in_all.runs, found.run_again), (15, 3));
    let of_fit: Vec<u64> =
        found.alarms.iter().filter(|a| a.check == "goodness-of-fit").map(|a| a.seed).collect();
    assert_eq!(of_fit, [1, 2, 3]);
    assert!(found.alarms.iter().all(|a| a.case.contains("planted") && a.verdict == Verdict::Fail));
    let errors = found.errors().join("\n");
    assert!(errors.contains("goodness-of-fit of planted θ=30° φ=137°, seed 2"), "{errors}");
    assert!(errors.contains("3 failures (normalization) in 12 runs"), "{errors}");
    assert!(found.markdown().contains("**above nominal**"));
}

#[test]
fn running_again_only_what_was_suspected_tells_the_same_as_running_all_again() {
    // Budgets so large that suspicions are frequent under both.
    let scope = scope(correct(), 12, 0.5, 0.1);
    let folder = tempfile::tempdir().unwrap();
    let progress = Progress::open(folder.path(), &Identity::new("test"), Arc::default()).unwrap();
    let work = Work::new(Effort::Quick, 1, Some(2), &progress, &|_| {}).unwrap();
    let found = FalseAlarms::measure(&scope, &work).unwrap();
    let (mut suspicions, mut fails): (BTreeMap<&str, u64>, BTreeMap<&str, u64>) = Default::default();
    let mut calm = 0;
    for seed in 1..=scope.seeds {
        for case in &scope.cases {
            let raised = &work.alone(case, seed, scope.raised).1.cases[0];
            let default = &work.alone(case, seed, scope.default).1.cases[0];
            for finding in &default.findings {
                *suspicions.entry(finding.check).or_default() += u64::from(is_suspected(finding));
                *fails.entry(finding.check).or_default() += u64::from(is_fail(finding));
            }
            if raised.findings.iter().any(is_suspected) {
                continue;
            }
            calm += 1;
            for (a, b) in raised.findings.iter().zip(&default.findings) {
                let told = |f: &Finding| (f.check, f.outcome.verdict, f.attempts.len(), f.outcome.samples);
                assert_eq!(told(a), told(b), "{}", case.label());
            }
        }
    }
    for row in &found.checks {
        assert_eq!(row.default_suspicions.count, suspicions[row.check.as_str()], "{}", row.check);
        assert_eq!(row.default_fails.count, fails[row.check.as_str()], "{}", row.check);
    }
    assert_eq!(found.run_again + calm, found.in_all.runs);
    let in_default: u64 = suspicions.values().sum();
    assert!(calm > 5 && found.run_again > 5 && in_default > 2, "{calm} {} {in_default}", found.run_again);
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let scope = scope(correct(), 2, 0.3, 1e-6);
    let on = |threads| {
        let folder = tempfile::tempdir().unwrap();
        bytes(&measure(folder.path(), &scope, threads, Arc::default(), &|_| {}).unwrap())
    };
    assert_eq!(on(1), on(3));
}

// ------------------------------------------------------------------- going on

#[test]
fn what_a_kill_leaves_goes_on_to_the_same_bytes() {
    let scope = scope(correct(), 3, 0.3, 1e-6);
    let folder = tempfile::tempdir().unwrap();
    let whole = bytes(&measure(folder.path(), &scope, 2, Arc::default(), &|_| {}).unwrap());
    let file = folder.path().join(PROGRESS);
    let saved = std::fs::read(&file).unwrap();
    let ends: Vec<usize> = (0..saved.len()).filter(|k| saved[*k] == b'\n').map(|k| k + 1).collect();
    assert_eq!(ends.len(), 4, "an identity and three units");
    // Killed after a unit, within the line of one, and just before the end of a line.
    for cut in [ends[0], ends[1], ends[1] + 100, ends[3] - 1, ends[3]] {
        std::fs::write(&file, &saved[..cut]).unwrap();
        let steps = AtomicU64::new(0);
        let count = |event: Event| {
            if let Event::Steps(n) = event {
                steps.fetch_add(n, Ordering::Relaxed);
            }
        };
        let again = measure(folder.path(), &scope, 2, Arc::default(), &count).unwrap();
        assert!(bytes(&again) == whole, "cut at {cut} of {}", saved.len());
        assert!(std::fs::read(&file).unwrap() == saved);
        assert_eq!(steps.into_inner(), 12, "steps of saved units are told too");
    }
}

#[test]
fn a_stop_keeps_the_units_that_are_done() {
    let scope = scope(correct(), 3, 0.3, 1e-6);
    let folder = tempfile::tempdir().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let steps = AtomicU64::new(0);
    let in_the_second_unit = |event: Event| {
        if let Event::Steps(_) = event
            && steps.fetch_add(1, Ordering::Relaxed) == 5
        {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let cut = measure(folder.path(), &scope, 1, stop.clone(), &in_the_second_unit);
    assert!(matches!(cut, Err(Unfinished::Interrupted)));
    assert_eq!(std::fs::read_to_string(folder.path().join(PROGRESS)).unwrap().lines().count(), 2);
    let again = measure(folder.path(), &scope, 2, Arc::default(), &|_| {}).unwrap();
    assert!(bytes(&again) == bytes(&measured(&scope)));
}

// ------------------------------------------------------------- the command line

fn gonio(folder: &Path) -> Child {
    let mut command = Command::new(cargo_bin("gonio"));
    command.args(["calibrate", "--quick", "--part", "false-alarms", "--out"]).arg(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn ended(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.stdout, b"", "stdout is for machines");
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args(["-s", name, &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
}

/// Waits until so many units are saved.
fn wait_for_units(folder: &Path, units: usize) {
    let start = Instant::now();
    let lines = || std::fs::read_to_string(folder.join(PROGRESS)).map_or(0, |t| t.lines().count());
    while lines() < 1 + units {
        assert!(start.elapsed() < Duration::from_secs(120), "{units} units did not come");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_killed_calibration_goes_on_and_an_interrupted_one_says_how() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = gonio(folder.path());
    wait_for_units(folder.path(), 1);
    let (code, told) = ended(gonio(folder.path()));
    assert!(code == Some(2) && told.contains("another calibration is at work"), "{code:?} {told}");
    signal(&first, "KILL");
    first.wait().unwrap();
    let mut saved = std::fs::read_to_string(folder.path().join(PROGRESS)).unwrap();
    saved.truncate(saved.rfind('\n').unwrap() + 1);

    let second = gonio(folder.path());
    wait_for_units(folder.path(), saved.lines().count());
    signal(&second, "INT");
    let (code, told) = ended(second);
    assert_eq!(code, Some(130), "{told}");
    for part in ["going on: ", "stopping; ", "the same command goes on"] {
        assert!(told.contains(part), "no `{part}` in {told}");
    }
    let after = std::fs::read_to_string(folder.path().join(PROGRESS)).unwrap();
    assert!(after.starts_with(&saved), "what was done is not done again");
    assert!(!folder.path().join("calibration.json").exists());
}
