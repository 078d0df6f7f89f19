//! What gonio writes for CI servers, read by others: Jenkins' schema of JUnit and junitparser,
//! the schema of SARIF, a reader of Markdown, and small readers in Python of what has none
//! (tests/data/formats/read.py). The workflows are held to the schemas of their servers.

mod common;

use common::tools::tools;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, Output};
use std::sync::OnceLock;
use tempfile::TempDir;

const GONIO: &str = env!("CARGO_BIN_EXE_gonio");
const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const ALL: &str = "junit,sarif,github,gitlab,markdown";

/// What formats give a meaning to, as a file may be called and a suite may label a row.
const NAME: &str = "::error|<b>`x`&%,%0A_*@me*";

/// A run with one of everything: failures with a cause, one that is waived, a subject that
/// ends in the middle, one with a hostile label, and too few samples for some.
const SUITE: &str = r#"
[suite]
name = "trou|ble <i>"
theta = [30, 60]
phi = 17
samples = 65536
[[subject]]
use = "mutant-no-jacobian"
[[subject]]
use = "lambert"
[[subject]]
use = "mutant-value-scaled"
label = "::error|<b>`x`&%,%0A_*@me*"
[[subject]]
use = "mutant-value-scaled"
waive = [{ check = "energy", because = "as in <the paper>" }, { check = "white-furnace", because = "so" }]
[[subject]]
use = "dielectric"
[[subject]]
process = ["python3", "::error|<b>`x`&%,%0A_*@me*.py", "frames", "raise"]
"#;

fn gonio(folder: &Path, words: &[&str], variables: &[(&str, &str)]) -> Output {
    let mut command = Command::new(GONIO);
    for name in ["GITHUB_ACTIONS", "GITHUB_STEP_SUMMARY", "GITHUB_WORKSPACE", "CI_PROJECT_DIR", "WORKSPACE"] {
        command.env_remove(name);
    }
    command.current_dir(folder).args(words).envs(variables.iter().copied()).output().unwrap()
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

struct Ran {
    folder: TempDir,
    report: Value,
    code: Option<i32>,
    told: String,
}

/// The suite above, run once with all formats in the folder `materials` of a repository.
fn ran() -> &'static Ran {
    static RAN: OnceLock<Ran> = OnceLock::new();
    RAN.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let materials = folder.path().join("materials");
        std::fs::create_dir_all(&materials).unwrap();
        std::fs::create_dir(folder.path().join(".git")).unwrap();
        std::fs::write(materials.join("s.toml"), SUITE).unwrap();
        let plugin = Path::new(ROOT).join("tests/data/plugins/hostile.py");
        std::fs::copy(plugin, materials.join(format!("{NAME}.py"))).unwrap();
        let done = gonio(&materials, &["run", "s.toml", "-o", "out", "--to", ALL], &[]);
        assert!(done.stdout.is_empty(), "{}", said(&done.stdout));
        let report = std::fs::read(materials.join("out/report.json")).expect("a report");
        Ran {
            report: serde_json::from_slice(&report).unwrap(),
            code: done.status.code(),
            told: said(&done.stderr),
            folder,
        }
    })
}

/// What readers see in the files of a folder.
fn read(folder: &Path) -> Value {
    let python = tools().python.join("python");
    let script = Path::new(ROOT).join("tests/data/formats/read.py");
    let done = Command::new(python).arg(script).arg(folder).output().unwrap();
    assert!(done.status.success(), "{}", said(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap()
}

fn seen() -> &'static Value {
    static SEEN: OnceLock<Value> = OnceLock::new();
    SEEN.get_or_init(|| read(&ran().folder.path().join("materials/out")))
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("no text: {value}"))
}

/// Subjects with a result of this verdict, by label and name.
fn subjects<'a>(report: &'a Value, verdict: &str) -> BTreeSet<(Option<&'a str>, &'a str)> {
    let of = list(&report["results"]).iter().filter(|r| r["verdict"] == verdict);
    of.map(|r| (r["subject"]["label"].as_str(), text(&r["subject"]["name"]))).collect()
}

#[test]
fn the_run_has_one_of_everything_and_tells_what_it_wrote() {
    let ran = ran();
    let summary = &ran.report["summary"];
    for count in ["passed", "failed", "inconclusive", "skipped", "errors", "waived"] {
        assert!(summary[count].as_u64() > Some(0), "{count}: {summary}");
    }
    assert!(!list(&ran.report["diagnoses"]).is_empty());
    assert_eq!(ran.code, Some(3), "{}", ran.told);
    for file in ["junit.xml", "gonio.sarif", "github-annotations.txt", "github-summary.md", "report.md"] {
        assert!(ran.told.contains(&format!("written: out/{file}\n")), "{file}: {}", ran.told);
    }
}

#[test]
fn junit_has_each_result_once_with_its_verdict() {
    let cases = list(&seen()["junit.xml"]);
    let names: BTreeSet<_> = cases.iter().map(|c| (text(&c["class"]), text(&c["name"]))).collect();
    assert_eq!(names.len(), cases.len(), "classes and names are unique");
    assert!(names.iter().all(|(class, _)| class.matches('.').count() == 2), "{names:?}");
    let told = |kind: &str, begins: &str| {
        let of = cases.iter().filter(|c| c["kind"] == kind);
        of.filter(|c| c["message"].as_str().is_none_or(|m| m.starts_with(begins))).count() as u64
    };
    let count = |name: &str| ran().report["summary"][name].as_u64().unwrap();
    assert_eq!(told("success", ""), count("passed"));
    assert_eq!(told("failure", ""), count("failed"));
    assert_eq!(told("error", ""), count("errors"));
    assert_eq!(told("skipped", "inconclusive: "), count("inconclusive"));
    assert_eq!(told("skipped", "waived: "), count("waived"));
    assert_eq!(cases.len() as u64, list(&ran().report["results"]).len() as u64);
    let failure = cases
        .iter()
        .find(|c| c["kind"] == "failure" && text(&c["name"]).starts_with("goodness-of-fit"))
        .expect("the jacobian's");
    for part in [
        "√D = ",
        "worst at θi",
        "[half-vector-jacobian]",
        "repair: divide",
        "$ gonio check mutant-no-jacobian",
    ] {
        assert!(text(&failure["text"]).contains(part), "{part}: {failure}");
    }
    let ended = cases.iter().find(|c| c["kind"] == "error").expect("one that ends");
    assert!(text(&ended["message"]).ends_with("ValueError: no such material"), "{ended}");
    assert!(cases.iter().any(|c| text(&c["suite"]).starts_with(NAME)), "the label as it is written");
}

#[test]
fn sarif_has_a_result_for_each_subject_and_cause_at_its_line() {
    let run = &seen()["gonio.sarif"];
    let rules = list(&run["tool"]["driver"]["rules"]);
    let ids: BTreeSet<&str> = rules.iter().map(|r| text(&r["id"])).collect();
    assert!(ids.len() == rules.len() && ids.contains("masking") && ids.contains("check/energy"));
    let results = list(&run["results"]);
    let mut prints = BTreeSet::new();
    for result in results {
        let rule = &rules[result["ruleIndex"].as_u64().unwrap() as usize];
        assert_eq!(rule["id"], result["ruleId"]);
        assert!(prints.insert(text(&result["partialFingerprints"]["primaryLocationLineHash"])));
        let place = &result["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "materials/s.toml", "from the repository's root");
        let line = place["region"]["startLine"].as_u64().unwrap() as usize;
        let asked = SUITE.lines().nth(line - 1).unwrap();
        assert!(asked.starts_with("use = ") || asked.starts_with("process = "), "{line}: {asked}");
        let subject = text(&result["locations"][0]["logicalLocations"][0]["fullyQualifiedName"]);
        assert!(!subject.starts_with('/'), "{subject}");
        assert!(asked.contains(subject.split(' ').next().unwrap()), "{subject}: {asked}");
    }
    let of =
        |verdict: &str| results.iter().filter(|r| r["properties"]["verdict"] == verdict).collect::<Vec<_>>();
    let report = &ran().report;
    assert_eq!(of("fail").len(), subjects(report, "fail").len(), "each failing subject has one cause");
    assert!(of("fail").iter().any(|r| r["ruleId"] == "half-vector-jacobian"));
    assert_eq!((of("error").len(), text(&of("error")[0]["ruleId"])), (1, "unmeasured"));
    assert!(of("inconclusive").iter().all(|r| r["level"] == "note"));
    assert_eq!(of("waived").len(), 2);
    for waived in of("waived") {
        let suppression = &waived["suppressions"][0];
        assert_eq!(suppression["kind"], "external");
        assert!(["as in <the paper>", "so"].contains(&text(&suppression["justification"])));
    }
    assert_eq!(run["invocations"][0]["executionSuccessful"], true);
}

#[test]
fn a_run_with_another_seed_and_more_samples_has_the_same_fingerprints() {
    let folder = tempfile::tempdir().unwrap();
    let suite = "[suite]\ntheta = 60\nphi = 17\n[[subject]]\nuse = \"mutant-no-jacobian\"\n";
    std::fs::write(folder.path().join("s.toml"), suite).unwrap();
    let prints = |options: &[&str]| {
        let done = gonio(
            folder.path(),
            &[&["run", "s.toml", "-o", "out", "--to", "sarif,gitlab"], options].concat(),
            &[],
        );
        assert_eq!(done.status.code(), Some(1), "{}", said(&done.stderr));
        let json = |name: &str| -> Value {
            serde_json::from_slice(&std::fs::read(folder.path().join("out").join(name)).unwrap()).unwrap()
        };
        (
            json("gonio.sarif")["runs"][0]["results"][0]["partialFingerprints"].clone(),
            json("gl-code-quality-report.json")[0]["fingerprint"].clone(),
        )
    };
    let first = prints(&["--seed", "1", "--samples", "65536"]);
    assert!(first.1.is_string());
    assert_eq!(first, prints(&["--seed", "2", "--samples", "131072"]));
}

#[test]
fn annotations_are_read_back_as_they_were_meant() {
    let found = list(&seen()["github-annotations.txt"]);
    let errors: Vec<&Value> = found.iter().filter(|a| a["kind"] == "error").collect();
    let report = &ran().report;
    assert_eq!(errors.len(), subjects(report, "fail").len() + subjects(report, "error").len());
    assert!(errors.iter().all(|a| a["file"] == "materials/s.toml"));
    let jacobian = errors.iter().find(|a| a["title"] == "gonio half-vector-jacobian").expect("its cause");
    let message = text(&jacobian["message"]);
    assert!(message.starts_with("mutant-no-jacobian: pdf() lacks the Jacobian"), "{message}");
    assert!(
        message.contains("\nrepair: divide")
            && message.contains("\nreproduce: gonio check mutant-no-jacobian")
    );
    assert!(errors.iter().any(|a| text(&a["message"]).starts_with(&format!("{NAME}: "))), "{errors:?}");
    assert!(found.iter().all(|a| ["error", "notice"].contains(&text(&a["kind"]))));
}

#[test]
fn gitlab_has_an_issue_for_each_subject_and_cause_but_what_is_waived() {
    let issues = list(&seen()["gl-code-quality-report.json"]);
    let prints: BTreeSet<_> = issues.iter().map(|i| text(&i["fingerprint"])).collect();
    assert_eq!(prints.len(), issues.len());
    let mut severities: BTreeMap<&str, usize> = BTreeMap::new();
    for issue in issues {
        *severities.entry(text(&issue["severity"])).or_default() += 1;
        assert_eq!(issue["location"]["path"], "materials/s.toml");
    }
    let report = &ran().report;
    assert_eq!(severities["critical"], subjects(report, "fail").len());
    assert_eq!(severities["blocker"], subjects(report, "error").len());
    assert!(severities["info"] > 0 && severities.keys().all(|s| ["critical", "blocker", "info"].contains(s)));
}

#[test]
fn markdown_says_the_verdict_first_and_holds_no_html_but_its_own() {
    let page = &seen()["report.md"];
    let heads: Vec<&str> = list(&page["heads"]).iter().map(text).collect();
    assert_eq!(heads[0], "✗ 2 of 6 subjects wrong, 1 could not be measured, 4 not decided");
    assert!(heads.contains(&"✗ `mutant-no-jacobian`"), "{heads:?}");
    let report = &ran().report;
    let told = subjects(report, "fail").len() + subjects(report, "error").len();
    assert_eq!(heads.iter().filter(|h| h.starts_with(['✗', 'E'])).count(), told + 1);
    for page in [page, &seen()["github-summary.md"]] {
        assert_eq!(page["html"], serde_json::json!(["<sub>", "</sub>"]));
        assert_eq!(list(&page["cells"]).len(), 1, "all rows are as wide: {}", page["cells"]);
        let links: Vec<&str> = list(&page["links"]).iter().map(text).collect();
        assert!(links.iter().all(|l| l.ends_with(".md") && l.contains("/docs/causes/")), "{links:?}");
        assert!(
            list(&page["code"]).iter().any(|c| text(c).starts_with("gonio check mutant-no-jacobian --theta"))
        );
    }
    let folder = ran().folder.path().join("materials/out");
    let pictures: Vec<&str> = list(&page["pictures"]).iter().map(text).collect();
    assert!(!pictures.is_empty() && pictures.iter().all(|p| folder.join(p).is_file()), "{pictures:?}");
    assert!(list(&seen()["github-summary.md"]["pictures"]).is_empty(), "there is nothing beside it");
}

/// Replaces every text that is not one of a few words.
fn poison(value: &mut Value, with: &str) {
    const FREE: [&str; 17] = [
        "name",
        "label",
        "check",
        "message",
        "reason",
        "command",
        "because",
        "waived_because",
        "statement",
        "repair",
        "cause",
        "suite",
        "gonio",
        "started",
        "channel",
        "partial",
        "runner_up",
    ];
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| poison(item, with)),
        Value::Object(fields) => {
            for (key, field) in fields {
                match field {
                    Value::String(text) if FREE.contains(&key.as_str()) || key == "subject" => {
                        *text = format!("{with}{}", text.len());
                    }
                    other => poison(other, with),
                }
            }
        }
        _ => {}
    }
}

#[test]
fn a_report_whose_every_text_is_hostile_is_read_by_all() {
    let hostile = "</failure><injected a='1'>\"&amp;]]>\u{1b}[31m\u{1b}]0;\0\u{7f}\u{ffff}\u{2028}|`x```%0A%,::error::\n\
        ::set-output name=a::b\r\n# h <script>alert(1)</script> [a](https://evil.example) {0} \\ @a #1 *b* ~~d~~ \u{202e}";
    let mut report = ran().report.clone();
    report["partial"] = "stopped".into();
    poison(&mut report, hostile);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
    let done = gonio(folder.path(), &["report", "report.json", "--to", ALL], &[]);
    assert_eq!(done.status.code(), Some(0), "{}", said(&done.stderr));
    let seen = read(folder.path());
    let cases = list(&seen["junit.xml"]);
    assert_eq!(cases.len(), list(&report["results"]).len());
    assert!(cases.iter().all(|c| text(&c["name"]).contains("<script>alert(1)</script>")));
    for page in ["report.md", "github-summary.md"] {
        assert_eq!(seen[page]["html"], serde_json::json!(["<sub>", "</sub>"]), "{page}");
        assert_eq!(seen[page]["links"], serde_json::json!([]), "{page}");
        assert_eq!(list(&seen[page]["cells"]).len(), 1, "{page}");
    }
    let commands = list(&seen["github-annotations.txt"]);
    assert!(commands.iter().all(|c| text(&c["title"]).starts_with("gonio")), "{commands:?}");
    for result in list(&seen["gonio.sarif"]["results"]) {
        assert_eq!(result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"], "s.toml");
        assert!(!text(&result["message"]["text"]).contains("]("));
    }
}

#[test]
fn outputs_are_the_same_from_the_report_alone_and_lie_where_they_are_wanted() {
    let folder = ran().folder.path();
    let materials = folder.join("materials");
    let done = gonio(&materials, &["report", "out", "--to", ALL, "-o", "elsewhere"], &[]);
    assert_eq!(done.status.code(), Some(0), "{}", said(&done.stderr));
    assert!(done.stdout.is_empty());
    let mut written = 0;
    for entry in std::fs::read_dir(materials.join("elsewhere")).unwrap() {
        let name = entry.unwrap().file_name();
        let text = |folder: &str| std::fs::read_to_string(materials.join(folder).join(&name)).unwrap();
        // Pictures are not there: all but them is the same.
        let lines = |text: &str| -> Vec<String> {
            text.lines()
                .filter(|line| !line.is_empty() && !line.starts_with("!["))
                .map(|line| line.trim_end().to_string())
                .collect()
        };
        assert_eq!(lines(&text("out")), lines(&text("elsewhere")), "{name:?}");
        assert!(!text("elsewhere").contains("!["), "{name:?}");
        written += 1;
    }
    assert_eq!(written, 6);
}

#[test]
fn github_actions_gets_annotations_on_stdout_and_its_summary() {
    let folder = ran().folder.path().join("materials");
    let summary = folder.join("summary.md");
    std::fs::write(&summary, "of another\n").unwrap();
    let variables = [("GITHUB_ACTIONS", "true"), ("GITHUB_STEP_SUMMARY", summary.to_str().unwrap())];
    let words = ["report", "out", "--to", "github", "-o", "actions"];
    let done = gonio(&folder, &words, &variables);
    assert_eq!(done.status.code(), Some(0), "{}", said(&done.stderr));
    let file = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(said(&done.stdout), file("actions/github-annotations.txt"));
    assert_eq!(file("summary.md"), format!("of another\n{}", file("actions/github-summary.md")));
    // What is there already counts: GitHub drops a summary that is too long.
    std::fs::write(&summary, "x".repeat((1 << 20) - 900)).unwrap();
    gonio(&folder, &words, &variables);
    let full = file("summary.md");
    assert!(full.len() <= 1 << 20 && full.trim_end().ends_with("has all."), "{}", full.len());
    let unasked = gonio(&folder, &["report", "out", "--to", "markdown", "-o", "actions"], &variables);
    assert!(unasked.stdout.is_empty());
    let json = ["check", "lambert", "--theta", "30", "--samples", "4096", "-o", "json", "--to", "github"];
    let done = gonio(&folder, &[&json[..], &["--format", "json"]].concat(), &variables);
    assert!(serde_json::from_slice::<Value>(&done.stdout).is_ok(), "{}", said(&done.stdout));
}

#[test]
fn mistakes_are_told_with_what_to_type() {
    let folder = tempfile::tempdir().unwrap();
    for (words, part) in [
        (&["check", "lambert", "--to", "junit"][..], "name the folder: --out DIR"),
        (&["run", "quick", "--to", "junit,xunit"], "possible values: html, junit, sarif, github"),
        (&["report", "nowhere", "--to", "junit"], "name the folder that `gonio run --out DIR` wrote"),
        (&["report", "nowhere", "-o", "x"], "--to"),
    ] {
        let done = gonio(folder.path(), words, &[]);
        assert_eq!(done.status.code(), Some(2), "{words:?}");
        assert!(said(&done.stderr).contains(part), "{words:?}: {}", said(&done.stderr));
    }
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none(), "nothing was written");
}

// ------------------------------------------------------------------ workflows

fn holds_to(schema: &str, path: &Path) {
    let check = tools().python.join("check-jsonschema");
    let done = Command::new(check).args(["--builtin-schema", schema]).arg(path).output().unwrap();
    assert!(done.status.success(), "{}: {}{}", path.display(), said(&done.stdout), said(&done.stderr));
}

#[test]
fn the_action_and_the_snippets_hold_to_their_schemas() {
    holds_to("vendor.github-actions", &Path::new(ROOT).join("action.yml"));
    let folder = tempfile::tempdir().unwrap();
    let manual = std::fs::read_to_string(Path::new(ROOT).join("docs/ci.md")).unwrap();
    let mut held = Vec::new();
    for (k, part) in manual.split("```yaml\n# ").skip(1).enumerate() {
        let (name, rest) = part.split_once('\n').unwrap();
        let path = folder.path().join(format!("{k}.yml"));
        std::fs::write(&path, rest.split("```").next().unwrap()).unwrap();
        match name {
            ".gitlab-ci.yml" => holds_to("vendor.gitlab-ci", &path),
            _ if name.starts_with(".github/workflows/") => holds_to("vendor.github-workflows", &path),
            _ => continue,
        }
        held.push(name);
    }
    assert_eq!(
        held,
        [".github/workflows/materials.yml", ".github/workflows/materials.yml", ".gitlab-ci.yml"]
    );
}

/// The script of a step of action.yml.
fn script(step: &str) -> String {
    let python = tools().python.join("python");
    let code = "import sys; from ruamel.yaml import YAML; \
        steps = YAML(typ='safe').load(open(sys.argv[1]))['runs']['steps']; \
        print(next(s['run'] for s in steps if s['name'] == sys.argv[2]), end='')";
    let path = Path::new(ROOT).join("action.yml");
    let done = Command::new(python).args(["-c", code]).arg(path).arg(step).output().unwrap();
    assert!(done.status.success(), "{}", said(&done.stderr));
    said(&done.stdout)
}

#[test]
fn the_action_s_scripts_take_inputs_as_words_and_fail_last() {
    for step in ["Build gonio", "Measure", "Verdict"] {
        assert!(!script(step).contains("${{"), "{step}: an expression within a script is run as code");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // Tells its words, and writes what the action looks for.
    let double =
        "#!/bin/bash\nprintf '%s\\n' \"$@\" > words\nmkdir -p \"$3\"\ntouch \"$3/gonio.sarif\"\nexit 1\n";
    std::fs::write(path("gonio"), double).unwrap();
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path("gonio"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let measure = |variables: &[(&str, &str)]| {
        let _ = std::fs::remove_file(path("output"));
        let done = Command::new("bash")
            .args(["-eo", "pipefail", "-c", &script("Measure")])
            .current_dir(folder.path())
            .envs([
                ("COMMAND", "./gonio"),
                ("OUT", "o p"),
                ("ARGS", ""),
                ("STRICT", "false"),
                ("BASELINE", ""),
            ])
            .envs([("RUNNER_TEMP", "/nowhere"), ("GITHUB_OUTPUT", "output")])
            .envs(variables.iter().copied())
            .output()
            .unwrap();
        assert!(done.status.success(), "{}", said(&done.stderr));
        let read = |name: &str| std::fs::read_to_string(path(name)).unwrap();
        assert_eq!(read("output"), "exit-code=1\nsarif=true\n", "a failure is told and does not end the job");
        read("words").lines().map(str::to_string).collect::<Vec<_>>()
    };
    let first = ["run", "--out", "o p", "--to", "html,junit,sarif,github,gitlab,markdown"];
    assert_eq!(
        measure(&[("SUITE", "a b.toml\n\nquick\n")]),
        [&first[..], &["--", "a b.toml", "quick"]].concat()
    );
    let hostile = "$(touch pwned); `touch pwned` * \"";
    let words = measure(&[
        ("SUITE", hostile),
        ("ARGS", "--seed 7\n --check $(touch pwned)"),
        ("STRICT", "true"),
        ("BASELINE", hostile),
    ]);
    let more =
        ["--strict", "--baseline", hostile, "--seed", "7", "--check", "$(touch", "pwned)", "--", hostile];
    assert_eq!(words, [&first[..], &more[..]].concat());
    assert!(!path("pwned").exists());
    let verdict = |code: &str| {
        let run = Command::new("bash")
            .args(["-eo", "pipefail", "-c", &script("Verdict")])
            .env("CODE", code)
            .status();
        run.unwrap().code()
    };
    assert_eq!((verdict("0"), verdict("3")), (Some(0), Some(3)));
}
