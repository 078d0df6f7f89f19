//! Events and results to terminal, JSON and SVG.

mod build;
mod diagnoses;
mod folder;
mod json;
mod plots;
mod saved;
mod schema;
mod terminal;
mod wording;

pub use build::Files;
pub use folder::{REPORT, draw_diagnoses, draw_results, evidence_of, redraw, write_report};
pub use json::{
    Allocation, AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectEntry, SubjectId,
    Summary, WaiverRow, WaiverState, WoAngles,
};
pub use plots::{
    Caption, Histogram, Interval, IntervalPlot, IntervalRow, Kind, Line, LinePlot, Mark, MatrixPlot,
    MatrixRow, Picture, Pictured, Which, albedo_curve, disc_picture, draw, p_value_histogram,
    pictures_of_case, pictures_of_subject, reciprocity_picture,
};
pub use saved::{FileError, evidence_path, read_evidence, write_evidence, write_whole};
pub use schema::{schema, schema_text};
pub use terminal::{Look, diagnoses, summary, symbol};
