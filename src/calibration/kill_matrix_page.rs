//! The kill matrix in words and in a picture.

use super::fixed_grid::{NORI, PBRT};
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

/// The recipes, by their names.
const GRIDS: [&str; 2] = [NORI.name, PBRT.name];

fn grid_mark(rejected: Option<&(usize, usize)>) -> (&'static str, Mark) {
    match rejected {
        None => ("", Mark::Blank),
        Some((0, _)) => ("·", Mark::Quiet),
        Some(_) => ("○", Mark::Open),
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
            "{killed} of {mutants} mutants of {} causes are caught, {caught} of {must} times by a check that must; of {} checks that must not fail {silent} do not; {quiet} of {controls} negative controls pass",
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
            "The last columns are the fixed grids of Nori and pbrt-v4 on the same mutants, at up to five directions, Šidák-corrected to 0.01 for the five: ○ rejected, · not.\n".into(),
            format!("| cause | mutant | the bug | ε | directions | {} | {} |", columns.join(" | "), GRIDS.join(" | ")),
            format!("|:--|:--|:--|--:|--:|{}", ":-:|".repeat(columns.len() + GRIDS.len())),
        ];
        for row in &self.rows {
            let checks = columns.iter().map(|id| mark(row.checks.get(*id)).0);
            let cells: Vec<_> = checks.chain(GRIDS.map(|g| grid_mark(row.grids.get(g)).0)).collect();
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
            marks: columns
                .iter()
                .map(|id| mark(row.checks.get(*id)).1)
                .chain(GRIDS.map(|g| grid_mark(row.grids.get(g)).1))
                .collect(),
        };
        let plot = MatrixPlot {
            title: "Kill matrix".into(),
            note: "Which check catches which planted bug.".into(),
            columns: columns
                .iter()
                .map(|c| (*c).into())
                .chain(GRIDS.map(|g| format!("grid of {g}")))
                .collect(),
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
        let grid = |name: &&str| {
            let met = self.mutants().filter_map(|r| r.grids.get(*name));
            let (caught, of) =
                met.fold((0, 0), |(n, m), (rejected, _)| (n + usize::from(*rejected > 0), m + 1));
            // A quick run leaves them out.
            (of > 0).then(|| {
                format!(
                    "  the fixed grid of {name} rejects {caught} of the {of} mutants that have a pdf and a sampler"
                )
            })
        };
        let told = format!("kill matrix: {}", self.told());
        std::iter::once(told).chain(GRIDS.iter().filter_map(grid)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cause::Cause;
    use std::collections::BTreeMap;

    #[test]
    fn grids_that_did_not_run_are_not_told() {
        let row = |grids| Row {
            mutant: "mutant-x".into(),
            cause: Some(Cause::Weight),
            what: String::new(),
            of: String::new(),
            source: String::new(),
            strength: None,
            cases: 1,
            samples: 0,
            checks: BTreeMap::new(),
            grids,
        };
        let summary = |grids| KillMatrix { suite: "quick".into(), rows: vec![row(grids)] }.summary();
        assert_eq!(summary(BTreeMap::new()).len(), 1);
        let told = summary(BTreeMap::from([(NORI.name.to_string(), (1, 5))]));
        assert!(told.len() == 2 && told[1].contains("nori rejects 1 of the 1 mutants"), "{told:?}");
    }
}
