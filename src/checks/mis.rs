//! Multiple importance sampling gives the same integral.

use super::albedo::{Mean, expected, judge_means};
use super::outcome::{Check, Judgement, Outcome, Terms, needs_determinism, needs_functions};
use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{Evidence, Measurement};

/// Cosine and BSDF sampling combined by the balance heuristic (Veach and Guibas
/// 1995) give the same integral as cubature: the use that a pdf is for. A pdf
/// that is wrong in a way that cancels in weights shows here.
pub struct Mis;

impl Check for Mis {
    fn id(&self) -> &'static str {
        "mis"
    }

    fn hypothesis(&self) -> &'static str {
        "cosine and BSDF sampling combined by the balance heuristic give ∫f|cos θi| + Σ P_k w_k"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Integrals, Measurement::Draws, Measurement::Mis]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        if !description.claims.reflective && !description.claims.transmissive {
            return Err("no side is claimed to which light leaves".into());
        }
        needs_functions(description, true, true, true)?;
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
        if draws.continuous() == 0 && integrals.mass().0 == 0.0 {
            return Outcome::skipped("discrete lobes cannot be hit by another strategy").into();
        }
        let (sampler, cosine) = (&draws.mis_sampler, &draws.mis_cosine);
        let (n, m) = (sampler.count as f64, cosine.count.max(1) as f64);
        let means: Vec<Mean> = (0..evidence.description.channels.len())
            .map(|c| {
                let (expected, error) = expected(integrals, draws, c);
                let (by_sampler, var_sampler) = sampler.moments(c);
                let (by_cosine, var_cosine) = cosine.moments(c);
                let balanced = integrals.largest_balanced;
                // Of a draw of the cosine the balanced value is that times m/n.
                let bound = balanced.max(sampler.largest.0) / n;
                let bound = bound.max(cosine.largest.0 / m);
                Mean {
                    expected,
                    error,
                    found: by_sampler + by_cosine,
                    variance: var_sampler / n + var_cosine / m,
                    bound,
                }
            })
            .collect();
        judge_means(&means, &evidence.description.channels, draws.samples, "MIS/∫f|cos θi|", terms)
    }
}
