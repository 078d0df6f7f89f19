//! Every number is what a number of its kind must be.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict};
use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{Evidence, Measurement};

/// Finite, eval ≥ 0, pdf ≥ 0, |wi| = 1: of everything that the subject returned
/// in the case, hostile inputs included (u at 0 and 1−ε, wo = n, wo ⟂ n, wi =
/// −wo, the other side).
pub struct Sanity;

impl Check for Sanity {
    fn id(&self) -> &'static str {
        "sanity"
    }

    fn hypothesis(&self) -> &'static str {
        "all values are finite, eval ≥ 0, pdf ≥ 0, |wi| = 1, at hostile inputs too"
    }

    fn needs(&self) -> &'static [Measurement] {
        &Measurement::ALL
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf, SubjectKind::Distribution, SubjectKind::Fresnel]
    }

    fn applies(&self, _: &Description) -> Result<(), String> {
        Ok(())
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        if evidence.corners.is_none() {
            return Judgement::Missing;
        }
        if evidence.looks_unimplemented() {
            let message = "not implemented: every sample() was no sample, and pdf() is 0 everywhere";
            return Outcome::new(Verdict::Fail, message).into();
        }
        let sanity = &evidence.sanity;
        let mut broken: Vec<_> = sanity.tallies.iter().collect();
        broken.sort_by_key(|(_, tally)| std::cmp::Reverse(tally.broken));
        let Some((_, first)) = broken.first() else {
            let message = format!("{} values are finite and in range", sanity.checked);
            let contradictions = &evidence.description.contradictions;
            if !contradictions.is_empty() {
                let told = format!("{}; it was measured as such", contradictions.join("; "));
                return Outcome::new(Verdict::Warn, told).into();
            }
            return Outcome::new(Verdict::Pass, message).into();
        };
        let sentences: Vec<_> =
            broken.iter().map(|(sentence, tally)| format!("{sentence} ({}×)", tally.broken)).collect();
        let message = format!("broken: {}, of {} values", sentences.join(", "), sanity.checked);
        Outcome {
            effect: Some(Effect::exact("values out of range", first.broken as f64, 0.0)),
            worst: first.place.clone(),
            ..Outcome::new(Verdict::Fail, message)
        }
        .into()
    }
}
