//! Radiance taken for importance, and their scale (η_o/η_i)².

use super::altered::{Altered, R};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Sample, Spectrum, Transport, TransportModes};
use crate::models::microfacet::RoughDielectric;
use crate::models::{Dielectric, Plastic, fresnel};

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "importance-not-handled",
            "rough-dielectric:alpha=0.3",
            "importance is scaled as radiance",
            |p, _| Altered::of(RoughDielectric::declared(p)?).eval(|m, wo, wi, _| m.eval(wo, wi, R)).made(),
        )
        .source("Mitsuba 3@83855d84a pplastic")
        .varied(&[("alpha", 0.05, 0.8), ("eta", 1.2, 2.5)])
        // Flux is weighed by the scale that reciprocity finds.
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "radiance-not-handled",
            "dielectric",
            "radiance passes smooth glass unscaled, as importance does",
            |p, _| {
                Altered::of(Dielectric::declared(p)?)
                    .finish(|_, _, _, s| Some(Sample { weight: Spectrum::from(1.0), ..s }))
                    .made()
            },
        )
        .source("radiance without 1/η²")
        .varied(&[("eta", 1.1, 2.5)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "unscaled-radiance",
            "rough-dielectric:alpha=0.4",
            "radiance without 1/η², and no other mode is claimed",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .eval(|m, wo, wi, _| m.eval(wo, wi, Transport::Importance))
                    .described(|d| d.claims(|c| c.transport = TransportModes::Radiance))
                    .made()
            },
        )
        .source("pbrt-v3#108: a convention")
        .varied(&[("alpha", 0.05, 0.8), ("eta", 1.2, 2.5)])
        .must_warn(&["reciprocity"]),
        Mutant::new(
            "eta-squared-twice",
            "rough-dielectric:distribution=beckmann",
            "radiance is divided by η² twice",
            |p, e| {
                Altered::of(RoughDielectric::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let scaled = t == Transport::Radiance && !wo.same_side(wi);
                        let factor = if scaled { m.relative_eta(wo).powf(-2.0 * e) } else { 1.0 };
                        m.eval(wo, wi, t) * factor
                    })
                    .made()
            },
        )
        .source("the scale counted twice")
        .strength(1.0, 1.0, "exponent of 1/η² beyond the right one")
        .varied(&[("alpha", 0.05, 0.4), ("eta", 1.3, 2.5)])
        // From inside, light is made.
        .must_fail(&["reciprocity", "energy"]),
        Mutant::new(
            "eta-squared-inverted",
            "dielectric",
            "radiance is multiplied by η² where it must be divided",
            |p, _| {
                Altered::of(Dielectric::declared(p)?)
                    .finish(|_, _, _, s| Some(Sample { weight: s.weight.map(|w| 1.0 / w), ..s }))
                    .made()
            },
        )
        .source("ompf2 t=2111: η_o² or η_i²")
        .varied(&[("eta", 1.1, 2.5)])
        .must_fail(&["reciprocity", "energy", "white-furnace"]),
        Mutant::new(
            "coat-cosine-ratio",
            "plastic:reflectance=1",
            "eval() has a factor cos θi/cos θt: radiance is converted into the coat by flux",
            |p, _| {
                let eta = p.number("eta");
                Altered::of(Plastic::declared(p)?)
                    .eval_times(move |_, _, wi| {
                        wi.z / fresnel::refracted_cosine(wi.z, eta).expect("light enters the denser medium")
                    })
                    .made()
            },
        )
        .source("mitsuba@9b225443, tungsten@eec36db")
        .varied(&[("eta", 1.2, 2.5)])
        .must_fail(&["reciprocity", "white-furnace"]),
    ]
}
