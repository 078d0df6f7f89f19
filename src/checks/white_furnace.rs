//! A lossless subject gives back all flux.

use super::energy::flux;
use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism, needs_functions};
use crate::bsdf::Description;
use crate::evidence::{Evidence, Measurement};

/// How far from 1 the furnace of a lossless subject may be. Albedo tables of
/// energy compensation hold about three digits.
const TOLERANCE: f64 = 1e-3;

/// Claimed lossless: the flux of `energy` is 1.
pub struct WhiteFurnace;

impl Check for WhiteFurnace {
    fn id(&self) -> &'static str {
        "white-furnace"
    }

    fn hypothesis(&self) -> &'static str {
        "claimed lossless: ∫s f|cos θi| + Σ s P_k w_k = 1"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Integrals, Measurement::Draws]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        if !description.claims.lossless {
            return Err("lossless is not claimed".into());
        }
        needs_functions(description, true, false, false)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let claims = &evidence.description.claims;
        if evidence.wo.z <= 0.0 && !claims.transmissive && !claims.two_sided {
            return Outcome::skipped("seen from behind, where a one-sided subject gives back nothing").into();
        }
        let Some(integrals) = &evidence.integrals else { return Judgement::Missing };
        // A rare discrete lobe may carry much of the flux: wait for all draws.
        if let (Some(next), true) = (terms.next, evidence.description.has.sample) {
            return Judgement::More(next);
        }
        let certainty = match integrals.certainty() {
            Ok(certainty) => certainty,
            Err(reason) => return Outcome::inconclusive(reason).into(),
        };
        let Some((channel, flux, error)) = flux(evidence, true) else { return Judgement::Missing };
        let error = certainty * error;
        let off = flux - 1.0;
        let outcome = Outcome {
            effect: Some(Effect::interval("flux − 1", (off, off - error, off + error), TOLERANCE)),
            channel: Some(channel),
            detection_limit: Some(TOLERANCE + error),
            ..Outcome::new(Verdict::Pass, format!("flux {flux:.5} = 1"))
        };
        if off.abs() - error > TOLERANCE {
            let message = format!("flux {flux:.5} where 1 is claimed");
            return Outcome { verdict: Verdict::Fail, message, ..outcome }.into();
        }
        if let Err(reason) = integrals.reliable() {
            return Outcome::inconclusive(reason).into();
        }
        outcome.into()
    }
}
