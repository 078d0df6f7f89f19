//! Plugins as they are met: right ones, and hostile ones in every way that can be
//! thought of. Each gets its verdict in bounded time, the rest of the run is complete,
//! and no process is left.

#[path = "plugins/sandbox.rs"]
mod sandbox;

use gonio::bsdf::{Direction, Lobe, Samples, Transport};
use gonio::registry::Registry;
use sandbox::{Sandbox, library, python, script};

/// What is shown of a subject that does `deed`.
fn library_that(deed: &str) -> String {
    format!("{}:deed={deed}", library("hostile").display())
}

#[test]
fn a_shared_library_passes() {
    let run = Sandbox::new("passes").check(&library_that("none"), &["--theta", "60", "--samples", "2^16"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert!(run.text.contains("0 failed"), "{}", run.text);
}

#[test]
fn in_process_or_elsewhere_gives_the_same_results() {
    let sandbox = Sandbox::new("in-process");
    let arguments = ["--theta", "60", "--samples", "2^16", "--format", "json"];
    let apart = sandbox.check(&library_that("none"), &arguments);
    // The same library at another place.
    std::fs::copy(library("hostile"), sandbox.folder().join("moved.so")).unwrap();
    let within = sandbox.check("moved.so:deed=none", &[&arguments[..], &["--in-process"]].concat());
    assert_eq!((apart.code, within.code), (Some(0), Some(0)), "{}{}", apart.text, within.text);
    let results = |json: &str| {
        let mut report: serde_json::Value = serde_json::from_str(json).unwrap();
        for result in report["results"].as_array_mut().unwrap() {
            result["command"].take();
            result["subject"]["name"].take();
        }
        report["results"].take()
    };
    assert_eq!(results(&apart.output), results(&within.output));
}

/// Each deed ends its case with an error that tells it, and a suite goes on.
fn told(subject: &str, deed: &str, parts: &[&str]) {
    let sandbox = Sandbox::new(&format!("{}-{deed}", if subject.contains(".so") { "so" } else { "py" }));
    // To take all memory takes time.
    let limit = if deed == "allocate" { "30" } else { "1" };
    let run = sandbox.suite(subject, &["--memory", "300", "--call-limit", limit]);
    assert_eq!(run.code, Some(3), "{deed}: {}", run.text);
    for part in parts {
        assert!(run.flat.contains(part), "{deed}: no `{part}` in\n{}", run.text);
    }
    // The other subject of the suite has all its results.
    let row = run.text.lines().find(|l| l.starts_with("lambert ")).unwrap_or_else(|| panic!("{}", run.text));
    assert!(!row.contains('E') && row.contains('✓'), "{row}");
    assert!(run.seconds < 60.0, "{deed}: {} s", run.seconds);
    assert_eq!(sandbox.left(), Vec::<String>::new(), "{deed}");
}

#[test]
fn a_library_that_crashes() {
    for (deed, parts) in [
        ("segfault", &["SIGSEGV", "eval() of"][..]),
        ("abort", &["SIGABRT"]),
        ("divide", &["SIGFPE"]),
        ("stack", &["overflowed its stack"]),
    ] {
        told(&library_that(deed), deed, parts);
    }
}

#[test]
fn a_library_that_leaves() {
    told(&library_that("exit"), "exit", &["ended with exit code 0 in eval()"]);
    told(&library_that("close"), "close", &["closed its standard output"]);
}

#[test]
fn a_library_that_takes_all_memory() {
    told(&library_that("allocate"), "allocate", &["SIGABRT", "memory is limited to 300 MiB"]);
}

#[test]
fn a_library_that_loops() {
    told(&library_that("loop"), "loop", &["did not answer eval()", "within 1 s"]);
}

#[test]
fn a_library_that_says_why_it_cannot() {
    told(&library_that("refuse"), "refuse", &["the table of this material is empty"]);
}

#[test]
fn what_a_library_prints_or_forks_is_no_error_and_is_not_left() {
    for deed in ["print", "fork", "daemon"] {
        let sandbox = Sandbox::new(deed);
        let run =
            sandbox.check(&library_that(deed), &["--theta", "60", "--samples", "2^14", "--check", "energy"]);
        assert_eq!(run.code, Some(0), "{deed}: {}", run.text);
        assert_eq!(sandbox.left(), Vec::<String>::new(), "{deed}");
    }
}

#[test]
fn nan_is_a_finding_and_no_broken_protocol() {
    for subject in [library_that("nan"), script("frames nan"), script("json-lines nan")] {
        let run = Sandbox::new("nan").check(&subject, &["--theta", "60", "--samples", "2^14"]);
        assert_eq!(run.code, Some(1), "{}", run.text);
        assert!(run.text.contains("eval() is finite"), "{}", run.text);
    }
}

#[test]
fn both_wires_give_the_same_numbers() {
    gonio::plugins::set_gonio(env!("CARGO_BIN_EXE_gonio").into());
    let numbers = |wire: &str| {
        let spelling = script(&format!("{wire} none")).parse().unwrap();
        let subject = Registry::builtin().resolve(&spelling).unwrap().subject;
        let wo = Direction::from_angles(0.7, 0.3);
        let wi: Vec<Direction> = (0..100).map(|k| Direction::from_angles(0.02 * f64::from(k), 1.0)).collect();
        let u: Vec<f64> = (0..200).map(|k| (0.5 + 0.618_034 * f64::from(k)).fract()).collect();
        let (mut f, mut p, mut samples) = (vec![0.0; 100], vec![0.0; 100], Samples::default());
        samples.clear(1);
        subject.eval(wo, &wi, Transport::Radiance, &mut f).unwrap();
        subject.pdf(wo, &wi, Transport::Radiance, &mut p).unwrap();
        subject.sample(wo, &u, Transport::Radiance, &mut samples).unwrap();
        (f, p, samples.wi, samples.weight, samples.pdf, samples.lobe)
    };
    let frames = numbers("frames");
    assert!(frames.0[0] > 0.1 && frames.5[0] == Lobe::DIFFUSE_REFLECTION);
    assert_eq!(frames, numbers("json-lines"));
}

#[test]
fn a_program_that_breaks_the_wire() {
    for (deed, wire, part) in [
        ("few", "frames", "1 numbers (8 bytes) where"),
        ("few", "json-lines", "1 rows of `f` where"),
        ("late-noise", "frames", "`debugging…"),
        ("late-noise", "json-lines", "`debugging…"),
        ("garbage", "frames", "fa fb fc fd fe ff"),
        ("half", "frames", "ended with exit code 3 in eval()"),
        // In words that depend on whether the second comes before the next call.
        ("twice", "frames", "E error"),
        ("twice", "json-lines", "E error"),
        ("refuse", "frames", "wo is too steep"),
        ("refuse", "json-lines", "wo is too steep"),
    ] {
        told(&script(&format!("{wire} {deed}")), &format!("{wire}-{deed}"), &[part]);
    }
}

#[test]
fn a_program_that_ends_or_hangs() {
    for (deed, parts) in [
        ("raise", &["ended with exit code 1", "ValueError: no such material", "line"][..]),
        ("exit", &["ended with exit code 0"]),
        ("kill", &["SIGKILL"]),
        ("close", &["closed its standard output"]),
        ("deaf", &["did not answer eval()"]),
        ("hang", &["within 1 s", "now I think about it"]),
        ("flood", &["within 1 s", "xxxx"]),
    ] {
        told(&script(&format!("frames {deed}")), deed, parts);
    }
}

#[test]
fn a_program_that_never_begins() {
    for (deed, wire, parts) in [
        ("noise", "frames", &["Hello, I am a plugin", "standard error"][..]),
        ("noise", "json-lines", &["Hello, I am a plugin", "standard error"]),
        ("late", "frames", &["ended with exit code 1 in its description", "cannot read the configuration"]),
        ("claim", "frames", &["isotropik"]),
        ("old", "json-lines", &["protocol 7"]),
    ] {
        told(&script(&format!("{wire} {deed}")), &format!("{wire}-{deed}"), parts);
    }
    told("python4 brdf.py", "missing", &["cannot start `python4`"]);
}

#[test]
fn children_of_a_program_are_not_left() {
    let sandbox = Sandbox::new("children");
    let run = sandbox
        .check(&script("frames children"), &["--theta", "60", "--samples", "2^14", "--check", "energy"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert_eq!(sandbox.left(), Vec::<String>::new());
}

#[test]
fn a_killed_gonio_leaves_no_process() {
    let sandbox = Sandbox::new("killed");
    let mut gonio = sandbox.start(&script("frames hang"), &["--theta", "60", "--call-limit", "100"]);
    let begun = || sandbox.running().iter().any(|line| line.contains("hostile.py"));
    assert!(sandbox::within(30.0, begun), "it has not begun");
    // Let it be in the middle of a call.
    std::thread::sleep(std::time::Duration::from_millis(500));
    gonio.kill().unwrap();
    gonio.wait().unwrap();
    assert!(sandbox::within(10.0, || sandbox.running().is_empty()), "{:?}", sandbox.left());
}

#[test]
fn mistakes_in_naming_a_plugin_are_told() {
    let sandbox = Sandbox::new("names");
    let so = library("hostile");
    for (subject, part) in [
        (format!("{}#hostil", so.display()), "did you mean `hostile`?"),
        (format!("{}:deeds=none", so.display()), "did you mean `deed`?"),
        (format!("{}:deed=sefgault", so.display()), "did you mean `segfault`?"),
        ("./nothing.so".into(), "there is no such file"),
    ] {
        let run = sandbox.check(&subject, &[]);
        assert_eq!(run.code, Some(2), "{subject}: {}", run.text);
        assert!(run.text.contains(part), "{subject}: {}", run.text);
    }
    let list = sandbox.gonio(&["list", so.to_str().unwrap()]);
    assert!(list.output.contains("deed") && list.output.contains("segfault"), "{}", list.output);
}

/// Every convention, alone and together: told if it contradicts the declaration, and
/// measured as it is; silent if declared.
#[test]
fn conventions_are_probed() {
    for (follows, part) in [
        ("weight=f", "declare `weight` = \"f\""),
        ("weight=f-cos", "declare `weight` = \"f-cos\""),
        ("weight=f-over-pdf", "declare `weight` = \"f-over-pdf\""),
        ("failure=zero-pdf", "declare `failure` = \"zero-pdf\""),
        ("up=y", "declare `up` = \"y\""),
        ("given=towards", "declare `given` = \"towards\""),
        ("up=y,given=towards,weight=f,failure=zero-pdf", "declare `given` = \"towards\""),
    ] {
        let options = ["--theta", "40", "--samples", "2^15", "--check", "sanity", "--check", "weight"];
        let options = [&options[..], &["--check", "goodness-of-fit", "--detect", "1"]].concat();
        let run = |declared: &str| {
            let subject = python(&format!("conventions.py {follows} {declared}"));
            Sandbox::new("conventions").check(&subject, &options)
        };
        let (silent, told) = (run("declared"), run("undeclared"));
        assert_eq!((silent.code, told.code), (Some(0), Some(0)), "{follows}: {}{}", silent.text, told.text);
        assert!(told.text.starts_with("warning: "), "{follows}: {}", told.text);
        assert!(
            told.flat.contains(part) && told.flat.contains("measured as such"),
            "{follows}: {}",
            told.text
        );
        assert!(!silent.text.contains("declare `") && silent.text.contains("3 passed"), "{}", silent.text);
    }
}

#[test]
fn a_plugin_in_a_suite_is_found_beside_it() {
    let sandbox = Sandbox::new("suite");
    let folder = sandbox.folder().join("materials");
    std::fs::create_dir(&folder).unwrap();
    std::fs::copy(library("hostile"), folder.join("paint.so")).unwrap();
    std::fs::copy(sandbox::data("conventions.py"), folder.join("lambert.py")).unwrap();
    let text = "[suite]\nname = \"beside\"\ntheta = 30\nphi = 17\nsamples = \"2^14\"\ndetect = 1.0\n\
        checks = [\"sanity\", \"energy\"]\n\
        [[subject]]\nlibrary = \"paint.so#hostile\"\nreference = \"paint.so\"\n\
        [[subject]]\nprocess = [\"python3\", \"lambert.py\", \"up=z\", \"declared\"]\n";
    std::fs::write(folder.join("suite.toml"), text).unwrap();
    let run = sandbox.gonio(&["run", "materials/suite.toml"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    for (line, part) in [
        ("library = \"pain.so\"", "does not exist"),
        ("library = \"lambert.py\"", "no shared library"),
        ("process = [\"pyhton3\"]", "no program `pyhton3`"),
        ("process = []", "empty list"),
        ("wasm = \"paint.so\"", "no WebAssembly module"),
        ("library = \"paint.so#matte\"", "has no model `matte`"),
    ] {
        std::fs::write(folder.join("wrong.toml"), format!("[[subject]]\n{line}\n")).unwrap();
        let run = sandbox.gonio(&["run", "materials/wrong.toml"]);
        assert!(run.code == Some(2) && run.flat.contains(part), "{line}: {}", run.text);
    }
}

/// What a subject has not, or does by chance, is skipped for that reason; the rest
/// passes.
#[test]
fn subjects_of_every_kind() {
    for (kind, code, row) in [
        // san det fit nrm sup wgt pdf alb mis nrg fur rec iso dis
        ("eval-only", 0, "✓ ✓ – – – – – – – ✓ – ✓ ✓ –"),
        ("internal", 0, "✓ ✓ ✓ ✓ ✓ ✓ ✓ ✓ ✓ ✓ – ✓ – –"),
        ("f32", 0, "✓ ✓ ✓ ✓ ✓ ✓ ✓ ✓ ✓ ✓ – ✓ ✓ –"),
        ("unimplemented", 1, "✗ – – – – – – – – – – – – –"),
    ] {
        let subject = python(&format!("kinds.py {kind}"));
        let run =
            Sandbox::new(kind).check(&subject, &["--theta", "50", "--samples", "2^15", "--detect", "1"]);
        assert_eq!(run.code, Some(code), "{kind}: {}", run.text);
        let line = run.text.lines().find(|l| l.starts_with("python3 ")).unwrap();
        let signs: Vec<&str> = line.split_whitespace().filter(|w| "✓✗–?!E".contains(*w)).collect();
        assert_eq!(signs[..14].join(" "), row, "{kind}: {}", run.text);
    }
}

/// Code in the space of a scene: its frame is declared, and guessed by nobody.
#[test]
fn a_frame_of_a_scene_is_turned() {
    let subject = python("conventions.py up=scene declared");
    let run = Sandbox::new("scene").check(&subject, &["--theta", "40", "--samples", "2^15", "--detect", "1"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
    assert!(run.text.contains(" 0 failed") && !run.text.contains("warning"), "{}", run.text);
}

#[test]
fn blank_lines_say_nothing() {
    let subject = script("json-lines blank");
    let run =
        Sandbox::new("blank").check(&subject, &["--theta", "60", "--samples", "2^14", "--check", "energy"]);
    assert_eq!(run.code, Some(0), "{}", run.text);
}

#[test]
fn a_subject_is_named_in_one_way() {
    let sandbox = Sandbox::new("two-ways");
    let text = format!("[[subject]]\nuse = \"lambert\"\nlibrary = \"{}\"\n", library("hostile").display());
    std::fs::write(sandbox.folder().join("suite.toml"), text).unwrap();
    let run = sandbox.gonio(&["run", "suite.toml"]);
    assert!(run.code == Some(2) && run.flat.contains("has `use` and `library`"), "{}", run.text);
}
