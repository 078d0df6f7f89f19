//! The probability of choosing a lobe.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use super::siblings::{draws_of, lobes_of, plastic_by};
use crate::bsdf::{Bsdf, Lobe, Sample};
use crate::models::coated_base::Lobes;
use crate::models::microfacet::{Fresnel, Masking, RoughDielectric, RoughPlastic, TorranceSparrow};
use crate::models::{Phong, Plastic};
use std::f64::consts::PI;

/// The last number below 1.
const LAST: f64 = 1.0 - f64::EPSILON / 2.0;

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "lobe-share-off",
            "phong",
            "pdf() takes 1 + ε times the share of the diffuse lobe, and the rest for the other",
            |p, e| {
                let m = Phong::declared(p)?;
                let [diffuse, glossy] = lobes_of(&m);
                let share = (m.shares[0] * (1.0 + e)).min(1.0);
                Altered::of(m)
                    .pdf(move |_, wo, wi| {
                        share * diffuse.pdf(wo, wi, R) + (1.0 - share) * glossy.pdf(wo, wi, R)
                    })
                    .made()
            },
        )
        .source("three-gpu-pathtracer: shares from different arguments in sample() and eval()")
        .strength(0.1, 0.4, "the share of the first lobe is 1 + epsilon times too large in pdf")
        .varied(&[("kd", 0.25, 0.5), ("ks", 0.3, 0.5), ("exponent", 10.0, 100.0)])
        // At its peak the glossy lobe alone is more than pdf.
        .must_fail(&["goodness-of-fit", "jacobian"])
        // Shares follow the albedos, so that to first order one lobe has too much of
        // what the other has too little; and masses differ by what is below the horizon.
        .may_fail(&["albedo", "mis", "normalization"]),
        Mutant::new("shares-forgotten", "phong", "pdf() adds densities without their shares", |p, _| {
            let m = Phong::declared(p)?;
            let lobes = lobes_of(&m);
            Altered::of(m).pdf(move |_, wo, wi| lobes.iter().map(|l| l.pdf(wo, wi, R)).sum()).made()
        })
        .source("dspbr-pt")
        .varied(&[("kd", 0.2, 0.5), ("ks", 0.2, 0.5), ("exponent", 5.0, 100.0)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis"]),
        Mutant::new(
            "one-share-forgotten",
            "rough-plastic:alpha=0.3",
            "pdf() has the share of the coat and not that of the base",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .pdf(|m, wo, wi| {
                        let base = m.lobes(wo.z).0.second * wi.z / PI;
                        if wo.z > 0.0 && wi.z > 0.0 { m.pdf(wo, wi, R) - base + wi.z / PI } else { 0.0 }
                    })
                    .made()
            },
        )
        .source("our own: one share of two")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.1, 0.6), ("reflectance", 0.3, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis"]),
        Mutant::new(
            "shares-not-normalised",
            "rough-plastic:alpha=0.3",
            "pdf() takes the lobes' albedos for their shares, without dividing by the sum",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .pdf(|m, wo, wi| {
                        let (lobes, passing) = m.lobes(wo.z.max(0.0));
                        // The coat's share is its albedo over the sum.
                        m.pdf(wo, wi, R) * (1.0 - passing) / lobes.first
                    })
                    .made()
            },
        )
        .source("LuisaRender glass")
        .varied(&[("alpha", 0.1, 0.6), ("reflectance", 0.2, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
        Mutant::new(
            "chosen-lobe-only",
            "phong",
            "sample() returns pdf and weight of the chosen lobe in place of the mixture's",
            |p, _| {
                let weights = [p.number("kd"), p.number("ks")];
                let m = Phong::declared(p)?;
                let lobes = lobes_of(&m);
                Altered::of(m)
                    .finish(move |m, wo, _, s| {
                        let k = usize::from(s.lobe == Lobe::GLOSSY_REFLECTION);
                        let pdf = lobes[k].pdf(wo, s.wi, R);
                        let value = lobes[k].eval(wo, s.wi, R) * (weights[k] / m.shares[k]);
                        Some(Sample { weight: value * (s.wi.z / pdf), pdf, ..s })
                    })
                    .made()
            },
        )
        .source("Mitsuba 3 blendbsdf")
        .varied(&[("kd", 0.2, 0.5), ("ks", 0.2, 0.5), ("exponent", 5.0, 100.0)])
        // Right on average, so that albedo holds.
        .must_fail(&["weight", "returned-pdf", "mis"]),
        Mutant::new(
            "share-clamped-in-sample",
            "rough-plastic:alpha=0.05,reflectance=1",
            "sample() keeps the share of the coat within 0.1 and 0.9, pdf() does not",
            |p, _| {
                let clamped = |lobes: Lobes| {
                    let first = lobes.first.clamp(0.1, 0.9);
                    Lobes { first, second: 1.0 - first }
                };
                Altered::of(RoughPlastic::declared(p)?)
                    .draw(plastic_by(move |lobes, u| clamped(lobes).choose(u)))
                    .made()
            },
        )
        .source("Cycles")
        .shows_at(&[30.0])
        .varied(&[("alpha", 0.02, 0.08), ("eta", 1.3, 1.5)])
        .must_fail(&["goodness-of-fit", "jacobian"])
        // The mean weight of each lobe is 1, so that albedo holds whatever their shares.
        .may_fail(&["mis"]),
        Mutant::new(
            "lobe-never-drawn",
            "rough-dielectric",
            "transmission has probability 0, in sample() and in pdf()",
            |p, _| {
                let m = RoughDielectric::declared(p)?;
                let facets = m.distribution.clone();
                let mirror = TorranceSparrow::new(facets, Masking::Smith, Fresnel::None, m.sampling)?;
                let drawn = draws_of(mirror.clone());
                Altered::of(m)
                    .pdf(move |m, wo, wi| mirror.pdf(m.upright(wo, wo), m.upright(wo, wi), R))
                    .draw(move |m, wo, u| {
                        let (wi, lobe) = drawn(m, m.upright(wo, wo), u)?;
                        Some((m.upright(wo, wi), lobe))
                    })
                    .made()
            },
        )
        .source("dspbr-pt and others: lobes with f > 0 and a share of 0")
        .varied(&[("alpha", 0.1, 0.6), ("eta", 1.2, 2.0)])
        // The cosine finds what the sampler does not, so that mis holds.
        .must_fail(&["support", "albedo"]),
        Mutant::new(
            "glass-half-and-half",
            "rough-dielectric",
            "sample() reflects half of the time, pdf() with the probability F",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .draw(|m, wo, u| {
                        let s = m.sample(wo, &[u[0], u[1], if u[2] < 0.5 { 0.0 } else { LAST }], R)?;
                        Some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("pbrt-v3 Disney: R or T by another probability than pdf's")
        .varied(&[("alpha", 0.05, 0.6), ("eta", 1.2, 2.0)])
        .must_fail(&["goodness-of-fit", "albedo", "mis", "jacobian"])
        // Only by what falls off the support differently in reflection and transmission.
        .may_fail(&["normalization"]),
        Mutant::new(
            "share-beside-mirror",
            "plastic",
            "pdf() of the base lacks the probability of not drawing the mirror",
            |p, _| {
                Altered::of(Plastic::new(p.number("reflectance"), p.number("eta")))
                    .pdf(|_, wo, wi| if wo.z > 0.0 && wi.z > 0.0 { wi.z / PI } else { 0.0 })
                    .made()
            },
        )
        .source("Mitsuba 3 mask: the chance of another event is not in pdf")
        .varied(&[("eta", 1.3, 2.0), ("reflectance", 0.2, 0.9)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis"]),
    ]
}
