//! A Fresnel function keeps the laws of reflection.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism};
use crate::bsdf::{Claims, Description, SubjectKind};
use crate::evidence::{Evidence, FresnelLaw, Measurement};

/// The laws of reflection at all angles. Each is looked at where its claim is
/// made. What no law here can see: a wrong cosine that is handed to the
/// function, a wrong reflectance at normal incidence where no eta is claimed,
/// and a wrong shape in between of an approximation; for these name a
/// `reference`.
pub struct Fresnel;

impl FresnelLaw {
    fn identity(self, claims: &Claims) -> &'static str {
        match self {
            Self::Range => "0 ≤ R ≤ 1",
            Self::Balance if claims.lossless => "R + T = 1",
            Self::Balance => "R + T ≤ 1",
            Self::Symmetry => "R from outside at θi = R from inside at θt",
            Self::TotalReflection => "R = 1 beyond the critical angle",
            Self::Grazing => "R = 1 at grazing incidence",
            Self::Normal => "R = ((η − 1)/(η + 1))² at normal incidence",
            Self::Brewster => "R = ½((η² − 1)/(η² + 1))² and Rp = 0 at Brewster's angle",
            Self::Polarisation => "R = (Rs + Rp)/2, Rs ≥ Rp, Rs = Rp at normal incidence",
        }
    }

    fn breach(self) -> &'static str {
        match self {
            Self::Range => "no part of the light",
            Self::Balance => "light is lost or made between reflection and transmission",
            Self::Symmetry => "one of the sides takes the wrong index or angle",
            Self::TotalReflection => "light is refracted that cannot be",
            Self::Grazing => "the approach to 1 is cut, as where 1 − F₀ counts twice",
            Self::Normal => "this is not the index that is claimed",
            Self::Brewster => {
                "parallel light is not extinguished, as where Rp is a copy of Rs; \
                 an approximation leaves eta unclaimed"
            }
            Self::Polarisation => "the polarised parts do not make the whole",
        }
    }
}

impl Check for Fresnel {
    fn id(&self) -> &'static str {
        "fresnel"
    }

    fn hypothesis(&self) -> &'static str {
        "0 ≤ R ≤ 1, R + T = 1, both sides alike along a refracted ray, total and grazing reflection, \
         known values at normal incidence and Brewster's angle"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::FresnelLaws]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Fresnel]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(laws) = &evidence.fresnel else { return Judgement::Missing };
        let claims = &evidence.description.claims;
        let broken: Vec<_> = laws.tallies.iter().filter(|(_, t)| t.is_broken()).collect();
        if let Some((law, tally)) = broken.first() {
            let outcome = Outcome::of_tally(tally, law.identity(claims), law.breach());
            let others: Vec<_> = broken[1..].iter().map(|(l, _)| l.identity(claims)).collect();
            let message = match &others[..] {
                [] => outcome.message,
                others => format!("{}; also broken: {}", outcome.message, others.join("; ")),
            };
            return Outcome { message, ..outcome }.into();
        }
        let checked = laws.tallies.values().map(|t| t.checked).sum::<u64>();
        let largest = laws.tallies.values().map(|t| t.worst.0).fold(0.0, f64::max);
        let tolerance = laws.tallies.values().map(|t| t.tolerance).fold(0.0, f64::max);
        let held: Vec<_> = laws.tallies.keys().map(|l| l.identity(claims)).collect();
        let message = format!("{checked} values keep {}", held.join("; "));
        Outcome {
            effect: Some(Effect::exact("largest relative error", largest, tolerance)),
            detection_limit: laws.tallies.values().map(|t| t.share_limit()).reduce(f64::min),
            ..Outcome::new(Verdict::Pass, message)
        }
        .into()
    }
}
