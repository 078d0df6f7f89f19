//! Turning the surface changes nothing.

use super::outcome::{Check, Judgement, Outcome, Terms, needs_determinism};
use crate::bsdf::Description;
use crate::evidence::{Evidence, Measurement};

/// Rotating wo and wi together about the normal changes neither eval nor pdf.
pub struct Isotropy;

impl Check for Isotropy {
    fn id(&self) -> &'static str {
        "isotropy"
    }

    fn hypothesis(&self) -> &'static str {
        "claimed isotropic: rotating wo and wi together changes nothing"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Rotations]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        if !description.claims.isotropic {
            return Err("isotropic is not claimed".into());
        }
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(tally) = &evidence.rotations else { return Judgement::Missing };
        let breach = "the azimuth matters although isotropic is claimed";
        Outcome::of_tally(tally, "equality under rotation about the normal", breach).into()
    }
}
