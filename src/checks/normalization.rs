//! The pdf's mass is the probability of a sample.

use super::outcome::{
    Check, Effect, Judgement, Outcome, POWER, Terms, Verdict, needs_determinism, needs_functions,
};
use crate::bsdf::Description;
use crate::evidence::{Evidence, Measurement};
use crate::statistics::{binomial, normal};

/// Z = ∫pdf equals S = P(valid continuous sample). Not 1: draws below the
/// horizon are no sample, and a right GGX at α = 0.5 has Z = 0.60 at 75°.
pub struct Normalization;

impl Check for Normalization {
    fn id(&self) -> &'static str {
        "normalization"
    }

    fn hypothesis(&self) -> &'static str {
        "∫pdf = P(valid continuous sample)"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Masses, Measurement::Draws]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, false, true, true)?;
        needs_determinism(description)
    }

    fn is_statistical(&self) -> bool {
        true
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let Some(integrals) = &evidence.integrals else { return Judgement::Missing };
        let (least, deviation) = integrals.cross_check;
        let excess = least - 10.0 * deviation > 1.0 + terms.mean_tolerance;
        if let (Err(reason), false) = (integrals.masses_reliable(), excess) {
            return Outcome::inconclusive(reason).into();
        }
        let Some(draws) = evidence.draws.get(terms.attempt) else { return Judgement::Missing };
        let (n, valid) = (draws.samples, draws.continuous());
        let mass = integrals.mass().0;
        let share = valid as f64 / n as f64;
        if valid == 0 && mass == 0.0 {
            return Outcome::skipped("there is no continuous lobe").into();
        }
        let slack = integrals.slack(terms.mean_tolerance);
        let (low, high) = (mass - slack, mass + slack);
        let ln_p = binomial::ln_tail_beyond(valid, n, low, high);
        // Either side could have been the one.
        let ln_p = (ln_p + 2f64.ln()).min(0.0);
        let ends = binomial::proportion_interval(valid, n, 0.025);
        let ratio = (mass / share - 1.0, mass / ends.1 - 1.0, mass / ends.0 - 1.0);
        let outcome = Outcome {
            certain: false,
            effect: Some(Effect::interval("∫pdf / P(sample) − 1", ratio, terms.mean_tolerance)),
            ln_p: Some(ln_p),
            ln_threshold: Some(terms.ln_tail),
            samples: n,
            ..Outcome::new(Verdict::Pass, String::new())
        };
        let figures =
            format!("∫pdf = {mass:.5}, P(continuous sample) = {share:.5} ({:.5} to {:.5})", ends.0, ends.1);
        if low > 1.0 {
            let message = format!("{figures}: no density integrates to more than 1");
            return Outcome { verdict: Verdict::Fail, certain: true, message, ..outcome }.into();
        }
        if ln_p < terms.ln_tail {
            return Outcome { verdict: Verdict::Fail, message: figures, ..outcome }.into();
        }
        let deviations = normal::quantile(terms.ln_tail - 2f64.ln()) + normal::quantile((1.0 - POWER).ln());
        let spread = (mass * (1.0 - mass).max(0.0) / n as f64).sqrt();
        let limit = (slack + deviations * spread) / mass;
        terms.settle(Outcome { message: figures, detection_limit: Some(limit), ..outcome })
    }
}
