//! How good the sampler is; not whether it is right.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism, needs_functions};
use crate::bsdf::Description;
use crate::evidence::{Evidence, Measurement};

/// Effective sample size per draw (∫f cos)²/∫(f cos)²/pdf = 1/(1 + χ²), and the
/// largest weight, by cubature. A figure to compare, not judged by itself.
pub struct Efficiency;

impl Check for Efficiency {
    fn id(&self) -> &'static str {
        "efficiency"
    }

    fn hypothesis(&self) -> &'static str {
        "none: variance of weight, largest weight and χ²-divergence of f·cos from pdf are reported"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Integrals]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, true, true, true)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(integrals) = &evidence.integrals else { return Judgement::Missing };
        if let Err(reason) = integrals.reliable() {
            return Outcome::inconclusive(reason).into();
        }
        let worst = (0..evidence.description.channels.len())
            .filter(|c| integrals.second[*c] > 0.0)
            .map(|c| {
                let albedo = integrals.albedo(c).0;
                (c, albedo * albedo / integrals.second[c])
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((channel, effective)) = worst else {
            return Outcome::skipped("no continuous lobe carries light").into();
        };
        let (second, error) = (integrals.second[channel], integrals.second_error[channel]);
        let albedo = integrals.albedo(channel).0;
        let finite = if error > 0.1 * second { "; its variance may be infinite" } else { "" };
        let message = format!(
            "{:.1} % of the draws count; χ² = {:.3}, variance of weight {:.4}, largest weight {:.3}{finite}",
            100.0 * effective,
            1.0 / effective - 1.0,
            second - albedo * albedo,
            integrals.largest_weight
        );
        let off = integrals.albedo(channel).1;
        let of = |albedo: f64, second: f64| albedo * albedo / second.max(f64::MIN_POSITIVE);
        let (low, high) = (of((albedo - off).max(0.0), second + error), of(albedo + off, second - error));
        let interval = (effective, low, high.min(1.0).max(effective));
        let effect = Effect::interval("effective draws per draw", interval, 0.0);
        Outcome { effect: Some(effect), channel: Some(channel), ..Outcome::new(Verdict::Pass, message) }
            .into()
    }
}
