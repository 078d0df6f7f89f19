//! Grading: a rubric and submissions to scores, feedback and gradebooks.

mod grade;
mod output;

pub use grade::{Broken, GRADE_VERSION, Grade, Hints, Incident, ItemGrade, ItemKind, Lost, Phase};
pub use output::{
    CauseTold, Class, Export, Fairness, Feedback, Found, LostItem, System, Template, Told, class, file_name,
    one, placeholders, write_class, write_student,
};
