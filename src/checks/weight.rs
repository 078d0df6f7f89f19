//! Weights are f·|cos θi|/pdf.

use super::outcome::{Check, Judgement, Outcome, Terms, Verdict, needs_determinism, needs_functions};
use crate::bsdf::{Cosine, Description};
use crate::evidence::{Evidence, Measurement};

/// weight·pdf(wo, wi) = f·|cos θi| for each continuous sample, per channel. Where
/// the probe found that eval follows the other convention of the cosine, that
/// is said here, as a warning.
pub struct Weight;

impl Check for Weight {
    fn id(&self) -> &'static str {
        "weight"
    }

    fn hypothesis(&self) -> &'static str {
        "weight·pdf(wo, wi) = f·|cos θi| for each continuous sample, per channel"
    }

    fn needs(&self) -> &'static [Measurement] {
        // Pairs, because reciprocity tells a cosine in eval from one that the weight lacks.
        &[Measurement::Samples, Measurement::Pairs]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, true, true, true)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(samples) = &evidence.samples else { return Judgement::Missing };
        if samples.weight.checked == 0 {
            return Outcome::skipped("no continuous sample came").into();
        }
        let breach = if samples.suggests_other_cosine() {
            "weight·pdf equals eval without |cos θi| everywhere: the weight lacks the cosine"
        } else {
            "the weight is not the value over the density"
        };
        let outcome = Outcome::of_tally(&samples.weight, "weight·pdf = f·|cos θi|", breach);
        if let (Some(found), Verdict::Pass) = (evidence.cosine_found, outcome.verdict) {
            let (is, word) = match found {
                Cosine::Included => ("contains", "included"),
                Cosine::Excluded => ("does not contain", "excluded"),
            };
            let message = format!(
                "eval() {is} |cos θi|, contrary to the declaration; measured as such: claim cosine = \"{word}\""
            );
            return Outcome { verdict: Verdict::Warn, message, ..outcome }.into();
        }
        outcome.into()
    }
}
