//! From the files of a submission to what is measured.

use super::grade::{Broken, Incident};
use super::grader::Failure;
use super::rubric::{Language, Route, Rubric};
use super::submissions::{Submission, digest, overlay};
use crate::plugins::{Limits, Named, offered};
use crate::registry::Registry;
use std::io;
use std::path::Path;

/// A submission's files in a folder of their own, with the course's over them.
pub struct Prepared {
    folder: tempfile::TempDir,
    /// Its language.
    pub language: Language,
    /// Names its files and how it is built.
    pub digest: String,
}

/// A submission that answers.
pub struct Opened {
    /// Its models.
    pub registry: Registry,
}

fn broken(why: impl Into<String>) -> Broken {
    Broken { why: why.into(), said: String::new() }
}

impl Prepared {
    /// Unpacks it and finds its language; `Err` within is the submission's fault.
    pub fn new(rubric: &Rubric, submission: &Submission) -> Result<Result<Self, Broken>, Failure> {
        let system = |e: io::Error| Failure::System(format!("no temporary folder: {e}"));
        let folder = tempfile::Builder::new().prefix("gonio-grade-").tempdir().map_err(system)?;
        if let Err(why) = submission.unpack(folder.path()) {
            return Ok(Err(broken(why)));
        }
        let there = |language: &&Language| folder.path().join(&language.when).is_file();
        let Some(language) = rubric.languages.iter().find(there).cloned() else {
            let names: Vec<&str> = rubric.languages.iter().map(|l| l.when.as_str()).collect();
            return Ok(Err(broken(format!("it has none of the files {}", names.join(", ")))));
        };
        overlay(&language.files, folder.path()).map_err(Failure::System)?;
        let files = digest(folder.path()).map_err(system)?;
        let recipe = (&language.build, &language.route, &rubric.sandbox);
        let digest = blake3::hash(format!("{files} {recipe:?}").as_bytes()).to_hex().to_string();
        Ok(Ok(Self { folder, language, digest }))
    }

    /// How it is kept apart from this machine.
    pub fn isolation(&self) -> String {
        String::new()
    }

    /// What it tried so far that no BRDF needs.
    pub fn incidents(&self) -> Vec<Incident> {
        Vec::new()
    }

    /// Builds and opens it; it must offer every model of the rubric.
    ///
    /// # Errors
    /// What is the submission's fault.
    pub fn open(&self, rubric: &Rubric, _incidents: &mut Vec<Incident>) -> Result<Opened, Broken> {
        if let Some(build) = &self.language.build {
            let done =
                std::process::Command::new("sh").args(["-c", build]).current_dir(self.folder.path()).output();
            let done = done.map_err(|e| broken(e.to_string()))?;
            if !done.status.success() {
                let said = String::from_utf8_lossy(&done.stderr).into_owned();
                return Err(Broken { said, ..broken("it does not build") });
            }
        }
        let at = |file: &String| -> std::path::PathBuf { Path::new(self.folder.path()).join(file) };
        let named = match &self.language.route {
            Route::Wasm(file) => Named::Wasm(at(file)),
            Route::Library(file) => Named::Library(at(file)),
            Route::Process(words) => Named::Command(words.iter().map(Into::into).collect()),
        };
        let models = offered("it", &named, &Limits::default()).map_err(broken)?;
        if let Some(name) = rubric.models.keys().find(|name| !models.iter().any(|m| m.name() == *name)) {
            let names: Vec<&str> = models.iter().map(|m| m.name()).collect();
            return Err(broken(format!("it offers no model `{name}`, but {}", names.join(", "))));
        }
        Ok(Opened { registry: models.into_iter().fold(Registry::empty(), Registry::register) })
    }
}
