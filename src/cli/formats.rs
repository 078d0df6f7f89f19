//! `--to`: what is made of a report for CI servers, and what GitHub Actions is told.

use super::error::CliError;
use super::output::{emit, tell};
use crate::report::{
    FileError, Format, Report, SUMMARY_BYTES, Site, annotations, summary_within, write_formats,
};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Variables by which servers tell where the repository is.
const ROOTS: [&str; 3] = ["GITHUB_WORKSPACE", "CI_PROJECT_DIR", "WORKSPACE"];

/// Outputs beside report.json.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Outputs {
    /// Write these too, beside the report: html, junit, sarif, github, gitlab, markdown
    /// (separated by commas). On GitHub Actions `github` also annotates and adds to the
    /// step's summary.
    #[arg(long, value_name = "FORMATS", value_delimiter = ',', value_parser = format(), hide_possible_values = true)]
    pub to: Vec<Format>,
}

fn format() -> impl TypedValueParser<Value = Format> {
    PossibleValuesParser::new(Format::ALL.map(Format::name)).map(|name| {
        let named = Format::ALL.into_iter().find(|format| format.name() == name);
        named.expect("only these names are possible")
    })
}

/// Where files go, and who listens.
#[derive(Clone, Copy)]
pub struct Destination<'a> {
    /// The folder of the report.
    pub report: &'a Path,
    /// The folder of what is made of it.
    pub out: &'a Path,
    /// Whether standard output has other things to say.
    pub stdout_is_taken: bool,
}

impl Outputs {
    /// Each format once.
    fn formats(&self) -> Vec<Format> {
        Format::ALL.into_iter().filter(|format| self.to.contains(format)).collect()
    }

    /// The same with the page for people.
    pub fn with_page(mut self) -> Self {
        self.to.push(Format::Html);
        self
    }

    /// Makes what was asked for; the files.
    pub fn write(&self, report: &Report, destination: Destination) -> Result<Vec<PathBuf>, CliError> {
        let formats = self.formats();
        let site = site(destination.report);
        let names = write_formats(report, &formats, &site, &real(destination.out))?;
        let on_github = std::env::var("GITHUB_ACTIONS").is_ok_and(|value| value == "true");
        if on_github && formats.contains(&Format::Github) {
            let annotations = annotations(report, &site);
            match destination.stdout_is_taken {
                true => tell(annotations.trim_end()),
                false => emit(&annotations)?,
            }
            if let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty()) {
                add_summary(Path::new(&path), report, &site)?;
            }
        }
        Ok(names.into_iter().map(|name| destination.out.join(name)).collect())
    }
}

/// Adds to a step's summary what there is room for.
fn add_summary(path: &Path, report: &Report, site: &Site) -> Result<(), CliError> {
    let used = std::fs::metadata(path).map_or(0, |m| usize::try_from(m.len()).unwrap_or(usize::MAX));
    let text = summary_within(report, site, SUMMARY_BYTES.saturating_sub(used));
    let file = std::fs::OpenOptions::new().append(true).create(true).open(path);
    let added = file.and_then(|mut file| file.write_all(text.as_bytes()));
    added.map_err(|source| FileError::Write { path: path.into(), source }.into())
}

/// Where a report lies in its repository.
fn site(folder: &Path) -> Site {
    let current = std::env::current_dir().and_then(std::fs::canonicalize).unwrap_or_default();
    Site::new(&repository(&current), &current, &real(folder))
}

/// A folder that is reached by a link is told as what it is.
fn real(folder: &Path) -> PathBuf {
    std::fs::canonicalize(folder).unwrap_or_else(|_| folder.to_path_buf())
}

/// The root of the repository around a folder: as the server tells it, else where git's
/// own folder is, else this one.
fn repository(current: &Path) -> PathBuf {
    let told = ROOTS.iter().filter_map(std::env::var_os).filter_map(|path| std::fs::canonicalize(path).ok());
    let around = told.into_iter().find(|root| current.starts_with(root));
    let marked = || current.ancestors().find(|folder| folder.join(".git").exists());
    around.or_else(|| marked().map(Path::to_path_buf)).unwrap_or_else(|| current.to_path_buf())
}
