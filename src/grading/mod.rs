//! Grading: a rubric and submissions to scores, feedback and gradebooks.

mod building;
mod class;
mod grade;
mod grader;
mod held;
mod kept;
mod output;
mod plan;
mod rubric;
mod score;
mod submissions;

pub use crate::plugins::{Incident, Phase};
pub use class::{folder_of, grade_all, kept};
pub use grade::{Broken, GRADE_VERSION, Grade, Hints, ItemGrade, ItemKind, Lost, schema_text};
pub use grader::{Failure, Graded, Grader, Took, Wishes};
pub use output::{Class, Export, Fairness, System, Told, class, file_name, one, write_class, write_student};
pub use plan::{Measurement, Planned};
pub use rubric::{Credit, Item, Language, Route, Rubric, SandboxTerms, load};
pub use submissions::{Submission, Submissions, find};
