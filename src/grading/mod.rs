//! Grading: a rubric and submissions to scores, feedback and gradebooks.

mod building;
mod class;
mod grade;
mod grader;
mod held;
mod kept;
mod plan;
mod rubric;
mod score;
mod submissions;

pub use crate::plugins::{Incident, Phase};
pub use class::{Fairness, folder_of, grade_all, kept};
pub use grade::{Broken, GRADE_VERSION, Grade, Hints, ItemGrade, ItemKind, Lost};
pub use grader::{Failure, Graded, Grader, Wishes};
pub use plan::{Measurement, Planned};
pub use rubric::{Credit, Export, Item, Language, Route, Rubric, SandboxTerms, load};
pub use submissions::{Found, Submission, find};
