//! Grading: a rubric and submissions to scores, feedback and gradebooks.

mod grade;

pub use crate::plugins::{Incident, Phase};
pub use grade::{Broken, GRADE_VERSION, Grade, Hints, ItemGrade, ItemKind, Lost};
