//! Normals drawn by one strategy, pdf of another; D or G1 missing.

use super::altered::{Altered, g2, half};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Lobe, Sample, Spectrum};
use crate::cause::Cause;
use crate::models::microfacet::{NormalSampling, RoughDielectric, TorranceSparrow};

/// What must see that a pdf is another one.
const ALL: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"];

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "pdf-without-g1",
            "torrance-sparrow:alpha=0.3",
            "pdf() lacks G1(wo) to the power ε",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(move |m, wo, _| m.distribution.g1(wo).powf(-e))
                    .made()
            },
        )
        .source("VNDF without G1")
        .strength(1.0, 1.0, "pdf lacks G1 to this power")
        .varied(&[("alpha", 0.2, 0.8)])
        .shows_at(&[45.0, 75.0])
        .must_fail(ALL),
        Mutant::new(
            "visible-normals-pdf-of-all",
            "torrance-sparrow:alpha=0.5",
            "sample() draws visible normals, pdf() is that of all: D cos θh/(4 wo·h)",
            |p, _| {
                let correct = TorranceSparrow::declared(p)?;
                let all = TorranceSparrow { sampling: NormalSampling::All, ..correct.clone() };
                Altered::of(correct).pdf_of(all).made()
            },
        )
        .source("donut#23")
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "all-normals-pdf-of-visible",
            "torrance-sparrow:distribution=beckmann,sampling=normals,alpha=0.5",
            "sample() draws all normals, pdf() is that of visible ones: D G1/(4 cos θo)",
            |p, _| {
                let correct = TorranceSparrow::declared(p)?;
                let visible = TorranceSparrow { sampling: NormalSampling::Visible, ..correct.clone() };
                Altered::of(correct).pdf_of(visible).made()
            },
        )
        .source("NDF sampler, VNDF pdf")
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "glass-all-normals-pdf-of-visible",
            "rough-dielectric:sampling=normals,alpha=0.5",
            "sample() draws all normals, pdf() is that of visible ones",
            |p, _| {
                let correct = RoughDielectric::declared(p)?;
                let visible = RoughDielectric { sampling: NormalSampling::Visible, ..correct.clone() };
                Altered::of(correct).pdf_of(visible).made()
            },
        )
        .source("NDF sampler, VNDF pdf, through glass")
        .varied(&[("alpha", 0.3, 0.8), ("eta", 1.3, 2.0)])
        .must_fail(ALL)
        // Steep facets are rare among all, and not among those seen at grazing.
        .may_fail(&["support"]),
        Mutant::new(
            "visible-pdf-without-d",
            "torrance-sparrow:alpha=0.5",
            "pdf() lacks D: G1/(4 cos θo)",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|m, wo, wi| 1.0 / m.distribution.density(half(wo, wi)))
                    .made()
            },
        )
        .source("Mitsuba 3 microfacet.h, mitsuba3@93cd2579a")
        .varied(&[("alpha", 0.2, 0.8)])
        .must_fail(ALL)
        // What is as wide as the hemisphere is where a narrow lobe has no samples.
        .may_fail(&["support"]),
        Mutant::new(
            "pdf-g2-for-g1",
            "torrance-sparrow:distribution=beckmann,alpha=0.5",
            "pdf() has G2(wo, wi) where G1(wo) must be",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|m, wo, wi| g2(&m.distribution, wo, wi) / m.distribution.g1(wo))
                    .made()
            },
        )
        .source("of VNDF another masking")
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "invalid-samples-kept",
            "torrance-sparrow:alpha=0.5",
            "sample() keeps what it draws below the horizon, with the pdf of its normal",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .sample(|m, wo, u, transport| {
                        m.sample(wo, u, transport).or_else(|| {
                            let facet = m.facet(wo, u).filter(|_| wo.z > 0.0)?;
                            let (wi, cos) = (wo.reflected(facet), wo.dot(facet));
                            let pdf = m.distribution.visible_density(wo, facet) / (4.0 * cos);
                            (cos > 0.0 && wi.z < 0.0).then_some(Sample {
                                wi,
                                weight: Spectrum::from(1.0),
                                pdf,
                                lobe: Lobe::GLOSSY_REFLECTION,
                            })
                        })
                    })
                    .made()
            },
        )
        .equivalent(&[(Cause::Support, "directions below the horizon are returned, which is all that shows")])
        .source("bevy solari, bevy#23442")
        .varied(&[("alpha", 0.3, 0.8)])
        // What falls below the horizon is flagged as reflection.
        .must_fail(&[
            "goodness-of-fit",
            "normalization",
            "support",
            "albedo",
            "mis",
            "discrete-lobes",
            "jacobian",
        ]),
    ]
}
