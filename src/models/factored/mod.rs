//! Factored sampling of any reflective subject (J. Lawrence, S. Rusinkiewicz and
//! R. Ramamoorthi, *Efficient BRDF importance sampling using a factored
//! representation*, ACM Transactions on Graphics 23(3), 2004).

mod cache;
mod conditional;
mod density;
mod grid;
mod non_negative;
mod parameterisation;
mod spline;
mod subject;
mod table;

pub use conditional::Conditional;
pub use density::{FactoredDensity, Factorisation, Term};
pub use grid::{Given, Grid};
pub use non_negative::{Factors, Matrix};
pub use parameterisation::Parameterisation;
pub use spline::{Knots, SplineDensity, bezier};
pub(super) use subject::model;
pub use subject::{Factored, Options};
