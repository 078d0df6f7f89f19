//! A wrong dot product, or exchanged arguments.

use super::altered::{Altered, R, half};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction};
use crate::models::Sheen;
use crate::models::microfacet::{RoughDielectric, TorranceSparrow, half_vector};

/// What must see that a pdf is another one by a factor that depends on wi.
const ALL: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"];

pub(super) fn mutants() -> Vec<Mutant> {
    let mut all = of_pdf();
    all.extend(of_value());
    all
}

fn of_pdf() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "pdf-wo-n-for-wo-h",
            "torrance-sparrow:sampling=normals,alpha=0.4",
            "pdf() has 1/(4 wo·n) where 1/(4 wo·h) must be",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|_, wo, wi| wo.dot(half(wo, wi)) / wo.z)
                    .made()
            },
        )
        .source("wo·n for wo·h")
        .varied(&[("alpha", 0.2, 0.8)])
        .must_fail(ALL)
        // At 89° pdf is up to 57 times too large, and where it is there are no samples.
        .may_fail(&["support"]),
        Mutant::new(
            "pdf-arguments-exchanged",
            "torrance-sparrow:alpha=0.5",
            "pdf(wo, wi) is pdf(wi, wo)",
            |p, _| Altered::of(TorranceSparrow::declared(p)?).pdf(|m, wo, wi| m.pdf(wi, wo, R)).made(),
        )
        .source("three-gpu-pathtracer#215, ompf2 t=2132")
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "pdf-g1-of-wi",
            "torrance-sparrow:distribution=beckmann,alpha=0.5",
            "pdf() has G1(wi) where G1(wo) must be",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|m, wo, wi| m.distribution.g1(wi) / m.distribution.g1(wo))
                    .made()
            },
        )
        .source("exchanged arguments")
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "pdf-anisotropic-g1-mixed",
            "torrance-sparrow:distribution=beckmann,alpha=0.6,alpha_y=0.2",
            "in pdf() G1(wo) takes the cosine of wi with the tangents of wo",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|m, wo, wi| {
                        let mixed = Direction::new(wo.x, wo.y, wi.z);
                        m.distribution.g1(mixed) / m.distribution.g1(wo)
                    })
                    .made()
            },
        )
        .source("Cycles anisotropic Beckmann, cycles@936cf7634")
        .varied(&[("alpha", 0.4, 0.9), ("alpha_y", 0.1, 0.4)])
        .must_fail(ALL),
        Mutant::new(
            "pdf-of-stretched-wo",
            "torrance-sparrow:alpha=0.3",
            "pdf() is that of normals visible from wo stretched by α",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(|m, wo, wi| {
                        let stretched = m.distribution.alpha().scale(wo).normalized();
                        half_vector::of_reflection(wo, wi).map_or(0.0, |(h, cos)| {
                            m.distribution.visible_density(stretched, h) / (4.0 * cos)
                        })
                    })
                    .made()
            },
        )
        .source("OSPRay GGX sampleVisible, ospray@a19d1d1d4")
        .varied(&[("alpha", 0.05, 0.6)])
        .must_fail(ALL),
        Mutant::new(
            "refraction-wo-h-for-wi-h",
            "rough-dielectric:alpha=0.2",
            "in pdf() the Jacobian of refraction has |wo·h| where |wi·h| must be",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf_times(|m, wo, wi| {
                        let (o, i) = (m.upright(wo, wo), m.upright(wo, wi));
                        half_vector::of_refraction(o, i, m.relative_eta(wo))
                            .map_or(1.0, |r| r.cos_o / r.cos_i)
                    })
                    .made()
            },
        )
        .source("GLSL-PathTracer@577cff2")
        .varied(&[("alpha", 0.1, 0.6), ("eta", 1.3, 2.0)])
        // Too small from outside, where the cosine within is the larger.
        .must_fail(ALL),
    ]
}

fn of_value() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "value-over-wi-n",
            "torrance-sparrow:alpha=0.5",
            "eval() is divided by 4 (wi·n)² where 4 wo·n wi·n must be",
            |p, _| Altered::of(TorranceSparrow::declared(p)?).eval_times(|_, wo, wi| wo.z / wi.z).made(),
        )
        .source("OSL closures, OpenShadingLanguage@4626bbf6")
        .varied(&[("alpha", 0.1, 1.0)])
        .must_fail(&["reciprocity"])
        // Brighter where wi is the lower.
        .may_fail(&["energy"]),
        // Not reciprocal and not claimed to be: nothing but another model says otherwise.
        Mutant::new(
            "sheen-arguments-exchanged",
            "sheen:terminator=softened",
            "eval(wo, wi) is eval(wi, wo), whose terminator is at wo",
            |p, _| {
                Altered::of(Sheen::declared(p)?).eval(|m, wo, wi, transport| m.eval(wi, wo, transport)).made()
            },
        )
        .source("OSL Westin sheen, OpenShadingLanguage@37c5cb6a")
        .varied(&[("roughness", 0.2, 0.8)])
        .must_fail(&["reference"])
        .compared(),
    ]
}
