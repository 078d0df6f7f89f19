//! Probability tails, intervals, random streams and the false-alarm budget.
//!
//! Nothing here knows what a BSDF is. Transcendental functions come from `libm`, so that a
//! p-value has the same bits on every platform.

pub mod binomial;
pub mod budget;
pub mod chi_square;
pub mod effect;
pub mod means;
pub mod multiscale;
pub mod noncentral;
pub mod normal;
pub mod roots;
pub mod smooth;
pub mod special;
pub mod streams;
pub mod uniformity;
