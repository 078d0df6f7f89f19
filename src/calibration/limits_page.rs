//! Detection limits in words and in a picture.

use super::limits::{Limit, Limits, Point};
use super::part::{Part, PartId, Picture};
use crate::checks::POWER;
use crate::report::{Line, LinePlot};

fn share(point: &Point) -> f64 {
    point.failed as f64 / point.runs.max(1) as f64
}

impl Limits {
    fn told(&self) -> String {
        let at = self.limits.iter().flat_map(|l| &l.points).filter(|p| p.ratio >= 0.98);
        let (runs, failed) = at.fold((0, 0), |(n, k), p| (n + p.runs, k + p.failed));
        format!(
            "errors at the printed limit or above are found in {failed} of {runs} runs; {POWER} is promised"
        )
    }
}

impl Part for Limits {
    fn id(&self) -> PartId {
        PartId::Limits
    }

    fn markdown(&self) -> String {
        let mut lines = vec![
            "## Detection limits\n".to_string(),
            format!(
                "A pass prints the smallest error that it would have found with probability {POWER}. Here errors of known size are planted: {}.\n",
                self.told()
            ),
            "| check | mutant | draws | limit | error / limit | ε | found |".into(),
            "|:--|:--|--:|--:|--:|--:|--:|".into(),
        ];
        for limit in &self.limits {
            for point in &limit.points {
                lines.push(format!(
                    "| {} | {} | 2^{} | {:.3e} | {:.2} | {:.3e} | {} of {} |",
                    limit.check,
                    limit.mutant,
                    limit.samples.ilog2(),
                    limit.limit,
                    point.ratio,
                    point.epsilon,
                    point.failed,
                    point.runs
                ));
            }
        }
        lines.join("\n") + "\n"
    }

    fn pictures(&self) -> Vec<Picture> {
        let line = |(k, limit): (usize, &Limit)| {
            let name = format!("{}: {}", limit.check, limit.mutant.trim_start_matches("mutant-"));
            let line = Line::new(name, k, limit.points.iter().map(|p| (p.ratio, share(p))).collect());
            if k < Line::COLOURS { line } else { line.dashed() }
        };
        let plot = LinePlot {
            title: "What happens at the detection limit".into(),
            note: "At 1 and beyond, all runs should find the error.".into(),
            x_name: "size of the error over the limit that a pass prints".into(),
            y_name: "share of runs that find it".into(),
            x: (0.0, 1.5),
            y: (0.0, 1.0),
            lines: self.limits.iter().enumerate().map(line).collect(),
        };
        vec![Picture {
            path: "plots/limits.svg".into(),
            caption: "Share of runs that find an error, by its size over the printed detection limit".into(),
            svg: plot.svg(),
        }]
    }

    fn errors(&self) -> Vec<String> {
        self.limits.iter().flat_map(Limit::errors).collect()
    }

    fn summary(&self) -> Vec<String> {
        vec![format!("detection limits: {}", self.told())]
    }
}
