//! From the files of a submission to what is measured.

use super::grade::Broken;
use super::grader::Failure;
use super::rubric::{Language, Route, Rubric};
use super::submissions::{Submission, digest, overlay};
use crate::plugins::{Allowance, Incident, Limits, Named, Sandbox, incidents, offered};
use crate::registry::Registry;
use crate::report::write_whole;
use std::ffi::OsString;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;

/// A submission's files in a folder of their own, with the course's over them.
pub struct Prepared {
    /// With the files in it, and the log of incidents beside them.
    folder: TempDir,
    /// Its language.
    pub language: Language,
    /// Names its files and how it is built.
    pub digest: String,
    sandbox: Arc<Sandbox>,
    limits: Limits,
}

/// A failure that is the submission's own.
fn broken(why: impl Into<String>) -> Broken {
    Broken { why: why.into(), said: String::new() }
}

impl Prepared {
    /// Unpacks it below `scratch` and finds its language; `Err` within is the submission's
    /// fault.
    pub fn new(
        rubric: &Rubric,
        submission: &Submission,
        scratch: &Path,
    ) -> Result<Result<Self, Broken>, Failure> {
        let system = |e: io::Error| Failure::System(format!("no folder in {}: {e}", scratch.display()));
        let folder = tempfile::tempdir_in(scratch).map_err(system)?;
        let files = folder.path().join("work");
        std::fs::create_dir(&files).map_err(system)?;
        if let Err(why) = submission.unpack(&files) {
            return Ok(Err(broken(why)));
        }
        let there = |language: &&Language| files.join(&language.when).is_file();
        let Some(language) = rubric.languages.iter().find(there).cloned() else {
            let names: Vec<&str> = rubric.languages.iter().map(|l| l.when.as_str()).collect();
            return Ok(Err(broken(format!("it has none of the files {}", names.join(", ")))));
        };
        overlay(&language.files, &files).map_err(Failure::System)?;
        let terms = &rubric.sandbox;
        let mut sandbox = Sandbox::new(&files);
        sandbox.read.clone_from(&terms.read);
        sandbox.log = Some(folder.path().join("incidents"));
        // What the rubric is made of must not be seen where a folder that may be read holds it.
        sandbox.hidden = rubric.own_files();
        sandbox.allowance = Allowance {
            processor: Some(terms.build_time),
            clock: Some(terms.build_time),
            processes: terms.processes,
            disk: terms.disk,
            output: terms.output,
            ..Allowance::default()
        };
        let recipe = (&language.build, &language.route, terms, &rubric.limits);
        let names = digest(&files).map_err(system)?;
        let digest = format!("{names} {recipe:?} {}", sandbox.isolation);
        let digest = blake3::hash(digest.as_bytes()).to_hex().to_string();
        Ok(Ok(Self { folder, language, digest, sandbox: Arc::new(sandbox), limits: rubric.limits }))
    }

    /// How it is kept apart from this machine while it is measured.
    pub fn isolation(&self) -> String {
        match self.language.route {
            Route::Wasm(_) => "WebAssembly".into(),
            _ => self.sandbox.isolation.to_string(),
        }
    }

    /// What it tried so far that no BRDF needs.
    pub fn incidents(&self) -> Vec<Incident> {
        self.sandbox.log.as_deref().map(incidents).unwrap_or_default()
    }

    fn files(&self) -> PathBuf {
        self.folder.path().join("work")
    }

    /// Builds and opens it: its models, every model of the rubric among them.
    ///
    /// # Errors
    /// What is the submission's fault.
    pub fn open(&self, rubric: &Rubric) -> Result<Registry, Broken> {
        let at = |file: &String| self.files().join(file);
        let (named, made) = match &self.language.route {
            Route::Wasm(file) => (Named::Wasm(at(file)), file),
            Route::Library(file) => (Named::Library(at(file)), file),
            Route::Process(words) => {
                let first = words.first().ok_or_else(|| broken("its language names no command"))?;
                (Named::Command(words.iter().map(OsString::from).collect()), first)
            }
        };
        if let Some(build) = &self.language.build {
            let bytes = self.sandbox.build(build, made.trim_start_matches("./")).map_err(|failure| {
                Broken { why: format!("it does not build: {}", failure.why), said: failure.said }
            })?;
            write_whole(&at(made), &bytes).map_err(|e| broken(e.to_string()))?;
            runnable(&at(made)).map_err(|e| broken(e.to_string()))?;
        }
        let run = Arc::new(Sandbox {
            // A program lives as long as its submission is measured.
            allowance: Allowance { processor: None, clock: None, ..self.sandbox.allowance },
            ..(*self.sandbox).clone()
        });
        let models = offered(&named, &self.limits, &run)
            .map_err(|why| broken(format!("it does not answer: {why}")))?;
        if let Some(name) = rubric.models.keys().find(|name| !models.iter().any(|m| m.name() == *name)) {
            let names: Vec<&str> = models.iter().map(|m| m.name()).collect();
            return Err(broken(format!("it offers no model `{name}`, but {}", names.join(", "))));
        }
        Ok(models.into_iter().fold(Registry::empty(), Registry::register))
    }
}

/// A program that was built may be run.
fn runnable(path: &PathBuf) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))
}
