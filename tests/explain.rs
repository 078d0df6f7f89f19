//! The manual of causes: `gonio explain`, `gonio list --mutants`, and what the
//! pages refer to.

use assert_cmd::Command;
use gonio::bsdf::ClaimsPatch;
use gonio::cause::Cause;
use gonio::registry::Registry;
use gonio::{checks, mutants};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Exit code, stdout and stderr.
fn gonio(line: &str) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_gonio")).args(line.split_whitespace()).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/causes")
}

/// The index and all pages, by the name of their file.
fn texts() -> Vec<(String, String)> {
    let mut all = vec![("README".to_string(), std::fs::read_to_string(folder().join("README.md")).unwrap())];
    all.extend(Cause::ALL.map(|c| (c.slug().to_string(), c.page().to_string())));
    all
}

/// The text without its blocks of code.
fn prose(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// The targets of links within the manual.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.starts_with("http"))
}

#[test]
fn every_cause_prints_its_page() {
    for cause in Cause::ALL {
        let (code, out, err) = gonio(&format!("explain {cause}"));
        assert_eq!((code, err.as_str()), (0, ""), "{cause}");
        assert!(out.starts_with(&format!("# {cause}: ")), "{out}");
        assert_eq!(out, cause.page());
    }
}

#[test]
fn without_a_cause_all_are_listed() {
    let (code, out, _) = gonio("explain");
    assert_eq!(code, 0);
    assert_eq!(out.lines().count(), 1 + Cause::ALL.len());
    for cause in Cause::ALL {
        let line = out.lines().find(|l| l.split_whitespace().next() == Some(cause.slug()));
        assert!(line.unwrap_or_else(|| panic!("no {cause} in {out}")).ends_with(cause.statement()));
    }
}

#[test]
fn an_unknown_cause_is_told_with_the_nearest() {
    for (line, part) in [
        ("explain half-vector-jacobean", "did you mean `half-vector-jacobian`?"),
        ("explain lobe", "did you mean `lobe-probability`?"),
        ("explain zzz", "there are constant-factor, "),
        ("explain support frame", "frame"),
    ] {
        let (code, out, err) = gonio(line);
        assert_eq!((code, out.as_str()), (2, ""), "{line}: {err}");
        assert!(err.contains(part), "{line}: {err}");
    }
}

#[test]
fn mutants_are_listed_with_their_cause() {
    let (code, out, _) = gonio("list --mutants");
    assert_eq!(code, 0);
    for mutant in mutants::all().into_iter().chain(mutants::controls()) {
        let line = out.lines().find(|l| l.split_whitespace().next() == Some(mutant.model_name().as_str()));
        let line = line.unwrap_or_else(|| panic!("no {} in {out}", mutant.name));
        let cause = mutant.cause.map_or("none", Cause::slug);
        assert_eq!(line.split_whitespace().nth(1), Some(cause), "{line}");
        assert!(line.ends_with(mutant.what), "{line}");
    }
    assert!(!gonio("list").1.contains("mutant-"), "they are hidden");
    assert_eq!(gonio("list lambert --mutants").0, 2);
}

/// A word in code style that could be one is the id of a check, a claim or a model;
/// causes are links.
#[test]
fn pages_name_only_what_exists() {
    let registry = Registry::builtin();
    let known: BTreeSet<&str> = checks::all()
        .iter()
        .map(|c| c.id())
        .chain(ClaimsPatch::NAMES)
        .chain(registry.models().map(|m| m.name()))
        .collect();
    for (page, text) in texts() {
        let prose = prose(&text);
        assert_eq!(prose.matches('`').count() % 2, 0, "{page}: an open `");
        for word in prose.split('`').skip(1).step_by(2) {
            let is_word = word.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
            assert!(!is_word || known.contains(word), "{page}: `{word}` is no check, claim or model");
        }
        assert!(checks::all().iter().any(|c| prose.contains(&format!("`{}`", c.id()))), "{page}");
    }
}

#[test]
fn pages_link_only_pages_that_exist() {
    let slugs: BTreeSet<&str> = Cause::ALL.iter().map(|c| c.slug()).collect();
    for (page, text) in texts() {
        for link in links(&text) {
            let slug = link.strip_suffix(".md").unwrap_or_else(|| panic!("{page}: {link}"));
            assert!(slugs.contains(slug), "{page}: {link}");
            assert_ne!(slug, page, "a link to itself");
            assert!(text.contains(&format!("[{slug}]({slug}.md)")), "{page}: {link} under another name");
        }
    }
    let index = &texts()[0].1;
    let linked: BTreeSet<_> = links(index).filter_map(|l| l.strip_suffix(".md")).collect();
    assert_eq!(linked, slugs, "the index has every page");
    let files: BTreeSet<_> =
        std::fs::read_dir(folder()).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    let wanted = slugs.iter().map(|s| format!("{s}.md")).chain(["README.md".to_string()]);
    assert_eq!(files, wanted.collect(), "a page for each cause, and no other file");
}

/// Links to the outside stand on lines of their own, so that the rest fits.
#[test]
fn pages_have_the_same_parts_and_fit_a_terminal() {
    for (page, text) in texts().into_iter().skip(1) {
        let parts: Vec<_> = text.lines().filter_map(|l| l.strip_prefix("## ")).collect();
        let common = [
            "What must hold",
            "What is done instead",
            "Classic mistakes",
            "How it shows",
            "Easily confused with",
            "How to fix it",
        ];
        assert_eq!(parts[..common.len()], common, "{page}");
        assert!(parts[common.len()].starts_with("Seen in "), "{page}");
        assert!((60..=120).contains(&text.lines().count()), "{page}: {} lines", text.lines().count());
        for (number, line) in text.lines().enumerate() {
            let fits = line.chars().count() <= 80 || number == 2 || line.trim_start().starts_with("https://");
            assert!(fits, "{page}: line {} is too long: {line}", number + 1);
        }
    }
}
