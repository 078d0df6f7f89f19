//! NaN, infinity, cancellation, hostile inputs.

use super::altered::{Altered, half};
use super::altered_parts::AlteredNormals;
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction, Lobe, NormalDistribution, Sample};
use crate::cause::Cause;
use crate::models::microfacet::TorranceSparrow;
use crate::models::{Lambert, OrenNayar, OrenNayarEon, Phong, Plastic};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

pub(super) fn mutants() -> Vec<Mutant> {
    [undefined(), out_of_range(), imprecise()].concat()
}

/// A factor that is NaN where `x` is, and changes nothing elsewhere.
fn nan_or_one(x: f64) -> f64 {
    if x.is_nan() { x } else { 1.0 }
}

/// 0/0 and the like at single inputs.
fn undefined() -> Vec<Mutant> {
    vec![
        // Shirley and Chiu's map of the square to the disc.
        Mutant::new("nan-at-the-centre", "lambert", "0/0 at u = (½, ½) of the concentric map", |p, _| {
            Altered::of(Lambert::declared(p)?)
                .draw(|_, wo, u| {
                    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
                    let (r, phi) = if a.abs() > b.abs() {
                        (a, FRAC_PI_4 * (b / a))
                    } else {
                        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
                    };
                    let wi = Direction::new(r * phi.cos(), r * phi.sin(), (1.0 - r * r).max(0.0).sqrt());
                    (wo.z > 0.0).then_some((wi, Lobe::DIFFUSE_REFLECTION))
                })
                .made()
        })
        .source("Mitsuba 0.x concentric disk 9c9d8b83: a missing `else`")
        .must_fail(&["sanity"]),
        Mutant::new(
            "logarithm-of-zero",
            "torrance-sparrow:distribution=beckmann,sampling=normals,alpha=0.3",
            "tan² θ = −α² ln u, infinite at u = 0",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .sample(|m, wo, u, t| {
                        let tan = m.distribution.alpha().x * (-u[0].ln()).sqrt();
                        let (y, x) = (TAU * u[1]).sin_cos();
                        let normal = Direction::new(tan * x, tan * y, 1.0).normalized();
                        let wi = wo.reflected(normal);
                        if wo.z <= 0.0 || wi.z <= 0.0 {
                            return None;
                        }
                        let pdf = m.distribution.density(normal) * normal.z / (4.0 * wo.dot(normal));
                        let weight = m.eval(wo, wi, t) * (wi.z / pdf);
                        Some(Sample { wi, weight, pdf, lobe: Lobe::GLOSSY_REFLECTION })
                    })
                    .made()
            },
        )
        .source("Mitsuba 0.x: u = 0")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["sanity"]),
        Mutant::new(
            "azimuth-of-the-normal",
            "oren-nayar",
            "cos Δφ is divided by sin θo sin θi, 0/0 at the normal",
            |p, _| {
                Altered::of(OrenNayar::declared(p)?)
                    .eval_times(|_, wo, wi| {
                        let sines = wo.x.hypot(wo.y) * wi.x.hypot(wi.y);
                        nan_or_one((wo.x * wi.x + wo.y * wi.y) / sines)
                    })
                    .made()
            },
        )
        .source("pbrt-v2 78dbb94, pbrt-v3 bcac285")
        .varied(&[("sigma", 10.0, 80.0)])
        .must_fail(&["sanity"]),
        Mutant::new(
            "half-vector-of-opposites",
            "torrance-sparrow",
            "wo + wi is normalised before the sides are looked at",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(|m, wo, wi, t| {
                        let h = (wo + wi).normalized();
                        // |h|² = 1, but for wi = −wo.
                        m.eval(wo, wi, t) * h.dot(h)
                    })
                    .made()
            },
        )
        .source("pbrt-v2 7700fb1: wi = −wo")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["sanity"]),
        Mutant::new(
            "masking-at-the-horizon",
            "torrance-sparrow",
            "pdf is G1 D/(4 cos θo), with `<` where `<=` is meant: 0/0 at cos θo = 0",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(|m, wo, wi| {
                        if wo.z < 0.0 || wi.z <= 0.0 {
                            return 0.0;
                        }
                        let d = m.distribution.density(half(wo, wi));
                        m.distribution.g1(wo) * d / (4.0 * wo.z)
                    })
                    .made()
            },
        )
        .source("rs_pbrt 1b0d5ae: wo.z = 0")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["sanity"]),
        Mutant::new(
            "no-loss-to-divide",
            "oren-nayar-eon:roughness=0",
            "(1 − E(μo)) (1 − E(μi)) is divided by 1 − E_avg = 0",
            |p, _| {
                Altered::of(OrenNayarEon::declared(p)?)
                    .eval_times(|m, wo, wi| {
                        // All three are proportional to the roughness.
                        let lost = |w: Direction| m.roughness * m.lost(w.z.min(1.0));
                        nan_or_one(lost(wo) * lost(wi) / m.roughness)
                    })
                    .made()
            },
        )
        .source("Cycles EON 7202f6df4: 0/0 as σ → 0")
        .varied(&[("reflectance", 0.1, 0.95)])
        .must_fail(&["sanity"]),
        Mutant::new(
            "power-of-a-negative",
            "phong:exponent=30.5",
            "the cosine is not cut at 0 before it is raised to a power",
            |p, _| {
                Altered::of(Phong::declared(p)?)
                    .eval_times(|m, wo, wi| nan_or_one(wo.mirrored().dot(wi).powf(m.exponent)))
                    .made()
            },
        )
        .source("OSL Phong f813908b: pow(negative, e)")
        .must_fail(&["sanity"]),
    ]
}

/// Values that are not what they must be.
fn out_of_range() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "infinite-mirror",
            "plastic",
            "eval() is infinite at the mirror direction, for the discrete lobe",
            |p, _| {
                Altered::of(Plastic::declared(p)?)
                    .eval_times(|_, wo, wi| if wi == wo.mirrored() { f64::INFINITY } else { 1.0 })
                    .made()
            },
        )
        .equivalent(&[(Cause::DiscreteLobe, "eval() contains the discrete lobe in its direction")])
        .source("Tungsten 66bda36: delta and continuous lobes mixed")
        .varied(&[("eta", 1.2, 2.5), ("reflectance", 0.1, 1.0)])
        .must_fail(&["sanity", "discrete-lobes"]),
        // Beckmann's lobe is 0 off its peak.
        Mutant::new(
            "negative-off-the-lobe",
            "torrance-sparrow:distribution=beckmann,alpha=0.1",
            "f is too small by the constant ε",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let lit = wo.z > 0.0 && wi.z > 0.0;
                        m.eval(wo, wi, t).map(|f| if lit { f - e } else { f })
                    })
                    .made()
            },
        )
        .source("Cycles 44995d22e: negative eval")
        .strength(1e-3, 1.0, "by how much f is too small, in 1/sr")
        .varied(&[("alpha", 0.03, 0.3)])
        .must_fail(&["sanity"]),
        // A draw without a direction is no sample, and no lobe without samples is narrow.
        Mutant::new("wi-not-of-unit-length", "torrance-sparrow:alpha=0.3", "|wi| = 1 + ε", |p, e| {
            Altered::of(TorranceSparrow::declared(p)?)
                .finish(move |_, _, _, s| Some(Sample { wi: s.wi * (1.0 + e), ..s }))
                .made()
        })
        .source("wh not normalised")
        .strength(1e-3, 1.0, "by how much wi is too long")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&[
            "sanity",
            "goodness-of-fit",
            "normalization",
            "support",
            "albedo",
            "mis",
            "sensitivity",
        ]),
        // Where pdf is clipped at 0, there is light and samples fall.
        Mutant::new(
            "negative-pdf",
            "phong:kd=0,ks=0.9,exponent=10",
            "the lobe's probability is 1 + ε, that of the diffuse one −ε, in pdf()",
            |p, e| {
                Altered::of(Phong::declared(p)?)
                    .pdf(move |m, wo, wi| {
                        Phong { shares: [-e, 1.0 + e], ..*m }.pdf(wo, wi, super::altered::R)
                    })
                    .made()
            },
        )
        .source("appleseed PR 2004: negative probabilities")
        .strength(0.1, 1.0, "by how much the probability of the lobe is too large")
        .varied(&[("exponent", 2.0, 50.0)])
        .must_fail(&["sanity", "goodness-of-fit", "normalization", "support", "jacobian"])
        // Weights have no bound next to where pdf is 0: their mean says little.
        .may_fail(&["albedo", "mis"]),
        Mutant::new("panics-near-one", "lambert", "an assertion that u is at most 1 − ε", |p, _| {
            Altered::of(Lambert::declared(p)?)
                .draw(|m, wo, u| {
                    // The spacing of numbers is ε above 1, and half of it below.
                    assert!(u[0] <= 1.0 - f64::EPSILON, "u is too near to 1");
                    let s = m.sample(wo, u, super::altered::R)?;
                    Some((s.wi, s.lobe))
                })
                .made()
        })
        .source("Cycles: u = 1")
        .must_fail(&["sanity"]),
    ]
}

/// Values that are wrong near a limit.
fn imprecise() -> Vec<Mutant> {
    /// sin²θ below which D counts as that of the pole.
    const POLE: f64 = 1e-4;
    vec![
        Mutant::new(
            "pole-of-the-distribution",
            "normals:alpha=0.05",
            "D = 1 where sin² θ < 1e-4",
            |p, _| {
                AlteredNormals::declared(p)?
                    .density(
                        |d, m| {
                            if m.z > 0.0 && m.x * m.x + m.y * m.y < POLE { 1.0 } else { d.density(m) }
                        },
                    )
                    .made(p)
            },
        )
        .source("dspbr-pt c3c3eb8")
        .varied(&[("alpha", 0.03, 0.07)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "white-furnace", "distribution"])
        // Few of its points may lie in the hole.
        .may_fail(&["jacobian"]),
        Mutant::new(
            "pole-of-the-lobe",
            "torrance-sparrow:alpha=0.1",
            "D = 1 where sin² θh < 1e-4, in eval() and pdf()",
            |p, _| {
                let hole = |m: &TorranceSparrow, wo: Direction, wi: Direction| {
                    let h = half(wo, wi);
                    if h.x * h.x + h.y * h.y < POLE { 1.0 / m.distribution.density(h) } else { 1.0 }
                };
                Altered::of(TorranceSparrow::declared(p)?).eval_times(hole).pdf_times(hole).made()
            },
        )
        .source("dspbr-pt c3c3eb8")
        .varied(&[("alpha", 0.07, 0.12)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo"])
        // Few points of jacobian may lie in the hole, and mis is off by 0.4 to 2 %, the
        // least of which is near what it sees of 2¹⁸ draws.
        .may_fail(&["jacobian", "mis"]),
        Mutant::new(
            "cancelling-distribution",
            "torrance-sparrow:alpha=0.001",
            "cos² θ (α² − 1) + 1 is formed in f32, and f64 is declared",
            |p, _| {
                let error = |m: &TorranceSparrow, wo: Direction, wi: Direction| {
                    let h = half(wo, wi);
                    let (a2, cos) = (m.distribution.alpha().x.powi(2) as f32, h.z as f32);
                    let s = f64::from(cos * cos * (a2 - 1.0) + 1.0);
                    f64::from(a2) / (PI * s * s) / m.distribution.density(h)
                };
                Altered::of(TorranceSparrow::declared(p)?).eval_times(error).pdf_times(error).made()
            },
        )
        .source("Cycles a1f81909a: 1 + (α² − 1) cos² θ")
        .varied(&[("alpha", 5e-4, 2e-3)])
        .must_fail(&["jacobian"])
        // No cubature resolves the steps, and the integrals hardly change: rounding of
        // cos² θ is even.
        .may_fail(&["goodness-of-fit", "normalization", "albedo", "mis"]),
    ]
}
