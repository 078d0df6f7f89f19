//! A folder like that of a course, with a submission in it, and what is left of a sandbox.

use crate::tools::tools;
use gonio::bsdf::Transport;
use gonio::plugins::{
    Call, Fault, Function, Incident, Isolation, Limits, Named, Sandbox, incidents, isolation,
};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// A course with a rubric, a neighbour, and a submission.
pub struct Desk {
    folder: tempfile::TempDir,
    pub sandbox: Sandbox,
    pub limits: Limits,
    before: Vec<String>,
}

impl Desk {
    /// A submission of these files.
    pub fn new(files: &[(&str, &str)]) -> Self {
        gonio::plugins::set_gonio(env!("CARGO_BIN_EXE_gonio").into());
        let _ = tools();
        let folder = tempfile::tempdir().unwrap();
        let course = folder.path();
        for name in ["one", "neighbour"] {
            std::fs::create_dir(course.join(name)).unwrap();
        }
        std::fs::write(course.join("rubric.toml"), "seed = 8231977").unwrap();
        std::fs::write(course.join("hidden.toml"), "seed = 8231977").unwrap();
        std::fs::write(course.join("neighbour/brdf.c"), "int solution;").unwrap();
        for (name, text) in files {
            std::fs::write(course.join("one").join(name), text).unwrap();
        }
        let mut sandbox = Sandbox::new(course.join("one"));
        assert!(sandbox.isolation.is_watched(), "these tests need bubblewrap: {}", sandbox.isolation);
        sandbox.log = Some(course.join("log"));
        sandbox.hidden = vec![course.into()];
        let limits = Limits { call: Duration::from_secs(5), memory: 1 << 30, in_process: false };
        let mut desk = Self { folder, sandbox, limits, before: Vec::new() };
        desk.before = desk.files();
        desk
    }

    /// A submission with the hostile library.
    pub fn hostile() -> Self {
        let desk = Self::new(&[("brdf.so", "")]);
        std::fs::copy(library(), desk.path("brdf.so")).unwrap();
        desk
    }

    /// Without bubblewrap.
    pub fn limited(mut self) -> Self {
        self.sandbox.isolation = Isolation::Limits { why: "a test".into() };
        self
    }

    /// A file of the submission.
    pub fn path(&self, name: &str) -> PathBuf {
        self.sandbox.folder.join(name)
    }

    fn files(&self) -> Vec<String> {
        let mut all = Vec::new();
        let mut folders = vec![self.folder.path().to_path_buf()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap().flatten() {
                if entry.file_type().unwrap().is_dir() {
                    folders.push(entry.path());
                }
                all.push(entry.path().to_string_lossy().into_owned());
            }
        }
        all.retain(|path| !path.ends_with("/log"));
        all.sort();
        all
    }

    /// What eval gives of the hostile library that does `deed`.
    pub fn library(&self, deed: &str) -> Result<f64, Fault> {
        self.eval(&Named::Library(self.path("brdf.so")), deed)
    }

    /// What eval of a command gives.
    pub fn command(&self, words: &[&str]) -> Result<f64, Fault> {
        self.eval(&Named::Command(words.iter().map(Into::into).collect()), "none")
    }

    fn eval(&self, named: &Named, deed: &str) -> Result<f64, Fault> {
        let sandbox = Arc::new(self.sandbox.clone());
        let mut instance = named.route(&self.limits, Some(&sandbox))?.start(&self.limits)?;
        let handle = instance.create("hostile", &format!("{{\"deed\":\"{deed}\"}}"))?.handle;
        let call = Call {
            function: Function::Eval,
            handle,
            transport: Transport::Radiance,
            wo: [0.0, 0.0, 1.0],
            rows: 1,
            channels: 1,
            input: &[0.0, 0.0, 1.0],
        };
        let mut answer = [f64::NAN];
        instance.call(&call, &mut answer)?;
        Ok(answer[0])
    }

    /// The incidents so far; and that nothing is left of what ran.
    pub fn incidents(&self) -> Vec<Incident> {
        let name = self.folder.path().file_name().unwrap().to_string_lossy().into_owned();
        let deadline = Instant::now() + Duration::from_secs(5);
        while !processes_with(&name).is_empty() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(processes_with(&name), Vec::<String>::new());
        assert!(!std::fs::read_to_string("/proc/self/mountinfo").unwrap().contains(&name), "a mount is left");
        assert_eq!(self.files(), self.before);
        incidents(&self.folder.path().join("log"))
    }

    /// That there were such incidents, and no others.
    #[track_caller]
    pub fn told(&self, parts: &[&str]) {
        let all = self.incidents();
        for part in parts {
            assert!(all.iter().any(|incident| incident.what.contains(part)), "no `{part}` in {all:#?}");
        }
        let other = all.iter().find(|incident| !parts.iter().any(|part| incident.what.contains(part)));
        assert_eq!(other, None, "{all:#?}");
    }
}

/// Processes that see a folder of this name: a sandbox has it mounted.
fn processes_with(name: &str) -> Vec<String> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir("/proc").unwrap().flatten() {
        let read = |file: &str| {
            String::from_utf8_lossy(&std::fs::read(entry.path().join(file)).unwrap_or_default()).into_owned()
        };
        let words = read("cmdline");
        if read("mountinfo").contains(name) || words.contains(name) {
            all.push(words.replace('\0', " "));
        }
    }
    all
}

/// A file of tests/data/sandbox.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/sandbox").join(name)
}

pub fn text(name: &str) -> String {
    std::fs::read_to_string(data(name)).unwrap()
}

/// The hostile library, built outside.
fn library() -> &'static Path {
    static BUILT: OnceLock<PathBuf> = OnceLock::new();
    BUILT.get_or_init(|| {
        let built = tools().target.join("sandbox-hostile.so");
        let cc = Command::new("cc")
            .args(["-O1", "-w", "-shared", "-fPIC", "-pthread", "-o"])
            .args([&built, &data("hostile.c")])
            .arg("-lm")
            .output()
            .expect("these tests need a C compiler called cc");
        assert!(cc.status.success(), "{}", String::from_utf8_lossy(&cc.stderr));
        built
    })
}

#[test]
fn this_machine_can() {
    gonio::plugins::set_gonio(env!("CARGO_BIN_EXE_gonio").into());
    let _ = tools();
    assert!(isolation().is_watched() && isolation().to_string().contains("bubblewrap 0."), "{}", isolation());
}
