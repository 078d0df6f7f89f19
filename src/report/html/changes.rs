//! What changed since another report, in words for a page.

use super::super::json::SubjectId;
use super::super::wording::{direction, ratio};
use super::head::counted;
use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::comparison::{Change, Comparison, Origin, Place, What};

/// Whether a change is for the better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trend {
    /// It fails now, or a figure dropped beyond noise.
    Worse,
    /// It passes now, or a figure rose beyond noise.
    Better,
    /// It was decided and is no longer.
    LessSure,
}

impl Trend {
    /// For a mark in the matrix.
    pub fn symbol(self) -> char {
        match self {
            Self::Worse => '▼',
            Self::Better => '▲',
            Self::LessSure => '◆',
        }
    }

    /// For those who do not see the mark.
    pub fn word(self) -> &'static str {
        match self {
            Self::Worse => "worse",
            Self::Better => "better",
            Self::LessSure => "less sure",
        }
    }

    /// For styles.
    pub fn class(self) -> &'static str {
        match self {
            Self::Worse => "worse",
            Self::Better => "better",
            Self::LessSure => "less-sure",
        }
    }
}

/// A change of a check of a subject.
pub struct Changed<'a> {
    /// Which.
    pub of: &'a Change,
    /// Whether it is for the better.
    pub trend: Trend,
    /// What it is that changed.
    pub what: &'static str,
    /// Earlier.
    pub before: String,
    /// Later.
    pub after: String,
    /// At which directions.
    pub places: String,
}

/// What a later report says that an earlier one did not.
pub struct Changes<'a> {
    /// The earlier report in words.
    pub before: String,
    /// The rest of it.
    pub of: &'a Comparison,
    /// The worse first.
    pub list: Vec<Changed<'a>>,
}

impl<'a> Changes<'a> {
    /// Of a comparison.
    pub fn of(of: &'a Comparison) -> Self {
        let lists =
            [(Trend::Worse, &of.worse), (Trend::LessSure, &of.less_sure), (Trend::Better, &of.better)];
        let list = lists.iter().flat_map(|(trend, list)| list.iter().map(|of| changed(of, *trend))).collect();
        let Origin { suite, started, seed, .. } = &of.before;
        let day = started.split('.').next().unwrap_or_default().trim_end_matches('Z').replacen('T', " ", 1);
        let when = if day.is_empty() { String::new() } else { format!(" of {day} UTC") };
        Self { before: format!("the report{when}, suite {suite}, seed {seed}"), of, list }
    }

    /// The gravest change of a check of a subject.
    pub fn trend(&self, subject: &SubjectId, check: &str) -> Option<Trend> {
        self.list.iter().find(|c| c.is_of(subject) && c.of.check == check).map(|c| c.trend)
    }

    /// Those of a trend.
    pub fn with(&self, trend: Trend) -> impl Iterator<Item = &Changed<'a>> {
        self.list.iter().filter(move |c| c.trend == trend)
    }

    /// How many there are of a trend.
    pub fn count(&self, trend: Trend) -> usize {
        self.with(trend).count()
    }
}

impl Changed<'_> {
    /// Whether it is one of a subject.
    pub fn is_of(&self, subject: &SubjectId) -> bool {
        self.of.subject == subject.name && self.of.label == subject.label
    }
}

fn changed(of: &Change, trend: Trend) -> Changed<'_> {
    let (what, before, after) = match of.what {
        What::Verdict { before, after } => {
            ("verdict", before.map_or("not there", Verdict::word).to_string(), after.word().to_string())
        }
        What::Efficiency { before, after } => ("draws that count", ratio(before.0), ratio(after.0)),
        What::DetectionLimit { before, after } => ("detection limit", ratio(before.0), ratio(after.0)),
    };
    Changed { of, trend, what, before, after, places: places(&of.places) }
}

fn places(places: &[Place]) -> String {
    let Some(first) = places.first() else { return String::new() };
    let mode = if first.transport == Transport::Importance { ", importance" } else { "" };
    let first = first.wo.map_or(String::new(), |wo| direction(wo) + mode);
    match places.len() {
        1 => first,
        n => format!("{first} and {}", counted(n - 1, "more direction")),
    }
}
