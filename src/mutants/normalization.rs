//! The normalisation of f: factors that are missing or there twice, lobes that add
//! up to more than the light.

use super::altered::Altered;
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Lobe, Sample, Spectrum};
use crate::cause::Cause;
use crate::models::microfacet::{GgxMultiscatter, RoughPlastic, TorranceSparrow};
use crate::models::{Dielectric, Lambert, OrenNayarEon, Phong, Plastic};
use std::f64::consts::PI;

pub(super) fn mutants() -> Vec<Mutant> {
    [diffuse(), coats(), lossless()].concat()
}

/// Factors and tints of single lobes.
fn diffuse() -> Vec<Mutant> {
    vec![
        Mutant::new("lambert-without-pi", "lambert", "f = ρ, without 1/π", |p, _| {
            Altered::of(Lambert::declared(p)?).eval_times(|_, _, _| PI).made()
        })
        .equivalent(&[(
            Cause::ConstantFactor,
            "f times a constant is the same whichever function it was meant for",
        )])
        .source("raysect source#349: f lacks 1/π")
        .varied(&[("reflectance", 0.4, 0.95)])
        .must_fail(&["energy"]),
        // The lobe's albedo is largest, and exactly ks, at normal incidence.
        Mutant::new("kd-plus-ks", "phong:kd=0.6,ks=0.4", "kd + ks = 1 + ε is accepted", |p, e| {
            Altered::of(Phong::declared(p)?)
                .eval(move |m, wo, wi, t| Phong { kd: m.kd + e, ..*m }.eval(wo, wi, t))
                .made()
        })
        .source("Mitsuba 0.x f231d57b: kd + ks > 1")
        .shows_at(&[0.0])
        .strength(0.2, 1.0, "kd + ks is 1 + epsilon")
        .varied(&[("exponent", 1.0, 200.0)])
        .must_fail(&["energy"]),
        Mutant::new(
            "tint-squared",
            "torrance-sparrow:fresnel=schlick,f0=0.5",
            "the colour is multiplied on top of a Fresnel term that has it",
            |p, _| {
                let tint = p.number("f0");
                Altered::of(TorranceSparrow::declared(p)?).eval_times(move |_, _, _| tint).made()
            },
        )
        .source("pbrt-v3 34ec1db: tint²")
        .varied(&[("f0", 0.1, 0.9), ("alpha", 0.05, 0.8)])
        .must_fail(&["reference"])
        .compared(),
        // Nothing else depends on the reflectance of a Lambertian surface.
        Mutant::new("albedo-ignored", "lambert", "f = 1/π whatever the reflectance", |p, _| {
            Altered::of(Lambert::declared(p)?)
                .eval(|m, wo, wi, t| Lambert { reflectance: 1.0, ..*m }.eval(wo, wi, t))
                .made()
        })
        .equivalent(&[(Cause::Parameter, "a parameter changes nothing, whatever it is called")])
        .source("Tungsten 1b23bda")
        .varied(&[("reflectance", 0.1, 0.95)])
        .must_fail(&["sensitivity"]),
        Mutant::new(
            "tinted-transmission",
            "dielectric",
            "transmission is multiplied by the colour of reflection, 1 − ε",
            |p, e| {
                Altered::of(Dielectric { eta: p.number("eta") })
                    .finish(move |_, _, _, s| {
                        let tint = if s.lobe.contains(Lobe::TRANSMISSION) { 1.0 - e } else { 1.0 };
                        Some(Sample { weight: s.weight * tint, ..s })
                    })
                    .made()
            },
        )
        .source("Mitsuba 3 a7d9508b7")
        .strength(0.1, 1.0, "share of the transmitted light that is lost")
        .varied(&[("eta", 1.1, 2.5)])
        .must_fail(&["white-furnace"]),
    ]
}

/// Coats and what they leave to the base.
fn coats() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "base-under-no-coat",
            "plastic:reflectance=1",
            "the coat is added to a base that gets all the light",
            |p, _| {
                let base = p.number("reflectance") / PI;
                Altered::of(Plastic::declared(p)?)
                    .eval(move |_, wo, wi, _| {
                        Spectrum::from(if wo.z > 0.0 && wi.z > 0.0 { base } else { 0.0 })
                    })
                    .made()
            },
        )
        .source("playcanvas engine#4459")
        .varied(&[("eta", 1.2, 2.5)])
        .must_fail(&["energy", "white-furnace"]),
        Mutant::new(
            "base-under-no-rough-coat",
            "rough-plastic:reflectance=1,alpha=0.3",
            "the rough coat is added to a base that gets all the light",
            |p, _| {
                let base = p.number("reflectance") / PI;
                Altered::of(RoughPlastic::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let lit = wo.z > 0.0 && wi.z > 0.0;
                        Spectrum::from(m.coat.eval(wo, wi, t)[0] + if lit { base } else { 0.0 })
                    })
                    .made()
            },
        )
        .source("playcanvas engine#4459")
        .varied(&[("alpha", 0.02, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(&["energy", "white-furnace"]),
        Mutant::new(
            "coat-attenuates-twice",
            "rough-plastic:reflectance=1",
            "the base gets T^(1 + ε) both ways in place of T",
            |p, e| {
                Altered::of(RoughPlastic::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let coat = m.coat.eval(wo, wi, t)[0];
                        let base = m.eval(wo, wi, t)[0] - coat;
                        let again = |cos: f64| if base > 0.0 { m.lobes(cos).1.powf(e) } else { 0.0 };
                        Spectrum::from(coat + base.max(0.0) * again(wo.z) * again(wi.z))
                    })
                    .made()
            },
        )
        .source("Cycles 2b408569f: T² of the coat")
        .strength(1.0, 2.0, "how often more than once the base is attenuated")
        .varied(&[("alpha", 0.02, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(&["white-furnace"]),
    ]
}

/// Any factor, on models that claim to give back all light.
fn lossless() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "lossless-scaled",
            "oren-nayar-eon:reflectance=1",
            "f is too large by the factor 1 + ε",
            |p, e| Altered::of(OrenNayarEon::declared(p)?).eval_times(move |_, _, _| 1.0 + e).made(),
        )
        .equivalent(&[(
            Cause::ConstantFactor,
            "f times a constant is the same whichever function it was meant for",
        )])
        .source("any factor")
        .strength(0.01, 1.0, "f is 1 + epsilon times too large")
        .varied(&[("roughness", 0.0, 1.0)])
        .must_fail(&["energy", "white-furnace"]),
        Mutant::new(
            "lossless-dimmed",
            "ggx-multiscatter",
            "f is too small by the factor 1 − ε",
            |p, e| Altered::of(GgxMultiscatter::declared(p)?).eval_times(move |_, _, _| 1.0 - e).made(),
        )
        .equivalent(&[(
            Cause::ConstantFactor,
            "f times a constant is the same whichever function it was meant for",
        )])
        .source("any factor")
        .strength(0.01, 1.0, "f is 1 − epsilon times too small")
        .varied(&[("alpha", 0.05, 1.0)])
        .must_fail(&["white-furnace"]),
    ]
}
