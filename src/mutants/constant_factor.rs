//! A constant factor in pdf or in f.

use super::altered::{Altered, R};
use super::mutant::Mutant;
use crate::bsdf::Bsdf;
use crate::models::microfacet::TorranceSparrow;

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "pdf-scaled",
            "torrance-sparrow:alpha=0.3",
            "pdf() is too large by the factor 1 + ε",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(move |m, wo, wi| m.pdf(wo, wi, R) * (1.0 + e))
                    .made()
            },
        )
        .source("C01: any constant")
        .strength(0.02, 1.0, "pdf is 1 + epsilon times too large")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "jacobian"])
        // The balance heuristic hides most of a constant.
        .may_fail(&["mis"]),
    ]
}
