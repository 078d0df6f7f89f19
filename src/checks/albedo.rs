//! Weights average to the integral of f.

use super::outcome::{
    Check, Effect, Judgement, Outcome, POWER, Terms, Verdict, needs_determinism, needs_functions,
};
use crate::bsdf::Description;
use crate::evidence::{Draws, Evidence, Integrals, Measurement};
use crate::statistics::means::{bernstein_deviation, bernstein_ln_tail};

/// E\[weight\] = ∫f|cos θi| + Σ P_k w_k, per channel. The variance is known from
/// cubature; Bernstein's inequality holds for any bounded distribution, where
/// a normal approximation of heavy-tailed weights would not.
pub struct Albedo;

/// ∫f|cos θi| + Σ P_k w_k of a channel, with the cubature's error.
pub(super) fn expected(integrals: &Integrals, draws: &Draws, channel: usize) -> (f64, f64) {
    let (continuous, error) = integrals.albedo(channel);
    let discrete: f64 = draws.discrete.iter().map(|d| d.probability * d.weight[channel]).sum();
    (continuous + discrete, error)
}

/// The judgement of a mean against its expected value, channel by channel.
pub(super) struct Mean {
    pub expected: f64,
    pub error: f64,
    pub found: f64,
    /// Variance of the found mean.
    pub variance: f64,
    /// Largest single contribution to it.
    pub bound: f64,
}

impl Mean {
    /// ln p that it is off by no more than the tolerance.
    fn ln_p(&self, tolerance: f64) -> f64 {
        let slack = tolerance * self.expected + self.error;
        let excess = (self.found - self.expected).abs() - slack;
        if excess <= 0.0 { 0.0 } else { bernstein_ln_tail(excess, self.variance, self.bound, 1) }
    }
}

/// Judges means, one a channel, under one share.
pub(super) fn judge_means(
    means: &[Mean],
    channels: &[String],
    samples: u64,
    what: &str,
    terms: &Terms,
) -> Judgement {
    let correction = (means.len() as f64).ln();
    let lit = |m: &Mean| m.expected != 0.0 || m.found != 0.0;
    let (worst, ln_p) = means
        .iter()
        .enumerate()
        .filter(|(_, mean)| lit(mean))
        .map(|(c, mean)| (c, (mean.ln_p(terms.mean_tolerance) + correction).min(0.0)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0, 0.0));
    let mean = &means[worst];
    if !lit(mean) {
        return Outcome::skipped("there is no light to account for: both are 0").into();
    }
    let ends = bernstein_deviation(mean.variance, mean.bound, 1, 0.05f64.ln());
    let ratio = |v: f64| v / mean.expected - 1.0;
    let effect = Effect::interval(
        &format!("{what} − 1"),
        (ratio(mean.found), ratio(mean.found - ends), ratio(mean.found + ends)),
        terms.mean_tolerance,
    );
    let outcome = Outcome {
        certain: false,
        effect: Some(effect),
        ln_p: Some(ln_p),
        ln_threshold: Some(terms.ln_tail),
        channel: Some(worst),
        samples,
        ..Outcome::new(Verdict::Pass, String::new())
    };
    let of_channel = if means.len() > 1 { format!(" ({})", channels[worst]) } else { String::new() };
    let message = format!("found {:.5} ± {ends:.5}, cubature {:.5}{of_channel}", mean.found, mean.expected);
    if ln_p < terms.ln_tail {
        return Outcome { verdict: Verdict::Fail, message, ..outcome }.into();
    }
    let limit = means
        .iter()
        .filter(|m| m.expected > 0.0)
        .map(|m| {
            let ln_tail = terms.ln_tail - correction;
            let deviation = bernstein_deviation(m.variance, m.bound, 1, ln_tail)
                + bernstein_deviation(m.variance, m.bound, 1, (1.0 - POWER).ln());
            terms.mean_tolerance + (deviation + m.error) / m.expected
        })
        .fold(0.0, f64::max);
    terms.settle(Outcome { message, detection_limit: Some(limit), ..outcome })
}

impl Check for Albedo {
    fn id(&self) -> &'static str {
        "albedo"
    }

    fn hypothesis(&self) -> &'static str {
        "E[weight] = ∫f|cos θi| + Σ P_k w_k, per channel"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Integrals, Measurement::Draws]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, true, false, true)?;
        needs_determinism(description)
    }

    fn is_statistical(&self) -> bool {
        true
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let Some(integrals) = &evidence.integrals else { return Judgement::Missing };
        if let Err(reason) = integrals.reliable() {
            return Outcome::inconclusive(reason).into();
        }
        let Some(draws) = evidence.draws.get(terms.attempt) else { return Judgement::Missing };
        let n = draws.samples as f64;
        let means: Vec<Mean> = (0..evidence.description.channels.len())
            .map(|c| {
                let (expected, error) = expected(integrals, draws, c);
                let (found, seen) = draws.weight.moments(c);
                let discrete: f64 =
                    draws.discrete.iter().map(|d| d.probability * d.weight[c] * d.weight[c]).sum();
                // Weights that are right on average only vary more than f·cos/pdf does.
                let known = integrals.second[c] + discrete - expected * expected;
                let variance = known.max(seen).max(0.0) / n;
                let bound = integrals.largest_weight.max(draws.weight.largest.0) / n;
                Mean { expected, error, found, variance, bound }
            })
            .collect();
        judge_means(&means, &evidence.description.channels, draws.samples, "E[weight]/∫f|cos θi|", terms)
    }
}
