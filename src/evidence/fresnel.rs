//! The laws that a Fresnel function keeps at all angles.

use super::meter::{Halt, Meter};
use super::parts::{self, Reflection};
use super::setup::Setup;
use super::tally::{Tally, relative_error};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Angles of each side at which the laws are looked at.
const ANGLES: usize = 256;

/// Cosines start here: refraction of more grazing light magnifies rounding by
/// the inverse of the cosine.
const GRAZING: f64 = 1e-3;

/// A law of reflection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FresnelLaw {
    /// 0 ≤ R ≤ 1, and so T and both polarisations.
    Range,
    /// R + T = 1, or ≤ 1 where `lossless` is not claimed.
    Balance,
    /// R from outside at θi equals R from inside at θt.
    Symmetry,
    /// All is reflected beyond the critical angle.
    TotalReflection,
    /// All is reflected at grazing incidence.
    Grazing,
    /// ((η − 1)/(η + 1))² at normal incidence.
    Normal,
    /// At Brewster's angle ½((η² − 1)/(η² + 1))², all of it polarised
    /// perpendicularly.
    Brewster,
    /// R = (Rs + Rp)/2, with Rs ≥ Rp, equal at normal incidence.
    Polarisation,
}

/// The laws that could be looked at.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FresnelLaws {
    /// By law.
    pub tallies: BTreeMap<FresnelLaw, Tally>,
}

impl FresnelLaws {
    /// Looks at the laws that the claims admit.
    pub fn gather(meter: &Meter, setup: &Setup) -> Result<Self, Halt> {
        let mut found = Self::default();
        let sides: &[f64] = if setup.claims.transmissive { &[1.0, -1.0] } else { &[1.0] };
        let mut stream = setup.key.with("stage", "fresnel").block(0);
        for side in sides {
            // One at random in each step of the cosine, and the ends.
            let mut cosines: Vec<f64> = (0..ANGLES)
                .map(|k| GRAZING + (1.0 - GRAZING) * (k as f64 + stream.next_f64()) / ANGLES as f64)
                .collect();
            cosines.extend([1.0, GRAZING, 1e-7]);
            for cos in cosines {
                let at = side * cos;
                let here = parts::reflection(meter, at)?;
                found.look_at(setup, at, &here);
                found.look_across(meter, setup, at, &here)?;
            }
            if let Some(eta) = setup.claims.eta {
                let relative = if *side > 0.0 { eta } else { 1.0 / eta };
                found.known_values(meter, setup, *side, relative)?;
            }
        }
        // Without a contrast nothing is reflected at any angle.
        if setup.claims.eta != Some(1.0) {
            let here = parts::reflection(meter, 0.0)?;
            found.look_at(setup, 0.0, &here);
            for r in here.reflectance.iter() {
                found.equal(FresnelLaw::Grazing, setup, 0.0, *r, 1.0);
            }
        }
        Ok(found)
    }

    fn tally(&mut self, law: FresnelLaw, tolerance: f64) -> &mut Tally {
        self.tallies.entry(law).or_insert_with(|| Tally::new(tolerance))
    }

    fn equal(&mut self, law: FresnelLaw, setup: &Setup, cos: f64, found: f64, right: f64) {
        let error = relative_error(found, right, setup.floor());
        self.tally(law, setup.tolerance())
            .look(error, || parts::at(setup, cos).value("found", found).value("right", right));
    }

    /// What holds at each angle by itself.
    fn look_at(&mut self, setup: &Setup, cos: f64, here: &Reflection) {
        let place = |name, v| parts::at(setup, cos).value(name, v);
        let tolerance = setup.tolerance();
        let mut in_range = |name, v: f64| {
            let outside = if v.is_nan() { v } else { (v - 1.0).max(-v).max(0.0) };
            self.tally(FresnelLaw::Range, tolerance).look(outside, || place(name, v));
        };
        for r in here.reflectance.iter() {
            in_range("R", *r);
        }
        for t in here.transmittance.iter().flat_map(|t| t.iter()) {
            in_range("T", *t);
        }
        for p in here.polarised.iter().flatten().flat_map(|p| p.iter()) {
            in_range("polarised R", *p);
        }
        if let Some(t) = &here.transmittance {
            for (r, t) in here.reflectance.iter().zip(t.iter()) {
                let excess = r + t - 1.0;
                let error = match (setup.claims.lossless, setup.claims.energy_conserving) {
                    (true, _) => excess.abs(),
                    (false, true) => excess.max(0.0),
                    (false, false) => continue,
                };
                let error = if excess.is_nan() { excess } else { error };
                self.tally(FresnelLaw::Balance, tolerance).look(error, || place("R", *r).value("T", *t));
            }
        }
        let Some([s, p]) = &here.polarised else { return };
        for ((r, s), p) in here.reflectance.iter().zip(s.iter()).zip(p.iter()) {
            let mean = relative_error(0.5 * (s + p), *r, setup.floor());
            let order = (p - s).max(0.0);
            let apart = if cos.abs() == 1.0 { relative_error(*s, *p, setup.floor()) } else { 0.0 };
            // A sum, so that NaN stays.
            self.tally(FresnelLaw::Polarisation, tolerance)
                .look(mean + order + apart, || place("R", *r).value("Rs", *s).value("Rp", *p));
        }
    }

    /// What binds both sides by the index.
    fn look_across(&mut self, meter: &Meter, setup: &Setup, cos: f64, here: &Reflection) -> Result<(), Halt> {
        let Some(eta) = setup.claims.eta else { return Ok(()) };
        let relative = if cos > 0.0 { eta } else { 1.0 / eta };
        // η² cos²θt, without forming 1 − cos².
        let beyond = (relative - 1.0) * (relative + 1.0) + cos * cos;
        if beyond < -setup.tolerance() * relative * relative {
            for r in here.reflectance.iter() {
                self.equal(FresnelLaw::TotalReflection, setup, cos, *r, 1.0);
            }
        }
        let cos_t = beyond.max(0.0).sqrt() / relative;
        // Next to the critical angle rounding of either cosine decides.
        if setup.claims.transmissive && setup.claims.reciprocal && cos.abs() >= GRAZING && cos_t >= GRAZING {
            let there = parts::reflection(meter, -cos_t.min(1.0).copysign(cos))?;
            for (a, b) in here.reflectance.iter().zip(there.reflectance.iter()) {
                self.equal(FresnelLaw::Symmetry, setup, cos, *a, *b);
            }
        }
        Ok(())
    }

    /// Values that the index `relative` of the far side over the near one gives.
    fn known_values(&mut self, meter: &Meter, setup: &Setup, side: f64, relative: f64) -> Result<(), Halt> {
        let normal = ((relative - 1.0) / (relative + 1.0)).powi(2);
        for r in parts::reflection(meter, side)?.reflectance.iter() {
            self.equal(FresnelLaw::Normal, setup, side, *r, normal);
        }
        let squared = relative * relative;
        let cos = side / (1.0 + squared).sqrt();
        let there = parts::reflection(meter, cos)?;
        let right = 0.5 * ((squared - 1.0) / (squared + 1.0)).powi(2);
        for r in there.reflectance.iter() {
            self.equal(FresnelLaw::Brewster, setup, cos, *r, right);
        }
        for p in there.polarised.iter().flat_map(|[_, p]| p.iter()) {
            self.equal(FresnelLaw::Brewster, setup, cos, *p, 0.0);
        }
        Ok(())
    }
}
