//! Negative controls: correct code that looks wrong.

use super::altered::Altered;
use super::mutant::Mutant;
use crate::bsdf::Bsdf;
use crate::models::microfacet::TorranceSparrow;

pub(super) fn controls() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "reversed-u",
            "torrance-sparrow:alpha=0.3",
            "sample() uses 1 − u in place of u",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .draw(|m, wo, u| {
                        let reversed: Vec<f64> = u.iter().map(|u| 1.0 - f64::EPSILON / 2.0 - u).collect();
                        let s = m.sample(wo, &reversed, super::altered::R)?;
                        Some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("C26-03 pbrt-v3@3123d85: a sign that comes to u → 1 − u"),
    ]
}
