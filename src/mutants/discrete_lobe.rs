//! Discrete lobes and flags.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction, Lobe, Sample};
use crate::cause::Cause;
use crate::models::microfacet::TorranceSparrow;
use crate::models::{Conductor, Dielectric, Plastic, fresnel};
use std::f64::consts::PI;

pub(super) fn mutants() -> Vec<Mutant> {
    let mut all = of_flags();
    all.extend(of_lobes());
    all
}

/// Kinds of lobes confounded.
fn of_flags() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "rough-lobe-flagged-discrete",
            "torrance-sparrow:alpha=0.3",
            "samples of a rough surface are flagged discrete",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .finish(|_, _, _, s| Some(Sample { lobe: Lobe(s.lobe.0 | Lobe::DISCRETE.0), ..s }))
                    .made()
            },
        )
        .source("student Nori microfacet")
        .varied(&[("alpha", 0.1, 0.5)])
        // Nothing continuous is drawn where pdf has mass, and each direction is a lobe
        // of its own, with a density for its probability.
        .must_fail(&[
            "discrete-lobes",
            "goodness-of-fit",
            "normalization",
            "support",
            "albedo",
            "mis",
            "energy",
            "reciprocity",
        ]),
        Mutant::new(
            "mirror-flagged-glossy",
            "conductor",
            "samples of a smooth mirror are not flagged discrete",
            |p, _| {
                Altered::of(Conductor::declared(p)?)
                    .finish(|_, _, _, s| Some(Sample { lobe: Lobe::GLOSSY_REFLECTION, ..s }))
                    .made()
            },
        )
        .source("pbrt-v4@765ce358")
        .must_fail(&["discrete-lobes", "normalization", "support", "albedo", "mis"])
        // There is no cell with pdf to count in.
        .may_fail(&["goodness-of-fit"]),
        Mutant::new(
            "mirror-with-cosine-pdf",
            "conductor:metal=gold",
            "pdf() of a smooth mirror is cos θ/π",
            |p, _| {
                Altered::of(Conductor::declared(p)?)
                    .pdf(|_, wo, wi| if wo.z > 0.0 { wi.z.max(0.0) / PI } else { 0.0 })
                    .made()
            },
        )
        .source("rs_pbrt@153b0ea")
        // No light and no continuous sample come that could have a wrong weight.
        .must_fail(&["goodness-of-fit", "normalization", "support"]),
        Mutant::new(
            "base-pdf-not-scaled",
            "plastic:reflectance=0.3",
            "pdf() of the base is cos θ/π, though the coat's mirror is drawn too",
            |p, _| {
                Altered::of(Plastic::declared(p)?).pdf_times(|m, wo, wi| wi.z / PI / m.pdf(wo, wi, R)).made()
            },
        )
        .equivalent(&[(
            Cause::LobeProbability,
            "the density of the base lacks the probability of not drawing the mirror",
        )])
        .source("tungsten@66bda36: discrete and continuous lobes mixed")
        .varied(&[("reflectance", 0.05, 0.8), ("eta", 1.3, 2.5)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis"]),
        Mutant::new(
            "value-in-the-mirror-direction",
            "plastic",
            "eval() and pdf() contain the mirror in its very direction",
            |p, _| {
                let eta = p.number("eta");
                let mirror = move |wo: Direction, wi: Direction| {
                    let there = wo.z > 0.0 && (wi - wo.mirrored()).length() < 1e-9;
                    if there { fresnel::dielectric(wo.z, eta) } else { 0.0 }
                };
                Altered::of(Plastic::declared(p)?)
                    .eval(move |m, wo, wi, t| m.eval(wo, wi, t).map(|f| f + mirror(wo, wi)))
                    .pdf(move |m, wo, wi| m.pdf(wo, wi, R) + mirror(wo, wi))
                    .made()
            },
        )
        .source("tungsten@66bda36, GLSL-PathTracer#96")
        .varied(&[("reflectance", 0.05, 0.3), ("eta", 1.5, 2.5)])
        .shows_at(&[75.0])
        .must_fail(&["discrete-lobes"]),
        Mutant::new(
            "discrete-and-continuous-summed",
            "plastic",
            "a draw of the mirror goes on to add value and pdf of the base there",
            |p, _| {
                Altered::of(Plastic::declared(p)?)
                    .finish(|m, wo, _, s| {
                        if !s.lobe.is_discrete() {
                            return Some(s);
                        }
                        let pdf = s.pdf + m.pdf(wo, s.wi, R);
                        let value = s.weight[0] * s.pdf + m.eval(wo, s.wi, R)[0] * s.wi.z;
                        Some(Sample { pdf, weight: (value / pdf).into(), ..s })
                    })
                    .made()
            },
        )
        .source("LuxCore@0e3b8addd mix")
        .varied(&[("reflectance", 0.1, 0.9), ("eta", 1.3, 2.5)])
        .must_fail(&["discrete-lobes", "albedo", "mis"]),
    ]
}

/// Probability, weight or direction of a discrete lobe.
fn of_lobes() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "discrete-probability-off",
            "plastic",
            "the mirror is drawn with another probability than is told",
            |p, e| {
                Altered::of(Plastic::declared(p)?)
                    .finish(move |_, _, _, s| {
                        let factor = if s.lobe.is_discrete() { 1.0 + e } else { 1.0 };
                        Some(Sample { pdf: s.pdf * factor, ..s })
                    })
                    .made()
            },
        )
        .source("a density told for a probability")
        .strength(0.1, 0.5, "the told probability is 1 + epsilon times too large")
        .varied(&[("reflectance", 0.1, 0.9), ("eta", 1.3, 2.0)])
        .must_fail(&["discrete-lobes", "albedo", "mis"])
        // Near grazing the mirror has nearly all light, and more than that is told.
        .may_fail(&["energy"]),
        Mutant::new(
            "mirror-not-divided-by-probability",
            "plastic:reflectance=1",
            "the weight of the mirror is not divided by its probability",
            |p, _| {
                Altered::of(Plastic::declared(p)?)
                    .finish(|_, _, _, s| {
                        let factor = if s.lobe.is_discrete() { s.pdf } else { 1.0 };
                        Some(Sample { weight: s.weight * factor, ..s })
                    })
                    .made()
            },
        )
        .source("a discrete lobe's value for its weight")
        .varied(&[("eta", 1.2, 2.5)])
        // Whatever the weight, it is what the lobe gives: only flux is missing.
        .must_fail(&["white-furnace"]),
        Mutant::new(
            "mirror-never-drawn",
            "plastic:reflectance=1",
            "the mask of lobes leaves the mirror out",
            |p, _| {
                Altered::of(Plastic::declared(p)?)
                    .finish(|_, _, _, s| (!s.lobe.is_discrete()).then_some(s))
                    .made()
            },
        )
        .source("tungsten@66b1d7a")
        .varied(&[("eta", 1.2, 2.5)])
        .must_fail(&["white-furnace"]),
        Mutant::new(
            "mirror-turned",
            "conductor:metal=silver",
            "the mirror direction is turned about the normal",
            |p, e| {
                Altered::of(Conductor::declared(p)?)
                    .finish(move |_, _, _, s| Some(Sample { wi: s.wi.rotated(e), ..s }))
                    .made()
            },
        )
        .source("a mirror direction slightly off")
        .strength(1e-3, 0.1, "radians")
        .must_fail(&["discrete-lobes", "reciprocity"]),
        Mutant::new(
            "snell-by-tangents",
            "dielectric:eta=2",
            "light is refracted by the ratio of tangents and not of sines",
            |p, _| {
                Altered::of(Dielectric::declared(p)?)
                    .finish(|m, wo, _, s| {
                        let eta = m.relative_eta(wo);
                        let bent = Direction::new(-wo.x / eta, -wo.y / eta, -wo.z).normalized();
                        let wi = if s.lobe.contains(Lobe::REFLECTION) { s.wi } else { bent };
                        Some(Sample { wi, ..s })
                    })
                    .made()
            },
        )
        .source("a refracted direction by a wrong Snell's law")
        .varied(&[("eta", 1.1, 2.5)])
        .must_fail(&["discrete-lobes", "reciprocity"]),
    ]
}
