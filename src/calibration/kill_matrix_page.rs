//! The kill matrix in words and in a picture.

use super::kill_matrix::{Answer, Expected, KillMatrix, Row};
use super::part::{Part, PartId, Picture};
use crate::checks;
use crate::report::{Mark, MatrixPlot, MatrixRow};
use std::collections::BTreeSet;

/// What a cell of the table says, and its mark in the picture.
fn mark(answer: Option<&Answer>) -> (&'static str, Mark) {
    let Some(answer) = answer else { return ("", Mark::Blank) };
    match answer.expected {
        _ if answer.is_wrong() => ("✗", Mark::Wrong),
        Expected::MustFail => ("●", Mark::Full),
        Expected::MayFail if answer.failed > 0 => ("○", Mark::Open),
        Expected::MustWarn => ("!", Mark::Told),
        _ => ("·", Mark::Quiet),
    }
}

impl KillMatrix {
    fn mutants(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|r| r.cause.is_some())
    }

    fn told(&self) -> String {
        let (mutants, controls) = (self.mutants().count(), self.rows.len() - self.mutants().count());
        let killed = self.mutants().filter(|r| r.is_killed()).count();
        let causes: BTreeSet<_> = self.mutants().filter_map(|r| r.cause).collect();
        let quiet = self.rows.iter().filter(|r| r.cause.is_none() && r.errors().is_empty()).count();
        let answers = |expected| {
            self.rows.iter().flat_map(|r| r.checks.values()).filter(move |a| a.expected == expected)
        };
        let caught = answers(Expected::MustFail).filter(|a| a.failed > 0).count();
        let must = answers(Expected::MustFail).count();
        let silent = answers(Expected::MustNotFail).filter(|a| !a.is_wrong()).count();
        format!(
            "{killed} of {mutants} mutants with {} causes are caught, {caught} of {must} times by a check that must; of {} checks that must not fail {silent} do not; {quiet} of {controls} negative controls pass",
            causes.len(),
            answers(Expected::MustNotFail).count()
        )
    }

    fn columns(&self) -> Vec<&'static str> {
        let ran = |id: &&str| self.rows.iter().any(|r| r.checks.contains_key(*id));
        checks::all().iter().map(|c| c.id()).filter(ran).collect()
    }
}

impl Part for KillMatrix {
    fn id(&self) -> PartId {
        PartId::KillMatrix
    }

    fn markdown(&self) -> String {
        let columns = self.columns();
        let mut lines = vec![
            "## Kill matrix\n".to_string(),
            format!("By the settings and thresholds of the suite `{}`: {}.\n", self.suite, self.told()),
            "● fails, as it must; ○ fails, as it may; ! warns, as it must; · does not fail; ✗ contradicts the label; empty: does not apply. What must fail follows from the identity that each check tests. Each mutant is a subject of its own: `gonio check NAME`.\n".into(),
            format!("| cause | mutant | the bug | ε | directions | {} |", columns.join(" | ")),
            format!("|:--|:--|:--|--:|--:|{}", ":-:|".repeat(columns.len())),
        ];
        for row in &self.rows {
            let cells: Vec<_> = columns.iter().map(|id| mark(row.checks.get(*id)).0).collect();
            lines.push(format!(
                "| {} | {} | {} ({}) | {} | {} | {} |",
                row.cause.map_or("none", |c| c.slug()),
                row.mutant,
                row.what,
                row.source,
                row.strength.map_or(String::new(), |s| s.to_string()),
                row.cases,
                cells.join(" | ")
            ));
        }
        lines.join("\n") + "\n"
    }

    fn pictures(&self) -> Vec<Picture> {
        let columns = self.columns();
        let row = |row: &Row| MatrixRow {
            group: row.cause.map_or("nothing is wrong", |c| c.slug()).into(),
            name: row.mutant.trim_start_matches("mutant-").trim_start_matches("control-").into(),
            marks: columns.iter().map(|id| mark(row.checks.get(*id)).1).collect(),
        };
        let plot = MatrixPlot {
            title: "Kill matrix".into(),
            note: "Which check catches which planted bug.".into(),
            columns: columns.iter().map(|c| (*c).into()).collect(),
            rows: self.rows.iter().map(row).collect(),
        };
        vec![Picture {
            path: "plots/kill-matrix.svg".into(),
            caption: "Which check catches which planted bug, by cause".into(),
            svg: plot.svg(),
        }]
    }

    fn errors(&self) -> Vec<String> {
        self.rows.iter().flat_map(Row::errors).collect()
    }

    fn summary(&self) -> Vec<String> {
        vec![format!("kill matrix: {}", self.told())]
    }
}
