//! One file per check: a pure judge of evidence against a null hypothesis.

mod albedo;
mod determinism;
mod discrete_lobes;
mod distribution;
mod efficiency;
mod energy;
mod fresnel;
mod goodness_of_fit;
mod isotropy;
mod jacobian;
mod mis;
mod normalization;
mod outcome;
mod reciprocity;
mod reference;
mod returned_pdf;
mod sanity;
mod sensitivity;
mod support;
mod weight;
mod white_furnace;

pub use goodness_of_fit::{density_p_values, level_p_values, strict_ln_p, true_effects};
pub use outcome::{Check, Effect, Judgement, Outcome, POWER, Terms, Verdict, needs_kind};

/// Every check, in the order of reports.
pub fn all() -> &'static [&'static dyn Check] {
    &[
        &sanity::Sanity,
        &determinism::Determinism,
        &goodness_of_fit::GoodnessOfFit,
        &normalization::Normalization,
        &support::Support,
        &weight::Weight,
        &returned_pdf::ReturnedPdf,
        &albedo::Albedo,
        &mis::Mis,
        &energy::Energy,
        &white_furnace::WhiteFurnace,
        &reciprocity::Reciprocity,
        &isotropy::Isotropy,
        &discrete_lobes::DiscreteLobes,
        &sensitivity::Sensitivity,
        &reference::Reference,
        &distribution::Distribution,
        &fresnel::Fresnel,
        &jacobian::Jacobian,
        &efficiency::Efficiency,
    ]
}

/// The check with this id.
pub fn find(id: &str) -> Option<&'static dyn Check> {
    all().iter().copied().find(|c| c.id() == id)
}
