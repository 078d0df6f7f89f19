//! Discrete lobes are where, what and as often as they say.

use super::outcome::{Check, Effect, Judgement, Outcome, POWER, Terms, Verdict, needs_functions};
use crate::bsdf::{Description, Lobe, Precision, SubjectKind};
use crate::evidence::{Evidence, Measurement, Place, refracted};
use crate::statistics::{binomial, normal};

/// Probabilities, mirror and Snell directions, weights; flags say what the
/// lobe is, of continuous ones too; pdf and eval say nothing of it.
pub struct DiscreteLobes;

/// Continuous samples that repeat bit for bit in more than this share of draws
/// are a discrete lobe without its flag.
const REPEATED: f64 = 0.01;

/// How far, in radians, a lobe's direction may be off.
fn direction_tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F64 => 1e-7,
        Precision::F32 => 1e-3,
    }
}

fn fail(message: String, worst: Option<Place>, effect: Option<Effect>) -> Judgement {
    Outcome { worst, effect, ..Outcome::new(Verdict::Fail, message) }.into()
}

impl Check for DiscreteLobes {
    fn id(&self) -> &'static str {
        "discrete-lobes"
    }

    fn hypothesis(&self) -> &'static str {
        "discrete lobes have their probability, direction, weight and flags; pdf and eval leave them out"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Samples, Measurement::Integrals, Measurement::Draws]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_functions(description, false, false, true)
    }

    fn is_statistical(&self) -> bool {
        true
    }

    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement {
        let Some(samples) = &evidence.samples else { return Judgement::Missing };
        if let Some((wi, share)) = samples.repeated.filter(|(_, share)| *share > REPEATED) {
            let message = format!(
                "{:.1} % of the continuous samples are one and the same direction: a discrete lobe without its flag",
                100.0 * share
            );
            let place = Place::pair(evidence.wo, wi);
            return fail(
                message,
                Some(place),
                Some(Effect::exact("share of repeated samples", share, REPEATED)),
            );
        }
        if samples.side.is_broken() {
            let breach =
                "a sample flagged `reflection` leaves on the other side, or `transmission` on that of wo";
            return Outcome::of_tally(&samples.side, "the side that flags tell", breach).into();
        }
        let Some(draws) = evidence.draws.get(terms.attempt) else { return Judgement::Missing };
        if draws.discrete.is_empty() {
            return Outcome::skipped("no discrete lobe was met").into();
        }
        if draws.discrete_overflow > 0 {
            let message = format!(
                "more than {} different directions are flagged discrete: a continuous lobe under a wrong flag",
                draws.discrete.len()
            );
            return fail(message, None, None);
        }
        if let Some(tally) = samples.discrete_value.as_ref().filter(|t| t.is_broken()) {
            let breach = "a discrete lobe is returned from eval() or pdf()";
            return Outcome::of_tally(tally, "continuity at the discrete direction", breach).into();
        }
        let wo = evidence.wo;
        let tolerance = direction_tolerance(evidence.description.precision);
        for lobe in &draws.discrete {
            let place = || {
                Place::pair(wo, lobe.wi)
                    .value("probability", lobe.probability)
                    .value("weight", lobe.weight[0])
            };
            let reflects = lobe.wi.same_side(wo);
            let told = lobe.lobe.contains(Lobe::REFLECTION);
            if told == lobe.lobe.contains(Lobe::TRANSMISSION) || told != reflects {
                let side = if reflects { "the side of wo" } else { "the other side" };
                let message = format!("a lobe flagged `{}` leaves on {side}", lobe.lobe);
                return fail(message, Some(place()), None);
            }
            let right = match (reflects, evidence.description.claims.eta) {
                (true, _) => Some(wo.mirrored()),
                (false, Some(eta)) => match refracted(wo, eta) {
                    None => {
                        let message = "a discrete lobe is transmitted beyond the critical angle";
                        return fail(message.into(), Some(place()), None);
                    }
                    right => right,
                },
                (false, None) => None,
            };
            if let Some(right) = right {
                let angle = right.angle(lobe.wi);
                if !(angle <= tolerance) {
                    let law = if reflects { "the mirror direction" } else { "Snell's law" };
                    let message = format!("a discrete lobe is {:.2e}° off {law}", angle.to_degrees());
                    let effect = Effect::exact("angle off (radians)", angle, tolerance);
                    return fail(message, Some(place()), Some(effect));
                }
            }
            if lobe.spread.is_broken() {
                let breach = "probability or weight differ between draws of one lobe";
                return Outcome::of_tally(&lobe.spread, "constancy of a discrete lobe", breach).into();
            }
        }
        probabilities(evidence, terms)
    }
}

/// √(p(1−p)): in its units a difference of probabilities is √D of the two cells
/// {this lobe, all else}, since D = (q−p)²/p + (q−p)²/(1−p).
fn spread(p: f64) -> f64 {
    (p * (1.0 - p)).max(0.0).sqrt()
}

/// Counts against the claimed probabilities.
fn probabilities(evidence: &Evidence, terms: &Terms) -> Judgement {
    let draws = &evidence.draws[terms.attempt];
    let n = draws.samples;
    let correction = (2.0 * draws.discrete.len() as f64).ln();
    let mut worst = (f64::INFINITY, 0);
    for (k, lobe) in draws.discrete.iter().enumerate() {
        let slack = terms.tolerance * spread(lobe.probability);
        let p = lobe.probability;
        let ln_p = binomial::ln_tail_beyond(lobe.count, n, p - slack, p + slack);
        let ln_p = (ln_p + correction).min(0.0);
        if ln_p < worst.0 {
            worst = (ln_p, k);
        }
    }
    let lobe = &draws.discrete[worst.1];
    let ends = binomial::proportion_interval(lobe.count, n, 0.025);
    let share = lobe.count as f64 / n as f64;
    // A lobe that is always drawn has no spread, and any other draw is an error.
    let scale = spread(lobe.probability).max(1.0 / n as f64);
    let off = |v: f64| (v - lobe.probability) / scale;
    let effect = Effect::interval(
        "(frequency − P)/√(P(1−P))",
        (off(share), off(ends.0), off(ends.1)),
        terms.tolerance,
    );
    let message = format!(
        "{} discrete lobes; `{}` has probability {:.5} and came in {share:.5} of {n} draws",
        draws.discrete.len(),
        lobe.lobe,
        lobe.probability
    );
    let deviations = normal::quantile(terms.ln_tail - correction) + normal::quantile((1.0 - POWER).ln());
    let limit = terms.tolerance + deviations / (n as f64).sqrt();
    let outcome = Outcome {
        certain: false,
        effect: Some(effect),
        ln_p: Some(worst.0),
        ln_threshold: Some(terms.ln_tail),
        samples: n,
        ..Outcome::new(Verdict::Pass, message)
    };
    if worst.0 < terms.ln_tail {
        let worst = Some(Place::pair(evidence.wo, lobe.wi).value("probability", lobe.probability));
        return Outcome { verdict: Verdict::Fail, worst, ..outcome }.into();
    }
    terms.settle(Outcome { detection_limit: Some(limit), ..outcome })
}
