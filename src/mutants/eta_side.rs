//! The index of the wrong side, and total reflection.

use super::altered::{Altered, R, half};
use super::altered_parts::AlteredFresnel;
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction, FresnelFunction, Lobe, Sample, Spectrum};
use crate::models::microfacet::{Fresnel, RoughDielectric, TorranceSparrow};
use crate::models::{Dielectric, fresnel};

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "eta-not-inverted-in-pdf",
            "rough-dielectric",
            "pdf() takes η and not 1/η where wo is inside",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf(|m, wo, wi| m.pdf(m.upright(wo, wo), m.upright(wo, wi), R))
                    .made()
            },
        )
        .source("specular-manifold-sampling#3")
        .varied(&[("alpha", 0.1, 0.5), ("eta", 1.3, 2.0)])
        // Also where facets refract by 1/η and not by η there is light, and no pdf.
        .must_fail(&["goodness-of-fit", "normalization", "support", "albedo", "mis", "jacobian"]),
        Mutant::new(
            "eta-not-inverted-in-sample",
            "rough-dielectric:alpha=0.1",
            "sample() takes η and not 1/η where wo is inside",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .draw(|m, wo, u| {
                        let s = m.sample(m.upright(wo, wo), u, R)?;
                        Some((m.upright(wo, s.wi), s.lobe))
                    })
                    .made()
            },
        )
        .source("specular-manifold-sampling#3")
        .varied(&[("alpha", 0.02, 0.15), ("eta", 1.3, 2.0)])
        // The lobe is elsewhere, for α → 0 too.
        .must_fail(&[
            "goodness-of-fit",
            "normalization",
            "support",
            "albedo",
            "mis",
            "jacobian",
            "sensitivity",
        ]),
        Mutant::new(
            "eta-not-inverted-in-eval",
            "rough-dielectric:alpha=0.3",
            "eval() takes η and not 1/η where wo is inside",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .eval(|m, wo, wi, t| m.eval(m.upright(wo, wo), m.upright(wo, wi), t))
                    .made()
            },
        )
        .source("specular-manifold-sampling#3")
        .varied(&[("alpha", 0.1, 0.5), ("eta", 1.3, 2.0)])
        // What is seen through facets that are not drawn is missed by sampling, and
        // made up for by the cosine of `mis`.
        .must_fail(&["reciprocity", "support", "albedo"]),
        Mutant::new(
            "zero-vector-beyond-critical-angle",
            "dielectric",
            "sample() returns a zero vector where all light is reflected",
            |p, _| {
                Altered::of(Dielectric::declared(p)?)
                    .finish(|m, wo, _, s| {
                        let total = fresnel::refracted_cosine(wo.z.abs(), m.relative_eta(wo)).is_none();
                        Some(if total { Sample { wi: Direction::default(), ..s } } else { s })
                    })
                    .made()
            },
        )
        .source("cycles@081aa191b, cycles@e3b4722e7")
        .varied(&[("eta", 1.1, 2.5)])
        .shows_at(&[75.0])
        // All light is lost there.
        .must_fail(&["sanity", "white-furnace"]),
        Mutant::new(
            "nan-beyond-critical-angle",
            "rough-dielectric",
            "sample() returns NaN where a facet reflects all light",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .finish(|m, wo, _, s| {
                        let cos = wo.dot(half(wo, s.wi));
                        let total = fresnel::refracted_cosine(cos, m.relative_eta(wo)).is_none();
                        let lost = total && wo.same_side(s.wi);
                        Some(if lost { Sample { wi: s.wi * f64::NAN, ..s } } else { s })
                    })
                    .made()
            },
        )
        .source("cycles@081aa191b, cycles@e3b4722e7")
        .varied(&[("alpha", 0.05, 0.5), ("eta", 1.3, 2.0)])
        // For α → 0 nothing is left of the reflection that samples should gather in.
        .must_fail(&[
            "sanity",
            "goodness-of-fit",
            "normalization",
            "support",
            "albedo",
            "mis",
            "sensitivity",
        ]),
        Mutant::new(
            "fresnel-of-outside-within",
            "dielectric",
            "from inside, what is reflected is that of the same angle outside",
            |p, _| {
                Altered::of(Dielectric::declared(p)?)
                    .finish(|m, wo, _, s| {
                        let reflected = |eta| fresnel::dielectric(wo.z.abs(), eta);
                        let (wrong, right) = (reflected(m.eta), reflected(m.relative_eta(wo)));
                        let ratio = if s.lobe.contains(Lobe::REFLECTION) {
                            wrong / right
                        } else {
                            (1.0 - wrong) / (1.0 - right)
                        };
                        Some(Sample { weight: s.weight * ratio, ..s })
                    })
                    .made()
            },
        )
        .source("pbrt-v3@478b2e6, pbrt-v3#214")
        .varied(&[("eta", 1.2, 2.5)])
        .shows_at(&[30.0, 75.0])
        // Below the critical angle the two lobes still share all light.
        .must_fail(&["reciprocity", "white-furnace"]),
        Mutant::new(
            "fresnel-eta-not-inverted",
            "fresnel",
            "reflectance() takes η and not 1/η for light from inside",
            |p, _| {
                AlteredFresnel::of(Fresnel::declared(p)?)
                    .reflectance(|f, cos| f.reflectance(cos.abs()))
                    .made()
            },
        )
        .source("pbrt-v3@478b2e6, pbrt-v3#254")
        .varied(&[("eta", 1.1, 3.0)])
        .must_fail(&["fresnel"]),
        Mutant::new(
            "conductor-not-relative-to-coat",
            "torrance-sparrow:fresnel=conductor,metal=copper",
            "the metal's index is divided by that of a coat, 1.5, which is not there",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(|m, wo, wi, t| {
                        let f = m.eval(wo, wi, t);
                        let Fresnel::Conductor(metal) = m.fresnel else { return f };
                        let (cos, index) = (wo.dot(half(wo, wi)), metal.index());
                        Spectrum::from_fn(f.len(), |c| {
                            let (n, k) = index[c];
                            let reflected = |coat: f64| fresnel::conductor(cos, n / coat, k / coat);
                            f[c] * (reflected(1.5) / reflected(1.0))
                        })
                    })
                    .made()
            },
        )
        .source("pbrt-v4@e86038eb, the other way round")
        .varied(&[("alpha", 0.05, 0.8)])
        .compared()
        .must_fail(&["reference"]),
    ]
}
