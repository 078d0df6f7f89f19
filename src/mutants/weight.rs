//! The weight, or the pdf that comes with a sample.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use super::siblings::lobes_of;
use crate::bsdf::{Bsdf, Direction, Lobe, Sample};
use crate::models::microfacet::{RoughDielectric, TorranceSparrow};
use crate::models::{OrenNayarEon, Phong};
use crate::registry::Parameters;

/// What a wrong weight breaks and nothing else does: eval and pdf are right.
const WEIGHT: &[&str] = &["weight", "albedo", "mis"];

/// Torrance and Sparrow's model whose weight is the correct one times this.
fn weighted(
    p: &Parameters,
    factor: impl Fn(&TorranceSparrow, Direction, Direction) -> f64 + Send + Sync + 'static,
) -> Result<Altered<TorranceSparrow>, String> {
    Ok(Altered::of(TorranceSparrow::declared(p)?)
        .finish(move |m, wo, _, s| Some(Sample { weight: s.weight * factor(m, wo, s.wi), ..s })))
}

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "weight-without-cosine",
            "torrance-sparrow:alpha=0.5",
            "the weight is f/pdf, without |cos θi|",
            |p, _| weighted(p, |_, _, wi| 1.0 / wi.z)?.made(),
        )
        .source("student solutions")
        .varied(&[("alpha", 0.1, 0.8)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-with-cosine-twice",
            "oren-nayar-eon:reflectance=1",
            "the weight has |cos θi| twice",
            |p, _| {
                Altered::of(OrenNayarEon::declared(p)?)
                    .finish(|_, _, _, s| Some(Sample { weight: s.weight * s.wi.z, ..s }))
                    .made()
            },
        )
        .source("kajiya")
        .varied(&[("roughness", 0.0, 1.0), ("reflectance", 0.2, 1.0)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-g2",
            "torrance-sparrow:alpha=0.5",
            "the weight of visible normals is F G2 in place of F G2/G1",
            |p, _| weighted(p, |m, wo, _| m.distribution.g1(wo))?.made(),
        )
        .source("shaders on Shadertoy")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-with-wrong-cosine",
            "torrance-sparrow:alpha=0.5,sampling=normals",
            "the weight G2 wo·m/(cos θo cos θm) has cos θi for cos θo",
            |p, _| weighted(p, |_, wo, wi| wo.z / wi.z)?.made(),
        )
        .source("Selas")
        .varied(&[("alpha", 0.1, 0.8)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-of-one-lobe",
            "phong",
            "the weight has f of the chosen lobe only, over the pdf of both",
            |p, _| {
                let weights = [p.number("kd"), p.number("ks")];
                let m = Phong::declared(p)?;
                let lobes = lobes_of(&m);
                Altered::of(m)
                    .finish(move |_, wo, _, s| {
                        let k = usize::from(s.lobe == Lobe::GLOSSY_REFLECTION);
                        let value = lobes[k].eval(wo, s.wi, R) * weights[k];
                        Some(Sample { weight: value * (s.wi.z / s.pdf), ..s })
                    })
                    .made()
            },
        )
        .source("a student solution")
        .varied(&[("kd", 0.2, 0.5), ("ks", 0.2, 0.5), ("exponent", 5.0, 60.0)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-without-share",
            "phong",
            "the weight is not divided by the probability of the chosen lobe",
            |p, _| {
                Altered::of(Phong::declared(p)?)
                    .finish(|m, _, _, s| {
                        let share = m.shares[usize::from(s.lobe == Lobe::GLOSSY_REFLECTION)];
                        Some(Sample { weight: s.weight * share, ..s })
                    })
                    .made()
            },
        )
        .source("Mitsuba 0.x composite")
        .varied(&[("kd", 0.2, 0.5), ("ks", 0.2, 0.5), ("exponent", 5.0, 100.0)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-clamped",
            "torrance-sparrow:alpha=0.5,sampling=normals",
            "weights above 1 are cut off against fireflies",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .finish(|_, _, _, s| Some(Sample { weight: s.weight.map(|w| w.min(1.0)), ..s }))
                    .made()
            },
        )
        .source("our own: a clamp that was meant for noise")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.3, 0.6)])
        .must_fail(WEIGHT),
        Mutant::new(
            "weight-scaled",
            "torrance-sparrow:alpha=0.3",
            "the weight is too large by the factor 1 + ε",
            |p, e| weighted(p, move |_, _, _| 1.0 + e)?.made(),
        )
        .source("our own: a constant in the weight alone")
        .strength(0.05, 1.0, "the weight is 1 + epsilon times too large")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(WEIGHT),
        Mutant::new(
            "returned-pdf-scaled",
            "oren-nayar-eon",
            "the pdf that comes with a sample is 1 + ε times pdf()",
            |p, e| {
                Altered::of(OrenNayarEon::declared(p)?)
                    .finish(move |_, _, _, s| Some(Sample { pdf: s.pdf * (1.0 + e), ..s }))
                    .made()
            },
        )
        .source("our own: sample.pdf ≠ pdf()")
        .strength(0.05, 1.0, "the pdf that comes with a sample is 1 + epsilon times too large")
        .varied(&[("roughness", 0.0, 1.0), ("reflectance", 0.2, 1.0)])
        .must_fail(&["returned-pdf"])
        // At most a quarter of ε, where the sampler and the cosine are equally dense.
        .may_fail(&["mis"]),
        Mutant::new(
            "pdf-shadowed",
            "rough-dielectric",
            "pdf() of transmission fills a variable of an inner scope, and returns 0",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf(|m, wo, wi| if wo.same_side(wi) { m.pdf(wo, wi, R) } else { 0.0 })
                    .sample(|m, wo, u, transport| m.sample(wo, u, transport))
                    .made()
            },
        )
        .source("LuisaRender")
        .varied(&[("alpha", 0.2, 0.6), ("eta", 1.4, 2.0)])
        .must_fail(&["goodness-of-fit", "normalization", "support", "mis", "jacobian"])
        // Where pdf is 0 they leave the word to support.
        .may_fail(&["weight", "returned-pdf"]),
    ]
}
