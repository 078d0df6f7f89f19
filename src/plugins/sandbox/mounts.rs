//! What a program sees in bubblewrap: its arguments.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Where the folder is, or its copy; the second where this machine has something at the
/// first that the program may read.
const WORK: [&str; 2] = ["/work", "/submission"];

/// Where a build finds what it copies.
pub const SOURCE: &str = "/source";

/// Where gonio is: a folder that nothing else is in.
pub const GONIO: &str = "/run/gonio";

/// Nobody, here as everywhere.
const NOBODY: &str = "65534";

/// The folders of programs and libraries, beside /usr: links to it, or folders.
const SYSTEM: [&str; 6] = ["/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32"];

/// What of /etc the dynamic linker and the names of compilers need.
const ETC: [&str; 4] = ["/etc/alternatives", "/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d"];

/// What a program finds.
pub const ENVIRONMENT: [(&str, &str); 8] = [
    ("HOME", "/tmp"),
    ("TMPDIR", "/tmp"),
    ("LANG", "C.UTF-8"),
    // A pool of threads in each of several processes is slower than none.
    ("OPENBLAS_NUM_THREADS", "1"),
    ("OMP_NUM_THREADS", "1"),
    ("MKL_NUM_THREADS", "1"),
    // It cannot write them beside the sources, and would try.
    ("PYTHONDONTWRITEBYTECODE", "1"),
    ("PYTHONUNBUFFERED", "1"),
];

/// What is wanted of a sandbox.
pub struct Wanted<'a> {
    /// At /work.
    pub folder: &'a Path,
    /// Whether /work is a copy that may be written.
    pub build: bool,
    /// Folders that it may read, where they are outside.
    pub open: &'a [PathBuf],
    /// PATH.
    pub path: &'a OsStr,
    /// What it must not see.
    pub hidden: &'a [PathBuf],
    /// Bytes of files.
    pub disk: u64,
    /// gonio's own program.
    pub gonio: &'a Path,
}

/// Where the folder is, beside what it may read.
pub fn work(open: &[PathBuf]) -> &'static str {
    let taken = open.iter().any(|path| path.starts_with(WORK[0]));
    WORK[usize::from(taken)]
}

/// The arguments of bubblewrap.
pub fn arguments(wanted: &Wanted) -> Vec<OsString> {
    let mut all = Arguments(Vec::new());
    all.add(&["--unshare-all", "--unshare-user", "--disable-userns", "--die-with-parent", "--new-session"]);
    all.add(&["--cap-drop", "ALL", "--uid", NOBODY, "--gid", NOBODY, "--hostname", "sandbox", "--clearenv"]);
    for (key, value) in ENVIRONMENT {
        all.add(&["--setenv", key, value]);
    }
    all.add(&["--setenv", "PATH"]).path(wanted.path);
    let disk = wanted.disk.to_string();
    // Before what it may read, which may be there.
    all.add(&["--size", &disk, "--tmpfs", "/tmp"]);
    seen(&mut all, wanted);
    all.add(&["--dev", "/dev", "--remount-ro", "/dev"]);
    // Where gonio is root, nobody in here is root outside, and the files of /proc/sys are
    // root's: without this, it could set the kernel's core_pattern.
    all.add(&["--proc", "/proc", "--remount-ro", "/proc"]);
    let work = work(wanted.open);
    if wanted.build {
        all.add(&["--ro-bind"]).path(wanted.folder).add(&[SOURCE]);
        all.add(&["--size", &disk, "--tmpfs", work]);
    } else {
        all.add(&["--ro-bind"]).path(wanted.folder).add(&[work]);
    }
    all.add(&["--ro-bind"]).path(wanted.gonio).add(&[GONIO]);
    all.add(&["--remount-ro", "/", "--chdir", work]);
    all.0
}

/// The folders of the machine that it sees, the outer ones first, and in them what is
/// hidden again.
fn seen(all: &mut Arguments, wanted: &Wanted) {
    let mut shown: Vec<&Path> = vec![Path::new("/usr")];
    for name in SYSTEM {
        match std::fs::read_link(name) {
            Ok(to) => {
                all.add(&["--symlink"]).path(&to).add(&[name]);
            }
            Err(_) if Path::new(name).is_dir() => shown.push(Path::new(name)),
            Err(_) => {}
        }
    }
    shown.extend(wanted.open.iter().map(PathBuf::as_path));
    shown.extend(ETC.iter().map(Path::new));
    let hidden: Vec<PathBuf> = wanted.hidden.iter().filter_map(|path| path.canonicalize().ok()).collect();
    let covers = hidden.iter().filter(|path| shown.iter().any(|shown| path.starts_with(shown)));
    let mut mounts: Vec<(&Path, bool)> = covers.map(|path| (path.as_path(), true)).collect();
    mounts.extend(shown.iter().map(|path| (*path, false)));
    mounts.sort_by_key(|(path, hides)| (path.components().count(), *hides));
    mounts.dedup();
    for (path, hides) in mounts {
        match (hides, path.is_dir()) {
            (false, _) => all.add(&["--ro-bind-try"]).path(path).path(path),
            (true, true) => all.add(&["--tmpfs"]).path(path),
            (true, false) => all.add(&["--ro-bind", "/dev/null"]).path(path),
        };
    }
}

struct Arguments(Vec<OsString>);

impl Arguments {
    fn add(&mut self, words: &[&str]) -> &mut Self {
        self.0.extend(words.iter().map(OsString::from));
        self
    }

    fn path(&mut self, path: impl AsRef<OsStr>) -> &mut Self {
        self.0.push(path.as_ref().into());
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_hidden_is_covered_and_what_is_in_it_shown() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::fs::create_dir_all(root.join("course/venv/bin")).unwrap();
        std::fs::write(root.join("course/rubric.toml"), "").unwrap();
        std::fs::write(root.join("key"), "").unwrap();
        let wanted = Wanted {
            folder: &root.join("course/one"),
            build: false,
            open: &[root.join("course/venv"), root.clone()],
            path: OsStr::new("/usr/bin"),
            hidden: &[root.join("course"), root.join("key"), root.join("none"), "/root".into()],
            disk: 1 << 20,
            gonio: Path::new("/gonio"),
        };
        let all: Vec<String> =
            arguments(&wanted).iter().map(|word| word.to_string_lossy().into_owned()).collect();
        let all = all.join(" ");
        let at = |part: String| all.find(&part).unwrap_or_else(|| panic!("no `{part}` in {all}"));
        let root = root.display();
        let outer = at(format!("--ro-bind-try {root} {root} "));
        let cover = at(format!("--tmpfs {root}/course "));
        let inner = at(format!("--ro-bind-try {root}/course/venv {root}/course/venv "));
        assert!(outer < cover && cover < inner, "{all}");
        at(format!("--ro-bind /dev/null {root}/key "));
        assert!(!all.contains("/root "), "not shown, so not hidden: {all}");
    }
}
