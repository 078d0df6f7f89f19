//! The instrument measured on itself: how often it calls right what is right, and
//! wrong what is wrong.

mod baselines;
mod confusion;
mod confusion_page;
mod false_alarms;
mod false_alarms_page;
mod fixed_grid;
mod kill_matrix;
mod kill_matrix_page;
mod limits;
mod limits_page;
mod part;
mod power;
mod power_page;
mod progress;
mod rates;
mod report;
mod simpson;
mod trial;
mod uniformity;
mod work;

pub use baselines::{Baselines, GridAlarms};
pub use confusion::{Confusion, Diagnosed, Named, TRIALS, quick_diagnoses};
pub use false_alarms::{Alarm, CheckAlarms, FalseAlarms, Scope};
pub use fixed_grid::{FixedGrid, GridOutcome, NORI, PBRT, RECIPES, Spacing, sidak};
pub use kill_matrix::{Answer, Expected, KillMatrix, Row, quick_rows};
pub use limits::{Limit, Limits};
pub use part::{Part, PartId, Picture};
pub use power::{Curve, Decision, Power};
pub use progress::{Identity, Progress, Unfinished};
pub use rates::{Rate, Standing};
pub use report::{CALIBRATION, Calibration, SCHEMA_VERSION, write};
pub use uniformity::Uniformity;
pub use work::{Effort, Event, Work};
