//! Programs outside of /usr, as a sandbox can show them.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// The folders of programs that every sandbox has.
const USUAL: &str = "/usr/local/bin:/usr/bin:/bin";

/// Links that are followed, as the system does.
const LINKS: usize = 40;

/// A command whose program was found.
#[derive(Debug)]
pub struct Found {
    /// The program as the sandbox calls it, and its arguments.
    pub words: Vec<OsString>,
    /// Folders that it needs to see.
    pub mounts: Vec<PathBuf>,
}

/// PATH in the sandbox: the programs of the folders that it may read, and the usual ones.
pub fn path(readable: &[PathBuf]) -> OsString {
    let mut path = OsString::new();
    for folder in readable.iter().flat_map(|folder| programs_of(folder)) {
        path.push(folder);
        path.push(":");
    }
    path.push(USUAL);
    path
}

/// The folders of programs in a folder: itself, its `bin`, those of a home of rustup.
fn programs_of(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    if folder.ends_with("bin") {
        all.push(folder.to_path_buf());
    }
    all.push(folder.join("bin"));
    // rustup's own `rustc` would look for a home and be let down; the toolchain's does not.
    let settings = std::fs::read_to_string(folder.join("settings.toml")).unwrap_or_default();
    let settings: toml::Table = toml::from_str(&settings).unwrap_or_default();
    if let Some(toolchain) = settings.get("default_toolchain").and_then(|name| name.as_str()) {
        all.push(folder.join("toolchains").join(toolchain).join("bin"));
    }
    all.retain(|folder| folder.is_dir());
    all
}

/// The folders that the packages of a Python in `prefix` name, as those do that are installed
/// to be edited: each is a line of a file `.pth`.
pub fn named_by(prefix: &Path) -> Vec<String> {
    let files = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path());
    let packages = files(&prefix.join("lib")).map(|python| python.join("site-packages"));
    let lists = packages.flat_map(|packages| files(&packages).collect::<Vec<_>>());
    let lists = lists.filter(|file| file.extension().is_some_and(|e| e == "pth"));
    let texts: Vec<String> = lists.filter_map(|file| std::fs::read_to_string(file).ok()).collect();
    let lines = texts.iter().flat_map(|text| text.lines()).map(str::trim);
    lines.filter(|line| Path::new(line).is_absolute()).map(String::from).collect()
}

/// Finds the program of a command: in the sandbox's own folder where it has a path from
/// there, else where this machine has it.
pub fn find(words: &[OsString], readable: &[PathBuf]) -> Result<Found, String> {
    let (program, arguments) = words.split_first().ok_or("a command without a program")?;
    let given = Path::new(program);
    let as_is = |program: PathBuf, mounts| {
        let words = std::iter::once(program.into_os_string()).chain(arguments.iter().cloned()).collect();
        Ok(Found { words, mounts })
    };
    if given.is_absolute() {
        return as_is(given.into(), mounts(given)?);
    }
    if given.components().count() > 1 || program.as_encoded_bytes().starts_with(b".") {
        return as_is(given.into(), Vec::new());
    }
    let mut places = path(readable);
    if let Some(more) = std::env::var_os("PATH") {
        places = std::env::join_paths(
            readable.iter().flat_map(|folder| programs_of(folder)).chain(std::env::split_paths(&more)),
        )
        .unwrap_or(places);
    }
    let mut why = None;
    for found in std::env::split_paths(&places).map(|folder| folder.join(given)).filter(|p| p.is_file()) {
        match mounts(&found) {
            Ok(mounts) => return as_is(found, mounts),
            Err(e) => why = why.or(Some(e)),
        }
    }
    Err(why.unwrap_or_else(|| format!("there is no program `{}` in PATH", given.display())))
}

/// The folders that a program, and what it is a link to, needs: those above `bin`, unless
/// they are the system's.
fn mounts(program: &Path) -> Result<Vec<PathBuf>, String> {
    let mut all = Vec::new();
    let mut at = program.to_path_buf();
    for _ in 0..LINKS {
        if !is_system(&at) {
            all.push(prefix(&at)?);
        }
        match std::fs::read_link(&at) {
            Ok(to) => at = at.parent().unwrap_or(Path::new("/")).join(to),
            Err(_) => break,
        }
    }
    // Folders on the way may be links too.
    let real = program.canonicalize().map_err(|e| format!("`{}` cannot be read: {e}", program.display()))?;
    if !is_system(&real) {
        all.push(prefix(&real)?);
    }
    all.sort();
    all.dedup();
    Ok(all)
}

fn is_system(path: &Path) -> bool {
    ["/usr", "/bin", "/sbin", "/lib", "/etc/alternatives"].iter().any(|system| path.starts_with(system))
}

/// The folder above `bin`, if it may be shown.
fn prefix(program: &Path) -> Result<PathBuf, String> {
    let refused = |why: &str| {
        Err(format!(
            "`{}` cannot be shown to a sandbox: {why}; name a program under /usr or in a `bin` of its own",
            program.display()
        ))
    };
    let Some(bin) = program.parent().filter(|folder| folder.file_name() == Some(OsStr::new("bin"))) else {
        return refused("it is in no folder `bin`");
    };
    let Some(prefix) = bin.parent().and_then(|prefix| prefix.canonicalize().ok()) else {
        return refused("its folder cannot be read");
    };
    let home = std::env::home_dir().and_then(|home| home.canonicalize().ok());
    if prefix.parent().is_none() || home.is_some_and(|home| home.starts_with(&prefix)) {
        return refused("that would show all of the home folder, or everything");
    }
    // As it is called, too: a venv knows itself by its path.
    Ok(bin.parent().unwrap_or(&prefix).to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    fn program(path: &Path) {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "#!/bin/sh\n").unwrap();
    }

    #[test]
    fn links_are_followed() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        program(&root.join("python/bin/python3.11"));
        symlink("python3.11", root.join("python/bin/python3")).unwrap();
        std::fs::create_dir_all(root.join("venv/bin")).unwrap();
        symlink(root.join("python/bin/python3"), root.join("venv/bin/python3")).unwrap();
        let words = [root.join("venv/bin/python3").into_os_string(), "x.py".into()];
        let found = find(&words, &[]).unwrap();
        assert_eq!(found.words, words);
        assert_eq!(found.mounts, [root.join("python"), root.join("venv")]);
        // By name, among the programs of what may be read.
        let found = find(&["python3".into()], &[root.join("venv")]).unwrap();
        assert_eq!(found.words, [root.join("venv/bin/python3")]);
        program(&root.join("shims/python3"));
        let why = find(&[root.join("shims/python3").into()], &[]).unwrap_err();
        assert!(why.contains("it is in no folder `bin`"), "{why}");
    }

    #[test]
    fn the_home_folder_is_not_shown() {
        let home = std::env::home_dir().unwrap();
        let why = prefix(&home.join("bin/tool")).unwrap_err();
        assert!(why.contains("home folder"), "{why}");
        assert!(prefix(Path::new("/bin/tool")).is_err());
    }

    #[test]
    fn what_needs_no_looking_for() {
        for words in [["./brdf", "a b"], ["bin/brdf", ""]] {
            let words = words.map(OsString::from);
            let found = find(&words, &[]).unwrap();
            assert_eq!((found.words, found.mounts), (words.to_vec(), vec![]));
        }
        assert!(find(&["sh".into()], &[]).unwrap().mounts.is_empty());
        let why = find(&["no-such-program".into()], &[]).unwrap_err();
        assert!(why.contains("no program `no-such-program`"), "{why}");
    }

    #[test]
    fn programs_of_rustup() {
        let folder = tempfile::tempdir().unwrap();
        let bin = folder.path().join("toolchains/stable-x/bin");
        std::fs::create_dir_all(&bin).unwrap();
        std::fs::write(folder.path().join("settings.toml"), "default_toolchain = \"stable-x\"\n").unwrap();
        let path = path(&[folder.path().into()]);
        assert_eq!(path.to_str().unwrap(), format!("{}:{USUAL}", bin.display()));
    }
}
