//! gonio as a command, and the processes that it leaves.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// A folder of its own, and a mark that every process started from it inherits.
pub struct Sandbox {
    folder: tempfile::TempDir,
    mark: String,
}

/// How a command ended.
pub struct Run {
    pub code: Option<i32>,
    /// Standard error: what people read.
    pub text: String,
    /// The same in one line.
    pub flat: String,
    /// Standard output.
    pub output: String,
    pub seconds: f64,
}

impl Sandbox {
    pub fn new(name: &str) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        Self {
            folder: tempfile::tempdir().unwrap(),
            mark: format!("GONIO_TEST={}-{number}-{name}", std::process::id()),
        }
    }

    /// Where gonio is run.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_gonio"));
        let (key, value) = self.mark.split_once('=').unwrap();
        command.args(arguments).current_dir(self.folder.path()).env(key, value).stdin(Stdio::null());
        command
    }

    pub fn gonio(&self, arguments: &[&str]) -> Run {
        let start = Instant::now();
        let done = self.command(arguments).output().unwrap();
        let text = String::from_utf8_lossy(&done.stderr).into_owned();
        Run {
            code: done.status.code(),
            flat: text.split_whitespace().collect::<Vec<_>>().join(" "),
            text,
            output: String::from_utf8_lossy(&done.stdout).into_owned(),
            seconds: start.elapsed().as_secs_f64(),
        }
    }

    pub fn check(&self, subject: &str, options: &[&str]) -> Run {
        self.gonio(&[&["check", subject], options].concat())
    }

    /// A suite of `subject` and a model of gonio's own.
    pub fn suite(&self, subject: &str, options: &[&str]) -> Run {
        let (name, deed) = match subject.rsplit_once(":deed=") {
            Some((name, deed)) => (name, format!("deed = \"{deed}\"\n")),
            None => (subject, String::new()),
        };
        let text = format!(
            "[suite]\ntheta = [30, 60]\nphi = 17\nsamples = \"2^14\"\ndetect = 1.0\ncall_limit = 1\n\
             checks = [\"energy\", \"weight\", \"support\"]\n\
             [[subject]]\nuse = '''{name}'''\n{deed}[[subject]]\nuse = \"lambert\"\n"
        );
        let path = self.folder.path().join("suite.toml");
        std::fs::write(&path, text).unwrap();
        self.gonio(&[&["run", "suite.toml"], options].concat())
    }

    pub fn start(&self, subject: &str, options: &[&str]) -> Child {
        let mut command = self.command(&[&["check", subject], options].concat());
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    }

    /// Command lines of processes that descend from this sandbox and still run a moment
    /// after gonio has ended.
    pub fn left(&self) -> Vec<String> {
        within(5.0, || self.running().is_empty());
        self.running()
    }

    /// Command lines of processes that descend from this sandbox.
    pub fn running(&self) -> Vec<String> {
        let mut left = Vec::new();
        for entry in std::fs::read_dir("/proc").unwrap().flatten() {
            let environment = std::fs::read(entry.path().join("environ")).unwrap_or_default();
            if environment.split(|b| *b == 0).any(|variable| variable == self.mark.as_bytes()) {
                let words = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
                left.push(String::from_utf8_lossy(&words).replace('\0', " "));
            }
        }
        left
    }
}

/// Whether `holds` becomes true in time.
pub fn within(seconds: f64, holds: impl Fn() -> bool) -> bool {
    let start = Instant::now();
    while start.elapsed().as_secs_f64() < seconds {
        if holds() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    false
}

/// A file of tests/data/plugins.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/plugins").join(name)
}

/// The shared library of tests/data/plugins/NAME.c.
pub fn library(name: &str) -> PathBuf {
    let built = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}.so", std::process::id()));
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let cc = Command::new("cc")
            .args(["-O1", "-w", "-shared", "-fPIC", "-o"])
            .args([built.as_path(), &data(&format!("{name}.c"))])
            .arg("-lm")
            .output()
            .expect("these tests need a C compiler called cc");
        assert!(cc.status.success(), "{}", String::from_utf8_lossy(&cc.stderr));
    });
    built
}

/// The command that runs tests/data/plugins/hostile.py.
pub fn script(arguments: &str) -> String {
    python(&format!("hostile.py {arguments}"))
}

/// The command that runs a script of tests/data/plugins.
pub fn python(words: &str) -> String {
    format!("python3 {}{words}", data("").display())
}
