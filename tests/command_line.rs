//! The built programs, as people and scripts use them: `gonio`, and the example
//! `own_command`, whose `paper` misbehaves on request.

mod common;

use common::desk::{Desk, GONIO, done, finished, own_command};
use gonio::report::schema_text;
use serde_json::Value;
use std::io::Read;
use std::process::Child;
use std::time::{Duration, Instant};

fn signal(child: &Child, name: &str) {
    let sent = std::process::Command::new("kill").args(["-s", name, &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
}

/// Waits until `ready`, or a while.
fn wait_for(what: &str, mut ready: impl FnMut() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(start.elapsed() < Duration::from_secs(60), "{what} did not come");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn results(report: &Value) -> &[Value] {
    report["results"].as_array().unwrap()
}

fn rows<'a>(report: &'a Value, subject: &str) -> Vec<&'a Value> {
    results(report).iter().filter(|r| r["subject"]["name"] == subject).collect()
}

fn verdict<'a>(report: &'a Value, subject: &str, check: &str) -> &'a str {
    let row = rows(report, subject).into_iter().find(|r| r["check"] == check);
    row.unwrap_or_else(|| panic!("no {check} of {subject}"))["verdict"].as_str().unwrap()
}

/// Fast, and enough for models that are right.
const HEAD: &str =
    "[suite]\nname = \"small\"\nsamples = 4096\ndetect = 10\ntheta = 30\nphi = 17\ntime_limit = 20\n";

fn suite(subjects: &str) -> String {
    format!("{HEAD}{subjects}")
}

/// `[[subject]]`s with these defects.
fn broken(defects: &[&str], parameters: &str) -> String {
    defects.iter().map(|d| format!("[[subject]]\nuse = \"paper-{d}\"\n{parameters}")).collect()
}

// ---------------------------------------------------------------- exit codes

#[test]
fn ends_with_0_where_all_passed_and_writes_a_report() {
    let desk = Desk::new();
    desk.write("s.toml", &suite("[[subject]]\nuse = \"lambert\"\n"));
    let run = desk.gonio("run s.toml");
    run.ends(0).says("small");
    assert_eq!(run.out, "", "stdout is for machines");
    let report = desk.report("reports/small");
    assert_eq!(report["suite"], "small");
    assert!(report["summary"]["passed"].as_u64().unwrap() > 8);
    assert!(report.get("partial").is_none());
    for row in results(&report) {
        let evidence = row["evidence"].as_str().unwrap();
        assert!(desk.path("reports/small").join(evidence).is_file());
    }
    assert!(desk.files("reports/small").keys().any(|n| n.ends_with(".svg")));
}

#[test]
fn check_measures_one_subject_and_writes_nothing_unless_asked() {
    let desk = Desk::new();
    let line = "check lambert:reflectance=0.5 --theta 30 --phi 17 --samples 4096 --detect 10";
    desk.gonio(line).ends(0).says("lambert (1)");
    assert!(desk.files(".").is_empty());
    desk.gonio(&format!("{line} -o here")).ends(0);
    assert!(desk.path("here/report.json").is_file());
}

#[test]
fn ends_with_1_where_a_check_failed_and_says_which() {
    let desk = Desk::new();
    desk.gonio("check lambert:reflectance=0.5 --claim lossless=true --check white-furnace --theta 30")
        .ends(1)
        .says("white-furnace");
}

#[test]
fn strict_turns_inconclusive_into_1() {
    let desk = Desk::new();
    let line = "check lambert --theta 30 --samples 4096 --detect 1e-6 --check goodness-of-fit";
    desk.gonio(line).ends(0).says("inconclusive");
    desk.gonio(&format!("{line} --strict")).ends(1);
}

#[test]
fn ends_with_2_for_wrong_usage_and_says_what_to_type() {
    let desk = Desk::new();
    desk.write("s.toml", &suite("[[subject]]\nuse = \"lambert\"\n"));
    for (line, part) in [
        ("", "Usage"),
        ("rum", "run"),
        ("run --theta", "--theta"),
        ("run --frobnicate", "--frobnicate"),
        ("run nowhere.toml", "nowhere.toml"),
        ("run quik", "did you mean `quick`?"),
        ("run .", "cannot be read"),
        ("run s.toml s.toml", "two suites are called `small`"),
        ("run --samples 0", "0"),
        ("run --samples many", "many"),
        ("run --check suport", "did you mean `support`?"),
        ("run --threads 0", "1..=1024"),
        ("run --quiet --verbose", "cannot be used with"),
        ("check", "<SUBJECT>"),
        ("check lambart", "did you mean `lambert`?"),
        ("check lambert:reflectence=1", "did you mean `reflectance`?"),
        ("check lambert:reflectance=2", "did you mean `1`?"),
        ("check lambert:reflectance=NaN", "0 to 1"),
        ("check lambert --theta NaN", "0 to 180"),
        ("check lambert --claim loss=true", "did you mean `lossless`?"),
        ("list lambart", "lambert"),
        ("completions tcl", "tcl"),
        ("report nowhere", "nowhere"),
    ] {
        let run = desk.gonio(line);
        run.ends(2).says(part);
        assert_eq!(run.out, "", "{line}");
        assert!(!run.err.contains("panicked"), "{line}: {}", run.err);
    }
    assert!(!desk.path("reports").exists(), "nothing was run");
}

#[test]
fn ends_with_2_for_a_wrong_suite_with_the_line_and_the_nearest_name() {
    let desk = Desk::new();
    // (text, line, what is told)
    for (text, line, part) in [
        ("[suite\nname = 1", 1, "not TOML"),
        ("[suite]\nname = \"a\nseed = 1", 2, "not TOML"),
        ("[suite]\nseed = 1\nseed = 2", 3, "not TOML"),
        ("[suit]\n", 1, "did you mean `suite`?"),
        ("[suite]\n\nsampels = 5", 3, "did you mean `samples`?"),
        ("[suite]\nchecks = [\"sanity\", \"suport\"]", 2, "did you mean `support`?"),
        ("[suite]\nsamples = 0", 2, "0"),
        ("[suite]\nsamples = \"lots\"", 2, "lots"),
        ("[suite]\nsamples = -5", 2, "-5"),
        ("[suite]\nseed = 1.5", 2, "seed"),
        ("[suite]\nseed = -1", 2, "seed"),
        ("[suite]\ntheta = 200", 2, "0 to 180"),
        ("[suite]\ntheta = [30, nan]", 2, "0 to 180"),
        ("[suite]\ntheta = \"north\"", 2, "theta"),
        ("[suite]\nphi = inf", 2, "phi"),
        ("[suite]\nfalse_alarm = 2", 2, "between 0 and 1"),
        ("[suite]\ntime_limit = 0", 2, "time"),
        ("[suite]\nname = 3", 2, "name"),
        ("[suite]\ncover = \"al\"", 2, "did you mean `all`?"),
        ("suite = 3", 1, "[suite]"),
        ("subject = 3", 1, "[[subject]]"),
        ("subject = [3]", 1, "[[subject]]"),
        ("\n[[subject]]\nuse = \"lambart\"", 3, "did you mean `lambert`?"),
        ("[[subject]]\nreflectance = 1", 1, "without `use`"),
        ("[[subject]]\nuse = 3", 2, "use"),
        ("[[subject]]\nuse = \"lambert\"\nreflectence = 1", 3, "did you mean `reflectance`?"),
        ("[[subject]]\nuse = \"lambert\"\nreflectance = 1.5", 3, "did you mean `1`?"),
        ("[[subject]]\nuse = \"lambert\"\nreflectance = \"red\"", 3, "0 to 1"),
        ("[[subject]]\nuse = \"lambert\"\nsampling = \"cosin\"", 3, "did you mean `cosine`?"),
        ("[[subject]]\nuse = \"lambert\"\nclaims = { reciprocl = true }", 3, "did you mean `reciprocal`?"),
        ("[[subject]]\nuse = \"lambert\"\nclaims = { reciprocal = 3 }", 3, "reciprocal"),
        ("[[subject]]\nuse = \"lambert\"\nwaive = [{ check = \"suport\", because = \"x\" }]", 3, "support"),
        ("[[subject]]\nuse = \"lambert\"\nreference = \"lambart\"", 3, "did you mean `lambert`?"),
        ("[[subject]]\nshader = \"x.wgsl\"", 2, "not supported"),
    ] {
        desk.write("wrong.toml", text);
        let run = desk.gonio("run wrong.toml");
        run.ends(2).says(part).says(&format!("wrong.toml:{line}:"));
        assert!(!desk.path("reports").exists(), "{text}: nothing was run");
    }
}

#[test]
fn all_mistakes_of_a_suite_are_shown_at_once() {
    let desk = Desk::new();
    desk.write("wrong.toml", "[suite]\nsed = 1\nsamples = 0\n[[subject]]\nuse = \"lambart\"\n");
    desk.gonio("run wrong.toml").ends(2).says("3 mistakes").says("`seed`").says("`lambert`");
}

#[test]
fn a_suite_that_is_not_text_is_told_and_ends_with_2() {
    let desk = Desk::new();
    std::fs::write(desk.path("s.toml"), [0xff, 0xfe, 0x00]).unwrap();
    desk.gonio("run s.toml").ends(2).says("s.toml");
}

#[test]
fn ends_with_4_where_nothing_was_run() {
    let desk = Desk::new();
    desk.write("empty.toml", "").write("head.toml", HEAD);
    desk.write("skips.toml", &suite("checks = [\"reference\"]\n[[subject]]\nuse = \"lambert\"\n"));
    desk.gonio("run empty.toml").ends(4).says("nothing was run");
    desk.gonio("run head.toml").ends(4).says("nothing was run");
    desk.gonio("run skips.toml").ends(4);
    assert_eq!(desk.report("reports/small")["summary"]["skipped"], 1, "the skip is in sight");
}

#[test]
fn ends_with_5_before_measuring_where_the_folder_cannot_be_written() {
    let desk = Desk::new();
    desk.write("file", "");
    // The deep suite would take hours.
    desk.gonio("run deep -o file/below").ends(5).says("cannot write into file/below").says("--out");
    desk.gonio("run deep -o file").ends(5).says("file");
    desk.gonio("check lambert -o file/below").ends(5);
}

#[test]
fn the_gravest_of_several_suites_decides_the_code() {
    let desk = Desk::new();
    desk.write("good.toml", &suite("[[subject]]\nuse = \"lambert\"\n"));
    desk.write(
        "bad.toml",
        &suite("[[subject]]\nuse = \"lambert\"\nreflectance = 0.5\nclaims = { lossless = true }\n")
            .replace("small", "bad"),
    );
    desk.write("none.toml", "");
    desk.gonio("run good.toml bad.toml none.toml -o out").ends(1);
    assert_eq!(desk.report("out/small")["summary"]["failed"], 0);
    assert_eq!(desk.report("out/bad")["summary"]["failed"], 1);
}

// ------------------------------------------------------------ other commands

#[test]
fn list_shows_models_and_parameters_one_s_own_too() {
    let desk = Desk::new();
    let all = desk.gonio("list");
    all.ends(0);
    assert_eq!(all.err, "");
    for model in gonio::registry::Registry::builtin().models() {
        assert!(all.out.contains(model.name()), "{}", all.out);
    }
    let own = desk.own("list");
    assert!(own.out.starts_with(&all.out[..4]) && own.out.contains("paper"), "{}", own.out);
    let paper = desk.own("list paper");
    paper.ends(0);
    assert!(paper.out.contains("1 to 4") && own.out.contains("paper-nan"), "{}", paper.out);
}

#[test]
fn parts_of_one_s_own_are_measured_and_are_no_bsdfs() {
    let desk = Desk::new();
    let own = desk.own("list");
    for (name, kind) in [("hemispheres", "distribution"), ("film", "Fresnel"), ("paper", "BSDF")] {
        let row = own.out.lines().find(|l| l.starts_with(&format!("{name} "))).unwrap_or_default();
        assert!(row.contains(kind), "{}", own.out);
    }
    desk.own("check hemispheres --samples 16384 --detect 1 --strict -o hemispheres").ends(0);
    desk.own("check film --samples 4096 --strict -o film").ends(0);
    let film = desk.report("film");
    assert_eq!(film["summary"]["failed"], 0);
    assert!(film["results"].as_array().unwrap().iter().all(|r| r["wo"].is_null()));
    let visible = desk.own("check hemispheres:sampling=visible-normals");
    visible.ends(2);
    assert!(visible.err.contains("sampling=normals"), "{}", visible.err);
    let nested = desk.gonio("check blend:first=fresnel");
    nested.ends(2);
    assert!(nested.err.contains("is a Fresnel function and no BSDF"), "{}", nested.err);
}

#[test]
fn completions_and_help_and_version_are_printed() {
    let desk = Desk::new();
    for (line, part) in [
        ("completions bash", "_gonio()"),
        ("completions zsh", "#compdef gonio"),
        ("completions fish", "complete -c gonio"),
        ("--help", "Exit codes"),
        ("run --help", "--strict"),
        ("--version", env!("CARGO_PKG_VERSION")),
    ] {
        let run = desk.gonio(line);
        run.ends(0);
        assert!(run.out.contains(part), "{line}: {}", run.out);
    }
}

#[test]
fn the_committed_schemas_are_those_that_are_printed() {
    for (of, text) in [("report", gonio::report::schema_text()), ("grade", gonio::grading::schema_text())] {
        let committed = format!("{}/schemas/{of}.schema.json", env!("CARGO_MANIFEST_DIR"));
        let committed = std::fs::read_to_string(committed).unwrap();
        let printed = Desk::new().gonio(&format!("schema {of}"));
        printed.ends(0);
        assert!(
            printed.out == committed && printed.out == text,
            "write it again: gonio schema {of} > schemas/{of}.schema.json"
        );
    }
}

/// What is wrong with a report by the schema that the program prints.
fn breaches(report: &Value) -> Vec<String> {
    let schema: Value = serde_json::from_str(&schema_text()).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    validator.iter_errors(report).map(|e| format!("{}: {e}", e.instance_path())).collect()
}

#[test]
fn json_is_all_of_stdout_and_keeps_the_schema_even_of_broken_subjects() {
    let desk = Desk::new();
    let subjects = "[[subject]]\nuse = \"dielectric\"\n[[subject]]\nuse = \"paper\"\nk = 2\n".to_string()
        + &broken(&["nan", "infinite", "panics", "never"], "");
    desk.write("s.toml", &suite(&subjects));
    let run = desk.own("run s.toml --format json --quiet --plots none");
    run.ends(3);
    assert_eq!(run.err, "", "quiet");
    let report: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(breaches(&report), Vec::<String>::new());
    assert_eq!(report, desk.report("reports/small"), "what is printed is what is written");
    let check = desk.gonio("check lambert --theta 30 --samples 4096 --format json");
    let report: Value = serde_json::from_str(&check.out).unwrap();
    assert_eq!(breaches(&report), Vec::<String>::new());
    assert!(breaches(&serde_json::json!({ "suite": 1 })).len() > 1, "the schema refuses another thing");
}

#[test]
fn report_draws_the_same_pictures_again() {
    let desk = Desk::new();
    let subjects = "[[subject]]\nuse = \"lambert\"\nlabel = \"a wall\"\nreflectance = [0.2, 0.8]\n\
        [[subject]]\nuse = \"torrance-sparrow\"\nalpha = 0.3\n\
        [[subject]]\nuse = \"lambert\"\nlabel = \"too bright\"\nreflectance = 0.5\nclaims = { lossless = true }\n\
        [[subject]]\nuse = \"dielectric\"\n\
        [[subject]]\nuse = \"mutant-no-jacobian\"\nalpha = 0.3\n";
    desk.write("s.toml", &suite(subjects).replace("theta = 30", "theta = [0, 75]"));
    for which in ["all", "auto"] {
        desk.gonio(&format!("run s.toml --plots {which} -o {which}")).ends(1);
        let first = desk.files(&format!("{which}/plots"));
        assert!(first.len() > 5, "{:?}", first.keys());
        // Some of its cells were cut once more, and the diagnosis predicts a line.
        let told = |(name, bytes): &(&String, &Vec<u8>)| {
            name.ends_with("-plane.svg") && String::from_utf8_lossy(bytes).contains("what the cause")
        };
        assert_eq!(first.iter().filter(told).count(), 1, "a prediction in its own case");
        assert!(first.contains_key("diagnosis-mutant-no-jacobian-alpha-0.3.svg"), "{:?}", first.keys());
        assert!(first.keys().any(|name| name.ends_with("-weights.svg")), "draws keep their weights");
        std::fs::remove_dir_all(desk.path(which).join("plots")).unwrap();
        desk.gonio(&format!("report {which} --plots {which}")).ends(0);
        let second = desk.files(&format!("{which}/plots"));
        assert_eq!(first.keys().collect::<Vec<_>>(), second.keys().collect::<Vec<_>>(), "{which}");
        for (name, bytes) in &first {
            assert!(second[name] == *bytes, "{which}: {name} differs");
        }
    }
}

#[test]
fn report_refuses_what_is_not_a_report() {
    let desk = Desk::new();
    desk.write("report.json", "{").write("other.json", "{}").write("new.json", "{\"schema_version\": 999}");
    desk.gonio("report .").ends(2).says("not a report");
    desk.gonio("report other.json").ends(2).says("not a report");
    desk.gonio("report new.json").ends(2).says("later version");
}

#[test]
fn evidence_that_is_gone_or_damaged_is_told_by_name() {
    let desk = Desk::new();
    desk.gonio("check lambert --theta 30 --samples 4096 --detect 10 --plots none -o out").ends(0);
    let file = desk.path("out/evidence/case-0000.json.gz");
    let whole = std::fs::read(&file).unwrap();
    std::fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    desk.gonio("report out").ends(5).says("case-0000.json.gz");
    std::fs::remove_file(&file).unwrap();
    desk.gonio("report out").ends(5).says("case-0000.json.gz");
}

// ----------------------------------------------------------- broken subjects

/// Each defect beside a good subject: (defect, code, check, its verdict, words).
#[test]
fn each_defect_is_told_and_the_good_subject_beside_it_passes() {
    let desk = Desk::new();
    for (defect, code, check, wanted, words) in [
        ("loud", 1, "normalization", "fail", ""),
        ("panics", 3, "goodness-of-fit", "error", "no entry 4 in a table of 4"),
        ("nan", 1, "sanity", "fail", "eval() is finite"),
        ("infinite", 1, "sanity", "fail", "eval() is finite"),
        ("negative", 1, "sanity", "fail", "eval() ≥ 0"),
        ("long", 1, "sanity", "fail", "|wi| = 1"),
        ("never", 1, "normalization", "fail", ""),
    ] {
        let subjects = broken(&[defect], "") + "[[subject]]\nuse = \"paper\"\nk = 2\n";
        desk.write("s.toml", &suite(&subjects).replace("samples = 4096", "samples = \"2^18\""));
        let run = desk.own(&format!("run s.toml -o {defect} --plots none"));
        run.ends(code).says(&format!("paper-{defect}"));
        assert!(!run.err.contains("panicked at"), "panics of subjects are told in the report: {}", run.err);
        let report = desk.report(defect);
        let name = format!("paper-{defect}");
        let row = rows(&report, &name).into_iter().find(|r| r["check"] == check).unwrap();
        assert_eq!(row["verdict"], wanted, "{defect}: {}", row["message"]);
        assert!(row["message"].as_str().unwrap().contains(words), "{defect}: {}", row["message"]);
        for good in rows(&report, "paper:k=2") {
            let verdict = good["verdict"].as_str().unwrap();
            assert!(["pass", "skipped"].contains(&verdict), "beside {defect}: {good:#}");
        }
        // Nothing measured is lost.
        assert_eq!(desk.whole_evidence(&format!("{defect}/evidence")), 2, "{defect}");
    }
}

#[test]
fn the_time_limit_ends_the_slow_and_the_hanging_and_the_rest_goes_on() {
    let desk = Desk::new();
    let subjects = broken(&["slow", "hangs"], "") + "[[subject]]\nuse = \"paper\"\nk = [1, 2, 3, 4]\n";
    let text = suite(&subjects).replace("time_limit = 20", "time_limit = 1");
    desk.write("s.toml", &text);
    let start = Instant::now();
    let run = desk.own("run s.toml --plots none --threads 2");
    run.ends(3).says("time limit of 1 s");
    assert!(start.elapsed() < Duration::from_secs(30), "took {:?}", start.elapsed());
    let report = desk.report("reports/small");
    for defect in ["slow", "hangs"] {
        let rows = rows(&report, &format!("paper-{defect}"));
        let ended: Vec<_> = rows.iter().filter(|r| r["verdict"] == "error").collect();
        assert!(!ended.is_empty(), "{rows:#?}");
        for row in ended {
            assert!(row["message"].as_str().unwrap().contains("time limit of 1 s"), "{row:#}");
        }
    }
    for k in ["paper:k=1", "paper:k=2", "paper:k=3", "paper:k=4"] {
        assert_eq!(verdict(&report, k, "sanity"), "pass");
        assert_eq!(verdict(&report, k, "goodness-of-fit"), "pass");
    }
    assert!(desk.whole_evidence("reports/small/evidence") >= 5);
}

#[test]
fn a_subject_that_hangs_alone_ends_too() {
    let desk = Desk::new();
    let line = "check paper-hangs --theta 30 --samples 4096 --time-limit 0.3 --threads 1";
    desk.own(line).ends(3).says("time limit of 0.3 s");
}

// ------------------------------------------------------ signals and processes

/// Fast cases first, then ones that take a while.
fn long_suite() -> String {
    let subjects =
        "[[subject]]\nuse = \"paper\"\nk = [1, 2]\n".to_string() + &broken(&["slow"], "k = [1, 2, 3, 4]\n");
    suite(&subjects).replace("time_limit = 20", "time_limit = 600")
}

#[test]
fn an_interrupt_writes_a_partial_report_and_ends_with_130() {
    let desk = Desk::new();
    desk.write("s.toml", &long_suite());
    let mut child = desk.spawn(own_command(), "run s.toml -o out --threads 2");
    wait_for("evidence", || desk.path("out/evidence/case-0001.json.gz").is_file());
    signal(&child, "INT");
    let start = Instant::now();
    wait_for("the end", || child.try_wait().unwrap().is_some());
    assert!(start.elapsed() < Duration::from_secs(10), "took {:?}", start.elapsed());
    let run = finished(child.wait_with_output().unwrap());
    run.ends(130).says("stopping");
    let report = desk.report("out");
    assert_eq!(breaches(&report), Vec::<String>::new());
    let partial = report["partial"].as_str().expect("says that it is partial");
    assert!(partial.contains("of 6 cases"), "{partial}");
    run.says(partial);
    assert_eq!(verdict(&report, "paper:k=2", "goodness-of-fit"), "pass", "what was measured stays");
    // Nothing that was not measured passes.
    for row in results(&report) {
        if row["subject"]["name"].as_str().unwrap().contains("slow") && row["samples"] == 0 {
            assert!(row["verdict"] != "fail" && row["verdict"] != "error", "{row:#}");
        }
    }
    let last = rows(&report, "paper-slow:k=4");
    assert!(!last.is_empty() && last.iter().all(|r| r["verdict"] == "skipped"), "{last:#?}");
    assert!(last.iter().all(|r| r["reason"].as_str().unwrap().contains("stopped")));
    assert!(desk.whole_evidence("out/evidence") >= 2);
}

#[test]
fn a_second_interrupt_ends_at_once() {
    let desk = Desk::new();
    let line = "check paper-hangs --theta 30 --samples 4096 --threads 1 -o out";
    let mut child = desk.spawn(own_command(), line);
    wait_for("the folder", || desk.path("out").is_dir());
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "INT");
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "the call does not return");
    signal(&child, "INT");
    let start = Instant::now();
    wait_for("the end", || child.try_wait().unwrap().is_some());
    assert!(start.elapsed() < Duration::from_secs(5));
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn a_kill_leaves_only_whole_files() {
    let desk = Desk::new();
    let subjects =
        "[[subject]]\nuse = \"torrance-sparrow\"\nalpha = [0.3, 0.5]\nphi = [1, 2, 3, 4, 5, 6, 7, 8]\n";
    desk.write("s.toml", &suite(subjects));
    for (k, millis) in [0, 20, 50, 110].into_iter().enumerate() {
        let out = format!("out{k}");
        let mut child = desk.spawn(GONIO, &format!("run s.toml -o {out}"));
        wait_for("evidence", || !desk.files(&format!("{out}/evidence")).is_empty());
        std::thread::sleep(Duration::from_millis(millis));
        signal(&child, "KILL");
        child.wait().unwrap();
        desk.whole_evidence(&format!("{out}/evidence"));
        if let Some(report) = desk.files(&out).get("report.json") {
            serde_json::from_slice::<Value>(report).expect("a whole report");
        }
    }
}

#[test]
fn two_runs_at_once_into_one_folder_both_succeed() {
    let desk = Desk::new();
    let subjects = "[[subject]]\nuse = \"torrance-sparrow\"\nalpha = [0.3, 0.5]\nphi = [1, 2]\n";
    desk.write("s.toml", &suite(subjects));
    let line = "run s.toml -o out";
    let both = [desk.spawn(GONIO, line), desk.spawn(GONIO, line)];
    for child in both {
        finished(child.wait_with_output().unwrap()).ends(0);
    }
    assert_eq!(breaches(&desk.report("out")), Vec::<String>::new());
    assert_eq!(desk.whole_evidence("out/evidence"), 4);
    let left: Vec<_> = desk.files("out").into_keys().filter(|n| n.contains(".writing")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let desk = Desk::new();
    let mut child = desk.spawn(GONIO, "list");
    let mut first = [0];
    let mut out = child.stdout.take().unwrap();
    out.read_exact(&mut first).unwrap();
    drop(out);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

// ------------------------------------------------------------ reproducibility

#[test]
fn the_command_of_a_failure_gives_the_same_numbers_again() {
    let desk = Desk::new();
    let subjects = broken(&["loud", "negative", "long"], "")
        + "[[subject]]\nuse = \"paper\"\nk = 2\nreference = \"paper:k=2.1\"\n\
        [[subject]]\nuse = \"lambert\"\nreflectance = 0.5\nclaims = { lossless = true }\n";
    desk.write("s.toml", &suite(&subjects).replace("samples = 4096", "samples = \"2^18\"\nseed = 7"));
    desk.own("run s.toml -o out --plots none").ends(1);
    let report = desk.report("out");
    let mut statistical = 0;
    let mut wrong = Vec::new();
    for row in results(&report).iter().filter(|r| r["verdict"] == "fail") {
        let command = row["command"].as_str().unwrap();
        let (program, line) = command.split_once(' ').unwrap();
        assert_eq!(program, "own_command");
        let again = desk.own(&format!("{line} --format json"));
        again.ends(1);
        let again: Value = serde_json::from_str(&again.out).unwrap();
        assert_eq!(results(&again).len(), 1, "{command}");
        // Sanity counts every number that any check asked for: alone, fewer.
        let fields: &[&str] = match row["check"].as_str() {
            Some("sanity") => &["verdict", "log10_p", "threshold"],
            _ => &["verdict", "log10_p", "threshold", "effect", "attempts", "samples", "message", "worst"],
        };
        for field in fields {
            if results(&again)[0][field] != row[field] {
                let other = &results(&again)[0][field];
                wrong.push(format!("{command}: {field} was {} and is {other}", row[field]));
            }
        }
        statistical += usize::from(!row["attempts"].as_array().unwrap().is_empty());
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(statistical > 3, "{statistical} failures with attempts");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let desk = Desk::new();
    let subjects = broken(&["loud", "nan", "panics"], "")
        + "[[subject]]\nuse = \"paper\"\nk = [1, 3]\n\
        [[subject]]\nuse = \"torrance-sparrow\"\nalpha = 0.3\n";
    desk.write("s.toml", &suite(&subjects).replace("samples = 4096", "samples = \"2^16\""));
    let run = |out: &str, threads: &str, option: &str| {
        let line = format!("run s.toml -o {out} {option} --plots none");
        let mut command = desk.command(own_command(), &line);
        done(command.env("RAYON_NUM_THREADS", threads)).ends(3);
        let text = std::fs::read_to_string(desk.path(out).join("report.json")).unwrap();
        let timeless = |l: &&str| !l.starts_with("  \"started\": ") && !l.starts_with("  \"duration_s\": ");
        let kept: Vec<String> = text.lines().filter(timeless).map(str::to_string).collect();
        assert_eq!(kept.len() + 2, text.lines().count());
        (kept, desk.files(&format!("{out}/evidence")))
    };
    let one = run("one", "1", "");
    for other in [run("two", "2", ""), run("three", "1", "--threads 3")] {
        for (a, b) in one.0.iter().zip(&other.0) {
            assert_eq!(a, b);
        }
        assert_eq!(one.0.len(), other.0.len());
        assert_eq!(one.1.keys().collect::<Vec<_>>(), other.1.keys().collect::<Vec<_>>());
        for (name, bytes) in &one.1 {
            assert!(other.1[name] == *bytes, "{name} differs");
        }
    }
}

#[test]
fn another_seed_gives_other_numbers_and_the_same_seed_the_same() {
    let desk = Desk::new();
    let p_values = |seed: u64| {
        let line = format!("check lambert --theta 30 --samples 4096 --detect 10 --format json --seed {seed}");
        let report: Value = serde_json::from_str(&desk.gonio(&line).out).unwrap();
        assert_eq!(report["seed"], seed);
        results(&report).iter().map(|r| r["log10_p"].to_string()).collect::<Vec<_>>()
    };
    assert_eq!(p_values(3), p_values(3));
    assert_ne!(p_values(3), p_values(4));
}

// ---------------------------------------------------------------- the voice

#[test]
fn colours_are_where_they_are_asked_for_and_quiet_is_quiet() {
    let desk = Desk::new();
    let line = "check lambert --theta 30 --samples 4096 --detect 10";
    let escape = '\u{1b}';
    let piped = desk.gonio(line);
    assert!(!piped.err.contains(escape), "a pipe has no colours");
    assert!(desk.gonio(&format!("{line} --color always")).err.contains(escape));
    assert!(!desk.gonio(&format!("{line} --color never")).err.contains(escape));
    let none = done(desk.command(GONIO, line).env("NO_COLOR", "1"));
    none.ends(0);
    assert!(!none.err.contains(escape));
    assert!(!done(desk.command(GONIO, "check lambart").env("NO_COLOR", "1")).err.contains(escape));
    let quiet = desk.gonio(&format!("{line} --quiet"));
    quiet.ends(0);
    assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""));
    desk.gonio("check lambart --quiet").ends(2).says("lambert");
    desk.gonio(&format!("{line} --verbose")).ends(0).says("pass lambert θ=30° φ=17°");
}

#[test]
fn a_narrow_or_senseless_width_is_no_trouble() {
    let desk = Desk::new();
    for columns in ["1", "0", "80", "100000", "wide", ""] {
        let line = "check lambert --theta 30 --samples 4096 --detect 10";
        done(desk.command(GONIO, line).env("COLUMNS", columns)).ends(0);
    }
}
