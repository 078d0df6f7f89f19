//! Which outputs there are, and their files.

use super::site::Site;
use super::{github, gitlab, junit, markdown, sarif};
use crate::report::html;
use crate::report::json::Report;
use crate::report::saved::{FileError, write_whole};
use std::path::Path;

/// An output that is made from a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A page for people.
    Html,
    /// Test results for CI servers.
    Junit,
    /// Alerts for code scanning and editors.
    Sarif,
    /// Annotations and a step's summary for GitHub Actions.
    Github,
    /// A code quality report for GitLab.
    Gitlab,
    /// A page for chats, issues and merge requests.
    Markdown,
}

impl Format {
    /// Every one.
    pub const ALL: [Self; 6] =
        [Self::Html, Self::Junit, Self::Sarif, Self::Github, Self::Gitlab, Self::Markdown];

    /// As it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Html => "html",
            Self::Junit => "junit",
            Self::Sarif => "sarif",
            Self::Github => "github",
            Self::Gitlab => "gitlab",
            Self::Markdown => "markdown",
        }
    }

    /// Its files: their names and content. `beside` the report they may show its pictures.
    fn files(self, report: &Report, site: &Site, beside: bool) -> Vec<(&'static str, String)> {
        match self {
            Self::Html => vec![(html::PAGE, html::page(site.folder(), report))],
            Self::Junit => vec![("junit.xml", junit::junit(report, site))],
            Self::Sarif => vec![("gonio.sarif", sarif::sarif(report, site))],
            Self::Github => vec![
                ("github-annotations.txt", github::annotations(report, site)),
                ("github-summary.md", github::summary_within(report, site, github::SUMMARY_BYTES)),
            ],
            Self::Gitlab => vec![("gl-code-quality-report.json", gitlab::gitlab(report, site))],
            Self::Markdown => vec![("report.md", markdown::markdown(report, site, beside))],
        }
    }
}

/// Writes what is asked for into a folder; the names of the files.
pub fn write_formats(
    report: &Report,
    formats: &[Format],
    site: &Site,
    folder: &Path,
) -> Result<Vec<&'static str>, FileError> {
    let mut written = Vec::new();
    let beside = site.is_at(folder);
    for (name, text) in formats.iter().flat_map(|format| format.files(report, site, beside)) {
        write_whole(&folder.join(name), text.as_bytes())?;
        written.push(name);
    }
    Ok(written)
}
