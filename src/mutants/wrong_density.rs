//! The sampler draws another density.

use super::altered::{Altered, R};
use super::altered_parts::AlteredNormals;
use super::mutant::Mutant;
use super::siblings::{draws_of, with_alpha, with_alpha_times};
use crate::bsdf::{Bsdf, Direction, Lobe};
use crate::models::microfacet::{Distribution, Roughness, TorranceSparrow};
use crate::models::{Lambert, Phong};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub(super) fn mutants() -> Vec<Mutant> {
    [roughness(), reflections(), warps()].concat()
}

/// Another roughness or exponent is drawn.
fn roughness() -> Vec<Mutant> {
    vec![
        Mutant::new("pdf-alpha", "torrance-sparrow:alpha=0.1", "pdf() takes α (1 + ε) for α", |p, e| {
            let m = TorranceSparrow::declared(p)?;
            let rougher = with_alpha_times(&m, 1.0 + e);
            Altered::of(m).pdf_of(rougher).made()
        })
        .source("Cycles hair: a width in sample(), another in pdf()")
        .strength(0.1, 1.0, "alpha is 1 + epsilon times too large in pdf")
        .varied(&[("alpha", 0.02, 0.5)])
        .must_fail(&["goodness-of-fit", "jacobian"])
        // Of second order in ε: f cos θi is nearly proportional to pdf; and masses
        // differ by what is below the horizon.
        .may_fail(&["normalization", "albedo", "mis"]),
        Mutant::new(
            "alpha-squared",
            "torrance-sparrow:alpha=0.5,sampling=normals",
            "sample() draws with α² in place of α",
            |p, _| {
                let m = TorranceSparrow::declared(p)?;
                let Roughness { x, y } = m.distribution.alpha();
                let smoother = with_alpha(&m, Roughness { x: x * x, y: y * y });
                Altered::of(m).draw(draws_of(smoother)).made()
            },
        )
        .source("our own: two meanings of roughness")
        .varied(&[("alpha", 0.3, 0.7)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
        Mutant::new(
            "anisotropic-drawn-round",
            "torrance-sparrow:distribution=beckmann,alpha=0.6,alpha_y=0.15",
            "sample() draws with αx along both tangents",
            |p, _| {
                let m = TorranceSparrow::declared(p)?;
                let round = with_alpha(&m, Roughness::isotropic(m.distribution.alpha().x));
                Altered::of(m).draw(draws_of(round)).made()
            },
        )
        .source("Cycles")
        .varied(&[("alpha", 0.4, 0.8), ("alpha_y", 0.1, 0.2)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
        Mutant::new(
            "axes-exchanged",
            "normals:alpha=0.6,alpha_y=0.15",
            "normals are drawn with αx and αy exchanged",
            |p, _| {
                AlteredNormals::declared(p)?
                    .draw(|m, u| {
                        let Roughness { x, y } = m.distribution.alpha();
                        Distribution::ggx(Roughness { x: y, y: x }).sample(u)
                    })
                    .made(p)
            },
        )
        .source("our own: two axes exchanged")
        .varied(&[("alpha", 0.4, 0.8), ("alpha_y", 0.05, 0.2)])
        // Every normal is drawn, with the weight 1.
        .must_fail(&["goodness-of-fit", "jacobian"])
        // Along the rougher axis they are 100 times rarer than pdf says.
        .may_fail(&["support"]),
        Mutant::new(
            "phong-exponent",
            "phong:kd=0,ks=1,exponent=10",
            "sample() draws the (n + 2) of the value, pdf() is the (n + 1) of the density",
            |p, _| {
                let narrower = Phong::new(p.number("kd"), p.number("ks"), p.number("exponent") + 1.0)?;
                Altered::of(Phong::declared(p)?).draw(draws_of(narrower)).made()
            },
        )
        .source("our own: the exponents of value and density (Lafortune and Willems 1994) mixed up")
        .varied(&[("exponent", 3.0, 20.0)])
        .must_fail(&["goodness-of-fit", "jacobian"])
        // A narrow lobe hardly differs in its mean cosine and in what is below.
        .may_fail(&["normalization", "albedo", "mis"]),
    ]
}

/// Normals are right, and directions are not.
fn reflections() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "reflection-without-dot",
            "torrance-sparrow:alpha=0.5",
            "wi = 2 h − wo, not of unit length",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .draw(|m, wo, u| Some((m.facet(wo, u)? * 2.0 - wo, Lobe::GLOSSY_REFLECTION)))
                    .made()
            },
        )
        .source("student microfacet")
        .varied(&[("alpha", 0.1, 0.8)])
        // No sample is left, at the mirror of smooth surfaces neither.
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
            "half-vector-returned",
            "torrance-sparrow:alpha=0.5",
            "sample() returns the normal that it drew",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .draw(|m, wo, u| Some((m.facet(wo, u)?, Lobe::GLOSSY_REFLECTION)))
                    .made()
            },
        )
        .source("3 student solutions; OSL")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.2, 0.8)])
        .must_fail(&["goodness-of-fit", "normalization", "albedo", "mis", "jacobian", "sensitivity"])
        // Smooth surfaces have no normal where they reflect to.
        .may_fail(&["support"]),
        Mutant::new(
            "mirrored-share",
            "torrance-sparrow:alpha=0.1",
            "the share ε of the samples is mirrored, y → −y",
            |p, e| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .described(|d| d.dimensions(3))
                    .draw(move |m, wo, u| {
                        let s = m.sample(wo, u, R)?;
                        let y = if u[2] < e { -s.wi.y } else { s.wi.y };
                        Some((Direction::new(s.wi.x, y, s.wi.z), s.lobe))
                    })
                    .made()
            },
        )
        .source("our own: a symmetry taken for granted")
        .strength(0.05, 1.0, "share of the samples that is mirrored")
        .varied(&[("alpha", 0.02, 0.2)])
        // Weights depend on both heights only, so that albedo holds.
        .must_fail(&["goodness-of-fit", "mis"])
        // Of a branch with a share of 5 % it is sure of half.
        .may_fail(&["jacobian"]),
    ]
}

/// Lambert's reflector drawn by warps that are not of its density. Its weight is
/// constant: albedo and multiple importance sampling are exact whatever is drawn.
fn warps() -> Vec<Mutant> {
    vec![
        Mutant::new("polar-without-root", "lambert:reflectance=1", "r = u in place of √u", |p, _| {
            Altered::of(Lambert::declared(p)?)
                .draw(|_, _, u| polar(u[0], (1.0 - u[0] * u[0]).sqrt(), u[1]))
                .made()
        })
        .source("our own: a warp that looks right")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(&["goodness-of-fit", "jacobian"]),
        Mutant::new("polar-angle-uniform", "lambert:reflectance=1", "θ = π u/2", |p, _| {
            Altered::of(Lambert::declared(p)?)
                .draw(|_, _, u| {
                    let (sin, cos) = (FRAC_PI_2 * u[0]).sin_cos();
                    polar(sin, cos, u[1])
                })
                .made()
        })
        .source("our own: a warp that looks right")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(&["goodness-of-fit", "jacobian"]),
        Mutant::new(
            "arcsine-of-pi-u",
            "lambert:reflectance=1",
            "θ = asin(π u), NaN from u = 1/π",
            |p, _| {
                Altered::of(Lambert::declared(p)?)
                    .draw(|_, _, u| {
                        let (sin, cos) = (PI * u[0]).asin().sin_cos();
                        polar(sin, cos, u[1])
                    })
                    .made()
            },
        )
        .source("student Lambert")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(&["sanity", "goodness-of-fit", "normalization", "albedo", "mis", "jacobian"]),
        Mutant::new(
            "cube-normalised",
            "lambert:reflectance=1",
            "a point of the upper half of a cube, normalised",
            |p, _| {
                Altered::of(Lambert::declared(p)?)
                    .described(|d| d.dimensions(3))
                    .draw(|_, _, u| {
                        let point = Direction::new(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0, u[2]);
                        Some((point.normalized(), Lobe::DIFFUSE_REFLECTION))
                    })
                    .made()
            },
        )
        .source("our own: a warp that looks right")
        .varied(&[("reflectance", 0.2, 1.0)])
        // wi moves with three numbers, which have no Jacobian. The centre of the cube
        // has no direction.
        .must_fail(&["goodness-of-fit", "sanity"]),
    ]
}

/// A direction by the sine and cosine of its polar angle, and its azimuth in turns.
fn polar(sin: f64, cos: f64, azimuth: f64) -> Option<(Direction, Lobe)> {
    let (y, x) = (TAU * azimuth).sin_cos();
    Some((Direction::new(sin * x, sin * y, cos), Lobe::DIFFUSE_REFLECTION))
}
