//! Suite files, and the plan of cases that they expand to.

mod plan;

pub use plan::{Case, ClaimsPatch, Plan, Settings, Waiver};
