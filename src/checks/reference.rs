//! A subject equals another one.

use super::goodness_of_fit::against;
use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism};
use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{Evidence, Measurement, Resemblance};

/// Equals the subject that the suite names as its `reference`: eval, pdf and discrete
/// lobes one by one, samples in distribution. A table equals it as far as its nodes
/// resolve it: eval alone is compared then, by RMS over the light.
pub struct Reference;

/// RMS relative difference that counts as wrong where a table is compared, unless
/// the suite tolerates more: what the tables in use resolve (METHOD §3).
const RESOLVED: f64 = 0.02;

fn resembles(table: &Resemblance, name: &str, evidence: &Evidence, terms: &Terms) -> Outcome {
    let tolerance = RESOLVED.max(terms.tolerance);
    let rms = table.rms.0;
    let shown = format!("{:.2} % RMS at {} samples of the light", 100.0 * rms, table.places);
    let outcome = Outcome {
        effect: Some(Effect::exact("RMS relative difference of eval", rms, tolerance)),
        channel: Some(table.channel),
        worst: table.worst.clone(),
        ..Outcome::new(Verdict::Pass, format!("equals {name} as far as a table can: {shown}"))
    };
    if table.places == 0 {
        return Outcome::inconclusive("no continuous sample came at which to compare values");
    }
    if !(rms <= tolerance) {
        let channel = &evidence.description.channels[table.channel];
        let message = format!("eval of {name} differs by {shown} (channel {channel})");
        return Outcome { verdict: Verdict::Fail, message, ..outcome };
    }
    Outcome { worst: None, ..outcome }
}

impl Check for Reference {
    fn id(&self) -> &'static str {
        "reference"
    }

    fn hypothesis(&self) -> &'static str {
        "equals the suite's reference: eval, pdf and discrete lobes one by one, samples in distribution"
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
        if let Some(table) = &reference.table {
            return resembles(table, &reference.name, evidence, terms).into();
        }
        for (tally, what, breach) in [
            (&reference.eval, "eval", "the two differ"),
            (&reference.pdf, "pdf", "the two differ"),
            (&reference.discrete, "the discrete lobes", "direction, probability or weight differ"),
        ] {
            if tally.is_broken() {
                let identity = format!("{what} of {}", reference.name);
                return Outcome::of_tally(tally, &identity, breach).into();
            }
        }
        let mut held = format!(
            "equals {} at {} values and {} densities",
            reference.name, reference.eval.checked, reference.pdf.checked
        );
        if reference.discrete.checked > 0 {
            held.push_str(", and in its discrete lobes");
        }
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
        let slack = terms.mean_tolerance * continuous + reference.mass_error;
        match against(evidence, partition, (&reference.masses, slack), draws, terms) {
            Judgement::Outcome(outcome) => {
                let message = format!("{held}; against its pdf: {}", outcome.message);
                Outcome { message, ..*outcome }.into()
            }
            other => other,
        }
    }
}
