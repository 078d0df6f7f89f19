//! Measured files on the command line and in suites.

use assert_cmd::Command;
use gonio::bsdf::Spectrum;
use gonio::measured::{MerlTable, Resolution, Rgl};
use std::path::Path;

/// Runs `gonio` in a folder; its exit code and all that it said.
fn gonio(folder: &Path, words: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
    command.current_dir(folder).args(words).env_remove("NO_COLOR").env("COLUMNS", "200");
    let output = command.output().expect("gonio runs");
    let text =
        String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
    (output.status.code().expect("a code"), text)
}

fn small_rgl() -> Vec<u8> {
    let resolution = Resolution { phi: vec![0.0], theta: 3, normals: 8, spectra: 6 };
    Rgl::bake("small", &[], 0.6, &resolution, |_, _| Spectrum::uniform(3, 0.2))
}

#[test]
fn a_file_is_checked_whatever_it_is_called() {
    let desk = tempfile::tempdir().unwrap();
    std::fs::write(desk.path().join("a, (b).png"), small_rgl()).unwrap();
    let line = ["check", "a, (b).png", "--theta", "30", "--check", "energy", "--check", "sanity"];
    let (code, text) = gonio(desk.path(), &line);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("2 passed"), "{text}");
    let (code, text) = gonio(desk.path(), &["check", "measured:file=(a, (b).png)", "--theta", "30"]);
    assert!(code == 0 || code == 1, "{text}");
    let (code, text) = gonio(desk.path(), &["check", "measured:file=(a, (b).png),interpolation=nearest"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("only MERL tables can be read with interpolation = nearest"), "{text}");
}

#[test]
fn what_cannot_be_opened_is_told() {
    let desk = tempfile::tempdir().unwrap();
    std::fs::write(desk.path().join("picture.binary"), b"\x89PNG\r\n\x1a\n").unwrap();
    std::fs::write(desk.path().join("short.bsdf"), &small_rgl()[..1000]).unwrap();
    for (word, part) in [
        ("none.binary", "no subject is called `none.binary`, and there is no such file"),
        ("measured:file=none.binary", "there is no file `none.binary`"),
        ("measured", "needs `file`"),
        ("picture.binary", "`picture.binary`: this is a PNG picture"),
        ("short.bsdf", "goes beyond the end of the file at 1000"),
    ] {
        let (code, text) = gonio(desk.path(), &["check", word]);
        assert_eq!(code, 2, "{text}");
        let one_line = text.replace(['\n', '│'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(one_line.contains(part), "{word}: {one_line}");
    }
}

#[test]
fn suites_name_files_relative_to_themselves() {
    let desk = tempfile::tempdir().unwrap();
    let folder = desk.path().join("suites");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("x.dat"), small_rgl()).unwrap();
    let suite = |text: &str| {
        std::fs::write(folder.join("mine.toml"), text).unwrap();
        gonio(desk.path(), &["run", "suites/mine.toml"])
    };
    let head = "[suite]\ntheta = 30\nphi = 17\nchecks = [\"energy\"]\n[[subject]]\n";
    let (code, text) = suite(&format!("{head}file = \"x.dat\"\nlabel = \"small\"\n"));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("1 passed"), "{text}");
    let (code, text) = suite(&format!("{head}file = [\"x.dat\", \"y.dat\"]\n"));
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("`suites/y.dat` does not exist") && text.contains("mine.toml:6:"), "{text}");
    std::fs::write(folder.join("y.dat"), b"no table").unwrap();
    let (code, text) = suite(&format!("{head}file = [\"x.dat\", \"y.dat\"]\n"));
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("not a format that gonio knows") && text.contains("mine.toml:6:"), "{text}");
}

/// The report of a MERL table says that reciprocity was not tried, and why.
#[test]
fn a_merl_file_is_checked() {
    let desk = tempfile::tempdir().unwrap();
    let bytes = MerlTable::bake(|_, _| [0.25; 3]);
    std::fs::write(desk.path().join("grey.binary"), bytes).unwrap();
    let line = ["check", "grey.binary", "--theta", "60", "--samples", "2^16", "--format", "json"];
    let (code, text) = gonio(desk.path(), &line);
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("cannot fail by construction: the table is stored over θh"), "{text}");
}
