//! What the parts of a calibration have in common.

/// A part that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartId {
    /// How often correct subjects are called wrong.
    FalseAlarms,
    /// Which check catches which planted bug.
    KillMatrix,
    /// The smallest error that is found.
    Power,
    /// What happens at the limits that passes print.
    Limits,
    /// How often the fixed grids of renderers reject what is right.
    Baselines,
    /// Which cause a diagnosis names.
    Confusion,
}

impl PartId {
    /// Every part, in the order of the report.
    pub const ALL: [Self; 6] =
        [Self::FalseAlarms, Self::KillMatrix, Self::Confusion, Self::Power, Self::Limits, Self::Baselines];

    /// As it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::FalseAlarms => "false-alarms",
            Self::KillMatrix => "kill-matrix",
            Self::Power => "power",
            Self::Limits => "limits",
            Self::Baselines => "fixed-grids",
            Self::Confusion => "diagnoses",
        }
    }

    /// The part called `name`.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// What it measures.
    pub fn doc(self) -> &'static str {
        match self {
            Self::FalseAlarms => {
                "how often correct subjects are called wrong, and whether p-values are uniform"
            }
            Self::KillMatrix => "which check catches which planted bug, and whether correct code passes",
            Self::Power => "the smallest error of each kind that is found in 95 % of runs",
            Self::Baselines => "how often the fixed-grid tests of renderers reject what is right",
            Self::Confusion => "which cause a diagnosis names, against the one that is there",
            Self::Limits => "how often errors of the size that a pass says it would have seen are seen",
        }
    }
}

/// A picture of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Its file, from the report's folder.
    pub path: String,
    /// What it shows, in a sentence.
    pub caption: String,
    /// The document.
    pub svg: String,
}

/// The result of a part: facts, of which every view is a pure function.
pub trait Part {
    /// Which one it is.
    fn id(&self) -> PartId;
    /// Its section of the report, heading included, without its pictures.
    fn markdown(&self) -> String;
    /// Its pictures.
    fn pictures(&self) -> Vec<Picture>;
    /// Where the instrument is not what it claims to be.
    fn errors(&self) -> Vec<String>;
    /// What a person at a terminal wants to read, line by line.
    fn summary(&self) -> Vec<String>;
}
