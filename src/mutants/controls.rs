//! Negative controls: correct code that looks wrong.

use super::altered::{Altered, R, half};
use super::altered_parts::AlteredFresnel;
use super::mutant::Mutant;
use super::parameter::with;
use crate::bsdf::{
    Bsdf, Cosine, Direction, FresnelFunction, Lobe, OffSupport, Sample, Spectrum, Transport, TransportModes,
};
use crate::models::coated_base::Lobes;
use crate::models::lambert::sample_cosine;
use crate::models::microfacet::{
    Fresnel, NormalSampling, RoughDielectric, RoughPlastic, TorranceSparrow, half_vector,
};
use crate::models::{Lambert, Phong, fresnel};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::sync::Arc;

pub(super) fn controls() -> Vec<Mutant> {
    [conventions(), samplers(), choices(), models()].concat()
}

/// Conventions other than gonio's own.
fn conventions() -> Vec<Mutant> {
    /// eval() contains the cosine, and the weight is eval/pdf.
    fn with_cosine(m: TorranceSparrow) -> Altered<TorranceSparrow> {
        Altered::of(m)
            .eval_times(|_, _, wi| wi.z)
            .finish(|_, _, _, s| Some(Sample { weight: s.weight * (1.0 / s.wi.z), ..s }))
    }
    vec![
        Mutant::new(
            "cosine-included",
            "torrance-sparrow:alpha=0.3",
            "eval() contains the cosine, as it declares",
            |p, _| {
                with_cosine(TorranceSparrow::declared(p)?)
                    .described(|d| d.claims(|c| c.cosine = Cosine::Included))
                    .made()
            },
        )
        .source("weight = eval/pdf where eval contains the cosine"),
        Mutant::new(
            "cosine-undeclared",
            "torrance-sparrow:alpha=0.3",
            "eval() contains the cosine and does not say so: a convention",
            |p, _| with_cosine(TorranceSparrow::declared(p)?).made(),
        )
        .source("detect the convention first")
        .must_warn(&["weight"]),
        Mutant::new(
            "importance",
            "rough-dielectric:alpha=0.3",
            "only importance is carried, as declared",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .eval(|m, wo, wi, _| m.eval(wo, wi, Transport::Importance))
                    .described(|d| d.claims(|c| c.transport = TransportModes::Importance))
                    .made()
            },
        )
        .source("pbrt-v3#108: η_o² or η_i² by the mode of transport"),
        Mutant::new(
            "off-support-returned",
            "torrance-sparrow:alpha=0.5",
            "draws below the horizon come with weight 0 and their pdf, as declared",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(|m, wo, wi| {
                        if wo.z <= 0.0 {
                            return 0.0;
                        }
                        let h = half(wo, wi);
                        let density = match m.sampling {
                            NormalSampling::Visible => m.distribution.visible_density(wo, h),
                            NormalSampling::All => m.distribution.density(h) * h.z,
                        };
                        density / (4.0 * wo.dot(h))
                    })
                    .draw(|m, wo, u| {
                        if wo.z <= 0.0 {
                            return None;
                        }
                        let normal = match m.sampling {
                            NormalSampling::Visible => m.distribution.sample_visible(wo, u)?,
                            NormalSampling::All => m.distribution.sample(u),
                        };
                        Some((wo.reflected(normal), Lobe::GLOSSY_REFLECTION))
                    })
                    .described(|d| d.claims(|c| c.off_support = OffSupport::ZeroWeight))
                    .made()
            },
        )
        .source("what becomes of draws off the support is a convention"),
    ]
}

/// Other maps from u to the same density.
fn samplers() -> Vec<Mutant> {
    /// `sample()` of the correct model, with other random numbers.
    fn with_u(m: TorranceSparrow, other: fn(&[f64]) -> Vec<f64>) -> Altered<TorranceSparrow> {
        Altered::of(m).draw(move |m, wo, u| {
            let s = m.sample(wo, &other(u), R)?;
            Some((s.wi, s.lobe))
        })
    }
    vec![
        Mutant::new(
            "reversed-u",
            "torrance-sparrow:alpha=0.3",
            "sample() uses 1 − u in place of u",
            |p, _| {
                let reversed = |u: &[f64]| u.iter().map(|u| 1.0 - f64::EPSILON / 2.0 - u).collect();
                with_u(TorranceSparrow::declared(p)?, reversed).made()
            },
        )
        .source("pbrt-v3@3123d85: a sign that comes to u → 1 − u"),
        Mutant::new(
            "permuted-strata",
            "torrance-sparrow:alpha=0.3",
            "the sixteenths of u come in another order",
            |p, _| {
                let permuted = |u: &[f64]| {
                    let stratum = (16.0 * u[0]).floor();
                    vec![u[0] + ((5.0 * stratum + 3.0) % 16.0 - stratum) / 16.0, u[1]]
                };
                with_u(TorranceSparrow::declared(p)?, permuted).made()
            },
        )
        .source("the same density from another map"),
        Mutant::new(
            "concentric-disc",
            "lambert:reflectance=1",
            "the cosine is drawn over Shirley and Chiu's map, which has creases; weights do not vary",
            |p, _| {
                Altered::of(Lambert::declared(p)?)
                    .draw(|_, wo, u| {
                        let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
                        let (r, phi) = match (a.abs() > b.abs(), b == 0.0) {
                            (true, _) => (a, FRAC_PI_4 * (b / a)),
                            (false, true) => (0.0, 0.0),
                            (false, false) => (b, FRAC_PI_2 - FRAC_PI_4 * (a / b)),
                        };
                        let z = ((1.0 - r) * (1.0 + r)).sqrt();
                        let wi = Direction::new(r * phi.cos(), r * phi.sin(), z);
                        (wo.z > 0.0).then_some((wi, Lobe::DIFFUSE_REFLECTION))
                    })
                    .made()
            },
        )
        .source("albedo exactly 1 with zero variance"),
    ]
}

/// Densities that do not follow f, alike in sample() and pdf().
fn choices() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "lobes-badly-chosen",
            "phong",
            "the diffuse lobe, of nearly half of the light, is drawn once in ten times",
            |p, _| Ok(Arc::new(Phong { shares: [0.1, 0.9], ..Phong::declared(p)? })),
        )
        .source("only efficiency is lost"),
        Mutant::new(
            "samples-of-another-roughness",
            "torrance-sparrow:alpha=0.2",
            "sample() and pdf() are those of 1.3 α, eval() that of α",
            |p, _| {
                let wider = || TorranceSparrow::declared(&with(p, "alpha", 1.3 * p.number("alpha")));
                let drawn = wider()?;
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_of(wider()?)
                    .draw(move |_, wo, u| drawn.sample(wo, u, R).map(|s| (s.wi, s.lobe)))
                    .made()
            },
        )
        .source("a consistent wrong density in sample and pdf"),
        Mutant::new(
            "lobe-narrowed",
            "phong",
            "sample() and pdf() have an exponent that depends on the view",
            |p, _| {
                let narrowed = |m: &Phong, wo: Direction| Phong {
                    exponent: m.exponent * (1.2 - 0.2 * wo.z.abs().sqrt()),
                    ..*m
                };
                Altered::of(Phong::declared(p)?)
                    .pdf(move |m, wo, wi| narrowed(m, wo).pdf(wo, wi, R))
                    .draw(move |m, wo, u| narrowed(m, wo).sample(wo, u, R).map(|s| (s.wi, s.lobe)))
                    .made()
            },
        )
        .source("Mitsuba 0.x 3b1f6dc2: a lobe enlarged the wrong way, in sample and pdf"),
        Mutant::new(
            "choice-clamped",
            "rough-plastic:alpha=0.1",
            "the coat is drawn with a probability in [0.3, 0.7], in sample() and pdf()",
            |p, _| {
                fn clamped(m: &RoughPlastic, wo: Direction) -> Lobes {
                    let first = m.lobes(wo.z).0.first.clamp(0.3, 0.7);
                    Lobes { first, second: 1.0 - first }
                }
                Altered::of(RoughPlastic::declared(p)?)
                    .pdf(|m, wo, wi| {
                        if wo.z <= 0.0 || wi.z <= 0.0 {
                            return 0.0;
                        }
                        let lobes = clamped(m, wo);
                        lobes.first * m.coat.pdf(wo, wi, R) + lobes.second * wi.z / PI
                    })
                    .draw(|m, wo, u| {
                        if wo.z <= 0.0 {
                            return None;
                        }
                        let (coat, rest) = clamped(m, wo).choose(u[0]);
                        if coat {
                            return m.coat.sample(wo, &[rest, u[1]], R).map(|s| (s.wi, s.lobe));
                        }
                        Some((sample_cosine(&[rest, u[1]]), Lobe::DIFFUSE_REFLECTION))
                    })
                    .made()
            },
        )
        .source("a defensive clamp of P in both"),
    ]
}

/// Other formulae for the same, and other models.
fn models() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "fresnel-at-wi",
            "torrance-sparrow:fresnel=dielectric",
            "F(wi·h) for F(wo·h): the same angle",
            |p, _| {
                let lossless = TorranceSparrow { fresnel: Fresnel::None, ..TorranceSparrow::declared(p)? };
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(move |m, wo, wi, t| m.reflected(wi.dot(half(wo, wi)), lossless.eval(wo, wi, t)[0]))
                    .made()
            },
        )
        .source("F(wi·h) with consistent η equals F(wo·h)"),
        Mutant::new(
            "fresnel-from-beyond",
            "fresnel",
            "the reflectance is taken from the other end of the refracted ray",
            |p, _| {
                AlteredFresnel::of(Fresnel::declared(p)?)
                    .reflectance(|f, cos| {
                        let Fresnel::Dielectric(eta) = *f else { return f.reflectance(cos) };
                        let relative = if cos < 0.0 { 1.0 / eta } else { eta };
                        let beyond = fresnel::refracted_cosine(cos.abs(), relative);
                        Spectrum::from(beyond.map_or(1.0, |cos| fresnel::dielectric(cos, 1.0 / relative)))
                    })
                    .made()
            },
        )
        .source("pbrt-v2 e2140b4: exchanged indices are exchanged again"),
        Mutant::new(
            "textbook-transmittance",
            "rough-dielectric:alpha=0.3",
            "1 − F, which loses its digits next to the critical angle",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .eval_times(|m, wo, wi| {
                        let eta = m.relative_eta(wo);
                        let (o, i) = (m.upright(wo, wo), m.upright(wo, wi));
                        half_vector::of_refraction(o, i, eta).map_or(1.0, |r| {
                            (1.0 - fresnel::dielectric(r.cos_o.min(1.0), eta))
                                / fresnel::transmitted(r.cos_o, r.cos_i, eta)
                        })
                    })
                    .made()
            },
        )
        .source("Walter et al. 2007, eq. 21, as it is written"),
        Mutant::new(
            "separable-masking",
            "torrance-sparrow:alpha=0.5",
            "G1(wo) G1(wi), not correlated by height",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval_times(|m, wo, wi| {
                        // G1 G1 (1 + Λo + Λi), by Λ = 1/G1 − 1.
                        let (o, i) = (m.distribution.g1(wo), m.distribution.g1(wi));
                        o + i - o * i
                    })
                    .made()
            },
        )
        .source("Smith 1967; Walter et al. 2007, eq. 23"),
        Mutant::new(
            "base-scaled-by-albedo",
            "rough-plastic:reflectance=1",
            "the base gets what the coat leaves at wo, however it goes out: not reciprocal, as told",
            |p, _| {
                let base = p.number("reflectance") / PI;
                Altered::of(RoughPlastic::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let lit = wo.z > 0.0 && wi.z > 0.0;
                        let passing = if lit { m.lobes(wo.z).1 } else { 0.0 };
                        Spectrum::from(m.coat.eval(wo, wi, t)[0] + base * passing)
                    })
                    .described(|d| d.claims(|c| c.reciprocal = false))
                    .made()
            },
        )
        .source("OpenPBR PR 30 trades reciprocity for energy"),
        Mutant::new(
            "floor-of-alpha",
            "torrance-sparrow:alpha=0.01",
            "alpha is at least 1e-3 in all functions",
            |p, _| {
                let alpha = p.number("alpha").max(1e-3);
                Ok(Arc::new(TorranceSparrow::declared(&with(p, "alpha", alpha))?))
            },
        )
        .source("α floor 1e-3"),
        Mutant::new(
            "both-sides-mirrored",
            "torrance-sparrow:alpha=0.3,alpha_y=0.1",
            "seen from behind, the sign of z is changed and no other",
            |p, _| {
                fn up(wo: Direction, w: Direction) -> Direction {
                    if wo.z < 0.0 { w.flipped() } else { w }
                }
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(|m, wo, wi, t| m.eval(up(wo, wo), up(wo, wi), t))
                    .pdf(|m, wo, wi| m.pdf(up(wo, wo), up(wo, wi), R))
                    .draw(|m, wo, u| m.sample(up(wo, wo), u, R).map(|s| (up(wo, s.wi), s.lobe)))
                    .described(|d| d.claims(|c| c.two_sided = true))
                    .made()
            },
        )
        .source("z → −z and not w → −w"),
    ]
}
