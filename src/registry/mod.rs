//! Name and parameters to subject: the one place where a model is listed.
//!
//! A model declares its parameters once; `gonio list`, validation, error
//! messages, suites and the `sensitivity` check all read that declaration.

mod error;
mod model;
mod models;
mod parameter;
mod spelling;

pub use error::{RegistryError, nearest};
pub use model::{Model, Parts};
pub use models::{MEASURED, Registry, Resolved};
pub use parameter::{Condition, Kind, Parameter, Parameters, Role, Value};
pub use spelling::Spelling;
