//! The density of a smooth sampler is the inverse of its Jacobian.

use super::outcome::{Check, Judgement, Outcome, Terms, needs_determinism, needs_functions};
use crate::bsdf::Description;
use crate::evidence::{Evidence, Jacobian as Derivative, Measurement};

/// Where the map u → wi is smooth and of rank 2 in two of its dimensions:
/// 1/|∂ω/∂u| = pdf at points, by finite differences; a lower bound of pdf where
/// several u may lead to one wi. Local, deterministic, names the place.
pub struct Jacobian;

impl Check for Jacobian {
    fn id(&self) -> &'static str {
        "jacobian"
    }

    fn hypothesis(&self) -> &'static str {
        "1/|∂ω/∂u| = pdf where u → wi is smooth; pdf is at least a branch's part where branches overlap"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Jacobian]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, false, true, true)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        match &evidence.jacobian {
            None => Judgement::Missing,
            Some(Derivative::Skipped(reason)) => Outcome::skipped(reason.clone()).into(),
            Some(Derivative::Measured { tally, one_to_one: true }) => {
                let breach = "pdf is not the density of this map";
                Outcome::of_tally(tally, "1/|∂ω/∂u| = pdf", breach).into()
            }
            Some(Derivative::Measured { tally, .. }) => {
                let breach = "pdf is below what this branch of the sampler alone gives";
                Outcome::of_tally(tally, "pdf ≥ 1/|∂ω/∂u| of a branch", breach).into()
            }
        }
    }
}
