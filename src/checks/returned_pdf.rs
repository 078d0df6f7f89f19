//! The pdf that comes with a sample is pdf().

use super::outcome::{Check, Judgement, Outcome, Terms, needs_determinism, needs_functions};
use crate::bsdf::Description;
use crate::evidence::{Evidence, Measurement};

/// sample.pdf = pdf(wo, wi) for each continuous sample.
pub struct ReturnedPdf;

impl Check for ReturnedPdf {
    fn id(&self) -> &'static str {
        "returned-pdf"
    }

    fn hypothesis(&self) -> &'static str {
        "sample.pdf = pdf(wo, wi) for each continuous sample"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Samples]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, false, true, true)?;
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(samples) = &evidence.samples else { return Judgement::Missing };
        if samples.returned_pdf.checked == 0 {
            return Outcome::skipped("no continuous sample came").into();
        }
        let breach = "sample() and pdf() do not agree on the density";
        Outcome::of_tally(&samples.returned_pdf, "sample.pdf = pdf(wo, wi)", breach).into()
    }
}
