//! False alarms in words and pictures.

use super::false_alarms::{CheckAlarms, FalseAlarms};
use super::part::{Part, PartId, Picture};
use super::rates::{Rate, Standing};
use super::uniformity::Uniformity;
use crate::report::{Histogram, Interval, IntervalPlot, IntervalRow};
use crate::statistics::normal;

/// Rates of a full calibration lie between what ten thousand runs exclude and 1.
const DECADES: (i32, i32) = (-5, 0);

/// Chance that a bin of the histogram is outside of its band.
const OUTSIDE: f64 = 0.01;

/// A rate as people read it.
fn rate(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.1e}") }
}

/// Few of them with a decimal.
fn expected(rate: &Rate) -> String {
    let value = rate.expected();
    if value == 0.0 || value >= 100.0 { format!("{value:.0}") } else { format!("{value:.1}") }
}

fn standing(rate: &Rate) -> &'static str {
    match rate.standing() {
        // Without chance there is no nominal rate to be below of.
        _ if rate.nominal == 0.0 && rate.count == 0 => "none",
        Standing::Below => "at most nominal",
        Standing::Open => "not above nominal",
        Standing::Above => "**above nominal**",
    }
}

impl FalseAlarms {
    /// What is known of failures at the default budget, in a sentence.
    fn by_default(&self) -> String {
        let fails = &self.in_all.default_fails;
        let alarms = match self.alarms.len() {
            0 => "no `fail`, `error` or `warn`".into(),
            n => format!("{n} results that are `fail`, `error` or `warn`"),
        };
        format!(
            "default budget of {:e} a run: {alarms} in {} runs; a rate of failing runs above {} is excluded (95 %)",
            self.default_budget,
            fails.of,
            rate(fails.high)
        )
    }

    /// The same at the raised budget.
    fn by_raised(&self) -> String {
        let CheckAlarms { fails, suspicions, tests, .. } = &self.in_all;
        let held = match fails.standing() {
            Standing::Below => "at most nominal with 95 % confidence",
            Standing::Open => "not shown to be above nominal",
            Standing::Above => "above nominal with 95 % confidence",
        };
        format!(
            "budget of {:e} a run: {} runs fail of at most {} nominal, a rate of at most {}: {held}; {} runs with suspicions, of at most {} nominal in {tests} tests",
            self.raised_budget,
            fails.count,
            expected(fails),
            rate(fails.high),
            suspicions.count,
            expected(suspicions),
        )
    }

    fn by_p_values(&self) -> String {
        uniformity(&self.p_values, "of independent levels")
    }

    fn by_density_p_values(&self) -> String {
        uniformity(&self.density_p_values, "along the density")
    }

    /// Bins outside of the band of the picture.
    fn bins_outside(&self) -> usize {
        let (n, bins) = (self.p_values.count as f64, self.p_values.bins.len() as f64);
        let reach = deviations() * (n / bins * (1.0 - 1.0 / bins)).sqrt();
        self.p_values.bins.iter().filter(|c| (**c as f64 - n / bins).abs() > reach).count()
    }

    fn histogram(&self) -> String {
        let histogram = Histogram {
            title: "p-values of correct subjects".into(),
            name_y: "p-values".into(),
            distance: self.p_values.distance.0,
            p: self.p_values.p_value.0,
            counts: self.p_values.bins.clone(),
            deviations: deviations(),
            band: "99 %".into(),
        };
        histogram.svg()
    }

    fn rates(&self) -> String {
        let interval = |rate: &Rate| {
            let value = rate.count as f64 / rate.of.max(1) as f64;
            Some(Interval { low: rate.low, value, high: rate.high, limit: rate.nominal })
        };
        let row = |alarms: &CheckAlarms| IntervalRow {
            name: alarms.check.clone(),
            intervals: vec![interval(&alarms.suspicions), interval(&alarms.fails)],
        };
        let plot = IntervalPlot {
            title: format!("False alarms at a budget of {:e} a run", self.raised_budget),
            note: "Right of its tick a check calls correct subjects wrong too often.".into(),
            x_name: "rate per run, with its 95 % bounds".into(),
            decades: DECADES,
            series: vec!["first attempt".into(), "confirmed".into()],
            limit_name: "nominal, at most".into(),
            rows: self.rows().filter(|r| r.tests > 0).map(row).collect(),
        };
        plot.svg()
    }
}

fn uniformity(p: &Uniformity, of: &str) -> String {
    format!(
        "{} p-values {of} (fixed N, ε = 0): Kolmogorov–Smirnov D = {:.5}, p = {:.3}; {} of them below 10⁻³, a share of {:.2e} ({:.2e} to {:.2e}, each 95 %)",
        p.count,
        p.distance.0,
        p.p_value.0,
        p.small.count,
        p.small.count as f64 / p.count.max(1) as f64,
        p.small.low,
        p.small.high
    )
}

/// Half the band's width, in standard deviations of a bin.
fn deviations() -> f64 {
    normal::quantile(libm::log(0.5 * OUTSIDE))
}

impl Part for FalseAlarms {
    fn id(&self) -> PartId {
        PartId::FalseAlarms
    }

    fn markdown(&self) -> String {
        let mut text = String::from("## False alarms\n\n");
        let mut line = |content: String| {
            text.push_str(&content);
            text.push('\n');
        };
        line(format!(
            "A run is one subject at one wo with all its checks, and every subject is right: {} cases of the suite `{}` at {} seeds.\n",
            self.cases, self.suite, self.seeds
        ));
        line(format!("- At the {}.", self.by_default()));
        line(format!("- At a {}.", self.by_raised()));
        line(format!("- {}.", self.by_p_values()));
        line(format!("- {}.\n", self.by_density_p_values()));
        line("| check | runs | tests | suspicions | nominal ≤ | fails | nominal ≤ | rate (95 %) | nominal ≤ | rate of fails | suspicions by default | fails by default |".into());
        line("|:--|--:|--:|--:|--:|--:|--:|--:|--:|:--|--:|--:|".into());
        for row in self.rows() {
            line(format!(
                "| {} | {} | {} | {} | {} | {} | {} | {} to {} | {} | {} | {} | {} |",
                row.check,
                row.runs,
                row.tests,
                row.suspicions.count,
                expected(&row.suspicions),
                row.fails.count,
                expected(&row.fails),
                rate(row.fails.low),
                rate(row.fails.high),
                rate(row.fails.nominal),
                standing(&row.fails),
                row.default_suspicions.count,
                row.default_fails.count
            ));
        }
        line(format!(
            "\nSuspicions are first attempts that crossed their threshold; what an independent second attempt crosses too is a fail. The budget of a run is shared out equally over its statistical tests. Each end of an interval is a one-sided bound: a rate is *at most nominal* where its upper end is, and *not above nominal* where only its lower end is. Where a check tests an identity without chance, no failure is nominal. {} results were inconclusive for another reason; {} runs had a suspicion at the raised budget and were run again at the default one.",
            self.undecided, self.run_again
        ));
        line(format!(
            "\nOf {} bins of the p-values {} are outside of their 99 % bands, where {:.1} are expected; {} runs ended before all draws and are left out.",
            self.p_values.bins.len(),
            self.bins_outside(),
            OUTSIDE * self.p_values.bins.len() as f64,
            self.left_out
        ));
        text
    }

    fn pictures(&self) -> Vec<Picture> {
        let mut pictures = vec![Picture {
            path: "plots/false-alarms.svg".into(),
            caption:
                "Rates of suspicions and failures of correct subjects, by check, against the nominal rates"
                    .into(),
            svg: self.rates(),
        }];
        if self.p_values.count > 0 {
            pictures.push(Picture {
                path: "plots/p-values.svg".into(),
                caption: "Histogram of the p-values of independent levels".into(),
                svg: self.histogram(),
            });
        }
        pictures
    }

    fn errors(&self) -> Vec<String> {
        self.wrong()
    }

    fn summary(&self) -> Vec<String> {
        let runs = format!(
            "false alarms: {} runs, {} cases of the suite `{}` at {} seeds",
            self.in_all.runs, self.cases, self.suite, self.seeds
        );
        let figures = [self.by_default(), self.by_raised(), self.by_p_values(), self.by_density_p_values()];
        std::iter::once(runs).chain(figures.map(|f| format!("  {f}"))).collect()
    }
}
