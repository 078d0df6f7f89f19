//! What an explanation is, and all of them.

use super::textbook::Textbook;
use super::view::View;
use super::{compensation, discrete, functions, inputs, pdf, sampler, shares, support, value, weight};
use crate::cause::Cause;

/// A statement about the code that predicts what was measured.
#[derive(Clone, Debug)]
pub struct Claim {
    /// What kind of bug it is.
    pub cause: Cause,
    /// What is wrong, in one sentence.
    pub statement: String,
    /// Where to look and what to change, in one sentence.
    pub repair: String,
    /// Checks that such a bug makes fail.
    pub covers: &'static [&'static str],
    /// ln of the likelihood of what was measured over that under a perfect fit, ≤ 0.
    pub ln_likelihood: f64,
    /// What it costs in nats that numbers were fitted, or that it says little: a number
    /// known to n digits costs ln 10ⁿ, as it would have fitted that many others.
    pub price: f64,
    /// ln of the p-value of the counts after the repair, where they were predicted.
    pub ln_p: Option<f64>,
    /// What speaks for it.
    pub evidence: Vec<String>,
}

/// A number that was fitted to exact values.
pub const EXACT_NUMBER: f64 = 12.0;

/// A number that was fitted to counts.
pub const COUNTED_NUMBER: f64 = 6.0;

/// A statement that would fit many bugs.
pub const VAGUE: f64 = 18.0;

/// Checks that a wrong pdf or sampler makes fail.
pub const DENSITY: &[&str] = &[
    "goodness-of-fit",
    "normalization",
    "support",
    "albedo",
    "mis",
    "jacobian",
    "weight",
    "returned-pdf",
    "sensitivity",
    "reference",
    "discrete-lobes",
    "sanity",
];

/// The same where sample() does not take its weight and pdf from a pdf() that is
/// otherwise right.
pub const DENSITY_ALONE: &[&str] = &[
    "goodness-of-fit",
    "normalization",
    "support",
    "albedo",
    "mis",
    "jacobian",
    "sensitivity",
    "reference",
    "discrete-lobes",
    "sanity",
];

/// Checks that a wrong eval makes fail.
pub const VALUE: &[&str] = &[
    "reciprocity",
    "energy",
    "white-furnace",
    "albedo",
    "mis",
    "weight",
    "support",
    "isotropy",
    "reference",
    "sensitivity",
];

/// Checks that a wrong weight or told density makes fail.
pub const WEIGHT: &[&str] = &["weight", "returned-pdf", "albedo", "mis", "support", "discrete-lobes"];

impl Claim {
    /// A claim that fits perfectly and costs nothing.
    pub fn new(cause: Cause, statement: impl Into<String>, repair: impl Into<String>) -> Self {
        Self {
            cause,
            statement: statement.into(),
            repair: repair.into(),
            covers: DENSITY,
            ln_likelihood: 0.0,
            price: 1.0,
            ln_p: None,
            evidence: Vec::new(),
        }
    }

    /// It explains these checks.
    pub fn covers(self, covers: &'static [&'static str]) -> Self {
        Self { covers, ..self }
    }

    /// It costs this much.
    pub fn price(self, price: f64) -> Self {
        Self { price, ..self }
    }

    /// It leaves this ln-likelihood.
    pub fn likelihood(self, ln_likelihood: f64) -> Self {
        Self { ln_likelihood, ..self }
    }

    /// The counts have this p-value after the repair.
    pub fn p(self, ln_p: f64) -> Self {
        Self { ln_p: Some(ln_p), ..self }
    }

    /// One more thing that speaks for it.
    pub fn because(mut self, evidence: impl Into<String>) -> Self {
        self.evidence.push(evidence.into());
        self
    }
}

/// A theme of bugs. A user's crate may add its own to
/// [`diagnose`](super::diagnose).
pub trait Explanation: Send + Sync {
    /// Every claim that the measurements do not contradict. `book` is the published
    /// model that the subject is meant to be, where one is found.
    fn claims(&self, view: &View, book: Option<&Textbook>) -> Vec<Claim>;
}

impl<F: Fn(&View, Option<&Textbook>) -> Vec<Claim> + Send + Sync> Explanation for F {
    fn claims(&self, view: &View, book: Option<&Textbook>) -> Vec<Claim> {
        self(view, book)
    }
}

/// Every explanation that comes with gonio.
pub fn all() -> Vec<Box<dyn Explanation>> {
    vec![
        Box::new(inputs::claims),
        Box::new(functions::claims),
        Box::new(pdf::claims),
        Box::new(shares::claims),
        Box::new(sampler::claims),
        Box::new(support::claims),
        Box::new(value::claims),
        Box::new(compensation::claims),
        Box::new(weight::claims),
        Box::new(discrete::claims),
    ]
}
