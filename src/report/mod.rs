//! Events and results to terminal, JSON and SVG.

mod axes;
mod build;
mod colours;
mod curves;
mod diagnoses;
mod disc;
mod disc_frame;
mod disc_leaves;
mod figure;
mod folder;
mod histogram;
mod interval_plot;
mod json;
mod line_plot;
mod matrix_plot;
mod numbers;
mod plots;
mod raster;
mod ratio_plot;
mod reciprocity_map;
mod saved;
mod schema;
#[cfg(test)]
mod synthetic;
mod terminal;
mod wording;

pub use build::Files;
pub use curves::{albedo as albedo_curve, p_values as p_value_histogram};
pub use disc::{Caption, picture as disc_picture};
pub use folder::{REPORT, draw_diagnoses, draw_results, evidence_of, redraw, write_report};
pub use histogram::Histogram;
pub use interval_plot::{Interval, IntervalPlot, IntervalRow};
pub use json::{
    AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectId, Summary, WoAngles,
};
pub use line_plot::{Line, LinePlot};
pub use matrix_plot::{Mark, MatrixPlot, MatrixRow};
pub use plots::{Pictured, Which, draw};
pub use reciprocity_map::picture as reciprocity_picture;
pub use saved::{FileError, evidence_path, read_evidence, write_evidence, write_whole};
pub use schema::{schema, schema_text};
pub use terminal::{Look, diagnoses, summary, symbol};
