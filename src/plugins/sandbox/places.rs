//! Which paths a program has business with: this decides what is told of, not what it gets.

use super::incident::Phase;
use super::mounts::GONIO;
use super::rules::Rules;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// What every sandbox shows.
const SHOWN: &[&str] = &[
    "/usr",
    "/bin",
    "/sbin",
    "/lib",
    "/lib32",
    "/lib64",
    "/libx32",
    "/tmp",
    "/dev",
    "/etc/alternatives",
    "/etc/ld.so.cache",
    "/etc/ld.so.conf",
    "/etc/ld.so.conf.d",
    // The dynamic linker looks for it in each program.
    "/etc/ld.so.preload",
];

/// What is not there, and honest programs look for: libraries, for the number of
/// processors, the time zone and the names of users; compilers, for what system this is
/// and what else is installed.
const LOOKED_FOR: &[&str] = &[
    "/sys/devices/system/cpu",
    "/sys/devices/system/node",
    "/sys/devices/virtual/dmi",
    "/sys/kernel/mm",
    "/sys/fs/cgroup",
    "/sys/fs/selinux",
    "/selinux",
    "/etc/selinux",
    "/etc/localtime",
    "/etc/timezone",
    "/etc/nsswitch.conf",
    "/etc/locale.alias",
    "/etc/debian_version",
    "/opt/rocm",
    "/opt/cuda",
];

/// The same while it is built.
const BUILDING: &[&str] = &["/source", "/include", "/etc/env.d"];

/// What of /proc tells of the machine and not of others.
const OF_PROC: &[&str] = &[
    "self",
    "thread-self",
    "cpuinfo",
    "meminfo",
    "stat",
    "loadavg",
    "mounts",
    "filesystems",
    "version",
    "uptime",
    "sys",
];

/// Where it may write, whatever it is for.
const WRITABLE: &[&str] = &["/tmp", "/dev", "/proc/self"];

/// `path` from `folder`, without `.` and `..`.
pub fn absolute(folder: &Path, path: &Path) -> PathBuf {
    let mut all = PathBuf::from("/");
    for part in folder.join(path).components() {
        match part {
            Component::ParentDir => {
                all.pop();
            }
            Component::Normal(name) => all.push(name),
            _ => {}
        }
    }
    all
}

/// Whether a program may look at this path; `own` is its number in the sandbox.
pub fn may_read(path: &Path, rules: &Rules, own: Option<u32>) -> bool {
    let more = || rules.open.iter().chain([&rules.work]).map(Path::new);
    let shown = || SHOWN.iter().map(Path::new).chain(more());
    // Code that panics is looked up there, and beside it.
    let is_gonio =
        path.parent() == Path::new(GONIO).parent() && path.file_stem() == Some(OsStr::new("gonio"));
    if is_gonio || rules.named.iter().any(|folder| path.starts_with(folder)) {
        return true;
    }
    // What is above it is on the way there.
    if shown().any(|place| path.starts_with(place) || place.starts_with(path)) {
        return true;
    }
    if LOOKED_FOR.iter().any(|place| path.starts_with(place) || Path::new(place).starts_with(path)) {
        return true;
    }
    if let Ok(rest) = path.strip_prefix("/proc") {
        let Some(Component::Normal(first)) = rest.components().next() else { return true };
        let first = first.to_string_lossy();
        let process = first.parse::<u32>().ok();
        // What is built has many processes, all of them its own.
        return OF_PROC.contains(&&*first)
            || process.is_some_and(|p| Some(p) == own || (p != 1 && rules.phase == Phase::Build));
    }
    if rules.phase == Phase::Build && BUILDING.iter().any(|place| path.starts_with(place)) {
        return true;
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    (path.parent() == Some(Path::new("/etc")) && name.ends_with("-release")) || is_pythons(path, rules)
}

/// Whether Python looks for its library there: lib/python… in every folder above its own.
fn is_pythons(path: &Path, rules: &Rules) -> bool {
    let above = rules.open.iter().flat_map(|open| Path::new(open).ancestors());
    let rest = above.filter_map(|folder| path.strip_prefix(folder).ok()).find_map(|rest| {
        let mut parts = rest.components().map(|part| part.as_os_str().to_string_lossy().into_owned());
        Some((parts.next()?, parts.next()?)).filter(|(first, _)| first.starts_with("lib"))
    });
    rest.is_some_and(|(_, second)| second.starts_with("python"))
}

/// Whether it may write there.
pub fn may_write(path: &Path, rules: &Rules) -> bool {
    WRITABLE.iter().any(|place| path.starts_with(place))
        || (rules.phase == Phase::Build && path.starts_with(&rules.work))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rules(phase: Phase) -> Rules {
        Rules {
            phase,
            library: false,
            watched: true,
            memory: 0,
            processor: None,
            clock: None,
            processes: 1,
            disk: 0,
            work: "/work".into(),
            open: vec!["/home/t/venv".into()],
            named: vec!["/home/u/package".into()],
        }
    }

    #[test]
    fn paths_are_made_absolute() {
        let from = |folder: &str, path: &str| absolute(Path::new(folder), Path::new(path));
        assert_eq!(from("/work", "../rubric.toml"), Path::new("/rubric.toml"));
        assert_eq!(from("/work/a", "./../../../x//y/."), Path::new("/x/y"));
        assert_eq!(from("/work", "/usr/lib/../../etc/passwd"), Path::new("/etc/passwd"));
    }

    #[test]
    fn what_is_a_program_s_business() {
        let run = rules(Phase::Run);
        let may = |path: &str| may_read(Path::new(path), &run, Some(7));
        for path in [
            "/",
            "/usr/lib/x",
            "/work/brdf.py",
            "/home",
            "/home/t/venv/lib",
            "/proc/self/maps",
            "/proc/7/status",
            "/proc/cpuinfo",
            "/etc/os-release",
            "/sys/devices/system/cpu/online",
            "/lib/x",
            "/etc",
            "/home/lib/python311.zip",
            "/home/u/package/brdf",
            "/run/gonio",
            "/run/gonio.dwp",
        ] {
            assert!(may(path), "{path}");
        }
        for path in [
            "/rubric.toml",
            "/home/t/x",
            "/etc/passwd",
            "/proc/1/environ",
            "/proc/8/mem",
            "/autograder/results/results.json",
            "/workshop",
            "/source/x",
            "/etc/x/y-release",
            "/home/lib/secret",
            "/home/u/other",
            "/run/other",
            "/var/lib/python311.zip",
        ] {
            assert!(!may(path), "{path}");
        }
        let build = rules(Phase::Build);
        assert!(may_read(Path::new("/source/x"), &build, None));
        assert!(may_read(Path::new("/proc/8/stat"), &build, None));
        assert!(!may_read(Path::new("/proc/1/environ"), &build, None));
        assert!(may_write(Path::new("/work/x"), &build) && !may_write(Path::new("/work/x"), &run));
        assert!(may_write(Path::new("/tmp/x"), &run) && !may_write(Path::new("/results.json"), &build));
    }
}
