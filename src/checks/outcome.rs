//! What a check says.

use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{Evidence, Figure, Measurement, Place, Tally};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The verdict of a check on a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Not tried, for a reason that is given.
    Skipped,
    /// Nothing wrong, within the detection limit that is given.
    Pass,
    /// Wrong, and the suite says why that is meant.
    Waived,
    /// A convention that differs from the declaration, not a bug.
    Warn,
    /// Samples or cubature cannot decide, or a suspicion was not confirmed.
    Inconclusive,
    /// Wrong.
    Fail,
    /// Could not be measured.
    Error,
}

impl Verdict {
    /// As it is written in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Warn => "warn",
            Self::Inconclusive => "inconclusive",
            Self::Skipped => "skipped",
            Self::Error => "error",
            Self::Waived => "waived",
        }
    }
}

/// How large an error is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Effect {
    /// What is measured.
    pub name: String,
    /// Its value.
    pub value: Figure,
    /// Lower end of its 95 % interval, or of what is certain.
    pub low: Figure,
    /// Upper end.
    pub high: Figure,
    /// What is tolerated.
    pub tolerance: Figure,
}

impl Effect {
    /// A value known exactly.
    pub fn exact(name: &str, value: f64, tolerance: f64) -> Self {
        Self::interval(name, (value, value, value), tolerance)
    }

    /// (value, low, high).
    pub fn interval(name: &str, (value, low, high): (f64, f64, f64), tolerance: f64) -> Self {
        Self {
            name: name.into(),
            value: value.into(),
            low: low.into(),
            high: high.into(),
            tolerance: tolerance.into(),
        }
    }
}

/// What a check found on a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The verdict.
    pub verdict: Verdict,
    /// Whether it needs no confirmation: no chance was involved.
    pub certain: bool,
    /// How large the error is.
    pub effect: Option<Effect>,
    /// ln of the probability, were the error within tolerance, of what was seen.
    pub ln_p: Option<f64>,
    /// ln of the probability below which the check fails at this look.
    pub ln_threshold: Option<f64>,
    /// In which channel.
    pub channel: Option<usize>,
    /// Draws used.
    pub samples: u64,
    /// The smallest error that would have been found with probability 0.999.
    pub detection_limit: Option<f64>,
    /// One sentence.
    pub message: String,
    /// Why it was skipped or could not decide.
    pub reason: Option<String>,
    /// Where it is worst.
    pub worst: Option<Place>,
}

impl Outcome {
    /// An outcome without figures.
    pub fn new(verdict: Verdict, message: impl Into<String>) -> Self {
        Self {
            verdict,
            certain: true,
            effect: None,
            ln_p: None,
            ln_threshold: None,
            channel: None,
            samples: 0,
            detection_limit: None,
            message: message.into(),
            reason: None,
            worst: None,
        }
    }

    /// Skipped for a reason.
    pub fn skipped(reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self { reason: Some(reason.clone()), ..Self::new(Verdict::Skipped, reason) }
    }

    /// Not decided, for a reason.
    pub fn inconclusive(reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self { reason: Some(reason.clone()), ..Self::new(Verdict::Inconclusive, reason) }
    }

    /// Could not be measured.
    pub fn error(reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self { reason: Some(reason.clone()), ..Self::new(Verdict::Error, reason) }
    }

    /// An identity that must hold at every place it was looked at. `identity` is
    /// its formula, `breach` what a breach means.
    pub fn of_tally(tally: &Tally, identity: &str, breach: &str) -> Self {
        let effect = Effect::exact("largest relative error", tally.worst.0, tally.tolerance);
        if tally.is_broken() {
            let share = 100.0 * tally.share();
            let message = format!(
                "{identity} is broken at {share:.3} % of {} places, by up to {:.3e}: {breach}",
                tally.checked, tally.worst.0
            );
            let worst = tally.place.clone();
            return Self { effect: Some(effect), worst, ..Self::new(Verdict::Fail, message) };
        }
        if tally.checked == 0 {
            return Self::inconclusive(format!("{identity} could not be looked at anywhere"));
        }
        let message = format!(
            "{identity} holds at {} places within {:.0e} (largest error {:.1e})",
            tally.checked, tally.tolerance, tally.worst.0
        );
        Self {
            effect: Some(effect),
            detection_limit: Some(tally.share_limit()),
            ..Self::new(Verdict::Pass, message)
        }
    }
}

/// What a statistical check says at a look.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    /// Undecided; it wants so many draws in all.
    More(u64),
    /// Decided. A failure that is not certain must be confirmed.
    Outcome(Box<Outcome>),
    /// A part of the evidence that it needs is not there.
    Missing,
}

impl From<Outcome> for Judgement {
    fn from(outcome: Outcome) -> Self {
        Self::Outcome(Box::new(outcome))
    }
}

/// The terms on which a check judges at one look.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// Which draws: 0 the first, 1 their confirmation.
    pub attempt: usize,
    /// ln of the probability of a false alarm that this look may spend.
    pub ln_tail: f64,
    /// Draws of the next look of this attempt, if there is one.
    pub next: Option<u64>,
    /// RMS relative cell error that counts as wrong.
    pub tolerance: f64,
    /// Relative error of masses and means that counts as wrong.
    pub mean_tolerance: f64,
    /// A pass must have been able to see this much.
    pub detect: f64,
}

/// The power at which detection limits are told.
pub const POWER: f64 = 0.999;

impl Terms {
    /// The final form of an undecided look: more draws while there are looks left;
    /// a pass if its detection limit suffices; else inconclusive.
    pub fn settle(&self, outcome: Outcome) -> Judgement {
        if outcome.verdict != Verdict::Pass {
            return outcome.into();
        }
        if let Some(next) = self.next {
            return Judgement::More(next);
        }
        match outcome.detection_limit {
            Some(limit) if !(limit <= self.detect) => {
                let reason = format!(
                    "would only have seen an error of {:.2} %, the suite asks for {:.2} %: raise --samples",
                    100.0 * limit,
                    100.0 * self.detect
                );
                Outcome { verdict: Verdict::Inconclusive, reason: Some(reason), ..outcome }.into()
            }
            _ => outcome.into(),
        }
    }
}

/// A check: a pure judge of evidence against a null hypothesis.
pub trait Check: Send + Sync {
    /// Its name in suites, reports and on the command line.
    fn id(&self) -> &'static str;
    /// The null hypothesis, or the identity.
    fn hypothesis(&self) -> &'static str;
    /// What must be measured.
    fn needs(&self) -> &'static [Measurement];
    /// The kinds of subject that it says something of: those with directions
    /// that are drawn.
    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf, SubjectKind::Distribution]
    }
    /// `Err` with the reason if it does not apply to a subject of these kinds.
    fn applies(&self, description: &Description) -> Result<(), String>;
    /// Whether chance is involved, so that it takes a share of the budget.
    fn is_statistical(&self) -> bool {
        false
    }
    /// Judges.
    fn judge(&self, evidence: &Evidence, terms: &Terms) -> Judgement;
}

/// `Err` with a reason if a subject is of none of the kinds that a check is for.
pub fn needs_kind(check: &dyn Check, kind: SubjectKind) -> Result<(), String> {
    if check.kinds().contains(&kind) {
        return Ok(());
    }
    let meant: Vec<_> = check.kinds().iter().map(|k| k.noun()).collect();
    Err(match meant[..] {
        [one] => format!("a {} is no {one}", kind.noun()),
        _ => format!("a {} is neither a {}", kind.noun(), meant.join(" nor a ")),
    })
}

/// `Err` with a reason if one of the needed functions is missing.
pub fn needs_functions(description: &Description, eval: bool, pdf: bool, sample: bool) -> Result<(), String> {
    let has = description.has;
    for (needed, there, name) in
        [(eval, has.eval, "eval"), (pdf, has.pdf, "pdf"), (sample, has.sample, "sample")]
    {
        if needed && !there {
            return Err(format!("the subject has no {name}()"));
        }
    }
    Ok(())
}

/// `Err` where eval and pdf are declared random: they hold on average only.
pub fn needs_determinism(description: &Description) -> Result<(), String> {
    if description.claims.stochastic {
        return Err("eval and pdf are declared stochastic; this identity holds on average only".into());
    }
    Ok(())
}
