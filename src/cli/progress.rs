//! Progress on a terminal; silence in a pipe.

use super::args::Voice;
use super::output::tell;
use crate::calibration;
use crate::checks::Verdict;
use crate::engine::{CaseResult, Event};
use crate::suite::{Case, Plan};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::Duration;

/// A bar that is only seen on a terminal.
fn bar(length: u64, voice: Voice) -> ProgressBar {
    let shown = stderr().is_terminal() && !voice.quiet;
    let target = if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(length), target);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len}, {eta} left  {wide_msg}") {
        bar.set_style(style);
    }
    if shown {
        // A long case must not look like a hang.
        bar.enable_steady_tick(Duration::from_millis(250));
    }
    bar
}

/// A bar for the parts of a calibration, one after the other.
pub struct Steps(ProgressBar);

impl Steps {
    /// Before the first part.
    pub fn new(voice: Voice) -> Self {
        Self(bar(0, voice))
    }

    /// Shows what a calibration tells.
    pub fn observe(&self, event: calibration::Event) {
        match event {
            calibration::Event::Part { title, steps } => {
                self.0.reset();
                self.0.set_length(steps);
                self.0.set_message(title.to_string());
            }
            calibration::Event::Steps(steps) => self.0.inc(steps),
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// A bar with failures above it as they are found.
pub struct Progress {
    bar: ProgressBar,
    voice: Voice,
    terminal: bool,
}

impl Progress {
    /// Nothing done of `plan` yet.
    pub fn new(plan: &Plan, voice: Voice) -> Self {
        Self { bar: bar(plan.cases.len() as u64, voice), voice, terminal: stderr().is_terminal() }
    }

    /// Shows what the engine tells.
    pub fn observe(&self, event: &Event) {
        match event {
            Event::Started { cases, .. } => self.bar.set_length(*cases as u64),
            Event::CaseStarted(case) => self.bar.set_message(case.label()),
            Event::CaseDone(result) => {
                self.bar.inc(1);
                for line in lines(result, self.voice, self.terminal) {
                    if self.bar.is_hidden() {
                        tell(&line);
                    } else {
                        self.bar.println(line);
                    }
                }
            }
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// What is worth a line: failures on a terminal, every case if asked for.
fn lines(result: &CaseResult, voice: Voice, terminal: bool) -> Vec<String> {
    let mut all = Vec::new();
    if voice.quiet || !(terminal || voice.verbose) {
        return all;
    }
    let label = Case::label(&result.case);
    for finding in &result.findings {
        let verdict = finding.outcome.verdict;
        if matches!(verdict, Verdict::Fail | Verdict::Error) {
            all.push(format!("{} {}: {label}: {}", verdict.word(), finding.check, finding.outcome.message));
        }
    }
    if voice.verbose {
        all.push(format!("{} {label} ({:.1} s)", result.worst().word(), result.seconds));
    }
    all
}
