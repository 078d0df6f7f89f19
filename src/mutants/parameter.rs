//! Parameters without effect, units, slips of the language.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Interface, Lobe, Sample};
use crate::models::microfacet::{Fresnel, TorranceSparrow};
use crate::models::{Conductor, ConductorFresnel, Dielectric, OrenNayar};
use crate::registry::Parameters;
use std::sync::Arc;

pub(super) fn mutants() -> Vec<Mutant> {
    [values(), slips()].concat()
}

/// The parameters with another number for this one.
pub(super) fn with(p: &Parameters, name: &str, number: f64) -> Parameters {
    let mut other = p.clone();
    other.0.insert(name.into(), number.into());
    other
}

/// Parameters that are not what is meant.
fn values() -> Vec<Mutant> {
    vec![
        Mutant::new("alpha-ignored", "torrance-sparrow", "alpha is 0.2 whatever is given", |p, _| {
            Ok(Arc::new(TorranceSparrow::declared(&with(p, "alpha", 0.2))?))
        })
        .source("LuisaRender 5100e275: a default in place of the value")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["sensitivity"]),
        Mutant::new(
            "slot-of-another",
            "torrance-sparrow:alpha=0.2,alpha_y=0.5",
            "alpha_y is read from the slot of alpha",
            |p, _| Ok(Arc::new(TorranceSparrow::declared(&with(p, "alpha_y", p.number("alpha")))?)),
        )
        .source("a parameter read from another's slot")
        .varied(&[("alpha", 0.05, 0.8), ("alpha_y", 0.05, 0.8)])
        .must_fail(&["sensitivity"]),
        Mutant::new(
            "eta-ignored",
            "fresnel:kind=dielectric,eta=2",
            "the index is 1.5 whatever is given",
            |p, _| Ok(Arc::new(Interface(Fresnel::declared(&with(p, "eta", 1.5))?))),
        )
        .source("a parameter without effect")
        .varied(&[("eta", 1.7, 3.0)])
        .must_fail(&["sensitivity"]),
        Mutant::new(
            "degrees-twice",
            "oren-nayar:sigma=40",
            "the angle is converted to radians twice, in all functions alike",
            |p, _| {
                let sigma = p.number("sigma").to_radians().to_radians();
                Ok(Arc::new(OrenNayar::new(p.number("reflectance"), sigma)))
            },
        )
        .source("pbrt-v3 9c70767")
        .varied(&[("sigma", 10.0, 80.0)])
        .must_fail(&["reference"])
        .compared(),
    ]
}

/// Conditions and labels that say something else than was meant.
fn slips() -> Vec<Mutant> {
    vec![
        // Of a mirror nothing is left, which looks like no implementation at all.
        Mutant::new(
            "early-out-of-mirror",
            "conductor:fresnel=schlick",
            "sample() ends where it should begin",
            |p, _| {
                Altered::of(Conductor { fresnel: ConductorFresnel::Schlick(p.number("f0")) })
                    .finish(|_, _, _, _| None)
                    .made()
            },
        )
        .source("Mitsuba 3 conductor 51e3bb2a2: an inverted condition")
        .must_fail(&["sanity"]),
        // A lobe that is never drawn is not narrow either as alpha goes to 0.
        Mutant::new(
            "early-out-of-lobe",
            "torrance-sparrow",
            "sample() ends where it should begin",
            |p, _| Altered::of(TorranceSparrow::declared(p)?).finish(|_, _, _, _| None).made(),
        )
        .source("Mitsuba 3 conductor 51e3bb2a2, of a rough one")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "support", "albedo", "mis", "sensitivity"]),
        // Total reflection, at 105°, is right.
        Mutant::new(
            "always-reflects",
            "dielectric",
            "`u < (chosen ? F : 1/2)` is always true: nothing is refracted",
            |p, _| {
                Altered::of(Dielectric { eta: p.number("eta") })
                    .finish(|m, wo, _, _| m.sample(wo, &[0.0], R))
                    .made()
            },
        )
        .source("Mitsuba 0.x dielectric 7ab003c3: operator precedence")
        .varied(&[("eta", 1.1, 2.5)])
        .must_fail(&["discrete-lobes", "white-furnace", "albedo"]),
        Mutant::new("labels-exchanged", "dielectric", "reflection is labelled transmission", |p, _| {
            Altered::of(Dielectric { eta: p.number("eta") })
                .finish(|_, _, _, s| Some(Sample { lobe: exchanged(s.lobe), ..s }))
                .made()
        })
        .source("Cycles d0fc26e1c")
        .varied(&[("eta", 1.1, 2.5)])
        .must_fail(&["discrete-lobes"]),
        // Cosine sampling alone finds the light, so that the combination is right.
    ]
}

fn exchanged(lobe: Lobe) -> Lobe {
    Lobe(lobe.0 ^ (Lobe::REFLECTION.0 | Lobe::TRANSMISSION.0))
}
