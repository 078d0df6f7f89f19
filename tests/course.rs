//! The example course: every synthetic submission has the score and the cause of its label,
//! cheats gain nothing and are told of, and the machine is as it was.

mod common;

use common::desk::{Desk, GONIO, done};
use common::tools::tools;
use gonio::grading::Grade;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// The course as a teacher has it: links are files.
fn course(desk: &Desk) -> PathBuf {
    let course = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/course");
    let copied = Command::new("cp").arg("-rL").arg(&course).arg(desk.path("course")).status().unwrap();
    let made = Command::new(desk.path("course/make-class")).arg(desk.path("class")).status().unwrap();
    assert!(copied.success() && made.success());
    desk.path("course")
}

struct Label {
    id: String,
    score: f64,
    causes: BTreeSet<String>,
    what: String,
}

fn labels(course: &Path) -> Vec<Label> {
    let mut reader = csv::Reader::from_path(course.join("labels.csv")).unwrap();
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let causes = row[3].split_whitespace().map(String::from).collect();
        Label { id: row[0].into(), score: row[2].parse().unwrap(), causes, what: row[4].into() }
    });
    rows.collect()
}

/// Slugs of the causes that a grade names.
fn named(grade: &Grade) -> BTreeSet<String> {
    grade.diagnoses.iter().filter_map(|d| d.cause.clone()).collect()
}

/// The table of README.md: true causes, named causes, scores.
fn confusion(labels: &[Label], grades: &BTreeMap<String, Grade>) -> String {
    let mut rows: BTreeMap<&str, Vec<&Grade>> = BTreeMap::new();
    for label in labels {
        for cause in &label.causes {
            rows.entry(cause).or_default().push(&grades[&label.id]);
        }
    }
    let none = labels.iter().filter(|l| l.causes.is_empty()).map(|l| &grades[&l.id]).collect();
    let mut text = String::from("| true cause | submissions | named | scores |\n|---|--:|---|---|\n");
    for (cause, of_it) in rows.into_iter().chain([("none", none)]) {
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for grade in &of_it {
            let causes: Vec<String> = named(grade).into_iter().collect();
            let words = if causes.is_empty() { "none".into() } else { causes.join(" and ") };
            *counts.entry(words).or_default() += 1;
        }
        let mut counts: Vec<(String, usize)> = counts.into_iter().collect();
        counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        let named: Vec<String> = match &counts[..] {
            [(words, 1)] => vec![words.clone()],
            counts => counts.iter().map(|(words, n)| format!("{n} × {words}")).collect(),
        };
        let mut scores: Vec<f64> = of_it.iter().map(|grade| grade.score).collect();
        scores.sort_by(f64::total_cmp);
        let scores: Vec<String> = scores.iter().map(f64::to_string).collect();
        text += &format!("| {cause} | {} | {} | {} |\n", of_it.len(), named.join(", "), scores.join(", "));
    }
    text
}

/// What a submission could have left behind: temporary files, and processes of the harness
/// or of a sandbox.
fn traces(temporary: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(temporary).unwrap().flatten();
    let mut found: BTreeSet<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    for process in std::fs::read_dir("/proc").unwrap().flatten() {
        let command = std::fs::read(process.path().join("cmdline")).unwrap_or_default();
        let command = String::from_utf8_lossy(&command).replace('\0', " ");
        if ["harness.py", "bwrap", "worker confine", "worker guard"].iter().any(|part| command.contains(part))
        {
            found.insert(command);
        }
    }
    found
}

#[test]
fn the_class_of_the_course_is_graded_as_its_labels_say() {
    let python = &tools().python;
    let desk = Desk::new();
    let course = course(&desk);
    let temporary = desk.path("tmp");
    std::fs::create_dir(&temporary).unwrap();
    let (before, files) = (traces(&temporary), desk.files("course"));
    let path = format!("{}:{}", python.display(), std::env::var("PATH").unwrap());
    let mut grade = desk.command(GONIO, "grade course/rubric.toml class -v");
    let graded = done(grade.env("PATH", path).env("TMPDIR", &temporary).timeout(Duration::from_secs(1500)));
    graded.ends(0);
    let labels = labels(&course);
    let read = |id: &str| -> Grade {
        let file = desk.path("grades/submissions").join(id).join("grade.json");
        serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap()
    };
    let grades: BTreeMap<String, Grade> = labels.iter().map(|l| (l.id.clone(), read(&l.id))).collect();
    assert!(labels.len() >= 30 && std::fs::read_dir(desk.path("class")).unwrap().count() == labels.len());
    let mut wrong = Vec::new();
    for label in &labels {
        let grade = &grades[&label.id];
        if grade.score != label.score {
            let why = grade.broken.as_ref().map(|b| format!("{}: {}", b.why, b.said)).unwrap_or_default();
            wrong.push(format!("{}: {} where the label has {} {why}", label.id, grade.score, label.score));
        }
        // What is wrong with a correct one: nothing.
        if label.what.starts_with("correct") || label.what == "the reference" {
            assert!(named(grade).is_empty() && grade.items.iter().all(|i| !i.is_lost()), "{}", label.id);
        }
    }
    let table = confusion(&labels, &grades);
    let readme = std::fs::read_to_string(course.join("README.md")).unwrap();
    let kept =
        readme.split("<!-- confusion -->\n").nth(1).and_then(|rest| rest.split("<!-- /confusion -->").next());
    assert!(wrong.is_empty(), "{wrong:#?}\n{table}");
    assert_eq!(kept, Some(table.as_str()), "examples/course/README.md has another table; this one:\n{table}");

    // What a student is shown as predicted goes through what was counted.
    let report = desk.report("grades/submissions/cpp-no-jacobian");
    let diagnoses = report["diagnoses"].as_array().unwrap().iter();
    let metal = diagnoses.filter(|d| d["subject"].as_str().unwrap().starts_with("metal")).collect::<Vec<_>>();
    assert!(metal.len() >= 3);
    for diagnosis in metal {
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let predicted = diagnosis["profile"]["predicted"].as_array().unwrap();
        let mut compared = 0;
        for bin in diagnosis["profile"]["bins"].as_array().unwrap() {
            let [theta, observed, expected] =
                ["theta_deg", "observed", "expected"].map(|key| number(&bin[key]));
            let off = |pair: &&serde_json::Value| (number(&pair[0]) - theta).abs();
            let nearest = predicted.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            // Bins are wider than the step of the curve; of a wrong density it is off by 2.
            if observed > 200.0 {
                let ratio = observed / expected / number(&nearest[1]);
                assert!((ratio.ln()).abs() < 0.25, "{}: {theta} {ratio}", diagnosis["subject"]);
                compared += 1;
            }
        }
        assert!(compared >= 5, "{}", diagnosis["subject"]);
    }

    // Cheats gain nothing over the same without the cheat, and are told of.
    let honest = grades["python-no-jacobian"].score;
    for (id, told) in [
        ("python-reads-rubric", &["rubric.toml", "/etc/passwd"][..]),
        ("python-writes-its-score", &["results.json"]),
        ("python-forks", &["process"]),
        ("python-opens-socket", &["socket"]),
        ("python-prints-its-score", &[]),
    ] {
        let grade = &grades[id];
        assert!(grade.score <= honest, "{id}");
        for part in told {
            assert!(grade.incidents.iter().any(|i| i.what.contains(part)), "{id}: {:?}", grade.incidents);
        }
    }
    for label in labels.iter().filter(|l| !l.what.starts_with("cheat")) {
        let incidents = &grades[&label.id].incidents;
        assert!(incidents.is_empty(), "{}: {incidents:?}", label.id);
    }
    for label in labels.iter().filter(|l| l.what.starts_with("cheat")) {
        assert!(grades[&label.id].score < 100.0, "{}", label.id);
    }

    // The machine is as it was: the course too, into which some have tried to write.
    let left: Vec<_> = traces(&temporary).difference(&before).cloned().collect();
    assert!(left.is_empty(), "{left:?}");
    assert_eq!(desk.files("course"), files);
    let beside: BTreeSet<String> = std::fs::read_dir(desk.path(""))
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(beside, ["class", "course", "grades", "tmp"].map(String::from).into());
    let written = ["results.json", "grade.json"].map(|name| Path::new("/autograder/results").join(name));
    assert!(written.iter().all(|path| !path.exists()));
}
