//! Grading: a rubric and submissions to scores, feedback and gradebooks.

mod grade;

pub use grade::{Broken, GRADE_VERSION, Grade, Hints, Incident, ItemGrade, ItemKind, Lost, Phase};
