//! `gonio grade`: a small class, from submissions to grades, and what happens to them later.

mod common;

use common::desk::{Desk, Done, GONIO, done};
use common::tools::tools;
use gonio::grading::Grade;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

const RUBRIC: &str = r#"
[rubric]
title = "Paint"
hidden = "hidden.toml"
solution = "solution"
false_alarm = 1e-4
hints = "full"
samples = "2^14"
detect = 0.2
theta = [20, 70]
call_limit = 1

[[language]]
name = "C for wasm"
when = "paint.c"
files = ["course/gonio.h", "course/gonio_parameters.h", "course/gonio_wasm.h"]
build = "clang --target=wasm32 -nostdlib -O2 -Wl,--no-entry paint.c -o paint.wasm"
wasm = "paint.wasm"

[[language]]
name = "C"
when = "native.c"
files = ["course/gonio.h", "course/gonio_parameters.h"]
build = "cc -O2 -shared -fPIC native.c -o native.so -lm"
library = "native.so"

[model.paint]
claims = { isotropic = true }

[[export]]
file = "moodle.csv"
columns = { Identifier = "Participant {id}", Grade = "{score}", Values = "{items.values}" }

[[item]]
id = "builds"
points = 1

[[item]]
id = "pdf"
title = "The density"
points = 4
subject = ["paint", "paint:reflectance=0.9"]
checks = ["normalization", "goodness-of-fit"]
needs = ["builds"]
loss = "Integrate it."

[[item]]
id = "weight"
points = 2
subject = "paint"
checks = ["weight"]
needs = ["pdf"]

[[item]]
id = "values"
points = 3
subject = ["paint", "paint:reflectance=0.9"]
checks = ["reference"]
reference = "solution"
within = 0.01

[[item]]
id = "bright"
points = 2
kind = "penalty"
subject = "paint:reflectance=0.9"
checks = ["energy"]
"#;

const HIDDEN: &str = "seed = 8231977\n[[item]]\nid = 'unseen'\ntitle = 'Unseen'\npoints = 5\nkind = 'bonus'\n\
    credit = 'whole'\nsubject = 'paint:reflectance=0.123'\nchecks = ['goodness-of-fit', 'returned-pdf']\nphi = 137.7625\n";

/// gonio's own template, which is right.
fn right() -> String {
    let text = std::fs::read_to_string(format!("{ROOT}/templates/c/bsdf.c")).unwrap();
    text.replace("@NAME@", "paint")
}

const PDF: &str = "cosine > 0.0 ? cosine / PI : 0.0";
const VALUE: &str = "self->reflectance / PI : 0.0";

fn with(before: &str, after: &str) -> String {
    let text = right();
    assert_eq!(text.matches(before).count(), 1, "{before}");
    text.replace(before, after)
}

/// A class with one of each kind.
fn class() -> Desk {
    tools();
    let desk = Desk::new();
    for folder in ["course", "solution", "class"] {
        std::fs::create_dir(desk.path(folder)).unwrap();
    }
    for header in ["gonio.h", "gonio_parameters.h", "gonio_wasm.h"] {
        std::fs::copy(format!("{ROOT}/include/{header}"), desk.path("course").join(header)).unwrap();
    }
    desk.write("rubric.toml", RUBRIC).write("hidden.toml", HIDDEN);
    desk.write("solution/paint.c", &right());
    for (id, file, text) in [
        ("ada", "paint.c", right()),
        ("ben", "paint.c", with(PDF, "cosine > 0.0 ? cosine / (2.0 * PI) : 0.0")),
        ("cy", "native.c", with(VALUE, "1.3 * self->reflectance / PI : 0.0")),
        ("dan", "paint.c", "int main( {".into()),
        ("eve", "native.c", with(PDF, "cosine > 0.0 ? cosine / PI : *(volatile double *)8")),
        ("fay", "paint.c", with("  f[k] = wo[2]", "  while (n) {}\n        f[k] = wo[2]")),
    ] {
        hand_in(&desk, id, file, &text);
    }
    std::fs::create_dir(desk.path("class/gus")).unwrap();
    desk.write("class/gus/essay.txt", "A BRDF is…");
    desk
}

fn hand_in(desk: &Desk, id: &str, file: &str, text: &str) {
    let folder = desk.path("class").join(id);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join(file), text).unwrap();
}

fn grade(desk: &Desk, id: &str) -> Grade {
    let path = desk.path("grades/submissions").join(id).join("grade.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn earned(grade: &Grade) -> Vec<f64> {
    grade.items.iter().map(|item| item.earned).collect()
}

fn run(desk: &Desk, more: &str) -> Done {
    desk.gonio(&format!("grade rubric.toml class {more}"))
}

/// Files of grades, without what differs from run to run.
fn results(desk: &Desk, out: &str) -> BTreeMap<String, Vec<u8>> {
    let mut files = desk.files(out);
    // What was being written when it was killed has no name yet.
    files.retain(|name, _| !name.contains(".writing-") && !name.ends_with("report.json"));
    for (name, bytes) in desk.files(out).iter().filter(|(name, _)| name.ends_with("report.json")) {
        let report: gonio::report::Report = serde_json::from_slice(bytes).unwrap();
        files.insert(name.clone(), serde_json::to_vec(&report.timeless()).unwrap());
    }
    files
}

#[test]
fn a_class_is_graded_whatever_its_members_hand_in() {
    let desk = class();
    run(&desk, "--to gradescope,prairielearn").ends(0).says("7 submissions");
    let [ada, ben, cy, dan, eve, fay, gus] =
        ["ada", "ben", "cy", "dan", "eve", "fay", "gus"].map(|id| grade(&desk, id));
    assert_eq!((earned(&ada), ada.score, ada.max), (vec![1.0, 4.0, 2.0, 3.0, 0.0, 5.0], 15.0, 10.0));
    assert!(ada.hidden && ada.seed == 8231977 && ada.incidents.is_empty() && ada.review.is_empty());
    assert_eq!(ada.isolation, "WebAssembly");
    // Half of a density: no item on it is earned, nor what needs it.
    assert_eq!(earned(&ben), [1.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    assert_eq!(ben.items[2].unmet.as_deref(), Some("pdf"));
    assert_eq!(ben.diagnoses[0].cause.as_deref(), Some("constant-factor"), "{:?}", ben.diagnoses);
    // 1.3 · 0.9 is more light than came.
    assert_eq!(earned(&cy), [1.0, 4.0, 0.0, 0.0, -2.0, 5.0]);
    assert!(cy.isolation.starts_with("bubblewrap"), "{}", cy.isolation);
    assert_eq!(cy.score, 8.0);
    let why = |grade: &Grade| grade.broken.clone().map(|b| (b.why, b.said)).unwrap_or_default();
    assert!(why(&dan).0.contains("does not build") && why(&dan).1.contains("paint.c:1"), "{:?}", why(&dan));
    assert!(why(&gus).0.contains("none of the files paint.c, native.c"), "{:?}", why(&gus));
    assert_eq!((dan.score, gus.score, earned(&dan).iter().sum::<f64>()), (0.0, 0.0, 0.0));
    // What crashes or hangs loses what needs it, and nothing else.
    assert_eq!(eve.items[0].earned, 1.0);
    assert!(eve.items[1].lost.iter().any(|l| l.message.contains("SIGSEGV")), "{:?}", eve.items[1].lost);
    assert!(fay.items[3].lost.iter().all(|l| l.verdict == gonio::checks::Verdict::Error), "{:?}", fay.items);
    let book = std::fs::read_to_string(desk.path("grades/gradebook.csv")).unwrap();
    assert_eq!(book.lines().count(), 8, "{book}");
    let moodle = std::fs::read_to_string(desk.path("grades/moodle.csv")).unwrap();
    assert_eq!(moodle.lines().nth(2), Some("Participant ben,4,3"), "{moodle}");
    for file in
        ["index.html", "feedback/ada.html", "feedback/gus.md", "gradescope/eve.json", "prairielearn/dan.json"]
    {
        assert!(desk.path("grades").join(file).is_file(), "{file}");
    }
    let appeal = std::fs::read_to_string(desk.path("grades/appeals/ben/pdf/README.md")).unwrap();
    assert!(appeal.contains("8231977") && appeal.contains("--only ben --item pdf"), "{appeal}");
}

#[test]
fn one_that_takes_too_long_loses_what_was_not_reached_and_stops_nobody() {
    let desk = class();
    desk.write("rubric.toml", &RUBRIC.replace("call_limit = 1", "call_limit = 1\nlimit = 2"));
    let slow =
        with("  pdf[k] = wo[2]", "  { volatile int i; for (i = 0; i < 40000; ++i) {} }\n  pdf[k] = wo[2]");
    hand_in(&desk, "liz", "native.c", &slow);
    run(&desk, "--workers 2 --only liz --only ada --only ben").ends(0);
    assert_eq!((grade(&desk, "ada").score, grade(&desk, "ben").score), (15.0, 4.0));
    let liz = grade(&desk, "liz");
    assert!(liz.review.iter().any(|what| what.contains("time was up")), "{:?}", liz.review);
    let unreached = liz.items.iter().flat_map(|item| &item.lost);
    assert!(unreached.clone().count() > 0);
    assert!(unreached.clone().all(|l| l.verdict != gonio::checks::Verdict::Fail), "{:?}", liz.items);
    // How far it came depends on the machine; what it reached, it has.
    assert!(liz.score < 15.0, "{}", liz.score);
    for item in liz.items.iter().filter(|item| item.lost.is_empty() && item.unmet.is_none()) {
        assert_eq!(item.earned, if item.id == "bright" { 0.0 } else { item.points }, "{item:?}");
    }
}

#[test]
fn students_learn_nothing_of_what_is_hidden() {
    let desk = class();
    run(&desk, "--to gradescope,prairielearn --only ben --only ada").ends(0);
    let mut read = 0;
    for folder in ["feedback", "gradescope", "prairielearn"] {
        for (name, bytes) in desk.files(&format!("grades/{folder}")) {
            let text = String::from_utf8(bytes).unwrap();
            for secret in ["8231977", "0.123", "137.7625"] {
                assert!(!text.contains(secret), "{secret} in {folder}/{name}");
            }
            assert!(text.contains("Unseen"), "{folder}/{name}");
            read += 1;
        }
    }
    assert_eq!(read, 8);
}

#[test]
fn grades_are_the_same_for_any_number_of_workers_and_after_a_kill() {
    let desk = class();
    // Whether what hangs ran out of fuel or of time first is said, and depends on the machine.
    std::fs::remove_dir_all(desk.path("class/fay")).unwrap();
    run(&desk, "--workers 1 --out one").ends(0);
    run(&desk, "--workers 3 --out three").ends(0);
    // Killed as soon as there is something. What it had unpacked goes with the next run.
    let mut child = desk.spawn(GONIO, "grade rubric.toml class --out killed --workers 2");
    let begun = Instant::now();
    while desk.files("killed/submissions").keys().filter(|name| name.ends_with("grade.json")).count() < 2 {
        assert!(begun.elapsed() < Duration::from_secs(100));
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    run(&desk, "--out killed").ends(0);
    let one = results(&desk, "one");
    for out in ["three", "killed"] {
        let other = results(&desk, out);
        let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&one), names(&other), "{out}");
        let differ: Vec<_> =
            one.iter().filter(|(name, bytes)| other[*name] != **bytes).map(|(name, _)| name).collect();
        assert!(differ.is_empty(), "{out}: {differ:?}");
    }
}

#[test]
fn what_did_not_change_is_not_measured_again() {
    let desk = class();
    let only = "--only ada --only ben --only cy";
    run(&desk, only).ends(0).says("4 of 7 submissions have no grade yet");
    let report = |id: &str| desk.report(&format!("grades/submissions/{id}"))["started"].clone();
    let before = ["ada", "ben", "cy"].map(report);
    // A late one is graded alone.
    hand_in(&desk, "ben", "paint.c", &right());
    run(&desk, "--only ben").ends(0);
    let after = ["ada", "ben", "cy"].map(report);
    assert!(before[0] == after[0] && before[1] != after[1] && before[2] == after[2]);
    assert_eq!(grade(&desk, "ben").score, 15.0);
    assert!(!desk.path("grades/appeals/ben").exists(), "nothing is lost any more");
    // Points, texts and partial credit are not measured.
    let changed = RUBRIC
        .replace("points = 3\n", "points = 6\n")
        .replace("loss = \"Integrate it.\"", "loss = \"It must be 1.\"\ncredit = \"whole\"")
        .replace("kind = \"penalty\"", "kind = \"penalty\"\ntitle = \"Too bright\"");
    desk.write("rubric.toml", &changed);
    run(&desk, only).ends(0);
    assert_eq!(["ada", "ben", "cy"].map(report), after);
    assert_eq!((grade(&desk, "ada").score, grade(&desk, "ada").max), (18.0, 13.0));
    // Other directions are, but only for the subjects that have them.
    let moved = changed.replace(
        "subject = \"paint\"\nchecks = [\"weight\"]",
        "subject = \"paint\"\ntheta = 30\nchecks = [\"weight\"]",
    );
    desk.write("rubric.toml", &moved);
    run(&desk, only).ends(0);
    assert!(report("ada") != after[0]);
    let carried = desk.report("grades/submissions/ada")["subjects"].clone();
    let flags: Vec<_> =
        carried.as_array().unwrap().iter().map(|s| (&s["name"], s["carried"] == true)).collect();
    assert!(flags.iter().any(|(name, carried)| **name == "paint:reflectance=0.9" && *carried), "{flags:?}");
    assert!(flags.iter().any(|(name, carried)| **name == "paint" && !*carried), "{flags:?}");
    // All of it, if it is wanted.
    let before = report("cy");
    run(&desk, "--only cy --again").ends(0);
    assert!(report("cy") != before);
}

#[test]
fn a_student_sees_the_same_by_the_public_part() {
    let desk = class();
    std::fs::remove_file(desk.path("hidden.toml")).unwrap();
    std::fs::remove_dir_all(desk.path("solution")).unwrap();
    // Its folder is called as it likes.
    desk.write("rubric.toml", &format!("{RUBRIC}\n[submissions]\npattern = 'submission-(?<n>\\d+)'\n"));
    let own =
        |id: &str| done(&mut desk.command(GONIO, &format!("grade --self rubric.toml class/{id} --out own")));
    own("ada").ends(0);
    own("ben").ends(1).says("The density").says("Integrate it.");
    own("dan").ends(3).says("does not build");
    assert!(!desk.path("grades").exists());
    let path = desk.path("own/submissions/ada/grade.json");
    let grade: Grade = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let ids: Vec<&str> = grade.items.iter().map(|item| item.id.as_str()).collect();
    assert_eq!((grade.seed, grade.hidden), (1, false));
    assert_eq!(ids, ["builds", "pdf", "weight", "bright"], "what needs the solution is left out");
    let share = |folder: &str| {
        let thresholds = desk.report(folder)["results"].as_array().unwrap().clone();
        let of = |r: &serde_json::Value| (r["check"].to_string(), r["threshold"].to_string());
        thresholds.iter().map(of).find(|(check, _)| check.contains("goodness")).unwrap()
    };
    let own = share("own/submissions/ada");
    run(&desk, "").ends(2).says("hidden.toml cannot be read");
    desk.write("hidden.toml", HIDDEN).write("rubric.toml", RUBRIC);
    run(&desk, "").ends(2).says("the solution: it cannot be read");
    std::fs::create_dir(desk.path("solution")).unwrap();
    desk.write("solution/paint.c", &right());
    run(&desk, "--only ada").ends(0);
    assert_eq!(share("grades/submissions/ada"), own, "by the same thresholds");
}

#[test]
fn an_item_is_measured_again_for_an_appeal() {
    let desk = class();
    let again = run(&desk, "--only ben --item pdf");
    again.ends(1).says("normalization").says("--only ben --item pdf").says("constant-factor");
    assert!(!again.err.contains("weight"), "{}", again.err);
    assert!(!desk.path("grades").exists(), "nothing is written");
    run(&desk, "--item pdf").ends(2).says("--only ID");
    run(&desk, "--only ben --item pdff").ends(2).says("did you mean `pdf`?");
    run(&desk, "--only benn").ends(2).says("did you mean `ben`?");
}

#[test]
fn a_wrong_solution_or_rubric_grades_nobody() {
    let desk = class();
    desk.write("solution/paint.c", &with(PDF, "cosine > 0.0 ? 1.1 * cosine / PI : 0.0"));
    run(&desk, "").ends(2).says("the solution itself loses points of pdf");
    desk.write("solution/paint.c", "int");
    run(&desk, "").ends(2).says("the solution: it does not build");
    desk.write("rubric.toml", &RUBRIC.replace("points = 4", "pionts = 4"));
    run(&desk, "").ends(2).says("did you mean `points`?");
    desk.write("rubric.toml", RUBRIC);
    desk.gonio("grade rubric.toml nowhere").ends(2).says("nowhere cannot be read");
    std::fs::create_dir(desk.path("empty")).unwrap();
    desk.gonio("grade rubric.toml empty").ends(2).says("no submission in empty");
    assert!(!desk.path("grades/submissions").exists());
}

#[test]
fn two_at_once_do_not_write_over_each_other() {
    let desk = class();
    let mut first = desk.spawn(GONIO, "grade rubric.toml class");
    while !desk.path("grades/submissions").exists() {
        std::thread::sleep(Duration::from_millis(5));
        assert!(first.try_wait().unwrap().is_none());
    }
    run(&desk, "").ends(2).says("another gonio grades into grades");
    first.kill().unwrap();
    first.wait().unwrap();
}

#[test]
fn zips_are_unpacked_and_none_leads_elsewhere() {
    let desk = class();
    let zip = |name: &str, files: &[(&str, &str)]| {
        let file = std::fs::File::create(desk.path("class").join(name)).unwrap();
        let mut writer = zip::ZipWriter::new(file);
        for (path, text) in files {
            writer.start_file(*path, zip::write::SimpleFileOptions::default()).unwrap();
            std::io::Write::write_all(&mut writer, text.as_bytes()).unwrap();
        }
        writer.finish().unwrap();
    };
    zip("hal.zip", &[("my work/paint.c", &right()), ("__MACOSX/my work/._paint.c", "x")]);
    zip("ivy.zip", &[("paint.c", &right()), ("../../evil", "x")]);
    zip("jo.zip", &[("paint.c", &right()), ("gonio.h", "#error mine")]);
    desk.write("class/kim.zip", "not a zip").write("class/notes.txt", "");
    run(&desk, "--only hal --only ivy --only jo --only kim").ends(0).says("class/notes.txt is neither");
    assert_eq!(grade(&desk, "hal").score, 15.0);
    assert_eq!(grade(&desk, "jo").score, 15.0, "the course's header stands over its own");
    assert!(grade(&desk, "ivy").broken.unwrap().why.contains("leads elsewhere"));
    assert!(grade(&desk, "kim").broken.unwrap().why.contains("no whole zip"));
    assert!(!desk.path("evil").exists() && !desk.path("class/evil").exists());
}
