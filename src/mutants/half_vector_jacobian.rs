//! The Jacobian 1/(4 wo·h) of reflection about a half vector.

use super::altered::{Altered, R, half};
use super::mutant::Mutant;
use crate::bsdf::Bsdf;
use crate::models::microfacet::TorranceSparrow;

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new("no-jacobian", "torrance-sparrow:alpha=0.5", "pdf() lacks 1/(4 wo·h)", |p, _| {
            Altered::of(TorranceSparrow::declared(p)?)
                .pdf(|m, wo, wi| m.pdf(wo, wi, R) * 4.0 * wo.dot(half(wo, wi)))
                .made()
        })
        .source("C02-01 student Nori microfacet")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
    ]
}
