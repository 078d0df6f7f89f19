//! The horizon, the side and the support.
//!
//! Samples at pdf = 0 are `support`'s alone: weights and returned densities are not
//! compared with 0.

use super::altered::{Altered, R, half};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Direction, Lobe, Sample, Spectrum};
use crate::models::microfacet::{RoughDielectric, TorranceSparrow};
use crate::models::{Lambert, fresnel};
use std::f64::consts::TAU;

/// What mass that is never drawn from breaks.
const PHANTOM: &[&str] = &["goodness-of-fit", "normalization", "support"];

pub(super) fn mutants() -> Vec<Mutant> {
    let mut all = of_densities();
    all.extend(of_samples());
    all.extend(of_values());
    all
}

/// pdf where nothing is drawn. There is no light, so the means hold.
fn of_densities() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "no-side-test-in-glass-pdf",
            "rough-dielectric:alpha=0.4",
            "pdf() does not ask on which sides of the facet wo and wi are",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf(|m, wo, wi| match m.pdf(wo, wi, R) {
                        0.0 if !wo.same_side(wi) => through_any_facet(m, wo, wi),
                        pdf => pdf,
                    })
                    .made()
            },
        )
        .source("pbrt-v3@9629f11, Mitsuba 3@0a7a0410a")
        .varied(&[("alpha", 0.3, 0.8), ("eta", 1.3, 2.0)])
        .must_fail(PHANTOM),
        Mutant::new(
            "pdf-below-the-horizon",
            "torrance-sparrow:alpha=0.5,distribution=beckmann",
            "pdf() is positive below the horizon too",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(move |m, wo, wi| m.pdf(wo, wi, R) + e * m.pdf(wo, wi.flipped(), R))
                    .made()
            },
        )
        .source("tungsten@d008dc6, students: a horizon test in eval() alone")
        .strength(0.05, 1.0, "mass of pdf below the horizon over that above")
        .varied(&[("alpha", 0.05, 0.9)])
        .must_fail(PHANTOM),
        Mutant::new(
            "phantom-ring",
            "torrance-sparrow:alpha=0.1,distribution=beckmann",
            "pdf() has a ring 60° off the mirror direction that is never drawn",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf(move |m, wo, wi| {
                        let lit = wo.z > 0.0 && wi.z > 0.0;
                        m.pdf(wo, wi, R) + if lit { e * ring(wi.dot(wo.mirrored())) } else { 0.0 }
                    })
                    .made()
            },
        )
        .source("phantom mass")
        .strength(0.05, 0.5, "mass of the ring, where all of it is above the horizon")
        .varied(&[("alpha", 0.02, 0.15)])
        .must_fail(PHANTOM),
    ]
}

/// Samples where there is no pdf, or light is not claimed.
fn of_samples() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "stray-samples",
            "torrance-sparrow:alpha=0.1",
            "some samples fall below the horizon, where pdf() is 0",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .described(|d| d.dimensions(3))
                    .finish(move |_, _, u, s| {
                        let wi = if u[2] < e { s.wi.flipped() } else { s.wi };
                        Some(Sample { wi, ..s })
                    })
                    .made()
            },
        )
        .source("tungsten@d008dc6")
        .strength(1e-3, 0.1, "share of the samples that fall below the horizon")
        .varied(&[("alpha", 0.05, 0.8)])
        // They keep the flag of reflection.
        .must_fail(&["support", "discrete-lobes"])
        // So few are hardly missed above the horizon.
        .may_fail(&["goodness-of-fit", "mis"]),
        Mutant::new(
            "dead-horizon-check",
            "torrance-sparrow:alpha=0.5",
            "the cosine is cut at 0 before sample() asks whether it is negative",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .sample(|m, wo, u, t| {
                        m.sample(wo, u, t).or_else(|| {
                            let h = m.distribution.sample_visible(wo, u).filter(|_| wo.z > 0.0)?;
                            let (wi, weight) = (wo.reflected(h), Spectrum::zero(m.channels()));
                            let pdf = by_facet(m, wo, h);
                            let lobe = Lobe::GLOSSY_REFLECTION;
                            (wi.z < 0.0).then_some(Sample { wi, weight, pdf, lobe })
                        })
                    })
                    .made()
            },
        )
        .source("cycles@6b8f4518a, bevy#23442")
        .varied(&[("alpha", 0.3, 0.9)])
        .shows_at(&[60.0, 75.0])
        // The weight is rightly 0 there, and the means hold.
        .must_fail(&["support", "goodness-of-fit", "normalization", "jacobian"]),
        Mutant::new(
            "facet-side-for-horizon",
            "torrance-sparrow:alpha=0.5",
            "all functions test wi·h where they must test n·wi",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(|m, wo, wi, t| {
                        if wo.z <= 0.0 || wi.z >= 0.0 {
                            return m.eval(wo, wi, t);
                        }
                        let h = half(wo, wi);
                        // G1(wi)/|cos θi|, as above the horizon.
                        let seen = 1.0 / (m.distribution.backfacing_area(wi.flipped()) - wi.z);
                        m.reflected(wo.dot(h), by_facet(m, wo, h) * seen)
                    })
                    .pdf(|m, wo, wi| {
                        let below = wo.z > 0.0 && wi.z < 0.0;
                        if below { by_facet(m, wo, half(wo, wi)) } else { m.pdf(wo, wi, R) }
                    })
                    .draw(|m, wo, u| {
                        let h = m.distribution.sample_visible(wo, u).filter(|_| wo.z > 0.0)?;
                        Some((wo.reflected(h), Lobe::GLOSSY_REFLECTION))
                    })
                    .made()
            },
        )
        .source("student CS184")
        .varied(&[("alpha", 0.3, 0.9)])
        .shows_at(&[75.0])
        // The functions agree, on a side to which no light is claimed to leave, and from
        // which none comes back; and what is drawn there is flagged as reflection.
        .must_fail(&["support", "reciprocity", "discrete-lobes"]),
    ]
}

/// f where sampling does not go.
fn of_values() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "no-horizon-test-in-eval",
            "torrance-sparrow:alpha=0.3",
            "eval() takes |cos θ| of both directions and tests neither",
            |p, _| {
                let up = |w: Direction| Direction::new(w.x, w.y, w.z.abs());
                Altered::of(TorranceSparrow::declared(p)?)
                    .eval(move |m, wo, wi, t| m.eval(up(wo), up(wi), t))
                    .made()
            },
        )
        .source("student CS184: no hemisphere test in f")
        .varied(&[("alpha", 0.05, 0.5)])
        // Neither strategy of `mis` goes there.
        .must_fail(&["support", "albedo", "mis", "energy"]),
        Mutant::new(
            "light-leak-behind",
            "lambert:reflectance=1",
            "eval() is positive on the back side too",
            |p, e| {
                Altered::of(Lambert::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let behind = m.eval(wo, wi.flipped(), t);
                        m.eval(wo, wi, t).map(|f| f + e * behind[0])
                    })
                    .made()
            },
        )
        .source("Mitsuba 3@eb3338383 measured")
        .strength(0.05, 1.0, "light behind over that before the surface")
        .must_fail(&["support", "albedo", "mis", "energy", "white-furnace"]),
        Mutant::new(
            "transmission-not-sampled",
            "rough-dielectric",
            "transmission is disabled in sample() and pdf(), and not in eval()",
            |p, _| {
                Altered::of(RoughDielectric::declared(p)?)
                    .pdf_times(|_, wo, wi| f64::from(wo.same_side(wi)))
                    .made()
            },
        )
        .source("Mitsuba 3@2183dd7b1")
        .varied(&[("alpha", 0.05, 0.8), ("eta", 1.2, 2.5)])
        // The cosine of `mis` finds what the sampler leaves out.
        .must_fail(&["support", "albedo"]),
    ]
}

/// A density that is 0 but where the cosine with a direction is 1/2 to 0.05.
fn ring(cos: f64) -> f64 {
    const WIDTH: f64 = 0.05;
    let x = ((cos - 0.5) / WIDTH).abs().min(1.0);
    // ∫(1 − x²)² = 16/15.
    15.0 / (16.0 * WIDTH * TAU) * (1.0 - x * x).powi(2)
}

/// Density of what a visible facet with normal `h` reflects, on whichever side of the
/// horizon: D/(4 (cos θo + Λ cos θo)).
fn by_facet(m: &TorranceSparrow, wo: Direction, h: Direction) -> f64 {
    0.25 * m.distribution.density(h) / (wo.z + m.distribution.backfacing_area(wo))
}

/// The density of transmission by the formula, whether or not the facet has wo and wi
/// on its two sides.
fn through_any_facet(m: &RoughDielectric, wo: Direction, wi: Direction) -> f64 {
    let (eta, wo, wi) = (m.relative_eta(wo), m.upright(wo, wo), m.upright(wo, wi));
    let sum = wo + wi * eta;
    let h = sum * (1f64.copysign(sum.z) / sum.length());
    let (cos_o, cos_i) = (wo.dot(h).abs(), wi.dot(h).abs());
    let through = 1.0 - fresnel::dielectric(cos_o.min(1.0), eta);
    let spread = cos_o * cos_i * eta * eta / sum.dot(sum);
    m.distribution.density(h) * through * spread / (wo.z + m.distribution.backfacing_area(wo))
}
