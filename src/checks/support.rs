//! pdf is positive where samples fall and where light is, and nowhere else.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism, needs_functions};
use crate::bsdf::{Description, OffSupport};
use crate::evidence::{Evidence, Measurement, Place, SMALLEST_PEAK};

/// The share of ∫f|cos θi| that may lie where pdf = 0: cells at the rim of the
/// support and rounding leave less.
const LOST: f64 = 1e-9;

/// Where samples are rarer than pdf says by more than this factor there is
/// phantom mass; a pdf that is off by less is off, but not in its support.
const PHANTOM: f64 = 0.1;

/// Nothing is sampled where pdf is 0 (not even within rounding of wi); no share
/// of ∫f|cos θi| lies where pdf = 0; no region has pdf and never a sample.
pub struct Support;

impl Check for Support {
    fn id(&self) -> &'static str {
        "support"
    }

    fn hypothesis(&self) -> &'static str {
        "pdf > 0 wherever samples fall and wherever f > 0, and no phantom mass where none fall"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Samples, Measurement::Integrals, Measurement::Draws]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, false, true, true)?;
        needs_determinism(description)
    }

    fn is_statistical(&self) -> bool {
        true
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let (Some(samples), Some(partition), Some(integrals)) =
            (&evidence.samples, &evidence.partition, &evidence.integrals)
        else {
            return Judgement::Missing;
        };
        let Some(draws) = evidence.draws.get(terms.attempt) else { return Judgement::Missing };
        for tally in [&samples.zero_pdf, &draws.zero_pdf] {
            if tally.is_broken() {
                let of = samples.drawn.max(1);
                let message = format!(
                    "{} samples fell where pdf(wo, wi) = 0 (looked at {of} samples and at all in cells without pdf)",
                    tally.broken
                );
                let effect = Effect::exact("samples at pdf = 0", tally.broken as f64, 0.0);
                let worst = tally.place.clone();
                return Outcome { effect: Some(effect), worst, ..Outcome::new(Verdict::Fail, message) }
                    .into();
            }
        }
        if let Err(reason) = integrals.reliable() {
            return Outcome::inconclusive(reason).into();
        }
        let claims = &evidence.description.claims;
        if claims.off_support == OffSupport::Never && draws.none > 0 {
            let message =
                format!("off_support = \"never\" is claimed, and {} draws gave no sample", draws.none);
            return Outcome::new(Verdict::Fail, message).into();
        }
        let channels = evidence.description.channels.len();
        let mean: f64 = (0..channels).map(|c| integrals.albedo(c).0).sum::<f64>() / channels as f64;
        let lost = if mean > 0.0 { integrals.lost / mean } else { 0.0 };
        let effect = Effect::exact("share of ∫f|cos θi| where pdf = 0", lost, LOST);
        if lost > LOST {
            let message = format!("{:.3e} of ∫f|cos θi| lies where pdf = 0: sampling never finds it", lost);
            return Outcome { effect: Some(effect), ..Outcome::new(Verdict::Fail, message) }.into();
        }
        // Light on a side that is not claimed would be missed by cosine sampling, and by readers.
        for (claimed, word, front) in [
            (claims.reflective, "reflective", evidence.wo.z > 0.0),
            (claims.transmissive, "transmissive", evidence.wo.z <= 0.0),
        ] {
            let leaves = (0..partition.len()).filter(|l| partition.leaf_cell(*l).is_front() == front);
            let there: f64 = leaves.flat_map(|l| &integrals.value[l * channels..(l + 1) * channels]).sum();
            if !claimed && there / channels as f64 > LOST * mean {
                let message = format!("{word} is not claimed, and ∫f|cos θi| = {there:.3e} on that side");
                return Outcome::new(Verdict::Fail, message).into();
            }
        }
        // Phantom mass: nodes that expect samples and have none.
        let counts = partition.sum_up(&draws.counts);
        let masses = partition.sum_up(&integrals.pdf);
        let empty = (0..partition.nodes())
            .filter(|v| counts[*v] == 0 && masses[*v] > 0.0)
            .max_by(|a, b| masses[*a].total_cmp(&masses[*b]));
        let n = draws.samples as f64;
        let correction = (partition.nodes() as f64).ln();
        let ln_p = empty.map_or(0.0, |v| (n * (-PHANTOM * masses[v].min(1.0)).ln_1p() + correction).min(0.0));
        let outcome = Outcome {
            certain: false,
            effect: Some(effect),
            ln_p: Some(ln_p),
            ln_threshold: Some(terms.ln_tail),
            samples: draws.samples,
            ..Outcome::new(Verdict::Pass, String::new())
        };
        if let (true, Some(node)) = (ln_p < terms.ln_tail, empty) {
            let cell = partition.node_cell(node);
            let wi = partition.chart().to_direction(cell.at(0.5, 0.5));
            let message = format!(
                "pdf has mass {:.4} around θ = {:.1}°, φ = {:.0}°, where none of {} draws fell",
                masses[node],
                wi.theta().to_degrees(),
                wi.phi().to_degrees().rem_euclid(360.0),
                draws.samples
            );
            let worst = Some(Place::pair(evidence.wo, wi).value("∫pdf over the cell", masses[node]));
            return Outcome { verdict: Verdict::Fail, message, worst, ..outcome }.into();
        }
        let message = format!(
            "no sample where pdf = 0; {lost:.1e} of ∫f|cos θi| outside of the support; peaks of {SMALLEST_PEAK:.1e} sr cannot hide"
        );
        // Phantom mass that n draws would have shown.
        let limit = (-terms.ln_tail + correction) / (PHANTOM * n);
        terms.settle(Outcome { message, detection_limit: Some(limit), ..outcome })
    }
}
