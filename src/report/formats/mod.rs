//! Outputs for continuous integration, each a pure function of report.json.
//!
//! A *finding* is what one alert tells: of a failing subject its cause, which may stand
//! for several checks; else a check, with all directions at which it does so.
//!
//! | verdict | JUnit, each result | SARIF, each finding | GitHub annotation | GitLab code quality | Markdown |
//! |---|---|---|---|---|---|
//! | `pass` | success | – | – | – | counted |
//! | `fail` | failure | `error`, rule: the cause, else `check/ID` | error | critical | told in full |
//! | `error` | error | `error`, rule `unmeasured` | error | blocker | told in full |
//! | `warn` | skipped, "warn: …" | `warning`, rule `check/ID` | warning | minor | a line |
//! | `inconclusive` | skipped, "inconclusive: …" | `note`, rule `check/ID` | notice | info | a line |
//! | `waived` | skipped, "waived: …" | `error` with an external suppression | – | – | a line |
//! | `skipped` | skipped, its reason | – | – | – | counted |
//!
//! A failure or an error that the baseline of the run has too fails no gate: in JUnit it is
//! skipped, "known: …", in SARIF its `baselineState` is `unchanged`, its annotation is a
//! notice, and Markdown gives it a line.
//!
//! A run that was stopped early says so in all of them: a property of each JUnit suite,
//! `executionSuccessful: false`, an annotation that warns, an issue of its own, and the
//! first lines of the Markdown.
//!
//! Text comes from anywhere: names of files, messages of plugins. What no output can hold
//! is replaced ([`visible`](super::visible::visible)), and each format escapes what means
//! something in it.

mod findings;
mod format;
mod github;
mod gitlab;
mod junit;
pub(crate) mod manual;
mod markdown;
pub(crate) mod markdown_text;
mod sarif;
mod sarif_rules;
mod site;

#[cfg(test)]
mod examples;

pub use format::{Format, write_formats};
pub use github::{SUMMARY_BYTES, annotations, summary_within};
pub use site::Site;
