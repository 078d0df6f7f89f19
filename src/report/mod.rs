//! Events and results to terminal, JSON, SVG and the formats of CI servers.

mod build;
mod carry;
mod changes;
mod diagnoses;
mod folder;
pub(crate) mod formats;
mod html;
mod json;
mod plots;
mod record;
mod saved;
mod schema;
#[cfg(test)]
pub(crate) mod synthetic;
mod terminal;
pub(crate) mod visible;
pub(crate) mod wording;

pub use build::Files;
pub use carry::Carried;
pub use folder::{REPORT, draw_diagnoses, draw_results, evidence_of, redraw, write_report};
pub use formats::{Format, SUMMARY_BYTES, Site, annotations, summary_within, write_formats};
pub use html::{PAGE, page as html_page};
pub(crate) use html::{STYLE, inline};
pub use json::{
    Allocation, AttemptRow, CheckResult, Diagnosis, Machine, Report, SCHEMA_VERSION, SubjectEntry, SubjectId,
    Summary, WaiverRow, WaiverState, WoAngles,
};
#[cfg(test)]
pub(crate) use plots::synthetic as lobes;
pub use plots::{
    Bars, Caption, Histogram, Interval, IntervalPlot, IntervalRow, Kind, Line, LinePlot, Mark, MatrixPlot,
    MatrixRow, Picture, Pictured, Which, albedo_curve, disc_picture, draw, p_value_histogram,
    pictures_of_case, pictures_of_subject, reciprocity_picture,
};
pub(crate) use plots::{diagnosis_picture, shortened};
pub use record::{Recording, record};
pub use saved::{FileError, evidence_path, read_evidence, write_evidence, write_whole};
pub(crate) use schema::as_committed;
pub use schema::{schema, schema_text};
pub use terminal::{Look, comparison, diagnoses, summary, symbol};
