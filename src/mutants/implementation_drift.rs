//! The functions evaluate different models.

use super::altered::{Altered, half};
use super::mutant::Mutant;
use super::siblings::{draws_of, with_alpha, with_alpha_times};
use crate::bsdf::{Bsdf, Direction, Sample};
use crate::cause::Cause;
use crate::models::fresnel;
use crate::models::microfacet::{Roughness, TorranceSparrow};

/// GGX as it is often written, in f32, over what it is: 1 + (α² − 1) cos² cancels.
fn ggx_in_f32(m: &TorranceSparrow, normal: Direction) -> f64 {
    let alpha = m.distribution.alpha().x;
    let (cos, square) = (normal.z as f32, (alpha * alpha) as f32);
    let t = 1.0 + (square - 1.0) * cos * cos;
    f64::from(square / (std::f32::consts::PI * t * t)) / m.distribution.density(normal)
}

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "stale-normal",
            "torrance-sparrow:alpha=0.5,fresnel=dielectric",
            "sample() takes F at the normal of the surface, eval() at that of the facet",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .finish(|m, wo, _, s| {
                        let right = m.reflected(wo.dot(half(wo, s.wi)), 1.0)[0];
                        let weight = s.weight * (m.reflected(wo.z, 1.0)[0] / right);
                        Some(Sample { weight, ..s })
                    })
                    .made()
            },
        )
        .source("appleseed: F of a normal that is out of date")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.2, 0.8), ("eta", 1.3, 2.0)])
        .must_fail(&["weight", "albedo", "mis"]),
        Mutant::new(
            "schlick-in-sample",
            "torrance-sparrow:alpha=0.1,fresnel=dielectric",
            "sample() takes Schlick's approximation, eval() Fresnel's equations",
            |p, _| {
                let eta = p.number("eta");
                let f0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
                Altered::of(TorranceSparrow::declared(p)?)
                    .finish(move |m, wo, _, s| {
                        let cos = wo.dot(half(wo, s.wi)).min(1.0);
                        let weight = s.weight * (fresnel::schlick(cos, f0) / m.reflected(cos, 1.0)[0]);
                        Some(Sample { weight, ..s })
                    })
                    .made()
            },
        )
        .source("our own: two forms of F in one material")
        .shows_at(&[60.0])
        .varied(&[("alpha", 0.05, 0.3), ("eta", 1.4, 1.8)])
        .must_fail(&["weight", "albedo", "mis"]),
        Mutant::new(
            "alpha-clamped-in-sample",
            "torrance-sparrow:alpha=0.01",
            "sample() draws with at least α = 0.05, eval() and pdf() do not",
            |p, _| {
                let m = TorranceSparrow::declared(p)?;
                let Roughness { x, y } = m.distribution.alpha();
                let rough = with_alpha(&m, Roughness { x: x.max(0.05), y: y.max(0.05) });
                Altered::of(m).draw(draws_of(rough)).made()
            },
        )
        .equivalent(&[(Cause::WrongDensity, "sample() draws by another α, which is all that shows")])
        .source("Mitsuba 0.x: a least α, in one function")
        .varied(&[("alpha", 0.005, 0.02)])
        .must_fail(&["goodness-of-fit", "mis", "jacobian", "sensitivity"])
        // Weights are nearly equal everywhere, little is below the horizon, and at the peak
        // samples are (0.05/α)² times rarer than pdf says.
        .may_fail(&["normalization", "albedo", "support"]),
        Mutant::new(
            "pdf-in-f32",
            "torrance-sparrow:alpha=0.01",
            "pdf() evaluates D in f32, by the form that cancels",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|m, wo, wi| ggx_in_f32(m, half(wo, wi)))
                    .sample(|m, wo, u, transport| m.sample(wo, u, transport))
                    .made()
            },
        )
        .source("Cycles GGX D in f32")
        .varied(&[("alpha", 0.008, 0.03)])
        .must_fail(&["weight", "returned-pdf"])
        // Off by 0.15 % at places; masses of cells by less than is tolerated.
        .may_fail(&["jacobian"]),
        Mutant::new(
            "sample-alpha",
            "torrance-sparrow:alpha=0.3",
            "sample() is of α (1 + ε), pdf and weight that come with it too",
            |p, e| {
                let m = TorranceSparrow::declared(p)?;
                let rougher = with_alpha_times(&m, 1.0 + e);
                Altered::of(m).sample(move |_, wo, u, transport| rougher.sample(wo, u, transport)).made()
            },
        )
        .source("Selas: another roughness in sample()")
        .strength(0.1, 1.0, "alpha is 1 + epsilon times too large in sample")
        .varied(&[("alpha", 0.05, 0.5)])
        .must_fail(&["goodness-of-fit", "weight", "returned-pdf", "jacobian"])
        // What single scattering loses depends little on α.
        .may_fail(&["normalization", "albedo", "mis"]),
    ]
}
