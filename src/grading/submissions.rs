//! Submissions: folders and zips, found by the pattern of a rubric.

use super::rubric::Rubric;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};

/// A submission unpacks to at most so much; a BRDF is a few kilobytes of text.
const MOST_BYTES: u64 = 64 << 20;
/// And to so many files.
const MOST_FILES: usize = 2000;

/// A submission where it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Submission {
    /// What it is called: a plain name.
    pub id: String,
    /// Named parts of its file's name.
    pub names: BTreeMap<String, String>,
    /// A folder or a zip.
    pub path: PathBuf,
}

/// What was found, and what was passed over with the reason.
#[derive(Debug, Default)]
pub struct Submissions {
    /// By id.
    pub all: Vec<Submission>,
    /// In sentences.
    pub passed_over: Vec<String>,
}

/// Finds submissions: each of `paths` is one, or a folder of them. A student's `own` may be
/// called as it likes.
///
/// # Errors
/// In a sentence: a path that cannot be read, two of one id, none at all.
pub fn find(paths: &[PathBuf], rubric: &Rubric, own: bool) -> Result<Submissions, String> {
    let mut found = Submissions::default();
    for path in paths {
        let unreadable = |e: io::Error| format!("{} cannot be read: {e}", path.display());
        if is_zip(path) || path.is_dir() && is_submission(path, rubric) {
            found.add(path, rubric, own);
            continue;
        }
        let mut entries: Vec<PathBuf> =
            fs::read_dir(path).map_err(unreadable)?.flatten().map(|e| e.path()).collect();
        entries.sort();
        for entry in entries {
            let hidden = entry.file_name().is_some_and(|n| n.to_string_lossy().starts_with('.'));
            if !hidden && (is_zip(&entry) || entry.is_dir() && !entry.is_symlink()) {
                found.add(&entry, rubric, own);
            } else if !hidden {
                found.passed_over.push(format!("{} is neither a folder nor a zip", entry.display()));
            }
        }
    }
    found.all.sort_by(|a, b| a.id.cmp(&b.id));
    if let Some(pair) = found.all.windows(2).find(|pair| pair[0].id == pair[1].id) {
        let [a, b] = [&pair[0], &pair[1]].map(|s| s.path.display().to_string());
        return Err(format!(
            "`{}` is the id of {a} and of {b}: give `id` in [submissions] what tells them apart",
            pair[0].id
        ));
    }
    if found.all.is_empty() {
        let places: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
        let passed: String = found.passed_over.iter().map(|why| format!("; {why}")).collect();
        return Err(format!("no submission in {}{passed}", places.join(", ")));
    }
    Ok(found)
}

fn is_zip(path: &Path) -> bool {
    path.is_file() && path.extension().is_some_and(|e| e.eq_ignore_ascii_case("zip"))
}

/// Whether a folder is a submission rather than a folder of them.
fn is_submission(folder: &Path, rubric: &Rubric) -> bool {
    rubric.languages.iter().any(|language| folder.join(&language.when).is_file())
}

impl Submissions {
    fn add(&mut self, path: &Path, rubric: &Rubric, own: bool) {
        // `.` has a name of its own.
        let real = path.canonicalize().unwrap_or_else(|_| path.into());
        let name = if is_zip(path) { real.file_stem() } else { real.file_name() };
        let name = name.unwrap_or_default().to_string_lossy().into_owned();
        if own {
            let id = plain(&name);
            return self.all.push(Submission { id, names: BTreeMap::new(), path: path.into() });
        }
        let Some(captures) = rubric.pattern.captures(&name) else {
            let pattern = rubric.pattern.as_str().trim_start_matches("^(?:").trim_end_matches(")$");
            self.passed_over.push(format!("{} does not fit the pattern `{pattern}`", path.display()));
            return;
        };
        let group = |name: &str| captures.name(name).map_or("", |m| m.as_str()).to_string();
        let names: BTreeMap<String, String> =
            rubric.pattern.capture_names().flatten().map(|n| (n.to_string(), group(n))).collect();
        let value = |name: &str| names.get(name).cloned().unwrap_or_default();
        let id = rubric.id.as_ref().map_or(name, |template| template.fill(value));
        self.all.push(Submission { id: plain(&id), names, path: path.into() });
    }
}

/// A name that is one part of a path everywhere, and no other's.
fn plain(id: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_.@ ".contains(c);
    let same: String = id.trim().chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
    match same.trim_start_matches('.') {
        "" => "unnamed".into(),
        // Names of files end at 255 bytes, and some have an ending.
        rest => {
            let end =
                rest.char_indices().map(|(at, c)| at + c.len_utf8()).take_while(|end| *end <= 200).last();
            rest[..end.unwrap_or(0)].into()
        }
    }
}

impl Submission {
    /// Its files below `into`, which is empty: links and devices are left out. A zip that
    /// holds one folder is that folder.
    ///
    /// # Errors
    /// In a sentence: a damaged zip, paths that lead elsewhere, too many files or bytes.
    pub fn unpack(&self, into: &Path) -> Result<(), String> {
        let mut room = Room { bytes: MOST_BYTES, files: MOST_FILES };
        if self.path.is_dir() {
            return room.copy(&self.path, into, 0);
        }
        let file = File::open(&self.path).map_err(|e| format!("it cannot be read: {e}"))?;
        let damaged = |e: zip::result::ZipError| format!("it is no whole zip: {e}");
        let mut archive = zip::ZipArchive::new(io::BufReader::new(file)).map_err(damaged)?;
        let top = single_folder(&archive);
        for k in 0..archive.len() {
            let mut entry = archive.by_index(k).map_err(damaged)?;
            if entry.is_dir() || entry.is_symlink() {
                continue;
            }
            let name = entry.name().map_or_else(|_| "a file".into(), |name| format!("`{name}`"));
            let path = entry.enclosed_name().ok_or_else(|| format!("{name} in its zip leads elsewhere"))?;
            let path = top.as_ref().and_then(|top| path.strip_prefix(top).ok()).unwrap_or(&path);
            if is_clutter(path) {
                continue;
            }
            room.write(&into.join(path), &mut entry)?;
        }
        Ok(())
    }
}

/// The one folder that holds everything in a zip, as tools make it.
fn single_folder(archive: &zip::ZipArchive<io::BufReader<File>>) -> Option<PathBuf> {
    let files: Vec<PathBuf> = archive
        .file_names()
        .filter_map(|name| name.ok())
        .filter(|name| !name.ends_with('/'))
        .map(|name| PathBuf::from(name.as_ref()))
        .filter(|path| !is_clutter(path))
        .collect();
    let first = match files.first()?.components().next()? {
        Component::Normal(first) => PathBuf::from(first),
        _ => return None,
    };
    files.iter().all(|path| path.starts_with(&first) && *path != first).then_some(first)
}

/// What systems and tools put beside the files that were meant.
fn is_clutter(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.starts_with("__MACOSX") || name.starts_with('.') || name == "__pycache__"
}

/// What may still be unpacked.
struct Room {
    bytes: u64,
    files: usize,
}

impl Room {
    fn copy(&mut self, from: &Path, into: &Path, depth: usize) -> Result<(), String> {
        // Deeper is a mistake, or a trap.
        if depth > 16 {
            return Err("its folders are nested more than 16 deep".into());
        }
        let unreadable = |e: io::Error| format!("{} cannot be read: {e}", from.display());
        for entry in fs::read_dir(from).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let kind = entry.file_type().map_err(unreadable)?;
            let (path, target) = (entry.path(), into.join(entry.file_name()));
            if is_clutter(&path) {
                continue;
            }
            if kind.is_dir() {
                self.copy(&path, &target, depth + 1)?;
            } else if kind.is_file() {
                let mut file =
                    File::open(&path).map_err(|e| format!("{} cannot be read: {e}", path.display()))?;
                self.write(&target, &mut file)?;
            }
        }
        Ok(())
    }

    fn write(&mut self, path: &Path, from: &mut dyn Read) -> Result<(), String> {
        self.files = self.files.checked_sub(1).ok_or(format!("it has more than {MOST_FILES} files"))?;
        let failed = |e: io::Error| format!("`{}` cannot be unpacked: {e}", path.display());
        fs::create_dir_all(path.parent().unwrap_or(Path::new("."))).map_err(failed)?;
        let mut file = File::create(path).map_err(failed)?;
        // A zip may unpack to more than it says.
        let written = io::copy(&mut from.take(self.bytes + 1), &mut file).map_err(failed)?;
        file.flush().map_err(failed)?;
        self.bytes =
            self.bytes.checked_sub(written).ok_or(format!("it has more than {} MiB", MOST_BYTES >> 20))?;
        Ok(())
    }
}

/// Puts files and folders of the course over those of a submission.
pub fn overlay(files: &[PathBuf], into: &Path) -> Result<(), String> {
    let mut room = Room { bytes: u64::MAX / 2, files: usize::MAX };
    for path in files {
        let target = into.join(path.file_name().unwrap_or_default());
        let failed = |e: io::Error| format!("{} cannot be copied: {e}", path.display());
        // What the submission has there is not the course's.
        let _ = fs::remove_dir_all(&target);
        let _ = fs::remove_file(&target);
        if path.is_dir() {
            room.copy(path, &target, 0)?;
        } else {
            room.write(&target, &mut File::open(path).map_err(failed)?)?;
        }
    }
    Ok(())
}

/// A digest of all files below a folder, by their names.
pub fn digest(folder: &Path) -> io::Result<blake3::Hash> {
    let mut hasher = blake3::Hasher::new();
    let mut open = vec![folder.to_path_buf()];
    let mut files = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            if entry.file_type()?.is_dir() {
                open.push(entry.path());
            } else {
                files.push(entry.path());
            }
        }
    }
    files.sort();
    for path in files {
        let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().into_owned();
        hasher.update(&(name.len() as u64).to_le_bytes());
        hasher.update(name.as_bytes());
        hasher.update(blake3::hash(&fs::read(&path)?).as_bytes());
    }
    Ok(hasher.finalize())
}
