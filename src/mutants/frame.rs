//! Frames, azimuths, the back side.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction};
use crate::models::microfacet::{RoughDielectric, TorranceSparrow};
use crate::models::{OrenNayar, OrenNayarEon};

/// wo on the front side if it is negated from behind while wi has its z changed:
/// seen from there the two are turned by π against each other.
fn negated(wo: Direction) -> Direction {
    if wo.z < 0.0 { wo.mirrored() } else { wo }
}

/// `w` in a frame whose tangent has the azimuth of wo.
fn along(wo: Direction, w: Direction) -> Direction {
    w.rotated(-wo.phi())
}

/// A local direction in the frame of a world whose up is 20° off the normal.
fn in_world(w: Direction) -> Direction {
    let (sin, cos) = 20f64.to_radians().sin_cos();
    Direction::new(w.x, cos * w.y - sin * w.z, sin * w.y + cos * w.z)
}

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "back-negated",
            "rough-dielectric",
            "seen from behind, eval() and pdf() negate wo in place of changing its z",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .eval(|m, wo, wi, transport| m.eval(negated(wo), wi, transport))
                    .pdf(|m, wo, wi| m.pdf(negated(wo), wi, R))
                    .made()
            },
        )
        .source("Mitsuba 3 twosided")
        .varied(&[("alpha", 0.1, 0.5), ("eta", 1.3, 2.0)])
        // Reciprocity compares transmission with that from the front.
        .must_fail(&["goodness-of-fit", "albedo", "mis", "jacobian", "reciprocity"])
        // Draws of refraction where pdf says there is none are no samples.
        .may_fail(&["normalization", "support"]),
        Mutant::new("azimuth-sum", "oren-nayar:sigma=40", "cos(φi + φo) for cos(φi − φo)", |p, _| {
            Altered::of(OrenNayar::declared(p)?)
                .eval(|m, wo, wi, transport| m.eval(wo, Direction::new(wi.x, -wi.y, wi.z), transport))
                .made()
        })
        .source("IrrlichtBAW")
        .shows_at(&[60.0])
        .varied(&[("sigma", 10.0, 60.0), ("reflectance", 0.3, 0.8)])
        // The sum is symmetric too, and integrates to the same.
        .must_fail(&["isotropy"]),
        Mutant::new(
            "azimuth-shifted",
            "torrance-sparrow:alpha=0.1",
            "samples are turned about the normal by ε",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .draw(move |m, wo, u| {
                        let s = m.sample(wo, u, R)?;
                        Some((s.wi.rotated(e), s.lobe))
                    })
                    .made()
            },
        )
        .source("our own: a tangent in sample() and another in pdf()")
        .strength(0.05, 1.0, "samples are turned by epsilon radians")
        .varied(&[("alpha", 0.02, 0.2)])
        // A mirror sends light where the smoothest surface does not.
        .must_fail(&["goodness-of-fit", "jacobian", "sensitivity"])
        // Weights depend on both heights only, so that albedo holds; and a lobe that is
        // narrower than ε leaves its place.
        .may_fail(&["mis", "support"]),
        Mutant::new(
            "lobe-not-turned-back",
            "oren-nayar-eon:reflectance=1,roughness=1",
            "the lobe is drawn in a frame along wo's azimuth and not turned back",
            |p, _| {
                Altered::of(OrenNayarEon::declared(p)?)
                    .draw(|m, wo, u| {
                        let s = m.sample(Direction::new(wo.x.hypot(wo.y), 0.0, wo.z), u, R)?;
                        Some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("a frame built in the wrong basis, invisible at φ = 0")
        .shows_at(&[75.0])
        .varied(&[("roughness", 0.5, 1.0), ("reflectance", 0.3, 1.0)])
        .must_fail(&["goodness-of-fit", "jacobian"])
        // By how much depends on the azimuth.
        .may_fail(&["albedo", "mis"]),
        Mutant::new(
            "world-wo",
            "oren-nayar:sigma=40",
            "eval() gets wo in the frame of the world, whose up is 20° off the normal",
            |p, _| {
                Altered::of(OrenNayar::declared(p)?)
                    .eval(|m, wo, wi, transport| m.eval(in_world(wo), wi, transport))
                    .made()
            },
        )
        .source("pbrt-v3 rho(); dspbr-pt")
        .shows_at(&[30.0])
        .varied(&[("sigma", 10.0, 60.0), ("reflectance", 0.3, 0.8)])
        .must_fail(&["isotropy", "reciprocity"]),
        Mutant::new(
            "tangent-follows-wo",
            "torrance-sparrow:alpha=0.5,alpha_y=0.1",
            "the tangent is that of wo's azimuth, in all functions",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(|m, wo, wi, transport| m.eval(along(wo, wo), along(wo, wi), transport))
                    .pdf(|m, wo, wi| m.pdf(along(wo, wo), along(wo, wi), R))
                    .draw(|m, wo, u| {
                        let s = m.sample(along(wo, wo), u, R)?;
                        Some((s.wi.rotated(wo.phi()), s.lobe))
                    })
                    .made()
            },
        )
        .source("GLSL-PathTracer: a tangent that depends on what it must not")
        .varied(&[("alpha", 0.3, 0.8), ("alpha_y", 0.05, 0.2)])
        // The functions agree with each other.
        .must_fail(&["reciprocity"]),
    ]
}
