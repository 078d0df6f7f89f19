//! Subjects × checks.

use super::super::terminal::symbol;
use super::changes::{Changes, Trend};
use super::names;
use super::section::at;
use super::subject::{Subject, is_telling};
use crate::checks::Verdict;

/// The table.
pub struct Matrix<'a> {
    /// Checks.
    pub columns: Vec<&'a str>,
    /// Subjects, in the suite's order.
    pub rows: Vec<Row<'a>>,
    /// Verdicts that are met, the gravest first.
    pub met: Vec<Verdict>,
}

/// A subject.
pub struct Row<'a> {
    /// Of its section.
    pub anchor: &'a str,
    /// The name before its parameters.
    pub base: &'a str,
    /// These.
    pub parameters: Vec<&'a str>,
    /// What the suite calls it, if it has a name of its own.
    pub label: Option<&'a str>,
    /// Its cells, one a column.
    pub cells: Vec<Cell>,
}

/// A check of a subject.
#[derive(Clone)]
pub struct Cell {
    /// None where the check was not asked for.
    pub verdict: Option<Verdict>,
    /// Where a click leads, if a person should look there.
    pub link: Option<String>,
    /// At how many directions.
    pub tip: String,
    /// What became of it since another report.
    pub trend: Option<Trend>,
}

impl Cell {
    /// A shape for its verdict.
    pub fn symbol(&self) -> String {
        self.verdict.map(|v| symbol(v).to_string()).unwrap_or_default()
    }

    /// For styles and filters.
    pub fn class(&self) -> &'static str {
        self.verdict.map_or("none", Verdict::word)
    }
}

/// The matrix of subjects.
pub fn matrix<'a>(subjects: &'a [Subject<'a>], columns: &[&'a str], changes: Option<&Changes>) -> Matrix<'a> {
    let rows = subjects.iter().map(|subject| row(subject, columns, changes)).collect();
    let mut met: Vec<Verdict> = subjects.iter().flat_map(|s| s.checks.iter().map(|c| c.verdict)).collect();
    met.sort_by(|a, b| b.cmp(a));
    met.dedup();
    Matrix { columns: columns.to_vec(), rows, met }
}

fn row<'a>(subject: &'a Subject, columns: &[&'a str], changes: Option<&Changes>) -> Row<'a> {
    let (base, parameters) = names::parts(&subject.id.name);
    let label = subject.id.label.as_deref();
    let cells = columns
        .iter()
        .map(|id| {
            let check = subject.checks.iter().find(|c| c.id == *id);
            let telling = check.filter(|c| is_telling(c.verdict));
            let changed = |changes: &Changes| changes.trend(subject.id, id);
            let trend = changes.and_then(changed);
            let linked = telling.is_some() || trend.is_some();
            Cell {
                verdict: check.map(|c| c.verdict),
                link: linked.then(|| names::check_anchor(&subject.anchor, id)),
                tip: check.map_or(String::new(), |c| format!("{}: {}", c.id, at(c))),
                trend,
            }
        })
        .collect();
    Row { anchor: &subject.anchor, base, parameters, label, cells }
}
