//! A constant factor in pdf or in f.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use crate::bsdf::Bsdf;
use crate::cause::Cause;
use crate::models::microfacet::{GgxMultiscatter, TorranceSparrow};
use crate::models::{Lambert, Phong};
use std::f64::consts::PI;

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "pdf-scaled",
            "torrance-sparrow:alpha=0.1",
            "pdf() is too large by the factor 1 + ε",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(move |m, wo, wi| m.pdf(wo, wi, R) * (1.0 + e))
                    .made()
            },
        )
        .source("any constant")
        .strength(0.02, 1.0, "pdf is 1 + epsilon times too large")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "jacobian"])
        // The smallest strengths are below what it sees.
        .may_fail(&["mis"]),
        Mutant::new("lambert-pdf-without-pi", "lambert", "pdf() lacks 1/π", |p, _| {
            Altered::of(Lambert::declared(p)?).pdf_times(|_, _, _| PI).made()
        })
        .source("cosine hemisphere with a wrong constant, student code")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
        // (n + 2)/(n + 1) of the lobe, constant where there is nothing else.
        Mutant::new(
            "phong-pdf-normalised-as-f",
            "phong:kd=0,ks=0.9,exponent=8",
            "the lobe's pdf is normalised by (n + 2)/2π, as f, and not by (n + 1)/2π",
            |p, _| {
                Altered::of(Phong::declared(p)?)
                    .pdf(|m, wo, wi| {
                        let pdf = m.pdf(wo, wi, R);
                        if pdf == 0.0 {
                            0.0
                        } else {
                            pdf + (pdf - m.shares[0] * wi.z / PI) / (m.exponent + 1.0)
                        }
                    })
                    .made()
            },
        )
        .source("any constant")
        .varied(&[("exponent", 1.0, 30.0)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
        // jacobian bounds the pdf of overlapping lobes from below, and this is more.
        Mutant::new(
            "multiscatter-pdf-without-pi",
            "ggx-multiscatter:alpha=0.7",
            "in pdf() the diffuse lobe lacks 1/π and the other one its share",
            |p, _| {
                Altered::of(GgxMultiscatter::declared(p)?)
                    .pdf(|m, wo, wi| {
                        let single = m.single.pdf(wo, wi, R);
                        let diffuse = || m.share(wo) * PI * m.multiple_density(wi);
                        if wo.z > 0.0 && wi.z > 0.0 { single + diffuse() } else { 0.0 }
                    })
                    .made()
            },
        )
        .source("Cycles MultiGGX, cycles@0c2fd7c36")
        .varied(&[("alpha", 0.4, 1.0)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis"]),
        Mutant::new(
            "value-scaled",
            "ggx-multiscatter:alpha=0.5",
            "eval() is too bright by the factor 1 + ε",
            |p, e| Altered::of(GgxMultiscatter::declared(p)?).eval_times(move |_, _, _| 1.0 + e).made(),
        )
        .equivalent(&[(
            Cause::Normalization,
            "f times a constant is the same whichever function it was meant for",
        )])
        .source("raysect/source#349: f of a library off by a constant")
        .strength(0.02, 1.0, "f is 1 + epsilon times too large")
        .varied(&[("alpha", 0.05, 1.0)])
        .must_fail(&["energy", "white-furnace"]),
    ]
}
