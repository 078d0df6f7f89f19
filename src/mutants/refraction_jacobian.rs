//! The Jacobian of refraction, and its η².

use super::altered::Altered;
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction};
use crate::models::microfacet::RoughDielectric;
use crate::models::microfacet::half_vector::{Refracting, of_refraction};
use crate::models::{Plastic, fresnel};

/// What a wrong density of one lobe breaks: where it is too small, also the lower
/// bound that the sampler's derivative gives.
const DENSITY: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"];

/// What remains of it where the density is nowhere too small.
const TOO_LARGE: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis"];

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "eta-squared-in-pdf",
            "rough-dielectric:alpha=0.4",
            "pdf() of what is refracted has the factor η² once too often",
            |p, e| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf_times(move |m, wo, wi| match refracting(m, wo, wi) {
                        Some((_, eta)) => eta.powf(2.0 * e),
                        None => 1.0,
                    })
                    .made()
            },
        )
        .source("student Nori rough dielectric")
        .strength(1.0, 1.0, "exponent of the spurious η²")
        .varied(&[("alpha", 0.1, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(DENSITY),
        Mutant::new(
            "no-eta-squared-in-pdf",
            "rough-dielectric:alpha=0.2,distribution=beckmann,eta=2",
            "pdf() of what is refracted lacks the factor η² of |dωm/dωi|",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf_times(|m, wo, wi| match refracting(m, wo, wi) {
                        Some((_, eta)) => 1.0 / (eta * eta),
                        None => 1.0,
                    })
                    .made()
            },
        )
        .source("pbrt-v4@dfa11074, pbrt-v4#30")
        .varied(&[("alpha", 0.05, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(DENSITY),
        Mutant::new(
            "reflection-jacobian-for-refraction",
            "rough-dielectric:alpha=0.3,alpha_y=0.5",
            "pdf() of what is refracted has the Jacobian of reflection, 1/(4 wo·h)",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf_times(|m, wo, wi| match refracting(m, wo, wi) {
                        Some((facet, eta)) => 0.25 / facet.cos_o / jacobian(&facet, eta),
                        None => 1.0,
                    })
                    .made()
            },
        )
        .source("the Jacobian of reflection on what is transmitted")
        .varied(&[("alpha", 0.1, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(DENSITY),
        Mutant::new(
            "no-facet-cosine-in-refraction-jacobian",
            "rough-dielectric:alpha=0.5,eta=1.7",
            "pdf() of what is refracted lacks the factor |wi·h| of |dωm/dωi|",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf_times(|m, wo, wi| match refracting(m, wo, wi) {
                        Some((facet, _)) => 1.0 / facet.cos_i,
                        None => 1.0,
                    })
                    .made()
            },
        )
        .source("a factor of the Jacobian forgotten")
        .varied(&[("alpha", 0.2, 0.8), ("eta", 1.2, 2.5)])
        .must_fail(TOO_LARGE),
        Mutant::new(
            "coat-without-change-of-direction",
            "plastic:eta=1.8",
            "the base is drawn below the coat, and pdf() is not changed on the way out",
            |p, _| {
                let eta = p.number("eta");
                Altered::of(Plastic::declared(p)?)
                    // cos θt/π; of what is drawn it is cos θi/(π η²).
                    .pdf_times(move |_, _, wi| below(wi, eta) / wi.z)
                    .draw(move |m, wo, u| {
                        let s = m.sample(wo, u, super::altered::R)?;
                        let wi = if s.lobe.is_discrete() { s.wi } else { out_of_coat(s.wi, eta)? };
                        Some((wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("Tungsten@2d95bdd smooth coat")
        .varied(&[("eta", 1.2, 2.5), ("reflectance", 0.2, 0.9)])
        .must_fail(TOO_LARGE),
    ]
}

/// The facet that refracts `wi` to `wo`, as seen from wo's side, and the index of the
/// far over the near side.
fn refracting(m: &RoughDielectric, wo: Direction, wi: Direction) -> Option<(Refracting, f64)> {
    let eta = m.relative_eta(wo);
    Some((of_refraction(m.upright(wo, wo), m.upright(wo, wi), eta)?, eta))
}

/// |dωm/dωi| (Walter et al. 2007, eq. 17).
fn jacobian(facet: &Refracting, eta: f64) -> f64 {
    let stretch = eta / facet.length;
    facet.cos_i * stretch * stretch
}

/// The cosine below a smooth coat of a direction above.
fn below(w: Direction, eta: f64) -> f64 {
    fresnel::refracted_cosine(w.z, eta).unwrap_or(0.0)
}

/// The direction above a smooth coat of one that goes up below it.
fn out_of_coat(w: Direction, eta: f64) -> Option<Direction> {
    let cos = fresnel::refracted_cosine(w.z, 1.0 / eta).filter(|cos| *cos > 0.0)?;
    Some(Direction::new(w.x * eta, w.y * eta, cos))
}
