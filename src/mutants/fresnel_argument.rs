//! The angle and the equations of the Fresnel term.

use super::altered::{Altered, half};
use super::altered_parts::AlteredFresnel;
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, FresnelFunction, Lobe, Sample, Spectrum};
use crate::cause::Cause;
use crate::models::microfacet::{Fresnel, RoughPlastic, TorranceSparrow};
use crate::models::{Dielectric, Plastic, fresnel};

pub(super) fn mutants() -> Vec<Mutant> {
    let mut all = of_surfaces();
    all.extend(of_functions());
    all
}

/// Wrong in a BSDF. Where F chooses no lobe, sampling knows nothing of it.
fn of_surfaces() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "fresnel-at-wo",
            "torrance-sparrow:alpha=0.3,fresnel=dielectric",
            "F is taken at n·wo in place of wo·h",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval_times(move |m, wo, wi| {
                        let cos = wo.dot(half(wo, wi));
                        m.reflected(cos + e * (wo.z - cos), 1.0)[0] / m.reflected(cos, 1.0)[0]
                    })
                    .made()
            },
        )
        .source("the macroscopic normal's angle")
        .strength(1.0, 1.0, "share of n·wo in the cosine")
        .varied(&[("alpha", 0.1, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "fresnel-at-wi",
            "torrance-sparrow:alpha=0.5,distribution=beckmann,fresnel=schlick",
            "F is taken at n·wi in place of wi·h",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval_times(|m, wo, wi| {
                        m.reflected(wi.z, 1.0)[0] / m.reflected(wo.dot(half(wo, wi)), 1.0)[0]
                    })
                    .made()
            },
        )
        .source("CS184 handout and students")
        .varied(&[("alpha", 0.1, 0.8), ("f0", 0.01, 0.5)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "transmittance-squared",
            "plastic:reflectance=1",
            "1 − F counts twice on both ways through the coat",
            |p, e| {
                let eta = p.number("eta");
                Altered::of(Plastic::declared(p)?)
                    .eval_times(move |_, wo, wi| {
                        let passing = |cos| 1.0 - fresnel::dielectric(cos, eta);
                        (passing(wo.z) * passing(wi.z)).powf(e)
                    })
                    .made()
            },
        )
        .equivalent(&[(
            Cause::Normalization,
            "the coat attenuates twice, by a squared F or by a second factor",
        )])
        .source("glTF#2022")
        .strength(1.0, 2.0, "exponent of 1 − F beyond the right one")
        .varied(&[("eta", 1.2, 2.5)])
        .must_fail(&["white-furnace"]),
        Mutant::new(
            "coat-passes-all-on-the-way-out",
            "rough-plastic:reflectance=1",
            "the base is lit through the coat, and seen without it",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .eval(|m, wo, wi, t| {
                        let (all, coat) = (m.eval(wo, wi, t)[0], m.coat.eval(wo, wi, t)[0]);
                        Spectrum::from(if all > 0.0 { coat + (all - coat) / m.lobes(wo.z).1 } else { 0.0 })
                    })
                    .made()
            },
        )
        .source("MaterialX@67d2e2836: transmittance of a layer")
        .varied(&[("alpha", 0.05, 0.8), ("eta", 1.3, 2.5)])
        .must_fail(&["reciprocity", "energy", "white-furnace"]),
        Mutant::new(
            "rp-copied-from-rs-in-glass",
            "dielectric",
            "Rp of what is reflected is a copy of Rs; what is transmitted is right",
            |p, _| {
                Altered::of(Dielectric::declared(p)?)
                    .finish(|m, wo, _, s| {
                        let [rs, rp] = fresnel::dielectric_polarised(wo.z.abs(), m.relative_eta(wo));
                        let copied = s.lobe.contains(Lobe::REFLECTION);
                        let factor = if copied { rs / (0.5 * (rs + rp)) } else { 1.0 };
                        Some(Sample { weight: s.weight * factor, ..s })
                    })
                    .made()
            },
        )
        .source("student CS184")
        .varied(&[("eta", 1.2, 2.5)])
        .shows_at(&[60.0])
        .must_fail(&["energy", "white-furnace"]),
    ]
}

/// Wrong in a Fresnel function by itself.
fn of_functions() -> Vec<Mutant> {
    vec![
        Mutant::new("rp-copied-from-rs", "fresnel", "Rp is a copy of Rs", |p, _| {
            AlteredFresnel::of(Fresnel::declared(p)?)
                .reflectance(|f, cos| f.polarised(cos).map_or_else(|| f.reflectance(cos), |[s, _]| s))
                .made()
        })
        .source("student CS184")
        .varied(&[("eta", 1.1, 3.0)])
        .must_fail(&["fresnel"]),
        Mutant::new(
            "fresnel-of-squared-cosine",
            "fresnel",
            "reflectance() takes cos² θ for cos θ",
            |p, _| {
                AlteredFresnel::of(Fresnel::declared(p)?)
                    .reflectance(|f, cos| f.reflectance(cos * cos.abs()))
                    .made()
            },
        )
        .source("a wrong cosine")
        .varied(&[("eta", 1.1, 3.0)])
        .must_fail(&["fresnel"]),
        Mutant::new("polarisations-exchanged", "fresnel", "Rs is called Rp, and Rp Rs", |p, _| {
            AlteredFresnel::of(Fresnel::declared(p)?)
                .polarised(|f, cos| f.polarised(cos).map(|[s, p]| [p, s]))
                .made()
        })
        .source("s and p exchanged")
        .varied(&[("eta", 1.1, 3.0)])
        .must_fail(&["fresnel"]),
        Mutant::new(
            "schlick-of-negative-cosine",
            "fresnel:kind=schlick",
            "Schlick's formula is given −cos θ",
            |p, _| {
                AlteredFresnel::of(Fresnel::declared(p)?)
                    .reflectance(|f, cos| match f {
                        Fresnel::Schlick(f0) => Spectrum::from(fresnel::schlick(-cos.abs(), *f0)),
                        _ => f.reflectance(cos),
                    })
                    .made()
            },
        )
        .source("the sign of the cosine")
        .varied(&[("f0", 0.0, 0.9)])
        .must_fail(&["fresnel"]),
        Mutant::new(
            "schlick-fourth-power",
            "fresnel:kind=schlick",
            "Schlick's formula with the power 4 in place of 5",
            |p, _| {
                AlteredFresnel::of(Fresnel::declared(p)?)
                    .reflectance(|f, cos| match f {
                        Fresnel::Schlick(f0) => Spectrum::from(f0 + (1.0 - f0) * (1.0 - cos.abs()).powi(4)),
                        _ => f.reflectance(cos),
                    })
                    .made()
            },
        )
        .source("students: a wrong symbol")
        .varied(&[("f0", 0.0, 0.9)])
        // An approximation need not be this one.
        .compared()
        .must_fail(&["reference"]),
    ]
}
