//! The page of a report in a browser: what people click, read and print. The pages are
//! made here, the clicking is done by tests/browser/ (pytest and Chromium).

mod common;

use common::tools::tools;
use gonio::bsdf::Direction;
use gonio::checks::Verdict;
use gonio::evidence::Evidence;
use gonio::report::{
    CheckResult, PAGE, Report, evidence_path, html_page, read_evidence, write_evidence, write_report,
};
use gonio::sphere::{Chart, Partition, Shape};
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::Instant;

const SUITE: &str = r#"
[suite]
name = "browser"
theta = [0, 30, 60]
samples = "2^16"
detect = 0.3

[[subject]]
use = "lambert"

[[subject]]
use = "torrance-sparrow"
alpha = [0.02, 0.5]

[[subject]]
use = "rough-dielectric"
alpha = 0.2
theta = [30]

[[subject]]
use = "mutant-no-jacobian"

[[subject]]
use = "mutant-value-over-wi-n"

[[subject]]
use = "lambert"
label = "waived for no reason"
reflectance = 0.25
waive = [{ check = "energy", because = "an old <bug>" }]
"#;

/// A name that wants out of every place where a page shows one.
const HOSTILE: &str = "</script><script>window.hacked=1</script><img src=x onerror=window.hacked=1>\"' onmouseover=\"window.hacked=1\u{202e}:a=<!--,b=]]>";

/// Where the pages lie, in folders of their own.
fn pages() -> &'static Path {
    static PAGES: OnceLock<PathBuf> = OnceLock::new();
    PAGES.get_or_init(|| {
        let pages = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pages");
        let _ = std::fs::remove_dir_all(&pages);
        std::fs::create_dir_all(&pages).unwrap();
        let suite = pages.join("suite.toml");
        std::fs::write(&suite, SUITE).unwrap();
        let failing = pages.join("failing");
        let run = Command::new(env!("CARGO_BIN_EXE_gonio"))
            .args(["run", "-q", "--plots", "all", "-o"])
            .args([&failing, &suite])
            .output()
            .unwrap();
        assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stderr));
        let report: Report =
            serde_json::from_slice(&std::fs::read(failing.join("report.json")).unwrap()).unwrap();
        hostile(&pages, &report);
        detached(&pages, &report);
        compared(&pages, &report);
        shapes(&pages, &report);
        pages
    })
}

fn linked(pages: &Path, folder: &str) -> PathBuf {
    let folder = pages.join(folder);
    std::fs::create_dir_all(folder.join("evidence")).unwrap();
    for file in std::fs::read_dir(pages.join("failing/evidence")).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), folder.join("evidence").join(file.file_name())).unwrap();
    }
    folder
}

/// The same report from a subject that means harm.
fn hostile(pages: &Path, report: &Report) {
    let folder = linked(pages, "hostile");
    let mut report = report.clone();
    let name = "mutant-no-jacobian";
    for result in report.results.iter_mut().filter(|r| r.subject.name == name) {
        result.subject.name = HOSTILE.into();
        result.subject.label = Some(HOSTILE.into());
        result.message = HOSTILE.into();
        result.reason = Some(HOSTILE.into());
        result.command = HOSTILE.into();
        result.plot = Some("javascript:window.hacked=1//".into());
    }
    for found in report.diagnoses.iter_mut().filter(|d| d.subject == name) {
        found.subject = HOSTILE.into();
        found.statement = HOSTILE.into();
        found.cause = Some(HOSTILE.into());
        found.evidence = vec![HOSTILE.into()];
        found.page = Some("javascript:window.hacked=1".into());
    }
    report.suite = HOSTILE.into();
    report.partial = Some(HOSTILE.into());
    write_report(&folder, &report).unwrap();
    write_page(&folder, &report);
}

/// Writes a report's page beside it.
fn write_page(folder: &Path, report: &Report) -> PathBuf {
    let path = folder.join(PAGE);
    std::fs::write(&path, html_page(folder, report)).unwrap();
    path
}

/// A page that has lost its evidence, which lies elsewhere.
fn detached(pages: &Path, report: &Report) {
    let folder = pages.join("detached");
    std::fs::create_dir_all(&folder).unwrap();
    write_page(&folder, report);
    // Too late for the page to carry it, in time for the browser to fetch it.
    linked(pages, "detached");
}

/// A page that tells what changed since a report in which another subject failed.
fn compared(pages: &Path, report: &Report) {
    let folder = linked(pages, "compared");
    write_report(&folder, report).unwrap();
    let mut before = report.clone();
    for result in &mut before.results {
        match (result.subject.name.as_str(), result.check.as_str()) {
            ("lambert", "energy") => result.verdict = Verdict::Fail,
            ("mutant-no-jacobian", "normalization") => result.verdict = Verdict::Pass,
            _ => {}
        }
    }
    before.results.retain(|r| !r.subject.name.starts_with("rough-dielectric"));
    let earlier = pages.join("earlier");
    write_report(&earlier, &before).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_gonio"))
        .args(["report", "--to", "html", "--baseline"])
        .args([&earlier, &folder])
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// Cells in charts of every shape, and what the library finds at directions.
fn shapes(pages: &Path, report: &Report) {
    let folder = pages.join("shapes");
    let result = report.results.iter().find(|r| r.subject.name == "lambert").unwrap();
    let path = result.evidence.as_ref().unwrap();
    let measured = read_evidence(&pages.join("failing").join(path)).unwrap();
    let (mut results, mut expected) = (Vec::new(), Vec::new());
    let shapes = [Shape::EqualArea, Shape::ProjectedConcentric, Shape::ProjectedCylindrical];
    for (number, shape) in shapes.into_iter().enumerate() {
        let evidence = counted(&measured, shape);
        let path = write_evidence(&folder, number, &evidence).unwrap();
        let partition = evidence.partition.as_ref().unwrap();
        let integrals = evidence.integrals.as_ref().unwrap();
        let draws = &evidence.draws[0];
        let found: Vec<serde_json::Value> = spiral(997)
            .map(|d| {
                let leaf = partition.locate_direction(d);
                let cell = partition.leaf_cell(leaf);
                serde_json::json!({
                    "direction": [d.x, d.y, d.z],
                    "observed": draws.counts[leaf],
                    "expected": integrals.pdf[leaf] * draws.samples as f64,
                    "steradians": partition.chart().solid_angle(&cell),
                })
            })
            .collect();
        expected.push(serde_json::json!({ "evidence": path, "found": found }));
        let mut result: CheckResult = result.clone();
        result.subject.name = format!("{shape:?}").to_lowercase();
        result.evidence = Some(path);
        results.push(result);
    }
    let report = Report { results, diagnoses: Vec::new(), ..report.clone() };
    write_report(&folder, &report).unwrap();
    write_page(&folder, &report);
    std::fs::write(folder.join("expected.json"), serde_json::to_vec(&expected).unwrap()).unwrap();
}

fn spiral(n: u32) -> impl Iterator<Item = Direction> {
    (0..n).map(move |k| {
        let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(n);
        Direction::from_angles(z.acos(), (f64::from(k) * 2.399963) % TAU)
    })
}

/// Counts that differ from cell to cell.
fn counted(measured: &Evidence, shape: Shape) -> Evidence {
    let mut evidence = measured.clone();
    let chart = Chart::new(0.7).shaped(shape);
    let pilot = spiral(1 << 14).map(|d| chart.to_point(d)).collect();
    let tree = Partition::build(chart, pilot, 512);
    let counts: Vec<u64> = (0..tree.len() as u64).map(|leaf| 1000 + 7 * leaf).collect();
    let samples: u64 = counts.iter().sum();
    let integrals = evidence.integrals.as_mut().unwrap();
    integrals.pdf = (0..tree.len()).map(|leaf| (900 + 5 * leaf) as f64 / samples as f64).collect();
    evidence.draws.truncate(1);
    evidence.draws[0].counts = counts;
    evidence.draws[0].samples = samples;
    evidence.partition = Some(tree);
    evidence
}

/// A real report over and over: 2000 subjects of 12 checks, two in a hundred of which fail.
fn large(pages: &Path) {
    let folder = pages.join("large");
    let source = pages.join("failing");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("evidence")).unwrap();
    let report: Report = serde_json::from_slice(&std::fs::read(source.join("report.json")).unwrap()).unwrap();
    let checks: Vec<&str> = gonio::checks::all().iter().map(|c| c.id()).take(12).collect();
    let of = |name: &str| -> Vec<&CheckResult> {
        let results = report.results.iter();
        results.filter(|r| r.subject.name == name && checks.contains(&r.check.as_str())).collect()
    };
    let (passing, failing) = (of("torrance-sparrow:alpha=0.5"), of("mutant-no-jacobian"));
    assert!(
        passing.len() > 12 && passing.iter().all(|r| matches!(r.verdict, Verdict::Pass | Verdict::Skipped))
    );
    assert!(failing.iter().any(|r| r.verdict == Verdict::Fail));
    let found = report.diagnoses.iter().find(|d| d.subject == "mutant-no-jacobian").unwrap();
    let mut large =
        Report { results: Vec::new(), diagnoses: Vec::new(), waivers: Vec::new(), ..report.clone() };
    let mut cases = 0;
    for number in 0..2000 {
        let wrong = number % 50 == 7;
        let name = format!("material-{number}:alpha=0.5,layer={}", number % 7);
        let mut of_case: Vec<(String, String)> = Vec::new();
        for result in if wrong { &failing } else { &passing } {
            let from = result.evidence.clone().unwrap();
            let known = of_case.iter().find(|(known, _)| *known == from).map(|(_, path)| path.clone());
            let path = known.unwrap_or_else(|| {
                let path = evidence_path(cases);
                cases += 1;
                std::fs::hard_link(source.join(&from), folder.join(&path)).unwrap();
                of_case.push((from, path.clone()));
                path
            });
            let mut result = (*result).clone();
            result.subject.name = name.clone();
            result.evidence = Some(path);
            large.results.push(result);
        }
        if wrong {
            large.diagnoses.push(gonio::report::Diagnosis { subject: name, ..found.clone() });
        }
    }
    let count = |verdict| large.results.iter().filter(|r| r.verdict == verdict).count();
    (large.summary.passed, large.summary.failed) = (count(Verdict::Pass), count(Verdict::Fail));
    let names: BTreeSet<&str> = large.results.iter().map(|r| r.subject.name.as_str()).collect();
    let met: BTreeSet<&str> = large.results.iter().map(|r| r.check.as_str()).collect();
    assert_eq!((names.len(), met.len()), (2000, 12));
    let begun = Instant::now();
    let path = write_page(&folder, &large);
    let size = std::fs::metadata(path).unwrap().len();
    println!("{cases} cases: {:.1} MB in {:.1} s", size as f64 / 1e6, begun.elapsed().as_secs_f64());
    assert!(size < 20_000_000, "{size} bytes");
}

/// Runs a file of tests/browser/.
fn clicks(file: &str) {
    let tools = tools();
    let run = Command::new(tools.python.join("python"))
        .args(["-m", "pytest", "-q", "-p", "no:cacheprovider", file])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("GONIO_PAGES", pages())
        .env("GONIO_SCREENSHOTS", tools.target.join("screenshots"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&run.stdout);
    println!("{told}");
    assert!(run.status.success(), "{told}{}", String::from_utf8_lossy(&run.stderr));
}

#[test]
fn people_find_the_bug_in_two_clicks() {
    clicks("test_reading.py");
}

#[test]
fn discs_tell_what_the_evidence_says() {
    clicks("test_discs.py");
}

#[test]
fn everybody_can_read_it() {
    clicks("test_access.py");
}

#[test]
fn nothing_harms_and_nothing_is_fetched() {
    clicks("test_safety.py");
}

#[test]
fn two_thousand_subjects_open_at_once() {
    large(pages());
    clicks("test_large.py");
}
