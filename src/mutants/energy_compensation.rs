//! Energy that is lost between facets and given back, and mixing that is not linear.

use super::altered::{Altered, half};
use super::mutant::Mutant;
use crate::bsdf::{self, Bsdf, Direction, Spectrum};
use crate::models::microfacet::{
    Distribution, Fresnel, GgxMultiscatter, Masking, NormalSampling, RoughPlastic, Roughness, TorranceSparrow,
};
use crate::models::{OrenNayarEon, Plastic};
use crate::registry::Parameters;
use std::sync::Arc;

/// GGX whose lobe of many bounces is F_ms/(π (1 − E_avg)) times `losses`, in place
/// of (1 − E(μo)) (1 − E(μi)).
pub(super) fn with_losses(
    p: &Parameters,
    losses: impl Fn(&GgxMultiscatter, Direction, Direction) -> f64 + Send + Sync + 'static,
) -> Result<Arc<dyn bsdf::Subject>, String> {
    Altered::of(GgxMultiscatter::declared(p)?)
        .eval(move |m, wo, wi, t| {
            let single = m.single.eval(wo, wi, t);
            if wo.z <= 0.0 || wi.z <= 0.0 {
                return single;
            }
            let losses = losses(m, wo, wi);
            Spectrum::from_fn(single.len(), |c| single[c] + m.scale[c] * losses)
        })
        .made()
}

/// (1 − E(μo)) (1 − E(μi)), as it is right.
fn both(m: &GgxMultiscatter, wo: Direction, wi: Direction) -> f64 {
    m.loss.at(wo.z.min(1.0)) * m.loss.at(wi.z.min(1.0))
}

pub(super) fn mutants() -> Vec<Mutant> {
    [facets(), others()].concat()
}

fn facets() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "loss-at-half-angle",
            "ggx-multiscatter:alpha=0.8",
            "the loss is looked up at the angle to the half vector",
            |p, _| with_losses(p, |m, wo, wi| m.loss.at(half(wo, wi).dot(wo).min(1.0)).powi(2)),
        )
        .source("Cycles c47b3fb08: E of the wrong angle")
        .varied(&[("alpha", 0.3, 1.0)])
        .must_fail(&["white-furnace"])
        // Where that angle's loss is the larger one.
        .may_fail(&["energy"]),
        Mutant::new(
            "loss-of-incident-twice",
            "ggx-multiscatter:alpha=0.8",
            "the loss is looked up at wi where wo is meant",
            |p, _| with_losses(p, |m, _, wi| m.loss.at(wi.z.min(1.0)).powi(2)),
        )
        .source("Cycles c47b3fb08: E of the reflected direction")
        .varied(&[("alpha", 0.3, 1.0)])
        .must_fail(&["white-furnace", "reciprocity"])
        .may_fail(&["energy"]),
        Mutant::new(
            "divided-by-the-kept",
            "ggx-multiscatter:alpha=0.8",
            "the lobe of many bounces is divided by E_avg where 1 − E_avg is meant",
            |p, _| {
                with_losses(p, |m, wo, wi| {
                    let lost = m.loss.average();
                    both(m, wo, wi) * lost / (1.0 - lost)
                })
            },
        )
        .source("OSPRay 711bcc1c1: E_avg for 1 − E_avg")
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(&["white-furnace"]),
        // At F = 1 both forms are 1.
        Mutant::new(
            "averages-exchanged",
            "ggx-multiscatter:alpha=0.8,fresnel=schlick,f0=0.5",
            "F_ms has E_avg and 1 − E_avg in each other's place",
            |p, _| {
                // 2∫F μ dμ of Schlick's F.
                let f = p.number("f0") + (1.0 - p.number("f0")) / 21.0;
                with_losses(p, move |m, wo, wi| {
                    let lost = m.loss.average();
                    let right = f * f * (1.0 - lost) / (1.0 - f * lost);
                    both(m, wo, wi) * f * lost / (1.0 - f * (1.0 - lost)) / right
                })
            },
        )
        .source("OSPRay 711bcc1c1")
        .varied(&[("alpha", 0.3, 0.9), ("f0", 0.1, 0.8)])
        .must_fail(&["reference"])
        .compared(),
    ]
}

fn others() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "bounces-left-out",
            "oren-nayar-eon:reflectance=1,roughness=1",
            "a share ε of the light of many bounces is left out",
            |p, e| {
                Altered::of(OrenNayarEon::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let all = m.eval(wo, wi, t);
                        let lit = wo.z > 0.0 && wi.z > 0.0;
                        let lost = |w: Direction| m.lost(w.z.min(1.0));
                        let out = if lit { e * m.multiple * lost(wo) * lost(wi) } else { 0.0 };
                        all.map(|f| (f - out).max(0.0))
                    })
                    .made()
            },
        )
        .source("three-gpu-pathtracer#348: the furnace is not white")
        .strength(1.0, 1.0, "share of the light of many bounces that is left out")
        .varied(&[("roughness", 0.3, 1.0)])
        .must_fail(&["white-furnace"]),
        // As on the slides that Hill corrected in 2018.
        Mutant::new(
            "bounce-not-counted",
            "oren-nayar-eon:reflectance=0.5,roughness=1",
            "light of many bounces is reflected once less than it bounces",
            |p, _| {
                let reflectance = p.number("reflectance");
                Altered::of(OrenNayarEon::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let mut other = *m;
                        other.multiple /= reflectance;
                        other.eval(wo, wi, t)
                    })
                    .made()
            },
        )
        .source("Kulla and Conty 2017, slides: F_avg once too few (Hill 2018)")
        .varied(&[("roughness", 0.3, 1.0), ("reflectance", 0.2, 0.8)])
        .must_fail(&["reference"])
        .compared(),
        Mutant::new(
            "smooth-transmittance",
            "rough-plastic:reflectance=1,alpha=0.6",
            "the base gets 1 − F of a smooth coat under a rough one",
            |p, _| {
                let smooth = Plastic::declared(p)?;
                Altered::of(RoughPlastic::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        Spectrum::from(m.coat.eval(wo, wi, t)[0] + smooth.eval(wo, wi, t)[0])
                    })
                    .made()
            },
        )
        .source("Mitsuba 3 roughplastic 62a0295e8: T = 1 − R")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.3, 1.0)])
        .must_fail(&["white-furnace"]),
        Mutant::new(
            "mixed-parameters",
            "blend:first=(torrance-sparrow:alpha=0.1),second=(torrance-sparrow:alpha=0.5)",
            "a mixture of two lobes is one lobe of the mean roughness",
            |p, _| {
                let alpha = 0.1 + p.number("weight") * (0.5 - 0.1);
                let distribution = Distribution::ggx(Roughness::isotropic(alpha));
                let sampling = NormalSampling::Visible;
                let mean = TorranceSparrow::new(distribution, Masking::Smith, Fresnel::None, sampling)?;
                Ok(Arc::new(mean))
            },
        )
        .source("Cycles cba09d961: closures merged")
        .varied(&[("weight", 0.2, 0.8)])
        .must_fail(&["reference"])
        .compared(),
    ]
}
