//! Light may take a path both ways.

use super::outcome::{Check, Judgement, Outcome, Terms, Verdict, needs_determinism, needs_functions};
use crate::bsdf::{Description, SubjectKind, TransportModes};
use crate::evidence::{Evidence, Measurement};

/// eval(wo, wi)/η_o² = eval(wi, wo)/η_i² in radiance mode, its inverse in
/// importance mode; the modes are each other's adjoint; the flux through a
/// discrete lobe is the same both ways. Where transmission follows the scale of the
/// other mode throughout, that is a convention, and told as one. Over directions spread evenly and drawn
/// from the lobe, with a local search for the worst pair.
pub struct Reciprocity;

impl Check for Reciprocity {
    fn id(&self) -> &'static str {
        "reciprocity"
    }

    fn hypothesis(&self) -> &'static str {
        "eval(wo, wi)/η_o² = eval(wi, wo)/η_i²; discrete lobes carry the same flux both ways"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Pairs]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        if !description.claims.reciprocal {
            return Err("reciprocal is not claimed".into());
        }
        needs_functions(description, true, false, false)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(pairs) = &evidence.pairs else { return Judgement::Missing };
        let identity = "eval(wo, wi)/η_o² = eval(wi, wo)/η_i²";
        let outcome = Outcome::of_tally(&pairs.reciprocity, identity, "f is not symmetric");
        if pairs.follows_other_mode() && evidence.description.claims.transport != TransportModes::Both {
            let message = format!(
                "transmission is scaled as in {} transport, contrary to the declaration; measured as such",
                evidence.scale()
            );
            return Outcome { verdict: Verdict::Warn, message, ..outcome }.into();
        }
        if outcome.verdict == Verdict::Fail {
            return outcome.into();
        }
        if let Some(adjoint) = pairs.adjoint.as_ref().filter(|t| t.is_broken()) {
            let breach = "importance is not the adjoint of radiance";
            return Outcome::of_tally(adjoint, "eval*(wo, wi) = eval(wi, wo)", breach).into();
        }
        if pairs.discrete.is_broken() {
            let breach = "a discrete lobe carries other flux on the way back";
            return Outcome::of_tally(&pairs.discrete, "flux there = flux back", breach).into();
        }
        outcome.into()
    }
}
