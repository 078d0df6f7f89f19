//! A density in (θ, φ), area or projected solid angle.

use super::altered::{Altered, half};
use super::mutant::Mutant;
use crate::bsdf::{Direction, Lobe};
use crate::cause::Cause;
use crate::models::microfacet::TorranceSparrow;
use crate::models::{EonSampling, HemisphereSampling, Lambert, OrenNayarEon, Phong};
use std::f64::consts::TAU;

/// What must see that a pdf is another one by a factor that depends on wi.
const ALL: &[&str] = &["goodness-of-fit", "normalization", "albedo", "mis", "jacobian"];

/// The same of one whose integral is right.
const BUT_MASS: &[&str] = &["goodness-of-fit", "albedo", "mis", "jacobian"];

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "pdf-of-half-vector-angle",
            "torrance-sparrow:sampling=normals,alpha=0.3",
            "pdf() has the density of θh where that per steradian must be: 2π sin θh too much",
            |p, _| {
                Altered::of(TorranceSparrow::declared(p)?)
                    .pdf_times(|_, wo, wi| {
                        let h = half(wo, wi);
                        TAU * h.x.hypot(h.y)
                    })
                    .made()
            },
        )
        .source("computergraphics.SE 7460")
        .varied(&[("alpha", 0.05, 0.8)])
        .must_fail(ALL),
        Mutant::new(
            "cosine-said-uniform",
            "lambert",
            "sample() draws by the cosine, pdf() is 1/2π",
            |p, _| {
                let correct = Lambert::declared(p)?;
                Altered::of(correct)
                    .pdf_of(Lambert { sampling: HemisphereSampling::Uniform, ..correct })
                    .made()
            },
        )
        .source("raytracing.github.io#933")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(BUT_MASS),
        // Of a smooth one (roughness 0) every weight is ρ, and the albedo exact.
        Mutant::new(
            "uniform-said-cosine",
            "oren-nayar-eon:sampling=uniform",
            "sample() draws evenly, pdf() is cos θi/π",
            |p, _| {
                let said =
                    OrenNayarEon::new(p.number("reflectance"), p.number("roughness"), EonSampling::Cosine);
                Altered::of(OrenNayarEon::declared(p)?).pdf_of(said).made()
            },
        )
        .source("raytracing.github.io#933, the other way round")
        .varied(&[("reflectance", 0.2, 1.0), ("roughness", 0.3, 1.0)])
        .must_fail(BUT_MASS),
        Mutant::new(
            "pdf-per-projected-solid-angle",
            "oren-nayar-eon:sampling=cosine",
            "pdf() is per projected solid angle: cos θi too little",
            |p, _| Altered::of(OrenNayarEon::declared(p)?).pdf_times(|_, _, wi| 1.0 / wi.z).made(),
        )
        .source("projected solid angle")
        .varied(&[("reflectance", 0.2, 1.0), ("roughness", 0.0, 1.0)])
        .must_fail(ALL),
        Mutant::new(
            "pdf-projected-twice",
            "phong:kd=0,ks=0.9,exponent=8",
            "pdf() has a cosine θi too much",
            |p, _| Altered::of(Phong::declared(p)?).pdf_times(|_, _, wi| wi.z).made(),
        )
        .source("projected solid angle")
        .varied(&[("exponent", 1.0, 50.0)])
        .must_fail(ALL),
        // The albedo is exact whatever is drawn, since every weight is ρ.
        Mutant::new(
            "cosine-sampler-doubled",
            "lambert",
            "sample() takes 2 cos φ √u and 2 sin φ √u for the tangents, and makes that a unit vector",
            |p, _| {
                Altered::of(Lambert::declared(p)?)
                    .draw(|_, wo, u| {
                        let r = 2.0 * u[0].sqrt();
                        let (sin, cos) = (TAU * u[1]).sin_cos();
                        let wi = Direction::new(r * cos, r * sin, (1.0 - u[0]).sqrt()).normalized();
                        (wo.z > 0.0).then_some((wi, Lobe::DIFFUSE_REFLECTION))
                    })
                    .made()
            },
        )
        .equivalent(&[(Cause::WrongDensity, "a wrong map draws another density, whatever the mistake in it")])
        .source("TheRestOfYourLife#9")
        .varied(&[("reflectance", 0.2, 1.0)])
        .must_fail(&["goodness-of-fit", "jacobian"]),
    ]
}
