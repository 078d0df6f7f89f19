//! Where the parts of a report lie, seen from the root of the repository.

use crate::registry::{Spelling, Value};
use crate::report::folder::REPORT;
use crate::report::json::{Report, SubjectId};
use std::path::{Component, Path, PathBuf};

/// The longest ending of a file's name.
const ENDING: usize = 10;

/// The folders that paths are told from. Servers show what they are told about a file
/// only if its path is that from the repository's root.
#[derive(Clone, Debug)]
pub struct Site {
    root: PathBuf,
    current: PathBuf,
    report: String,
    folder: PathBuf,
}

/// A line of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spot {
    /// From the repository's root, with `/` between its parts.
    pub file: String,
    /// From 1.
    pub line: usize,
}

impl Site {
    /// Of a report in `folder`; `root` is that of the repository, `current` is what paths
    /// were typed in. Both are absolute.
    pub fn new(root: &Path, current: &Path, folder: &Path) -> Self {
        let mut site =
            Self { root: root.into(), current: current.into(), report: REPORT.into(), folder: folder.into() };
        if let Some(found) = site.relative(&folder.join(REPORT)) {
            site.report = found;
        }
        site
    }

    /// report.json, from the root; without its folder where that lies elsewhere.
    pub fn report(&self) -> &str {
        &self.report
    }

    /// The report's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Whether that is the report's folder.
    pub fn is_at(&self, folder: &Path) -> bool {
        lexical(&self.current.join(folder)) == lexical(&self.current.join(&self.folder))
    }

    /// A path from the root; `None` of what lies elsewhere.
    fn relative(&self, path: &Path) -> Option<String> {
        let path = lexical(&self.current.join(path))?;
        let parts: Option<Vec<&str>> = path
            .strip_prefix(lexical(&self.root)?)
            .ok()?
            .components()
            .map(|part| part.as_os_str().to_str())
            .collect();
        parts.filter(|p| !p.is_empty()).map(|p| p.join("/"))
    }

    /// A subject's name without the folders of this machine: paths from the repository's
    /// root, and of a program elsewhere only its name.
    pub fn portable(&self, name: &str) -> String {
        let mut text = name.to_string();
        for folder in [&self.current, &self.root].into_iter().filter_map(|f| f.to_str()) {
            // A root that is the whole disk would leave relative paths that are none.
            if folder.len() > 1 {
                text = text.replace(&format!("{folder}/"), "");
            }
        }
        let end = text.find([' ', ':', '#']).unwrap_or(text.len());
        match text[..end].rfind('/') {
            Some(slash) if text.starts_with('/') => text.split_off(slash + 1),
            _ => text,
        }
    }

    /// The line to go to for a subject: the one that asks for it in its suite; else the
    /// file that its name tells; else the report.
    pub fn spot(&self, report: &Report, subject: &SubjectId) -> Spot {
        let entry =
            report.subjects.iter().find(|entry| entry.name == subject.name && entry.label == subject.label);
        let source = entry.and_then(|entry| entry.source.as_ref());
        let asked = source.and_then(|s| Some((self.relative(Path::new(&s.file))?, s.line.max(1))));
        let (file, line) = asked
            .or_else(|| Some((self.file_in(&subject.name)?, 1)))
            .unwrap_or_else(|| (self.report.clone(), 1));
        Spot { file, line }
    }

    /// The file that a subject's name tells: of a command the first of its words that
    /// looks like one, the program last; or the one of its parameter `file`.
    fn file_in(&self, name: &str) -> Option<String> {
        let spelling: Option<Spelling> = name.parse().ok();
        let given = spelling.as_ref().map_or(name, |s| &s.name);
        let given = given.rsplit_once('#').map_or(given, |(file, _)| file);
        let words = match given.contains(char::is_whitespace) {
            true => shell_words::split(given).unwrap_or_default(),
            false => vec![given.to_string()],
        };
        let parameters = spelling.iter().flat_map(|s| &s.parameters);
        let files = parameters.filter_map(|(key, value)| match value {
            Value::Text(text) if key == "file" => Some(text.clone()),
            _ => None,
        });
        let mut candidates = words.iter().skip(1).chain(words.first()).cloned().chain(files);
        candidates.find_map(|word| self.relative(Path::new(&word)).filter(|_| looks_like_a_file(&word)))
    }
}

/// Without `.` and `..`; `None` where it leads above its beginning.
fn lexical(path: &Path) -> Option<PathBuf> {
    let mut found = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                if !found.pop() {
                    return None;
                }
            }
            other => found.push(other),
        }
    }
    Some(found)
}

fn looks_like_a_file(word: &str) -> bool {
    let ending = Path::new(word).extension().and_then(|e| e.to_str()).unwrap_or_default();
    let is_ending = |e: &str| {
        (1..=ENDING).contains(&e.len())
            && e.chars().all(char::is_alphanumeric)
            && e.contains(char::is_alphabetic)
    };
    !word.starts_with('-') && (word.contains('/') || is_ending(ending))
}

#[cfg(test)]
mod tests {
    use super::super::examples::report;
    use super::*;
    use crate::report::json::SubjectEntry;
    use crate::suite::Source;

    fn site() -> Site {
        Site::new(Path::new("/repo"), Path::new("/repo/materials"), Path::new("out"))
    }

    #[test]
    fn paths_are_told_from_the_root_and_never_absolute() {
        assert_eq!(site().report(), "materials/out/report.json");
        let elsewhere = Site::new(Path::new("/repo"), Path::new("/repo"), Path::new("/tmp/out"));
        assert_eq!(elsewhere.report(), "report.json");
        assert!(elsewhere.is_at(Path::new("../tmp/out")) && !elsewhere.is_at(Path::new("out")));
        let relative = |path: &str| site().relative(Path::new(path));
        assert_eq!(relative("./a/../b.toml").as_deref(), Some("materials/b.toml"));
        assert_eq!(relative("../b.toml").as_deref(), Some("b.toml"));
        assert_eq!(relative("/repo/x/b.toml").as_deref(), Some("x/b.toml"));
        for outside in ["../../b.toml", "/etc/passwd", "../../../../../x", "/repo", "/repository/x"] {
            assert_eq!(relative(outside), None, "{outside}");
        }
    }

    #[test]
    fn names_are_the_same_on_every_machine() {
        for (name, told) in [
            ("lambert:reflectance=0.5", "lambert:reflectance=0.5"),
            ("./brdf.so:alpha=0.1", "./brdf.so:alpha=0.1"),
            ("/usr/bin/python3 brdf.py fast", "python3 brdf.py fast"),
            ("/usr/bin/python3 /repo/src/brdf.py", "python3 src/brdf.py"),
            ("/repo/materials/brdf.so#one:file=/repo/a.binary", "brdf.so#one:file=a.binary"),
            ("/opt/a/brdf.so:file=x/y", "brdf.so:file=x/y"),
            ("node /x/y.js", "node /x/y.js"),
        ] {
            assert_eq!(site().portable(name), told);
        }
    }

    #[test]
    fn a_subject_without_a_line_is_at_its_file_or_at_the_report() {
        let mut found = report();
        let mut at = |name: &str, source: Option<&str>| {
            let id = &mut found.results[0].subject;
            id.name = name.into();
            let id = id.clone();
            let source = source.map(|file| Source { file: file.into(), line: 7 });
            found.subjects = vec![SubjectEntry {
                name: name.into(),
                label: None,
                digest: String::new(),
                source,
                carried: false,
            }];
            let spot = site().spot(&found, &id);
            (spot.file, spot.line)
        };
        let whole = |file: &str, line| (file.to_string(), line);
        assert_eq!(at("lambert", Some("seed.toml")), whole("materials/seed.toml", 7));
        assert_eq!(
            at("lambert:reflectance=0.5", Some("/tmp/seed.toml")),
            whole("materials/out/report.json", 1)
        );
        assert_eq!(at("lambert", None), whole("materials/out/report.json", 1));
        assert_eq!(at("./brdf.so:alpha=0.1", None), whole("materials/brdf.so", 1));
        assert_eq!(at("brdf.py#rough:alpha=0.1", None), whole("materials/brdf.py", 1));
        assert_eq!(at("node --check src/brdf.js", None), whole("materials/src/brdf.js", 1));
        assert_eq!(at("./wrap.sh src/brdf.js", None), whole("materials/src/brdf.js", 1));
        assert_eq!(at("./wrap.sh --fast", None), whole("materials/wrap.sh", 1));
        assert_eq!(at("/usr/bin/python3 ../brdf.py", None), whole("brdf.py", 1));
        assert_eq!(at("merl:file=data/red.binary", None), whole("materials/data/red.binary", 1));
        assert_eq!(at("/opt/brdf.so", None), whole("materials/out/report.json", 1));
    }
}
