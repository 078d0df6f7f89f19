//! Diagnoses as they reach people and machines.

use assert_cmd::Command;
use gonio::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use gonio::cause::Cause;
use gonio::diagnosis::{Claim, Diagnosed, Explanation, Textbook, View, diagnose_all, diagnose_here};
use gonio::engine::{Options, Results, run};
use gonio::registry::{Model, Registry};
use gonio::report::{Diagnosis, schema_text};
use gonio::suite::{Overrides, load};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// stdout as JSON and stderr of a command that is not asked for its exit code.
fn gonio(line: &str) -> (Value, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    let output = command.args(line.split_whitespace()).env_remove("COLUMNS").output().unwrap();
    (serde_json::from_slice(&output.stdout).unwrap_or_default(), String::from_utf8(output.stderr).unwrap())
}

/// What a mutant is found to be.
const FOUND: [(&str, &str); 6] = [
    ("mutant-no-jacobian --theta 60", "half-vector-jacobian"),
    ("mutant-shares-forgotten --theta 60", "lobe-probability"),
    ("mutant-eta-squared-in-pdf --theta 60", "refraction-jacobian"),
    ("mutant-masking-of-wo-only --theta 60", "masking"),
    ("mutant-loss-of-incident-twice --theta 30 --theta 75", "energy-compensation"),
    ("mutant-fresnel-at-wo --theta 60", "fresnel-argument"),
];

#[test]
fn the_cause_is_in_the_report_and_on_the_terminal() {
    let schema: Value = serde_json::from_str(&schema_text()).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    for (line, slug) in FOUND {
        let (report, err) = gonio(&format!("check {line} --samples 32768 --format json"));
        let breaches: Vec<_> = validator.iter_errors(&report).map(|e| e.to_string()).collect();
        assert_eq!(breaches, Vec::<String>::new(), "{line}");
        let [found] = &report["diagnoses"].as_array().unwrap()[..] else { panic!("{line}: {report:#}") };
        assert_eq!((&found["cause"], &found["confident"]), (&slug.into(), &true.into()), "{found:#}");
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join(found["page"].as_str().unwrap());
        assert!(page.is_file() && found["subject"] == report["results"][0]["subject"]["name"], "{found:#}");
        let words: Vec<&str> = err.split_whitespace().collect();
        let told = words.join(" ");
        for part in [
            format!("cause: {} [{slug}]", found["statement"].as_str().unwrap()),
            format!("repair: {}", found["repair"].as_str().unwrap()),
            format!("since: {}", found["evidence"][0].as_str().unwrap()),
            format!("more: gonio explain {slug}"),
        ] {
            assert!(told.contains(&part), "no `{part}` in\n{err}");
        }
        assert_eq!(told.matches("cause: ").count(), 1, "once a subject\n{err}");
        let explained = Command::new(env!("CARGO_BIN_EXE_gonio")).args(["explain", slug]).output().unwrap();
        assert!(explained.status.success());
    }
}

#[test]
fn a_correct_subject_has_no_diagnosis() {
    let (report, err) = gonio("check torrance-sparrow --theta 60 --samples 32768 --format json");
    assert_eq!(report["diagnoses"], Value::Array(Vec::new()));
    assert!(report["summary"]["failed"] == 0 && !err.contains("cause"), "{err}");
}

#[test]
fn a_saved_report_tells_its_diagnoses_again() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    gonio(&format!("check mutant-no-jacobian --theta 60 --samples 32768 --plots none --quiet -o {out}"));
    let file = folder.path().join("report.json");
    let before = std::fs::read_to_string(&file).unwrap();
    let (_, err) = gonio(&format!("report {out} --plots none"));
    assert!(err.contains("\nmutant-no-jacobian\n    cause: pdf() lacks the Jacobian"), "{err}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), before);
}

// ------------------------------------------------------------- the library

/// Lambert whose pdf is told this often; it may sleep, and counts its calls.
struct Matte {
    pdf: f64,
    calls: Arc<AtomicU64>,
    sleeps: Duration,
}

impl Matte {
    fn new(pdf: f64) -> Self {
        Self { pdf, calls: Arc::default(), sleeps: Duration::ZERO }
    }
}

impl Bsdf for Matte {
    fn describe(&self) -> Description {
        Description::new("matte").dimensions(2)
    }

    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        self.calls.fetch_add(1, Ordering::Relaxed);
        std::thread::sleep(self.sleeps);
        Spectrum::from(if wo.z > 0.0 && wi.z > 0.0 { 0.5 / PI } else { 0.0 })
    }

    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        self.calls.fetch_add(1, Ordering::Relaxed);
        if wo.z > 0.0 && wi.z > 0.0 { self.pdf * wi.z / PI } else { 0.0 }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        self.calls.fetch_add(1, Ordering::Relaxed);
        let wi = Direction::from_angles(u[0].sqrt().asin(), 2.0 * PI * u[1]);
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        (pdf > 0.0).then(|| Sample {
            wi,
            weight: Spectrum::from(0.5 / self.pdf),
            pdf,
            lobe: Lobe::DIFFUSE_REFLECTION,
        })
    }
}

/// A registry with one model.
fn registry(pdf: f64, calls: &Arc<AtomicU64>, sleeps: Duration) -> Registry {
    let calls = calls.clone();
    Registry::empty()
        .register(Model::new("matte", "a wall", move |_| Ok(Matte { pdf, calls: calls.clone(), sleeps })))
}

/// Runs a suite of it, with one more line for the subject.
fn results(registry: &Registry, line: &str) -> Results<'static> {
    within(60, registry, line)
}

/// The same within so many seconds.
fn within(seconds: u32, registry: &Registry, line: &str) -> Results<'static> {
    let text = format!(
        "[suite]\nname = \"s\"\nsamples = 32768\ndetect = 1\ntheta = [30, 75]\nphi = 17\ntime_limit = {seconds}\n\
         [[subject]]\nuse = \"matte\"\n{line}"
    );
    let plan = load("s", &text, registry, &Overrides::default()).unwrap().plan;
    run(&plan, &Options::default(), &mut |_| {})
}

fn diagnosed(registry: &Registry, results: &Results<'static>, options: &Options) -> Vec<Diagnosed> {
    diagnose_all(results, &Arc::new(registry.explanations()), options)
}

#[test]
fn threads_change_nothing_and_an_interrupt_ends_it() {
    let registry = registry(1.1, &Arc::default(), Duration::ZERO);
    let results = results(&registry, "");
    let on = |threads| {
        let options = Options { threads: Some(threads), ..Options::default() };
        Diagnosis::all(&results, diagnosed(&registry, &results, &options))
    };
    assert_eq!(on(1), on(2));
    assert_eq!(on(1), Diagnosis::all(&results, diagnose_here(&results, &[])));
    assert_eq!(on(1)[0].cause.as_deref(), Some("constant-factor"));
    let stopped = Options { stop: Arc::new(AtomicBool::new(true)), ..Options::default() };
    assert!(diagnosed(&registry, &results, &stopped).is_empty());
}

#[test]
fn waived_failures_have_no_diagnosis() {
    let registry = registry(1.1, &Arc::default(), Duration::ZERO);
    let waive = ["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]
        .map(|check| format!("{{ check = \"{check}\", because = \"a test\" }}"));
    let results = results(&registry, &format!("waive = [{}]", waive.join(", ")));
    assert!(results.cases.iter().any(|c| c.worst() == gonio::checks::Verdict::Waived));
    assert!(diagnosed(&registry, &results, &Options::default()).is_empty());
}

#[test]
fn what_took_too_long_is_not_called_again() {
    let calls = Arc::default();
    let registry = registry(1.1, &calls, Duration::from_millis(2));
    let results = within(1, &registry, "");
    assert!(results.cases.iter().any(|c| c.worst() == gonio::checks::Verdict::Error));
    // A thread that was given up may be in its last call.
    let mut before = u64::MAX;
    while std::mem::replace(&mut before, calls.load(Ordering::Relaxed)) != before {
        std::thread::sleep(Duration::from_secs(1));
    }
    assert!(diagnosed(&registry, &results, &Options::default()).is_empty());
    assert_eq!(calls.load(Ordering::Relaxed), before);
}

/// An explanation of one's own.
fn house_rule(view: &View, _: Option<&Textbook>) -> Vec<Claim> {
    let one = |p: &gonio::diagnosis::Point| p.pdf == 0.0 || (p.pdf * PI / p.wi.z - 1.25).abs() < 1e-9;
    if !view.cases.iter().flat_map(|c| &c.points).all(one) {
        return Vec::new();
    }
    vec![Claim::new(Cause::Table, "pdf() has the house factor 5/4", "drop it").price(0.0)]
}

fn panics(_: &View, _: Option<&Textbook>) -> Vec<Claim> {
    panic!("an explanation with a bug")
}

#[test]
fn a_registry_s_own_explanation_takes_part() {
    let own = registry(1.25, &Arc::default(), Duration::ZERO).explanation(house_rule);
    let found = results(&own, "");
    let said = Diagnosis::all(&found, diagnosed(&own, &found, &Options::default()));
    assert_eq!((said[0].cause.as_deref(), said[0].statement.contains("house factor")), (Some("table"), true));
    let other = registry(1.1, &Arc::default(), Duration::ZERO).explanation(house_rule);
    let found = results(&other, "");
    let said = Diagnosis::all(&found, diagnosed(&other, &found, &Options::default()));
    assert_eq!(said[0].cause.as_deref(), Some("constant-factor"));
    let broken: Vec<Box<dyn Explanation>> = vec![Box::new(panics)];
    assert!(diagnose_here(&found, &broken).is_empty(), "no diagnosis, and no end of the run");
}

#[test]
fn assert_valid_tells_the_cause() {
    let failed = std::panic::catch_unwind(|| gonio::assert_valid(&Matte::new(1.1))).unwrap_err();
    let message = failed.downcast_ref::<String>().unwrap();
    assert!(message.contains("gonio found the BSDF wrong:\n  fail"), "{message}");
    assert!(message.contains("\n    cause: ") && message.contains("[constant-factor]"), "{message}");
    gonio::assert_valid(&Matte::new(1.0));
}

#[test]
fn the_gallery_s_links_lead_somewhere() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let page = std::fs::read_to_string(docs.join("gallery.md")).unwrap();
    let targets: Vec<&str> = page.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    assert!(targets.iter().filter(|t| t.ends_with(".svg")).count() >= 5, "{targets:?}");
    for target in targets {
        assert!(docs.join(target).is_file(), "{target}");
    }
    assert_eq!(page.matches("    cause: ").count(), page.matches("\n## ").count());
}

/// Some mutants of each cause with random parameters: the right cause first, as often as
/// calibration asks for, and no wrong one with confidence.
#[test]
fn causes_are_named_at_random_parameters() {
    let rows = gonio::calibration::quick_diagnoses(7);
    let wrong: Vec<_> = rows.iter().filter_map(|r| r.declared.wrong.as_ref()).collect();
    let sum =
        |of: fn(&gonio::calibration::Named) -> usize| rows.iter().map(|r| of(&r.declared)).sum::<usize>();
    assert!(sum(|n| n.confirmed) >= 60, "{rows:?}");
    assert!(10 * sum(|n| n.first) >= 9 * sum(|n| n.confirmed), "{wrong:?}");
    assert_eq!(sum(|n| n.confidently_wrong), 0, "{wrong:?}");
}
