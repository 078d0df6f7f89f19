//! Whole folders of grades.

use super::examples::{SEED, broken, evidence_in, hostile, report, whole};
use super::*;
use crate::grading::Grade;
use std::collections::BTreeMap;
use std::path::Path;

const AGAIN: &str = "gonio grade --self rubric.toml .";
const BOTH: [System; 2] = [System::Gradescope, System::PrairieLearn];

/// Writes a student; measured in `measured`.
fn student(folder: &Path, measured: &Path, grade: &Grade) {
    let command =
        |item: &str| format!("gonio grade rubric.toml submissions --only {} --item {item}", grade.id);
    let told = Told { measured, to: &BOTH, again: AGAIN, command: &command };
    let report = report(&["metal:alpha=0.1", "metal:alpha=0.7734"]);
    write_student(folder, grade, Some(&report), &told).unwrap();
}

/// Every file below a folder, by its path from there.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => open.push(path),
                false => {
                    let name = path.strip_prefix(folder).unwrap().display().to_string();
                    found.insert(name, std::fs::read(&path).unwrap());
                }
            }
        }
    }
    found
}

fn text<'a>(files: &'a BTreeMap<String, Vec<u8>>, name: &str) -> &'a str {
    std::str::from_utf8(files.get(name).unwrap_or_else(|| panic!("no {name}"))).unwrap()
}

#[test]
fn a_student_has_pages_results_and_appeals() {
    let measured = tempfile::tempdir().unwrap();
    let evidence = evidence_in(measured.path());
    let out = tempfile::tempdir().unwrap();
    student(out.path(), measured.path(), &whole(&evidence));
    let written = files(out.path());
    let names: Vec<&str> = written.keys().map(String::as_str).collect();
    let expected = [
        "appeals/1042/grazing/README.md",
        "appeals/1042/grazing/case-0003.json.gz",
        "appeals/1042/grazing/discs.svg",
        "appeals/1042/nan/README.md",
        "appeals/1042/nan/case-0003.json.gz",
        "appeals/1042/nan/discs.svg",
        "appeals/1042/pdf/README.md",
        "appeals/1042/pdf/case-0003.json.gz",
        "appeals/1042/pdf/discs.svg",
        "appeals/1042/pdf/plane.svg",
        "appeals/1042/sampling/README.md",
        "appeals/1042/secret/README.md",
        "feedback/1042.html",
        "feedback/1042.md",
        "gradescope/1042.json",
        "prairielearn/1042.json",
    ];
    assert_eq!(names, expected);
    let readme = text(&written, "appeals/1042/pdf/README.md");
    for part in [
        "# Title of pdf: 1.33 points lost",
        "Seed 8231977, gonio 0.1.0, kept apart by wasm.",
        "gonio grade rubric.toml submissions --only 1042 --item pdf",
        "- subject: `metal:alpha=0.1`",
        "- direction: θo 30° φo 17°, Radiance",
        "- error: ∫pdf / P(sample) − 1 = 126.00 % (125.00 to 127.00 %), tolerated 0.10 %",
        "- worst at θi 28.65° φi 194.8°: expected = 34.9825, observed = 858",
        "[discs.svg](discs.svg)",
        "| `metal:alpha=0.1` | `goodness-of-fit` | θo 60° φo 17° | fail |",
        "(`half-vector-jacobian`)",
    ] {
        assert!(readme.contains(part), "no {part}:\n{readme}");
    }
    let secret = text(&written, "appeals/1042/secret/README.md");
    assert!(secret.contains("hidden from students") && secret.contains("alpha=0.7734"), "{secret}");
}

#[test]
fn nothing_hidden_is_in_any_file_for_students() {
    let measured = tempfile::tempdir().unwrap();
    let mut grade = whole(&evidence_in(measured.path()));
    for item in grade.items.iter_mut().filter(|item| item.hidden) {
        item.lost[0].evidence = grade_evidence(measured.path());
    }
    let out = tempfile::tempdir().unwrap();
    student(out.path(), measured.path(), &grade);
    let written = files(out.path());
    let of_students = written.keys().filter(|name| !name.starts_with("appeals/"));
    let mut count = 0;
    for name in of_students {
        let text = text(&written, name);
        for part in [SEED.to_string().as_str(), "0.7734", "a hidden message", "could not decide", "78.9"] {
            assert!(!text.contains(part), "{part} in {name}");
        }
        // The manual's pages name other causes, and the page of a told cause is folded in.
        assert!(!text.contains("causes/masking") || name.ends_with(".html"), "{name}");
        assert!(text.contains("Text of secret."), "{name}");
        count += 1;
    }
    assert_eq!(count, 4);
}

/// Evidence of a direction that only a hidden item has.
fn grade_evidence(folder: &Path) -> Option<String> {
    use crate::report::lobes::{Lobe, evidence};
    let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
    Some(
        crate::report::write_evidence(folder, 9, &evidence("metal:alpha=0.7734", 78.9, 17.0, lobe, lobe))
            .unwrap(),
    )
}

#[test]
fn appeals_of_a_point_that_is_given_back_are_gone() {
    let out = tempfile::tempdir().unwrap();
    let nowhere = out.path().join("nowhere");
    let mut grade = whole("evidence/case-0003.json.gz");
    student(out.path(), &nowhere, &grade);
    assert!(out.path().join("appeals/1042/pdf/README.md").exists());
    grade.items[1].earned = grade.items[1].points;
    student(out.path(), &nowhere, &grade);
    assert!(!out.path().join("appeals/1042/pdf").exists() && out.path().join("appeals/1042/nan").exists());
}

#[test]
fn hostile_names_stay_within_the_folder() {
    let measured = tempfile::tempdir().unwrap();
    let out = tempfile::tempdir().unwrap();
    let inner = out.path().join("grades");
    for id in ["../../x", "..", "/etc/x", "a/b", "a\nb"] {
        let grade = Grade { id: id.into(), ..hostile(&evidence_in(measured.path())) };
        student(&inner, measured.path(), &grade);
    }
    let written = files(out.path());
    assert!(written.keys().all(|name| name.starts_with("grades/")), "{:?}", written.keys());
    assert_eq!(written.keys().filter(|name| name.ends_with(".html")).count(), 5);
}

#[test]
fn a_class_is_written_with_its_tables() {
    let out = tempfile::tempdir().unwrap();
    let known = placeholders(["pdf"], ["name"]);
    let moodle = Export::new("moodle.csv", [("Name", "{name}"), ("Grade", "{score}")], &known).unwrap();
    let grades = [broken(), whole("")];
    let fairness = Fairness::new(2e-4, 2);
    let class = Class { title: "t", grades: &grades, fairness, exports: &[moodle], again: AGAIN };
    let paths = write_class(out.path(), &class).unwrap();
    let names: Vec<_> = paths.iter().map(|p| p.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["index.html", "gradebook.csv", "moodle.csv"]);
    let written = files(out.path());
    assert_eq!(text(&written, "moodle.csv"), "Name,Grade\nAda Lovelace,4.1667\nAda Lovelace,0\n");
}

#[test]
fn a_folder_that_cannot_be_written_is_told_with_its_path() {
    let out = tempfile::tempdir().unwrap();
    std::fs::write(out.path().join("feedback"), "a file").unwrap();
    let told = Told { measured: out.path(), to: &[], again: "", command: &|_| String::new() };
    let error = write_student(out.path(), &broken(), None, &told).unwrap_err();
    assert!(error.to_string().contains("feedback/1043.html"), "{error}");
}
