//! What may be typed.

use super::formats::Outputs;
use super::{
    calibrate, check, completions, diff, explain, figures, grade, list, new, report, run, schema, worker,
};
use crate::checks;
use crate::registry::nearest;
use crate::report::Which;
use crate::suite::{Overrides, azimuth, count, mebibytes, polar, time_limit};
use clap::{Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// A goniophotometer for material code: measures whether a BSDF's eval, sample
/// and pdf agree.
#[derive(Debug, Parser)]
#[command(name = "gonio", version, about, max_term_width = 100, propagate_version = true)]
#[command(after_help = "Exit codes: 0 all passed, 1 a check failed, 2 wrong usage or suite, \
    3 a subject crashed, hung or broke the protocol, 4 nothing was run, \
    5 internal or I/O error, 130 interrupted.")]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How to talk.
    #[command(flatten)]
    pub voice: Voice,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Measure the subjects of suites.
    Run(run::RunArgs),
    /// Measure one subject.
    Check(check::CheckArgs),
    /// Show the subjects, or the parameters of one.
    List(list::ListArgs),
    /// Print the manual's page on a kind of bug, or list them.
    Explain(explain::ExplainArgs),
    /// Draw the pictures of a saved report again and tell its diagnoses, or write it in
    /// the formats of CI servers.
    Report(report::ReportArgs),
    /// Tell what got worse and what got better from one report to another.
    Diff(diff::DiffArgs),
    /// Score submissions of a class by a rubric, with feedback and gradebooks.
    Grade(grade::GradeArgs),
    /// Draw the figures of a lecture on reflection, from the built-in models.
    Figures(figures::FiguresArgs),
    /// Write a plugin to start from, in a language of your choice.
    New(new::NewArgs),
    /// Measure how far gonio's own verdicts can be trusted.
    Calibrate(calibrate::CalibrateArgs),
    /// Print the JSON Schema of report.json or grade.json.
    Schema(schema::SchemaArgs),
    /// Print completions for a shell.
    Completions(completions::CompletionsArgs),
    /// The processes that plugins run in; gonio starts them itself.
    #[command(hide = true)]
    Worker(worker::WorkerArgs),
}

/// How gonio talks to people.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct Voice {
    /// Colours in messages; `auto` is for terminals without NO_COLOR.
    #[arg(long, global = true, value_enum, default_value_t, value_name = "WHEN", display_order = 900)]
    pub color: Color,
    /// Only errors.
    #[arg(short, long, global = true, conflicts_with = "verbose", display_order = 901)]
    pub quiet: bool,
    /// Every case as it ends.
    #[arg(short, long, global = true, display_order = 902)]
    pub verbose: bool,
}

/// When to colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal, unless NO_COLOR is set.
    #[default]
    Auto,
    /// Everywhere.
    Always,
    /// Nowhere.
    Never,
}

/// What comes out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A page for people, on stderr.
    #[default]
    Text,
    /// report.json, on stdout.
    Json,
}

/// Which cases get a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Plots {
    /// Cases that did not pass, and one of each subject.
    #[default]
    Auto,
    /// Every case.
    All,
    /// None.
    None,
}

impl Plots {
    /// As the report draws them.
    pub fn which(self) -> Option<Which> {
        match self {
            Self::Auto => Some(Which::Telling),
            Self::All => Some(Which::All),
            Self::None => None,
        }
    }
}

/// Options of every command that measures.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Measuring {
    /// Write the report, evidence and pictures into this folder. A suite's is
    /// reports/SUITE if left out; `check` writes none then.
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; one for each processor if left out. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Seed of all random numbers.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Only this check (may be repeated).
    #[arg(long, value_name = "ID", value_parser = check_id)]
    pub check: Vec<String>,
    /// Samples per case at most, as 1000000, 1_000_000 or 2^20.
    #[arg(long, value_name = "N", value_parser = count)]
    pub samples: Option<u64>,
    /// Polar angle of wo in degrees, over 90 on the back side (may be repeated).
    #[arg(long, value_name = "DEG", value_parser = theta, allow_negative_numbers = true)]
    pub theta: Vec<f64>,
    /// Azimuth of wo in degrees (may be repeated).
    #[arg(long, value_name = "DEG", value_parser = phi, allow_negative_numbers = true)]
    pub phi: Vec<f64>,
    /// What one call of a plugin may take.
    #[arg(long, value_name = "SECONDS", value_parser = seconds, help_heading = "Plugins")]
    pub call_limit: Option<f64>,
    /// What a plugin may take of memory.
    #[arg(long, value_name = "MIB", value_parser = memory, help_heading = "Plugins")]
    pub memory: Option<f64>,
    /// Load shared libraries into gonio itself: faster, and a crash is a crash of gonio.
    #[arg(long, help_heading = "Plugins")]
    pub in_process: bool,
    /// Fail only on what got worse since this report, and tell what got better.
    #[arg(long, value_name = "REPORT", help_heading = "Gates")]
    pub baseline: Option<PathBuf>,
    /// Measure only subjects that are not what they were in this report; take the results
    /// of the others from it.
    #[arg(long, value_name = "REPORT", help_heading = "Gates")]
    pub changed_since: Option<PathBuf>,
    /// Spend this much time where it buys most, as 30s or 5m, in place of a number of samples.
    #[arg(long, value_name = "TIME", value_parser = duration, help_heading = "Gates", conflicts_with = "samples")]
    pub time: Option<Duration>,
    /// Give each case the draws that it had in this report of a run with --time.
    #[arg(long, value_name = "REPORT", help_heading = "Gates", conflicts_with_all = ["time", "samples"])]
    pub allocation: Option<PathBuf>,
    /// What comes out.
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// Let `inconclusive` and `warn` fail too.
    #[arg(long)]
    pub strict: bool,
    /// Which cases get a picture.
    #[arg(long, value_enum, default_value_t, value_name = "WHICH")]
    pub plots: Plots,
    /// What else is written.
    #[command(flatten)]
    pub outputs: Outputs,
}

impl Measuring {
    /// What it puts in place of a suite's own.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            seed: self.seed,
            samples: self.samples,
            theta: distinct(&self.theta),
            phi: distinct(&self.phi),
            checks: distinct(&self.check),
            call_limit: self.call_limit.map(Duration::from_secs_f64),
            memory: self.memory.map(|mib| (mib as u64) << 20),
            in_process: self.in_process,
        }
    }
}

/// The same option twice means the same as once.
fn distinct<T: PartialEq + Clone>(list: &[T]) -> Vec<T> {
    let mut found = Vec::new();
    for item in list {
        if !found.contains(item) {
            found.push(item.clone());
        }
    }
    found
}

fn check_id(text: &str) -> Result<String, String> {
    match checks::find(text) {
        Some(_) => Ok(text.into()),
        None => Err(unknown("check", text, checks::all().iter().map(|c| c.id()))),
    }
}

/// What is told of a name that none of the `known` is.
pub(super) fn unknown<'a>(what: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    match nearest(name, known.clone()) {
        Some(n) => format!("no {what} is called so; did you mean `{n}`?"),
        None => format!("no {what} is called so; there are {}", known.collect::<Vec<_>>().join(", ")),
    }
}

/// A number that `range` accepts.
pub(super) fn number(text: &str, range: fn(f64) -> Result<f64, String>) -> Result<f64, String> {
    range(text.parse().map_err(|_| "this is not a number".to_string())?)
}

/// What a time limit is.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    number(text, time_limit)
}

/// A time as people write it; a bare number is seconds.
fn duration(text: &str) -> Result<Duration, String> {
    let wrong = || format!("`{text}` is not a time; type for example 30s or 5m");
    let seconds = match text.parse::<f64>() {
        Ok(seconds) => seconds,
        Err(_) => text.parse::<jiff::SignedDuration>().map_err(|_| wrong())?.as_secs_f64(),
    };
    time_limit(seconds).map(Duration::from_secs_f64).map_err(|_| wrong())
}

fn memory(text: &str) -> Result<f64, String> {
    number(text, mebibytes)
}

fn theta(text: &str) -> Result<f64, String> {
    number(text, polar)
}

fn phi(text: &str) -> Result<f64, String> {
    number(text, azimuth)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Args::command().debug_assert();
    }

    fn usage_error(line: &str) -> String {
        let error = Args::try_parse_from(line.split(' ')).expect_err(line);
        assert_eq!(error.exit_code(), 2, "{line}");
        error.to_string()
    }

    #[test]
    fn wrong_values_are_told_with_what_to_type() {
        for (line, part) in [
            ("gonio run --samples 0", "2^18"),
            ("gonio run --samples 2^99", "2^40"),
            ("gonio run --check suport", "did you mean `support`?"),
            ("gonio run --theta 200", "0 to 180"),
            ("gonio run --theta nan", "0 to 180"),
            ("gonio run --threads 0", "1..=1024"),
            ("gonio check lambert --share 2", "between 0 and 1"),
            ("gonio calibrate --part false-alarm", "did you mean `false-alarms`?"),
            ("gonio rum", "run"),
            ("gonio new java paint", "rust, c, cpp, python, wasm-c"),
            ("gonio new c Paint", "small letters"),
        ] {
            let text = usage_error(line);
            assert!(text.contains(part), "{line}: {text}");
        }
    }

    #[test]
    fn repeated_options_and_spellings_of_counts() {
        let line = "gonio run --samples 1_000_000 --theta 10 --theta 20 --theta 10 --phi -30";
        let Command::Run(run) = Args::parse_from(line.split(' ')).command else { panic!() };
        let found = run.measuring.overrides();
        assert_eq!((found.samples, found.theta, found.phi), (Some(1_000_000), vec![10.0, 20.0], vec![-30.0]));
    }
}
