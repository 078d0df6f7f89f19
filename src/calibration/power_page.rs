//! Power in words and in a picture.

use super::part::{Part, PartId, Picture};
use super::power::{Curve, Decision, Power};
use crate::report::{Interval, IntervalPlot, IntervalRow};
use std::collections::BTreeSet;

/// The smallest strength, as people read it; nothing where it was not asked for.
fn figure(curve: &Curve, decision: Decision) -> String {
    match curve.smallest.get(&decision) {
        None => String::new(),
        Some(None) => "not found".into(),
        Some(Some(v)) if *v < 1e-3 => format!("{v:.1e}"),
        Some(Some(v)) if *v < 0.1 => format!("{v:.4}"),
        Some(Some(v)) => format!("{v:.2}"),
    }
}

fn smallest(curve: &Curve, decision: Decision) -> Option<f64> {
    curve.smallest.get(&decision).copied().flatten()
}

/// Of the ways to decide.
const NAMES: [&str; 5] = ["ε = 0", "statistical", "any", "grid of Nori", "grid of pbrt-v4"];

impl Power {
    fn draws(&self) -> BTreeSet<u64> {
        self.curves.iter().map(|c| c.samples).collect()
    }

    fn of<'c>(&'c self, mutant: &str, samples: u64) -> Option<&'c Curve> {
        self.curves.iter().find(|c| c.mutant == mutant && c.samples == samples)
    }

    /// In their order, each once.
    fn mutants(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.curves.iter().map(|c| c.mutant.as_str()).collect();
        let mut seen = BTreeSet::new();
        names.retain(|name| seen.insert(*name));
        names
    }

    fn plot(&self, decision: Decision, title: &str) -> String {
        let measured = |c: &&Curve| smallest(c, decision).is_some();
        let draws: BTreeSet<u64> = self.curves.iter().filter(measured).map(|c| c.samples).collect();
        let row = |mutant: &&str| IntervalRow {
            name: mutant.trim_start_matches("mutant-").into(),
            intervals: draws
                .iter()
                .map(|n| {
                    let value = smallest(self.of(mutant, *n)?, decision)?;
                    Some(Interval { low: value, value, high: f64::NAN, limit: f64::NAN })
                })
                .collect(),
        };
        let plot = IntervalPlot {
            title: title.into(),
            note: "The further to the left, the smaller the error that is found in 95 % of runs.".into(),
            x_name: "strength ε of the bug, in its own unit".into(),
            decades: (-6, 1),
            series: draws.iter().map(|n| format!("2^{} draws", n.ilog2())).collect(),
            limit_name: String::new(),
            rows: self
                .mutants()
                .iter()
                .map(row)
                .filter(|r| r.intervals.iter().any(Option::is_some))
                .collect(),
        };
        plot.svg()
    }
}

impl Part for Power {
    fn id(&self) -> PartId {
        PartId::Power
    }

    fn markdown(&self) -> String {
        let runs = self.curves.iter().flat_map(|c| &c.points).map(|p| p.runs).max().unwrap_or(0);
        let theta = self.curves.first().map_or(0.0, |c| c.theta_deg);
        let mut lines = vec![
            "## Power\n".to_string(),
            format!(
                "The smallest strength ε of a graded bug that is found in at least 95 % of {runs} runs, on a grid of strengths 12 % apart, at θ = {theta}°. *ε = 0*: a test of samples against pdf without tolerance, at fixed N, p < 10⁻⁵. *Statistical*: the verdict `fail` of a statistical check, with its tolerance, confirmed, at the default budget. *Any*: the verdict `fail` of any check, exact ones included; these do not see more with more draws. *Grids*: rejected by the fixed-grid recipe in a single test at 0.01.\n"
            ),
            "| mutant | ε is | correct model | draws | ε = 0 | statistical | any | grid of Nori | grid of pbrt-v4 |".into(),
            "|:--|:--|:--|--:|--:|--:|--:|--:|--:|".into(),
        ];
        for curve in &self.curves {
            let figures = Decision::ALL.map(|d| figure(curve, d));
            lines.push(format!(
                "| {} | {} | `{}` | 2^{} | {} |",
                curve.mutant,
                curve.meaning,
                curve.of,
                curve.samples.ilog2(),
                figures.join(" | ")
            ));
        }
        lines.join("\n") + "\n"
    }

    fn pictures(&self) -> Vec<Picture> {
        let picture = |path: &str, decision, title: &str| Picture {
            path: format!("plots/{path}.svg"),
            caption: title.into(),
            svg: self.plot(decision, title),
        };
        vec![
            picture("power-strict", Decision::Strict, "Smallest error seen without tolerance (p < 10⁻⁵)"),
            picture("power", Decision::Any, "Smallest error that any check fails"),
        ]
    }

    /// Power is a figure: it has no limit that it must keep.
    fn errors(&self) -> Vec<String> {
        Vec::new()
    }

    fn summary(&self) -> Vec<String> {
        let most = self.draws().last().copied().unwrap_or(0);
        let line = |curve: &Curve| {
            let told = Decision::ALL.iter().zip(NAMES).filter(|(d, _)| curve.smallest.contains_key(d));
            let figures: Vec<_> = told.map(|(d, name)| format!("{name}: {}", figure(curve, *d))).collect();
            format!("  {:32} {}", curve.mutant, figures.join(", "))
        };
        let head = format!("power: smallest ε found in 95 % of runs with 2^{} draws", most.max(1).ilog2());
        std::iter::once(head).chain(self.curves.iter().filter(|c| c.samples == most).map(line)).collect()
    }
}
