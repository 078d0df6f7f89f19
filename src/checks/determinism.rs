//! Equal inputs give equal outputs, and successive samples are independent.

use super::outcome::{Check, Effect, Judgement, Outcome, POWER, Terms, Verdict, needs_determinism};
use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{Evidence, Measurement, SERIAL};
use crate::statistics::{effect, noncentral};

/// Equal (wo, u) gives the equal sample bit for bit, whatever was called
/// between; so do eval and pdf; and the cells of successive samples are
/// independent, which a generator hidden in the subject may break.
pub struct Determinism;

impl Check for Determinism {
    fn id(&self) -> &'static str {
        "determinism"
    }

    fn hypothesis(&self) -> &'static str {
        "equal (wo, u) gives the equal sample; eval and pdf have no hidden state"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Repeats, Measurement::Draws]
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
        let Some(repeats) = &evidence.repeats else { return Judgement::Missing };
        for (tally, what) in [
            (&repeats.sample, "sample() of equal u"),
            (&repeats.value, "eval() or pdf() of equal directions"),
        ] {
            if tally.is_broken() {
                let breach = "something is remembered between calls, or drawn inside";
                return Outcome::of_tally(tally, &format!("equality of {what}"), breach).into();
            }
        }
        let held = format!(
            "{} repeated samples and {} repeated values are equal bit for bit",
            repeats.sample.checked, repeats.value.checked
        );
        let pass = Outcome::new(Verdict::Pass, held.clone());
        if !evidence.description.has.sample {
            return pass.into();
        }
        let Some(draws) = evidence.draws.get(terms.attempt) else { return Judgement::Missing };
        let Some((x2, dof, pairs)) = contingency(&draws.serial) else {
            return terms.settle(Outcome { samples: draws.samples, ..pass });
        };
        let lambda = pairs as f64 * terms.tolerance * terms.tolerance;
        let ln_p = noncentral::ln_sf(x2, dof, lambda);
        let effect =
            Effect::interval("serial dependence √D", effect::root_d(x2, dof, pairs), terms.tolerance);
        let outcome = Outcome {
            certain: false,
            effect: Some(effect),
            ln_p: Some(ln_p),
            ln_threshold: Some(terms.ln_tail),
            samples: draws.samples,
            ..pass
        };
        if ln_p < terms.ln_tail {
            let message = format!(
                "successive samples depend on each other (X² = {x2:.0} with {dof} degrees of freedom)"
            );
            return Outcome { verdict: Verdict::Fail, message, ..outcome }.into();
        }
        let message = format!("{held}; {pairs} successive pairs are independent");
        let threshold = effect::tolerance_threshold(dof, pairs, terms.tolerance, terms.ln_tail);
        let limit = effect::detection_limit(dof, pairs, threshold, POWER);
        let outcome = Outcome { message, detection_limit: Some(limit), ..outcome };
        // The suite's `detect` is of errors of the distribution; dependence is
        // looked for beside, as far as the same draws show it.
        match terms.next {
            Some(next) => Judgement::More(next),
            None => outcome.into(),
        }
    }
}

/// Pearson's test of independence on the table of serial pairs: X², degrees of
/// freedom, pairs. Only rows and columns that expect 20 in each of their
/// cells, by the largest others, take part.
fn contingency(table: &[u64]) -> Option<(f64, f64, u64)> {
    let total: u64 = table.iter().sum();
    let row_total = |r: usize| table[r * SERIAL..(r + 1) * SERIAL].iter().sum::<u64>();
    let column_total = |c: usize| table.iter().skip(c).step_by(SERIAL).sum::<u64>();
    // Marginals of at least √(20 · total) expect at least 20 together.
    let least = (20.0 * total as f64).sqrt();
    let rows: Vec<usize> = (0..SERIAL).filter(|r| row_total(*r) as f64 >= least).collect();
    let columns: Vec<usize> = (0..SERIAL).filter(|c| column_total(*c) as f64 >= least).collect();
    if total == 0 || rows.len() < 2 || columns.len() < 2 {
        return None;
    }
    let cell = |r: usize, c: usize| table[r * SERIAL + c] as f64;
    let part: f64 = rows.iter().map(|r| columns.iter().map(|c| cell(*r, *c)).sum::<f64>()).sum();
    let mut x2 = 0.0;
    for &r in &rows {
        let of_row: f64 = columns.iter().map(|c| cell(r, *c)).sum();
        for &c in &columns {
            let of_column: f64 = rows.iter().map(|r| cell(*r, c)).sum();
            let expected = of_row * of_column / part;
            x2 += (cell(r, c) - expected).powi(2) / expected;
        }
    }
    Some((x2, ((rows.len() - 1) * (columns.len() - 1)) as f64, part as u64))
}
