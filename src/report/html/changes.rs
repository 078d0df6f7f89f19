//! What changed since another report, in words for a page.

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
#[derive(Clone, Debug)]
pub struct Changed {
    /// How the subject is written.
    pub subject: String,
    /// What the suite calls its row, if it has a name of its own.
    pub label: Option<String>,
    /// Which check.
    pub check: String,
    /// Whether it is for the better.
    pub trend: Trend,
    /// What it is that changed: the verdict, efficiency, the detection limit.
    pub what: &'static str,
    /// Earlier.
    pub before: String,
    /// Later.
    pub after: String,
    /// At which directions.
    pub places: String,
    /// The named bug.
    pub cause: Option<String>,
    /// One sentence of the report that is worse.
    pub message: String,
}

/// What a later report says that an earlier one did not.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    /// The earlier report in words: its suite, when it was made, its seed.
    pub before: String,
    /// The worse first.
    pub list: Vec<Changed>,
    /// Results that fail in both.
    pub still_failing: usize,
    /// Results without a change.
    pub same: usize,
    /// Subjects that only the later report has.
    pub added: Vec<String>,
    /// Subjects that only the earlier report has.
    pub removed: Vec<String>,
    /// Results that only the earlier report has, of subjects that both have.
    pub removed_results: usize,
}

impl Changes {
    /// The gravest change of a check of a subject.
    pub fn of(&self, subject: &str, label: Option<&str>, check: &str) -> Option<Trend> {
        let same = |c: &&Changed| c.subject == subject && c.label.as_deref() == label && c.check == check;
        let grave = |trend: &Trend| match trend {
            Trend::Worse => 0,
            Trend::LessSure => 1,
            Trend::Better => 2,
        };
        self.list.iter().filter(same).map(|c| c.trend).min_by_key(grave)
    }

    /// Those of a trend.
    pub fn with(&self, trend: Trend) -> Vec<&Changed> {
        self.list.iter().filter(|c| c.trend == trend).collect()
    }

    /// How many there are of a trend.
    pub fn count(&self, trend: Trend) -> usize {
        self.list.iter().filter(|c| c.trend == trend).count()
    }
}
