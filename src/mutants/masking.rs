//! Masking and shadowing.

use super::altered::{Altered, g2, half};
use super::altered_parts::AlteredNormals;
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction};
use crate::models::microfacet::{GgxMultiscatter, MaskedDistribution, TorranceSparrow};

pub(super) fn mutants() -> Vec<Mutant> {
    let mut all = of_value();
    all.extend(of_normals());
    all
}

/// None of the one-sided ones gives back more than arrives: f cos θi over the density
/// of visible normals, whose mass is at most 1, is G1(wo) in the first, 1 in the next
/// two, and cos²θo G2/G1(wo) in the last.
fn of_value() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "masking-of-wo-twice",
            "torrance-sparrow:alpha=0.5",
            "eval() has G1(wo) G1(wo) where G2(wo, wi) must be",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval_times(|m, wo, wi| m.distribution.g1(wo).powi(2) / g2(&m.distribution, wo, wi))
                    .made()
            },
        )
        .source("pbrt-v3 Disney, pbrt-v3@a8c3616")
        .varied(&[("alpha", 0.1, 1.0)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "masking-of-wo-only",
            "torrance-sparrow:distribution=beckmann,alpha=0.5",
            "eval() has G1(wo) where G2(wo, wi) must be",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval_times(|m, wo, wi| m.distribution.g1(wo) / g2(&m.distribution, wo, wi))
                    .made()
            },
        )
        .source("nerfactor#18")
        .varied(&[("alpha", 0.1, 1.0)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "grooves-one-sided",
            "torrance-sparrow:masking=v-cavity,alpha=0.4",
            "eval() has 2 (n·h) (n·wo)/(wo·h) without the same of wi",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval_times(|_, wo, wi| {
                        let h = half(wo, wi);
                        let g1 = |w: Direction| (2.0 * h.z * w.z / wo.dot(h)).min(1.0);
                        g1(wo) / g1(wo).min(g1(wi))
                    })
                    .made()
            },
        )
        .source("one-sided")
        .varied(&[("alpha", 0.1, 1.0)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "value-times-cosine-squared",
            "torrance-sparrow:alpha=0.2",
            "eval() has G2/4·cos θo, without parentheses, where G2/(4 cos θo) must be",
            |p, _| Altered::of(TorranceSparrow::declared(p)?).eval_times(|_, wo, _| wo.z * wo.z).made(),
        )
        .source("LuxCore Glossy2, LuxCore@a2796ea23")
        .varied(&[("alpha", 0.05, 1.0)])
        .must_fail(&["reciprocity"]),
        Mutant::new(
            "masking-missing",
            "ggx-multiscatter:alpha=0.5",
            "in eval() the lobe of one bounce lacks G2 to the power ε",
            |p, e| {
                Altered::of(GgxMultiscatter::declared(p)?)
                    .eval(move |m, wo, wi, transport| {
                        let all = m.eval(wo, wi, transport);
                        let single = m.single.eval(wo, wi, transport).mean();
                        if single == 0.0 {
                            return all;
                        }
                        let excess = g2(&m.single.distribution, wo, wi).powf(-e) - 1.0;
                        all.map(|f| f + single * excess)
                    })
                    .made()
            },
        )
        .source("masking missing")
        .strength(1.0, 1.0, "f lacks G2 to this power")
        .varied(&[("alpha", 0.2, 1.0)])
        .must_fail(&["energy", "white-furnace"]),
    ]
}

fn of_normals() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "normals-g1-of-half-vector",
            "normals:alpha=0.4",
            "G1 has tan θm where tan θ must be",
            |p, _| AlteredNormals::declared(p)?.g1(|d, _, m| d.distribution.g1(m)).made(p),
        )
        .source("student Nori and CS184")
        .varied(&[("alpha", 0.1, 1.0)])
        .must_fail(&["distribution"]),
        Mutant::new(
            "normals-g1-of-sine",
            "normals:sampling=visible-normals,alpha=0.4",
            "Λ has sin θ where tan θ must be",
            |p, _| {
                AlteredNormals::declared(p)?
                    .g1(|d, w, _| 1.0 / (1.0 + lambda_of_sine(d, w)))
                    .lambda(lambda_of_sine)
                    .made(p)
            },
        )
        .source("student Nori")
        .varied(&[("alpha", 0.2, 1.0)])
        .must_fail(&[
            "distribution",
            "goodness-of-fit",
            "normalization",
            "albedo",
            "white-furnace",
            "jacobian",
        ]),
    ]
}

/// Smith's Λ as at the angle whose tangent is the sine of this one.
fn lambda_of_sine(d: &MaskedDistribution, w: Direction) -> f64 {
    d.distribution.lambda(Direction::new(w.x, w.y, 1.0).normalized())
}
