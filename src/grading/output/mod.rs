//! What people and learning systems read of grades.
//!
//! [`Grade`](super::Grade) is the one source. What a student may see of it is decided in
//! one place, [`Feedback`]; the pages, Markdown, results.json and cells for students are
//! made from that, and those for teachers (gradebook, overview, appeals) from the grade.

mod appeals;
mod cells;
mod class_page;
mod export;
mod fairness;
mod feedback;
mod files;
mod found;
mod gradebook;
mod gradescope;
mod markdown;
mod page;
mod pictures;
mod plain;
mod points;
mod prairielearn;
mod statistics;
mod template;
mod terminal;
mod write;

#[cfg(test)]
mod examples;
#[cfg(test)]
mod tests;

pub use export::{Export, placeholders};
pub use fairness::Fairness;
pub use files::file_name;
pub use template::Template;
pub use terminal::{class, one};
pub use write::{Class, System, Told, write_class, write_student};
