//! No direction gives back more flux than arrives.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism, needs_functions};
use crate::bsdf::{Description, Precision, SubjectKind};
use crate::evidence::{Evidence, Measurement, Place};

/// ∫s f|cos θi| + Σ s P_k w_k ≤ 1 for every channel, with the flux factor s =
/// (η_i/η_o)² of transmission in radiance mode.
pub struct Energy;

/// The flux that leaves, of the channel where it is largest (or farthest from
/// 1), and the cubature's error: (channel, flux, error).
pub(super) fn flux(evidence: &Evidence, farthest: bool) -> Option<(usize, f64, f64)> {
    let fluxes = evidence.fluxes()?;
    let each = fluxes.iter().enumerate().map(|(c, flux)| (c, flux.total, flux.error));
    let size = |flux: f64| if farthest { (flux - 1.0).abs() } else { flux };
    each.max_by(|a, b| size(a.1).total_cmp(&size(b.1)))
}

/// What flux may exceed 1 by: five times the cubature's goal, or rounding.
fn tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F64 => 1e-4,
        Precision::F32 => 1e-3,
    }
}

impl Check for Energy {
    fn id(&self) -> &'static str {
        "energy"
    }

    fn hypothesis(&self) -> &'static str {
        "∫s f|cos θi| + Σ s P_k w_k ≤ 1, with s = (η_i/η_o)² in radiance mode"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Integrals, Measurement::Draws]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        if !description.claims.energy_conserving {
            return Err("energy_conserving is not claimed".into());
        }
        needs_functions(description, true, false, false)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let Some(integrals) = &evidence.integrals else { return Judgement::Missing };
        // A rare discrete lobe may carry much of the flux: wait for all draws.
        if let (Some(next), true) = (terms.next, evidence.description.has.sample) {
            return Judgement::More(next);
        }
        let certainty = match integrals.certainty() {
            Ok(certainty) => certainty,
            Err(reason) => return Outcome::inconclusive(reason).into(),
        };
        let Some((channel, flux, error)) = flux(evidence, false) else { return Judgement::Missing };
        let error = certainty * error;
        let tolerance = tolerance(evidence.description.precision);
        // A table names the patch, and where its largest sum is.
        let given = evidence.given.as_ref().map_or_else(String::new, |given| format!(" ({given})"));
        let effect =
            Effect::interval("flux − 1", (flux - 1.0, flux - 1.0 - error, flux - 1.0 + error), tolerance);
        let missing = match evidence.description.table {
            Some(table) if table.missing > 0.0 => format!(
                ", {:.2} % of the table being missing and counted as 0: a lower bound",
                100.0 * table.missing
            ),
            _ => String::new(),
        };
        let outcome = Outcome {
            effect: Some(effect),
            channel: Some(channel),
            detection_limit: Some(tolerance + error),
            ..Outcome::new(Verdict::Pass, format!("flux {flux:.5} ≤ 1{given}{missing}"))
        };
        if flux - error > 1.0 + tolerance {
            let name = &evidence.description.channels[channel];
            let message = format!("flux {flux:.5} of channel {name} leaves where 1 arrives{given}{missing}");
            let worst = Some(Place { wo: evidence.wo, ..Place::default() }.value("flux", flux));
            return Outcome { verdict: Verdict::Fail, message, worst, ..outcome }.into();
        }
        if let Err(reason) = integrals.reliable() {
            return Outcome::inconclusive(reason).into();
        }
        outcome.into()
    }
}
