//! Random numbers used twice, or not stretched after a choice.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use super::siblings::{lobes_of, plastic_by};
use crate::bsdf::{Bsdf, Lobe};
use crate::cause::Cause;
use crate::models::lambert::sample_cosine;
use crate::models::microfacet::RoughPlastic;
use crate::models::{Lambert, Phong};
use crate::statistics::streams::StreamKey;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// The 24 bits of f32's mantissa, the rest cut off.
fn to_24_bits(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & !((1 << 29) - 1))
}

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "number-not-stretched",
            "rough-plastic:distribution=beckmann,alpha=0.1",
            "the number that chose a lobe is used again as it is",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .draw(plastic_by(|lobes, u| (u < lobes.first, u)))
                    .made()
            },
        )
        .source("4 student solutions")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.05, 0.15), ("reflectance", 0.3, 0.7)])
        // Where the base has no sample, the coat has none either: a hole in the support.
        .must_fail(&["goodness-of-fit", "support", "jacobian"])
        // Weights hardly vary within a lobe, and masses change by what falls below the
        // horizon.
        .may_fail(&["normalization", "albedo", "mis"]),
        Mutant::new(
            "stretches-swapped",
            "rough-plastic",
            "each lobe's number is stretched by the formula of the other one",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .draw(plastic_by(|lobes, u| match u < lobes.first {
                        true => (true, (u - lobes.first) / lobes.second),
                        false => (false, u / lobes.first),
                    }))
                    .made()
            },
        )
        .source("Mitsuba 3 blendbsdf")
        .varied(&[("alpha", 0.1, 0.6), ("reflectance", 0.2, 0.8)])
        // Numbers below 0 and above 1 lead to no direction at all.
        .must_fail(&["sanity", "goodness-of-fit", "normalization", "support", "albedo", "mis"]),
        Mutant::new(
            "diffuse-gets-raw-number",
            "phong",
            "the number that chose the diffuse lobe is used again as it is",
            |p, _| {
                let m = Phong::declared(p)?;
                let [_, glossy] = lobes_of(&m);
                Altered::of(m)
                    .draw(move |m, wo, u| {
                        if u[0] < m.shares[0] {
                            return Some((sample_cosine(u), Lobe::DIFFUSE_REFLECTION));
                        }
                        let stretched = (u[0] - m.shares[0]) / m.shares[1];
                        let s = glossy.sample(wo, &[stretched, u[1]], R)?;
                        Some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("student solutions: stretched, then the raw number used")
        .varied(&[("kd", 0.2, 0.5), ("ks", 0.3, 0.5), ("exponent", 20.0, 100.0)])
        // Each diffuse sample is above the horizon, so that masses hold.
        .must_fail(&["goodness-of-fit", "support", "jacobian"])
        // Away from the glossy lobe all weights are equal.
        .may_fail(&["albedo", "mis"]),
        Mutant::new("number-used-twice", "lambert", "both coordinates come from the first number", |p, _| {
            Altered::of(Lambert::declared(p)?)
                .draw(|_, _, u| Some((sample_cosine(&[u[0], u[0]]), Lobe::DIFFUSE_REFLECTION)))
                .made()
        })
        .source("student Nori")
        .varied(&[("reflectance", 0.2, 1.0)])
        // The weight is constant, and a curve of samples has no Jacobian to look at.
        .must_fail(&["goodness-of-fit", "support"]),
        Mutant::new(
            "hidden-generator",
            "rough-plastic",
            "the lobe is chosen by a generator inside, which is not claimed",
            |p, _| {
                let hidden = Mutex::new(StreamKey::new(1).block(0));
                Altered::of(RoughPlastic::declared(p)?)
                    .draw(plastic_by(move |lobes, u| {
                        let own = hidden.lock().map_or(0.5, |mut hidden| hidden.next_f64());
                        (own < lobes.first, u)
                    }))
                    .made()
            },
        )
        .source("student Nori: rand()")
        .varied(&[("alpha", 0.1, 0.6), ("reflectance", 0.2, 0.8)])
        .must_fail(&["determinism"])
        // u → wi is no map at all, but its derivative within a lobe looks like one.
        .may_fail(&["jacobian"]),
        Mutant::new("number-of-last-call", "lambert", "the azimuth is that of the call before", |p, _| {
            let last = AtomicU64::new(0.5f64.to_bits());
            Altered::of(Lambert::declared(p)?)
                .draw(move |_, _, u| {
                    let before = f64::from_bits(last.swap(u[1].to_bits(), Ordering::Relaxed));
                    Some((sample_cosine(&[u[0], before]), Lobe::DIFFUSE_REFLECTION))
                })
                .made()
        })
        .source("Cycles: the state of the generator is copied")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(&["determinism"]),
        Mutant::new(
            "stretched-beyond-one",
            "rough-plastic",
            "the base's share is rounded to f32, so that the last numbers are stretched to above 1",
            |p, _| {
                Altered::of(RoughPlastic::declared(p)?)
                    .draw(plastic_by(|lobes, u| match u < lobes.first {
                        true => lobes.choose(u),
                        false => (false, (u - lobes.first) / to_24_bits(lobes.second)),
                    }))
                    .made()
            },
        )
        .equivalent(&[(Cause::Numerics, "one number below 1 gives no direction, which is all that shows")])
        .source("pbrt-v3: a stretched number rounds to 1")
        .varied(&[("alpha", 0.1, 0.6), ("reflectance", 0.2, 0.8)])
        // One number in 10⁸ leads to no direction.
        .must_fail(&["sanity"]),
    ]
}
