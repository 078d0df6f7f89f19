//! Samples redrawn or mirrored without dividing the pdf.

use super::altered::{Altered, R, g2};
use super::mutant::Mutant;
use crate::bsdf::{Bsdf, Lobe};
use crate::cause::Cause;
use crate::models::microfacet::TorranceSparrow;
use crate::models::{OrenNayar, Phong};

/// How often a draw below the horizon is repeated at most: of 10 % below, all but
/// 1e-7 come through.
const TRIES: usize = 7;

/// What must see that S is not Z.
const ALL: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis"];

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "redrawn-below-horizon",
            "torrance-sparrow:alpha=0.6",
            "sample() draws again what falls below the horizon",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .described(|d| d.dimensions(3 * TRIES + 1))
                    .draw(move |m, wo, u| {
                        let (tries, rest) = u.split_at(3 * TRIES);
                        let tries = if rest[0] < e { tries } else { &tries[..3] };
                        let s = tries.chunks_exact(3).find_map(|u| m.sample(wo, u, R))?;
                        Some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("samples below the surface discarded and redrawn")
        .strength(1.0, 1.0, "share of the draws below the horizon that are repeated")
        .varied(&[("alpha", 0.3, 1.0)])
        .shows_at(&[60.0, 75.0])
        .must_fail(ALL),
        Mutant::new(
            "flipped-below-horizon",
            "torrance-sparrow:alpha=0.6,distribution=beckmann",
            "sample() mirrors up what falls below the horizon",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .described(|d| d.dimensions(3))
                    .draw(move |m, wo, u| {
                        let facet = m.facet(wo, u).filter(|f| wo.z > 0.0 && wo.dot(*f) > 0.0)?;
                        let wi = wo.reflected(facet);
                        let wi = if wi.z < 0.0 && u[2] < e { wi.flipped() } else { wi };
                        Some((wi, Lobe::GLOSSY_REFLECTION))
                    })
                    .made()
            },
        )
        .source("flip below the horizon")
        .strength(1.0, 1.0, "share of the draws below the horizon that are mirrored")
        .varied(&[("alpha", 0.3, 1.0)])
        .shows_at(&[60.0, 75.0])
        .must_fail(ALL)
        // Where the mirrored branch alone is denser than pdf.
        .may_fail(&["jacobian"]),
        Mutant::new(
            "shadowed-samples-rejected",
            "torrance-sparrow:alpha=0.5",
            "sample() keeps a draw with probability G2/G1(wo), which pdf() knows nothing of",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .described(|d| d.dimensions(3))
                    .draw(|m, wo, u| {
                        let s = m.sample(wo, u, R)?;
                        let seen = g2(&m.distribution, wo, s.wi) / m.distribution.g1(wo);
                        (u[2] < seen).then_some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("Cycles, cycles@9c5ccfab9: valid samples rejected")
        .varied(&[("alpha", 0.3, 1.0)])
        .must_fail(ALL),
        // Nothing is left to sample, and all of pdf is where no sample falls.
        Mutant::new(
            "flip-inverted",
            "oren-nayar",
            "sample() mirrors to the other side what it has drawn on the right one",
            |p, _| {
                Altered::of(OrenNayar::declared(p)?)
                    .draw(|m, wo, u| {
                        let s = m.sample(wo, u, R)?;
                        Some((s.wi.flipped(), s.lobe))
                    })
                    .made()
            },
        )
        .equivalent(&[(
            Cause::Parameter,
            "nothing is drawn where pdf() is positive, as behind an inverted condition",
        )])
        .source("rs_pbrt Oren-Nayar, rs_pbrt@fb18bfc")
        .varied(&[("sigma", 0.0, 60.0), ("reflectance", 0.2, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "support"]),
        Mutant::new(
            "lobe-redrawn-below-horizon",
            "phong:exponent=8",
            "sample() draws the lobe again where that falls below the horizon",
            |p, _| {
                Altered::of(Phong::declared(p)?)
                    .described(|d| d.dimensions(2 * TRIES))
                    .draw(|m, wo, u| {
                        let [diffuse, lobe] = m.shares;
                        let again = |u: &[f64]| m.sample(wo, &[diffuse + lobe * u[0], u[1]], R);
                        let s = m.sample(wo, u, R).or_else(|| u[2..].chunks_exact(2).find_map(again))?;
                        Some((s.wi, s.lobe))
                    })
                    .made()
            },
        )
        .source("samples below the surface discarded and redrawn, in one lobe of two")
        .varied(&[("exponent", 1.0, 20.0)])
        .shows_at(&[75.0])
        .must_fail(ALL),
    ]
}
