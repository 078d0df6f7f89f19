//! Pictures of what was measured, as SVG.

mod axes;
mod chosen;
pub(super) mod colours;
mod curves;
mod disc;
mod disc_frame;
mod disc_leaves;
mod figure;
mod histogram;
mod interval_plot;
mod line_plot;
mod matrix_plot;
mod numbers;
mod raster;
mod ratio_plot;
mod reciprocity_map;
#[cfg(test)]
pub(super) mod synthetic;

pub use chosen::{Pictured, Which, draw};
pub use curves::{albedo as albedo_curve, p_values as p_value_histogram};
pub use disc::{Caption, picture as disc_picture};
pub use histogram::Histogram;
pub use interval_plot::{Interval, IntervalPlot, IntervalRow};
pub use line_plot::{Line, LinePlot};
pub use matrix_plot::{Mark, MatrixPlot, MatrixRow};
pub use reciprocity_map::picture as reciprocity_picture;

pub(super) use chosen::file_name;
pub(super) use disc::{Scale, scale as disc_scale};
pub(super) use figure::shortened;
pub(super) use ratio_plot::ratio as ratio_picture;
