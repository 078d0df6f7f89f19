//! What others build plugins with: the headers, the class of C++, the examples, and
//! the templates of `gonio new`, which must pass out of the box.

mod common;

use common::tools::tools;
use gonio::bsdf::{Direction, Samples, Transport};
use gonio::registry::Registry;
use serde_json::Value;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const GONIO: &str = env!("CARGO_BIN_EXE_gonio");
const ROOT: &str = env!("CARGO_MANIFEST_DIR");
const WARNINGS: [&str; 5] = ["-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"];

fn root() -> &'static Path {
    Path::new(ROOT)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What it wrote to stdout; everything that it said is told if it fails.
fn succeeds(command: &mut Command) -> String {
    let done = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    assert!(
        done.status.success(),
        "{command:?} ended with {}\n{}{}",
        done.status,
        text(&done.stdout),
        text(&done.stderr)
    );
    text(&done.stdout)
}

/// A compiler with warnings as errors and the headers at hand.
fn compiler(program: &str, standard: &str) -> Command {
    tools();
    let mut command = Command::new(program);
    command.current_dir(root()).arg(format!("-std={standard}")).args(WARNINGS);
    command.args(["-Iinclude", "-Isdk/cpp"]);
    command
}

const C: [(&str, &str); 4] = [("gcc", "c99"), ("gcc", "c11"), ("clang", "c99"), ("clang", "c11")];
const CPP: [(&str, &str); 4] =
    [("g++", "c++11"), ("g++", "c++17"), ("clang++", "c++11"), ("clang++", "c++17")];

/// As the only thing in a file, twice.
fn include(desk: &TempDir, header: &str, extension: &str) -> std::path::PathBuf {
    let path = desk.path().join(format!("{header}.{extension}"));
    std::fs::write(&path, format!("#include \"{header}\"\n#include \"{header}\"\n")).unwrap();
    path
}

#[test]
fn headers_and_sources_have_no_warnings() {
    let desk = tempfile::tempdir().unwrap();
    let c = ["gonio.h", "gonio_parameters.h"];
    for (program, standard) in C {
        let ours = ["examples/plugins/ggx.c", "templates/c/bsdf.c"].map(|s| root().join(s));
        for source in c.iter().map(|h| include(&desk, h, "c")).chain(ours) {
            succeeds(compiler(program, standard).arg("-fsyntax-only").arg(source));
        }
    }
    for (program, standard) in CPP {
        let headers = c.iter().chain(&["gonio.hpp", "gonio_model.hpp"]).map(|h| include(&desk, h, "cpp"));
        let ours = ["examples/plugins/ggx.cpp", "templates/cpp/bsdf.cpp", "tests/sdk/models.cpp"];
        for source in headers.chain(ours.map(|s| root().join(s))) {
            for extra in [&[][..], &["-fno-exceptions", "-fno-rtti"]] {
                succeeds(compiler(program, standard).arg("-fsyntax-only").args(extra).arg(&source));
            }
        }
    }
    for (program, standard, extension) in [("clang", "c99", "c"), ("clang++", "c++11", "cpp")] {
        let source = include(&desk, "gonio_wasm.h", extension);
        succeeds(compiler(program, standard).args(["--target=wasm32", "-fsyntax-only"]).arg(source));
    }
}

#[test]
fn parameters_are_read_as_json_says() {
    let desk = tempfile::tempdir().unwrap();
    for program in ["gcc", "clang"] {
        let built = desk.path().join(program);
        succeeds(compiler(program, "c99").arg("tests/sdk/parameters.c").arg("-o").arg(&built).arg("-lm"));
        let run = Command::new(&built).output().unwrap();
        assert!(run.status.success() && text(&run.stdout) == "0 failures\n", "{}", text(&run.stdout));
    }
}

/// tests/sdk/driver.c with a plugin in it.
fn driver(desk: &TempDir, source: &str, extra: &[&str]) -> std::path::PathBuf {
    let object = desk.path().join("driver.o");
    succeeds(compiler("gcc", "c99").args(["-c", "tests/sdk/driver.c", "-o"]).arg(&object));
    let built = desk.path().join("driver");
    let mut command = if source.ends_with(".c") { compiler("gcc", "c99") } else { compiler("g++", "c++11") };
    succeeds(command.args(extra).arg(source).arg(object).arg("-o").arg(&built).arg("-lm"));
    built
}

/// Lines that it writes.
fn drive(driver: &Path, arguments: [&str; 4], input: &str) -> Vec<String> {
    let mut command = Command::new(driver);
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_string();
    let writer = std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    let Output { stdout, .. } = child.wait_with_output().unwrap();
    // A plugin that refuses reads nothing.
    let _ = writer.join().unwrap();
    text(&stdout).lines().map(String::from).collect()
}

/// C, C++ and Rust draw the same from the same numbers.
#[test]
fn the_examples_are_gonios_own_model() {
    let views: Vec<_> = [0.0f64, 20.0, 60.0, 85.0, 89.9, 90.0, 130.0]
        .map(|theta| Direction::from_angles(theta.to_radians(), 0.7))
        .into();
    let ends = [0.0, 0.5, 1.0 - f64::EPSILON / 2.0];
    let mut u: Vec<f64> = ends.iter().flat_map(|a| ends.iter().flat_map(move |b| [*a, *b])).collect();
    // Additive recurrence by the plastic number's powers.
    u.extend((1..=400).map(f64::from).flat_map(|k| [(k * 0.754877666).fract(), (k * 0.569840291).fract()]));
    for source in ["examples/plugins/ggx.c", "examples/plugins/ggx.cpp"] {
        let desk = tempfile::tempdir().unwrap();
        let driver = driver(&desk, source, &[]);
        for alpha in [1e-4, 0.05, 0.3, 1.0] {
            let spelling = format!("torrance-sparrow:alpha={alpha}").parse().unwrap();
            let own = Registry::builtin().resolve(&spelling).unwrap().subject;
            let mut input = String::new();
            for wo in &views {
                input += &format!("{:e} {:e} {:e} {}\n", wo.x, wo.y, wo.z, u.len() / 2);
                u.iter().for_each(|u| input += &format!("{u:e}\n"));
            }
            let lines = drive(&driver, ["ggx", &format!("{{\"alpha\":{alpha:e}}}"), "2", "1"], &input);
            let mut rows = lines[2..].iter();
            for wo in &views {
                let mut expected = Samples::default();
                expected.clear(1);
                own.sample(*wo, &u, Transport::Radiance, &mut expected).unwrap();
                let (mut f, mut p) = (vec![0.0; expected.len()], vec![0.0; expected.len()]);
                own.eval(*wo, &expected.wi, Transport::Radiance, &mut f).unwrap();
                own.pdf(*wo, &expected.wi, Transport::Radiance, &mut p).unwrap();
                for k in 0..expected.len() {
                    let row = rows.next().expect("a line a row");
                    let found: Vec<f64> = row.split(' ').map(|x| x.parse().unwrap()).collect();
                    assert_eq!(found[0] as u8, expected.lobe[k].0, "{source} {alpha} {wo:?} {row}");
                    if found[0] == 0.0 {
                        continue;
                    }
                    let wi = expected.wi[k];
                    let close = |a: f64, b: f64, by: f64| (a - b).abs() <= by * b.abs().max(1.0);
                    // f and pdf find m again from wi, whose rounding D magnifies.
                    let found_again = 1e-12 + 1e-14 / alpha;
                    let same = close(found[1], wi.x, 1e-14)
                        && close(found[2], wi.y, 1e-14)
                        && close(found[3], wi.z, 1e-14)
                        && close(found[4], expected.weight[k], 1e-12)
                        && close(found[5], expected.pdf[k], 1e-12)
                        && close(found[6], f[k], found_again)
                        && close(found[7], p[k], found_again);
                    assert!(same, "{source} {alpha} {wo:?}: {row} is not {wi:?} {}", expected.pdf[k]);
                }
            }
        }
        let told = drive(&driver, ["ggx", "{\"alpha\":2}", "2", "1"], "");
        let description: Value = serde_json::from_str(&told[0]).unwrap();
        assert_eq!(description["models"][0]["parameters"][0]["role"], "roughness");
        // gonio.hpp leaves ranges to gonio.
        assert!(source.ends_with("cpp") || told[1] == "refused: alpha must be from 0.0001 to 1", "{told:?}");
    }
}

#[test]
fn a_class_declares_and_refuses() {
    for extra in [&[][..], &["-fno-exceptions", "-fno-rtti"]] {
        let desk = tempfile::tempdir().unwrap();
        let driver = driver(&desk, "tests/sdk/models.cpp", extra);
        let plain = drive(&driver, ["declared", "{\"eta\":1.25,\"table\":\"/a/\\u0062 c\"}", "0", "3"], "");
        let all: Value = serde_json::from_str(&plain[0]).unwrap();
        assert_eq!((&all["protocol"], &all["parallel"]), (&1.into(), &false.into()));
        assert_eq!(all["models"].as_array().unwrap().len(), 3);
        let model = &all["models"][0];
        assert_eq!(model["doc"], "a \"quoted\" \\ line\n\ttwo");
        assert_eq!(model["conventions"]["weight"], "f-over-pdf");
        assert_eq!(model["claims"]["off_support"], "zero-weight");
        assert_eq!(model["parameters"][0]["max"], 1000.0);
        assert_eq!(model["parameters"][1]["options"][1], "v-cavity");
        let special: Value = serde_json::from_str(&plain[1]).unwrap();
        assert_eq!(special["claims"]["eta"], 1.25);
        assert_eq!(plain[2..], ["1.25 0 6", "11.25 0 6"]);
        let other = drive(&driver, ["declared", "{\"masking\":\"v-cavity\"}", "0", "1"], "");
        let special: Value = serde_json::from_str(&other[1]).unwrap();
        assert_eq!((&special["channels"][0], &special["has"][0]), (&"value".into(), &"eval".into()));
        assert_eq!(other[2..], ["1.5", "11.5"]);

        let refused = |how: &str| {
            drive(&driver, ["fails", &format!("{{\"how\":\"{how}\"}}"), "0", "1"], "").pop().unwrap()
        };
        assert_eq!(refused("refuse"), "refused: eval refuses");
        assert_eq!(refused("create"), "refused: not this one");
        assert_eq!(refused("undeclared"), "refused: fails declares no number called alpha");
        if extra.is_empty() {
            assert_eq!(refused("throw"), "refused: thrown on purpose");
            assert!(refused("int").contains("no std::exception"));
        }
        let unknown = drive(&driver, ["nobody", "{}", "0", "1"], "").pop().unwrap();
        assert_eq!(unknown, "refused: no model is called nobody");

        let rows = drive(&driver, ["batched", "{}", "1", "1"], "0.5 0 1 2 0.25 0.75");
        assert_eq!(rows[2..], ["0 0 0 0 0 0 0.5 0", "17 0.5 0 1 2 0.75 1.5 1"]);
    }
}

/// The commands of the first block of a README, run by a shell in `folder`.
fn follow(folder: &Path, readme: &Path, adapt: impl Fn(&str) -> String) {
    let tools = tools();
    let text = std::fs::read_to_string(readme).unwrap();
    let block = text.lines().skip_while(|l| !l.starts_with("```sh")).skip(1);
    let lines: Vec<_> = block.take_while(|l| !l.starts_with("```")).map(adapt).collect();
    assert!(lines.iter().any(|l| l.contains(" check ")), "{text}");
    let own = Path::new(GONIO).parent().unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{}:{path}", own.display(), tools.python.display());
    let mut shell = Command::new("sh");
    shell.args(["-exc", &lines.join("\n")]).current_dir(folder).env("PATH", path);
    succeeds(shell.env("CARGO_TARGET_DIR", &tools.target));
}

fn new(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(GONIO).arg("new").args(arguments).current_dir(folder).output().unwrap()
}

/// Writes the template, and does what its README says.
fn template(language: &str, adapt: impl Fn(&Path, &str) -> String) {
    let desk = tempfile::tempdir().unwrap();
    let written = new(desk.path(), &[language, "rough-paint_2"]);
    assert!(written.status.success(), "{}", text(&written.stderr));
    assert!(text(&written.stderr).contains("cd rough-paint_2") && written.stdout.is_empty());
    let folder = desk.path().join("rough-paint_2");
    follow(&folder, &folder.join("README.md"), |line| adapt(&folder, line));
}

#[test]
fn the_template_of_c_passes() {
    template("c", |_, line| line.into());
}

#[test]
fn the_template_of_cpp_passes() {
    template("cpp", |_, line| line.into());
}

#[test]
fn the_template_of_wasm_passes() {
    template("wasm-c", |_, line| line.into());
}

#[test]
fn the_template_of_python_passes() {
    // tests/setup.sh has installed what is in this repository.
    template("python", |_, line| if line.starts_with("pip ") { ":".into() } else { line.into() });
}

/// With gonio from this folder, beside what is built: gonio alone is built anew, as
/// another workspace's, and quickly.
#[test]
fn the_template_of_rust_passes() {
    template("rust", |folder, line| {
        std::fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
        let quickly = "--config profile.release.package.gonio.opt-level=0";
        let patch = format!("cargo --config 'patch.crates-io.gonio.path=\"{ROOT}\"' {quickly} ");
        let profile = if cfg!(debug_assertions) { "" } else { " --release" };
        let line = line.replace(" --release", "").replace("cargo ", &patch);
        line.replace(" run", &format!(" run{profile}")).replace(" test", &format!(" test{profile}"))
    });
}

#[test]
fn the_examples_pass_as_their_readme_says() {
    let desk = tempfile::tempdir().unwrap();
    for part in ["include", "sdk", "examples"] {
        std::os::unix::fs::symlink(root().join(part), desk.path().join(part)).unwrap();
    }
    std::fs::create_dir(desk.path().join("target")).unwrap();
    follow(desk.path(), &root().join("examples/plugins/README.md"), str::to_string);
}

#[test]
fn new_says_what_it_wants_and_writes_over_nothing() {
    let desk = tempfile::tempdir().unwrap();
    let told = |arguments: &[&str], part: &str| {
        let done = new(desk.path(), arguments);
        let err = text(&done.stderr);
        assert_eq!(done.status.code(), Some(2), "{err}");
        assert!(err.contains(part), "{err}");
    };
    told(&["java", "paint"], "rust, c, cpp, python, wasm-c");
    told(&["c", "Paint"], "small letter");
    told(&["c", "../paint"], "small letter");
    told(&["rust", "fn"], "`fn-bsdf`");
    std::fs::create_dir(desk.path().join("empty")).unwrap();
    assert!(new(desk.path(), &["c", "paint", "-o", "empty"]).status.success());
    assert!(desk.path().join("empty/bsdf.c").is_file());
    std::fs::write(desk.path().join("empty/bsdf.c"), "mine").unwrap();
    told(&["c", "paint", "--out", "empty"], "not empty");
    told(&["c", "paint", "--out", "empty/bsdf.c"], "--out DIR");
    assert_eq!(std::fs::read_to_string(desk.path().join("empty/bsdf.c")).unwrap(), "mine");
    let quiet = new(desk.path(), &["python", "paint", "--quiet", "-o", "a/b"]);
    assert!(quiet.status.success() && quiet.stderr.is_empty());
    assert!(desk.path().join("a/b/bsdf.py").is_file());
}

#[test]
fn the_python_package_passes_its_own_tests() {
    let python = tools().python.join("python");
    let mut pytest = Command::new(python);
    pytest.args(["-m", "pytest", "-q", "-p", "no:cacheprovider"]).current_dir(root().join("sdk/python"));
    let told = succeeds(pytest.env("GONIO", GONIO));
    // With gonio at hand nothing is skipped.
    assert!(told.contains(" passed") && !told.contains("skipped"), "{told}");
}
