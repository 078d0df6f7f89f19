//! Pictures of what was measured, as SVG.

mod albedo;
mod angle_axis;
mod axes;
mod azimuth;
mod bars;
mod by_theta;
mod chosen;
pub(super) mod colours;
mod disc;
mod disc_frame;
mod disc_leaves;
mod figure;
mod furnace;
mod histogram;
mod interval_plot;
mod line_plot;
mod lobe;
mod matrix_plot;
mod numbers;
mod pictures;
mod plane;
mod raster;
mod ratio_axes;
mod reciprocity_map;
#[cfg(test)]
pub(crate) mod synthetic;
mod weights;

pub use albedo::albedo as albedo_curve;
pub use bars::Bars;
pub use chosen::{Pictured, Which, draw};
pub use disc::{Caption, picture as disc_picture};
pub use histogram::{Histogram, p_values as p_value_histogram};
pub use interval_plot::{Interval, IntervalPlot, IntervalRow};
pub use line_plot::{Line, LinePlot};
pub use matrix_plot::{Mark, MatrixPlot, MatrixRow};
pub use pictures::{Kind, Picture, of_case as pictures_of_case, of_subject as pictures_of_subject};
pub use reciprocity_map::picture as reciprocity_picture;

pub(super) use chosen::file_name;
pub(super) use disc::{Scale, scale as disc_scale};
pub(crate) use figure::shortened;
pub(crate) use plane::of_diagnosis as diagnosis_picture;
