//! The Jacobian 1/(4 wo·h) of reflection about a half vector.

use super::altered::{Altered, R, half};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction};
use crate::models::Ward;
use crate::models::microfacet::{RoughPlastic, TorranceSparrow};

/// What must see that a pdf is another one by a factor that depends on wi.
const ALL: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"];

/// wo·h.
fn cosine(wo: Direction, wi: Direction) -> f64 {
    wo.dot(half(wo, wi))
}

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new("no-jacobian", "torrance-sparrow:alpha=0.5", "pdf() lacks 1/(4 wo·h)", |p, _| {
            Altered::of(TorranceSparrow::declared(p)?).pdf_times(|_, wo, wi| 4.0 * cosine(wo, wi)).made()
        })
        .source("student Nori microfacet")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "jacobian-without-cosine",
            "torrance-sparrow:distribution=beckmann,sampling=normals,alpha=0.4",
            "pdf() has 1/4 where 1/(4 wo·h) must be",
            |p, _| Altered::of(TorranceSparrow::declared(p)?).pdf_times(|_, wo, wi| cosine(wo, wi)).made(),
        )
        .source("of the wrong vector or in part")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "jacobian-twice",
            "ward:alpha=0.4,alpha_y=0.2",
            "pdf() is divided by 4 wo·h twice",
            |p, _| Altered::of(Ward::declared(p)?).pdf_times(|_, wo, wi| 0.25 / cosine(wo, wi)).made(),
        )
        .source("a reflection that divides the pdf of a distribution which has done so")
        .varied(&[("alpha", 0.1, 0.6)])
        .must_fail(ALL),
        Mutant::new(
            "jacobian-of-normal",
            "torrance-sparrow:sampling=normals,alpha=0.4",
            "pdf() has 1/(4 n·h) where 1/(4 wo·h) must be",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|_, wo, wi| cosine(wo, wi) / half(wo, wi).z)
                    .made()
            },
        )
        .source("of the wrong vector")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "coat-without-jacobian",
            "rough-plastic:alpha=0.3",
            "in pdf() the coat's lobe lacks 1/(4 wo·h)",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .pdf(|m, wo, wi| {
                        let coat = m.coat.pdf(wo, wi, R);
                        let missing = || m.lobes(wo.z).0.first * coat * (4.0 * cosine(wo, wi) - 1.0);
                        m.pdf(wo, wi, R) + if coat > 0.0 { missing() } else { 0.0 }
                    })
                    .made()
            },
        )
        .source("student Nori microfacet with two lobes")
        .varied(&[("alpha", 0.1, 0.6)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis"])
        // Lobes overlap: only a pdf below the coat's part is seen, where wo·h < 1/4.
        .may_fail(&["jacobian"]),
    ]
}
