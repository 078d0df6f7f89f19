//! The instrument measured on itself: how often it calls right what is right, and
//! wrong what is wrong.

mod false_alarms;
mod false_alarms_page;
mod kill_matrix;
mod part;
mod progress;
mod rates;
mod report;
mod uniformity;
mod work;

pub use false_alarms::{Alarm, CheckAlarms, FalseAlarms, Scope};
pub use part::{Part, PartId, Picture};
pub use progress::{Identity, Progress, Unfinished};
pub use rates::{Rate, Standing};
pub use report::{CALIBRATION, Calibration, SCHEMA_VERSION, write};
pub use uniformity::Uniformity;
pub use work::{Effort, Event, Work};
