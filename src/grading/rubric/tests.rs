use super::*;
use crate::bsdf::Precision;
use crate::grading::{Hints, ItemKind};
use std::path::PathBuf;
use std::time::Duration;
use tempfile::TempDir;

const RUBRIC: &str = r#"
[rubric]
title = "Two models"
hidden = "hidden.toml"
solution = "solution"
seed = 3
false_alarm = 1e-4
precision = "f32"
hints = "region"
samples = "2^14"
theta = [30, 70]
call_limit = 2
limit = 40

[submissions]
pattern = '(?<name>.+)_(?<number>\d+)'
id = "{number}"

[sandbox]
processes = 9
disk = 64
read = ["~/tools", "beside"]

[[language]]
name = "C"
when = "brdf.c"
files = ["given.h"]
build = "cc brdf.c"
library = "brdf.so"

[model.paint]
claims = { isotropic = true }

[[export]]
file = "moodle.csv"
columns = { Identifier = "Participant {number}", Grade = "{score}", "Item A" = "{items.a}", Empty = "" }

[[item]]
id = "a"
points = 1

[[item]]
id = "b"
title = "Second"
points = 2.5
kind = "bonus"
credit = "whole"
needs = ["a"]
subject = ["paint:alpha=0.1", "paint"]
checks = ["reference", "sanity", "sanity"]
reference = "solution"
within = 0.01
theta = 80
hints = "full"
claims = { lossless = true }
"#;

const HIDDEN: &str =
    "seed = 99\n[[item]]\nid = 'c'\npoints = 1\nneeds = 'b'\nsubject = 'paint'\nchecks = 'mis'\n";

fn folder(rubric: &str, hidden: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("rubric.toml", rubric), ("hidden.toml", hidden), ("given.h", "")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("rubric.toml");
    (folder, path)
}

#[test]
fn a_rubric_is_read_as_it_is_written() {
    let (folder, path) = folder(RUBRIC, HIDDEN);
    let rubric = load(&path, true).unwrap();
    assert_eq!((rubric.title.as_str(), rubric.seed, rubric.hidden), ("Two models", 99, true));
    assert_eq!((rubric.false_alarm, rubric.precision), (1e-4, Precision::F32));
    assert_eq!((rubric.limit, rubric.max()), (Duration::from_secs(40), 2.0));
    assert_eq!(rubric.solution, Some(folder.path().join("solution")));
    assert_eq!(rubric.sandbox.processes, 9);
    assert_eq!(rubric.sandbox.disk, 64 << 20);
    assert!(rubric.sandbox.read[0].is_absolute(), "{:?}", rubric.sandbox.read);
    assert_eq!(rubric.languages[0].route, Route::Library("brdf.so".into()));
    assert_eq!(rubric.languages[0].files, [folder.path().join("given.h")]);
    assert_eq!(rubric.exports[0].file(), "moodle.csv");
    let [a, b, c] = &rubric.items[..] else { panic!("{:?}", rubric.items) };
    assert!(a.subjects.is_empty() && a.kind == ItemKind::Regular && a.title == "a");
    assert_eq!((b.kind, b.credit, b.hints, b.points), (ItemKind::Bonus, Credit::Whole, Hints::Full, 2.5));
    assert_eq!(b.checks, ["sanity", "reference"], "in the order of reports, once");
    assert_eq!((&b.theta[..], &b.phi[..]), (&[80.0][..], &[17.0][..]));
    assert_eq!((b.claims.lossless, b.within), (Some(true), Some(0.01)));
    assert_eq!((b.settings.samples, b.settings.limits.call), (1 << 14, Duration::from_secs(2)));
    assert!(c.hidden && !b.hidden);
    assert_eq!((&c.theta[..], c.hints), (&[30.0, 70.0][..], Hints::Region), "as the rubric says");
}

#[test]
fn students_do_without_the_hidden_part() {
    let (folder, path) = folder(RUBRIC, HIDDEN);
    std::fs::remove_file(folder.path().join("hidden.toml")).unwrap();
    let rubric = load(&path, false).unwrap();
    assert_eq!((rubric.seed, rubric.hidden, rubric.items.len()), (3, false, 2));
    let lines = load(&path, true).unwrap_err().lines();
    assert!(
        lines.len() == 1 && lines[0].contains("hidden.toml cannot be read") && lines[0].contains("--self")
    );
}

#[test]
fn mistakes_are_told_with_what_to_type() {
    for (before, after, part) in [
        ("seed = 3", "sead = 3", "did you mean `seed`?"),
        ("[sandbox]", "[sandbx]", "did you mean `sandbox`?"),
        ("processes = 9", "processes = 0", "whole number"),
        ("points = 2.5", "points = -2", "not a positive number"),
        ("id = \"b\"", "id = \"a\"", "another item is called `a`"),
        ("id = \"b\"", "id = \"b/..\"", "is no id"),
        ("needs = [\"a\"]", "needs = [\"b\"]", "no item before this one is called `b`"),
        ("\"sanity\", \"sanity\"", "\"sanety\"", "did you mean `sanity`?"),
        ("reference = \"solution\"\n", "", "nothing to compare with"),
        ("\"reference\", ", "", "no check looks at"),
        ("\"paint\"]", "\"pant\"]", "is no [model] of the rubric"),
        ("\"paint\"]", "\"paint:alpha\"]", "not KEY=VALUE"),
        ("\"paint\"]", "\"paint:alpha=0.1\"]", "twice"),
        ("hints = \"full\"", "hints = \"all\"", "value of `hints`"),
        ("library = \"brdf.so\"", "library = \"../brdf.so\"", "in its own folder"),
        ("library = \"brdf.so\"\n", "", "in one way what is measured"),
        ("when = \"brdf.c\"\n", "", "without `when`"),
        ("given.h", "taken.h", "does not exist"),
        ("{number}\"\n\n[sandbox]", "{nummer}\"\n\n[sandbox]", "did you mean {number}?"),
        (r"(?<number>\d+)", r"(?<number>\d+", "no regular expression"),
        ("isotropic = true", "isotropc = true", "did you mean `isotropic`?"),
        ("solution = \"solution\"\n", "", "a rubric without `solution`"),
        (
            "[[item]]\nid = \"a\"\npoints = 1",
            "[[item]]\nid = \"a\"\npoints = 1\nkind = \"bonus\"",
            "a maximum",
        ),
    ] {
        let text = RUBRIC.replacen(before, after, 1);
        let (_folder, path) = folder(&text, HIDDEN);
        let lines = load(&path, false).map_or_else(|e| e.lines(), |_| Vec::new());
        let told = lines.iter().any(|line| line.contains(part));
        assert!(told || part.is_empty() && lines.is_empty(), "{after}: {part}: {lines:?}");
    }
}

#[test]
fn all_mistakes_are_told_at_once_and_those_of_the_hidden_part_too() {
    let text = RUBRIC.replace("seed = 3", "seed = -3").replace("points = 1", "points = 'one'");
    let (_folder, path) = folder(&text, HIDDEN);
    assert!(load(&path, false).unwrap_err().lines().len() >= 2);
    let (_folder, path) = folder(&RUBRIC.replace("{score}", "{scor}"), HIDDEN);
    assert!(load(&path, false).is_ok(), "students have no use for exports");
    assert!(load(&path, true).unwrap_err().lines()[0].contains("did you mean {score}?"));
    for (hidden, part) in [
        ("seed = 3", "the hidden seed is the public one"),
        ("", "without `seed`"),
        ("seed = 9\nfalse_alarm = 1", "key of a hidden part"),
        ("seed = 9\n[[item]]\nid = 'a'\npoints = 1", "another item is called `a`"),
        ("seed = 9\n[[item]]\nid = 'z'\npoints = 1\nsubject = 'ink'\nchecks = 'mis'", "no [model]"),
        ("seed = = 9", "not TOML"),
    ] {
        let (_folder, path) = folder(RUBRIC, hidden);
        let lines = load(&path, true).unwrap_err().lines();
        assert!(lines.iter().any(|line| line.contains(part)), "{hidden}: {lines:?}");
    }
}
