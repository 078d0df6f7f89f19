//! A subject equals another one.

use super::goodness_of_fit::against;
use super::outcome::{Check, Judgement, Outcome, Terms, Verdict, needs_determinism};
use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{Evidence, Measurement};

/// Equals the subject that the suite names as its `reference`: eval and pdf
/// pointwise, samples in distribution.
pub struct Reference;

impl Check for Reference {
    fn id(&self) -> &'static str {
        "reference"
    }

    fn hypothesis(&self) -> &'static str {
        "equals the suite's reference: eval and pdf pointwise, samples in distribution"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Samples, Measurement::Integrals, Measurement::Draws, Measurement::Reference]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf, SubjectKind::Distribution, SubjectKind::Fresnel]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_determinism(description)
    }

    fn is_statistical(&self) -> bool {
        true
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let Some(reference) = &evidence.reference else { return Judgement::Missing };
        if let Some(reason) = &reference.incomparable {
            return Outcome::new(Verdict::Fail, format!("not comparable with {}: {reason}", reference.name))
                .into();
        }
        for (tally, function) in [(&reference.eval, "eval"), (&reference.pdf, "pdf")] {
            if tally.is_broken() {
                let identity = format!("{function} of {}", reference.name);
                return Outcome::of_tally(tally, &identity, "the two differ").into();
            }
        }
        let held = format!(
            "equals {} at {} values and {} densities",
            reference.name, reference.eval.checked, reference.pdf.checked
        );
        let (Some(partition), Some(draws)) = (&evidence.partition, evidence.draws.get(terms.attempt)) else {
            return Outcome::new(Verdict::Pass, held).into();
        };
        if reference.masses.is_empty() {
            return Outcome::new(Verdict::Pass, held).into();
        }
        if let Some(reason) = &reference.unreliable {
            return Outcome::inconclusive(format!("of the reference: {reason}")).into();
        }
        let continuous: f64 = reference.masses.iter().sum();
        if continuous == 0.0 && draws.continuous() == 0 {
            return Outcome::new(Verdict::Pass, format!("{held}; neither has a continuous lobe")).into();
        }
        match against(evidence, partition, &reference.masses, draws, terms) {
            Judgement::Outcome(outcome) => {
                let message = format!("{held}; against its pdf: {}", outcome.message);
                Outcome { message, ..*outcome }.into()
            }
            other => other,
        }
    }
}
