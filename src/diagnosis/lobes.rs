//! The lobes of the models in which bugs are told apart by lobe.

use super::parts::Parts;
use super::textbook::{Lobe, Share};
use crate::bsdf::{self, Bsdf, Direction, Spectrum, Transport};
use crate::models::microfacet::{
    Fresnel, GgxMultiscatter, Masking, RoughDielectric, RoughPlastic, TorranceSparrow, half_vector,
};
use crate::models::{Dielectric, Disney, OrenNayarEon, Phong, Plastic};
use crate::registry::Parameters;
use std::f64::consts::PI;
use std::sync::Arc;

/// Parts and lobes of a model; no lobes where it is taken as a whole.
pub fn known(name: &str, p: &Parameters) -> (Parts, Vec<Lobe>) {
    let found = match name {
        "torrance-sparrow" => TorranceSparrow::declared(p).ok().map(facets),
        "rough-dielectric" => RoughDielectric::declared(p).ok().map(glass),
        "ggx-multiscatter" => GgxMultiscatter::declared(p).ok().map(multiscatter),
        "rough-plastic" => RoughPlastic::declared(p).ok().map(rough_plastic),
        "plastic" => Plastic::declared(p).ok().map(|m| plastic(m, p.number("eta"))),
        "phong" => Phong::declared(p).ok().map(phong),
        "oren-nayar-eon" => OrenNayarEon::declared(p).ok().map(eon),
        "disney" => Disney::declared(p).ok().map(disney),
        "dielectric" => {
            Dielectric::declared(p).ok().map(|m| (Parts { eta: Some(m.eta), ..Parts::default() }, Vec::new()))
        }
        _ => None,
    };
    found.unwrap_or_default()
}

/// Lobes that are not chosen before a direction is drawn.
pub fn share_of_one() -> Share {
    Box::new(|_| 1.0)
}

fn facets(m: TorranceSparrow) -> (Parts, Vec<Lobe>) {
    let eta = match m.fresnel {
        Fresnel::Dielectric(eta) => Some(eta),
        _ => None,
    };
    let parts =
        Parts { distribution: Some(m.distribution), masking: Some(m.masking), fresnel: Some(m.fresnel), eta };
    (parts, Vec::new())
}

fn glass(m: RoughDielectric) -> (Parts, Vec<Lobe>) {
    let parts = Parts {
        distribution: Some(m.distribution.clone()),
        masking: Some(Masking::Smith),
        fresnel: None,
        eta: Some(m.eta),
    };
    let side = |m: &RoughDielectric, name, same: bool, flags| {
        let (a, b) = (m.clone(), m.clone());
        let on = move |wo: Direction, wi: Direction| wo.same_side(wi) == same;
        Lobe {
            name,
            share: share_of_one(),
            density: Box::new(
                move |wo, wi| {
                    if on(wo, wi) { Bsdf::pdf(&a, wo, wi, Transport::Radiance) } else { 0.0 }
                },
            ),
            value: Box::new(
                move |wo, wi, t| {
                    if on(wo, wi) { Bsdf::eval(&b, wo, wi, t) } else { Spectrum::zero(1) }
                },
            ),
            flags: Some(flags),
        }
    };
    let lobes = vec![
        side(&m, "reflection", true, bsdf::Lobe::REFLECTION),
        side(&m, "transmission", false, bsdf::Lobe::TRANSMISSION),
    ];
    (parts, lobes)
}

fn multiscatter(m: GgxMultiscatter) -> (Parts, Vec<Lobe>) {
    let parts = Parts {
        distribution: Some(m.single.distribution.clone()),
        masking: Some(m.single.masking),
        fresnel: Some(m.single.fresnel),
        eta: None,
    };
    let m = Arc::new(m);
    let (a, b, c, d, e, f) = (m.clone(), m.clone(), m.clone(), m.clone(), m.clone(), m);
    let above = |wo: Direction, wi: Direction| wo.z > 0.0 && wi.z > 0.0;
    let single = Lobe {
        name: "the lobe of one bounce",
        share: Box::new(move |wo| 1.0 - a.share(wo)),
        density: Box::new(move |wo, wi| b.single.pdf(wo, wi, Transport::Radiance)),
        value: Box::new(move |wo, wi, t| c.single.eval(wo, wi, t)),
        flags: Some(bsdf::Lobe::GLOSSY),
    };
    let multiple = Lobe {
        name: "the lobe of many bounces",
        share: Box::new(move |wo| d.share(wo)),
        density: Box::new(move |wo, wi| if above(wo, wi) { e.multiple_density(wi) } else { 0.0 }),
        value: Box::new(move |wo, wi, _| {
            let losses =
                if above(wo, wi) { f.loss.at(wo.z.min(1.0)) * f.loss.at(wi.z.min(1.0)) } else { 0.0 };
            f.scale * losses
        }),
        flags: Some(bsdf::Lobe::DIFFUSE),
    };
    (parts, vec![single, multiple])
}

fn rough_plastic(m: RoughPlastic) -> (Parts, Vec<Lobe>) {
    let parts = Parts {
        distribution: Some(m.coat.distribution.clone()),
        masking: Some(m.coat.masking),
        fresnel: Some(m.coat.fresnel),
        eta: match m.coat.fresnel {
            Fresnel::Dielectric(eta) => Some(eta),
            _ => None,
        },
    };
    let m = Arc::new(m);
    let (a, b, c, d, e) = (m.clone(), m.clone(), m.clone(), m.clone(), m);
    let coat = Lobe {
        name: "the coat's lobe",
        share: Box::new(move |wo| a.lobes(wo.z.max(0.0)).0.first),
        density: Box::new(move |wo, wi| b.coat.pdf(wo, wi, Transport::Radiance)),
        value: Box::new(move |wo, wi, t| c.coat.eval(wo, wi, t)),
        flags: Some(bsdf::Lobe::GLOSSY),
    };
    let base = Lobe {
        name: "the diffuse lobe",
        share: Box::new(move |wo| d.lobes(wo.z.max(0.0)).0.second),
        density: Box::new(cosine),
        value: Box::new(move |wo, wi, t| {
            let coat = e.coat.eval(wo, wi, t)[0];
            e.eval(wo, wi, t).map(|f| (f - coat).max(0.0))
        }),
        flags: Some(bsdf::Lobe::DIFFUSE),
    };
    (parts, vec![coat, base])
}

fn cosine(wo: Direction, wi: Direction) -> f64 {
    if wo.z > 0.0 && wi.z > 0.0 { wi.z / PI } else { 0.0 }
}

fn plastic(m: Plastic, eta: f64) -> (Parts, Vec<Lobe>) {
    let parts = Parts { eta: Some(eta), ..Parts::default() };
    let base = Lobe {
        name: "the diffuse lobe",
        share: Box::new(move |wo| m.pdf(wo, Direction::NORMAL, Transport::Radiance) * PI),
        density: Box::new(cosine),
        value: Box::new(move |wo, wi, t| m.eval(wo, wi, t)),
        flags: Some(bsdf::Lobe::DIFFUSE),
    };
    (parts, vec![base])
}

fn phong(m: Phong) -> (Parts, Vec<Lobe>) {
    let of = |name, kd: f64, ks: f64, share: f64, flags| {
        let alone = Phong { kd, ks, shares: if kd > 0.0 { [1.0, 0.0] } else { [0.0, 1.0] }, ..m };
        Lobe {
            name,
            share: Box::new(move |_| share),
            density: Box::new(move |wo, wi| alone.pdf(wo, wi, Transport::Radiance)),
            value: Box::new(move |wo, wi, t| alone.eval(wo, wi, t)),
            flags: Some(flags),
        }
    };
    let mut lobes = Vec::new();
    if m.kd > 0.0 {
        lobes.push(of("the diffuse lobe", m.kd, 0.0, m.shares[0], bsdf::Lobe::DIFFUSE));
    }
    if m.ks > 0.0 {
        lobes.push(of("the glossy lobe", 0.0, m.ks, m.shares[1], bsdf::Lobe::GLOSSY));
    }
    (Parts::default(), lobes)
}

fn eon(m: OrenNayarEon) -> (Parts, Vec<Lobe>) {
    let bounces = move |wo: Direction, wi: Direction| {
        let lit = wo.z > 0.0 && wi.z > 0.0;
        if lit { m.multiple * m.lost(wo.z.min(1.0)) * m.lost(wi.z.min(1.0)) } else { 0.0 }
    };
    let single = Lobe {
        name: "the light of one bounce",
        share: share_of_one(),
        density: Box::new(move |wo, wi| m.pdf(wo, wi, Transport::Radiance)),
        value: Box::new(move |wo, wi, t| m.eval(wo, wi, t).map(|f| f - bounces(wo, wi))),
        flags: None,
    };
    let multiple = Lobe {
        name: "the light of many bounces",
        share: Box::new(|_| 0.0),
        density: Box::new(|_, _| 0.0),
        value: Box::new(move |wo, wi, _| Spectrum::from(bounces(wo, wi))),
        flags: None,
    };
    (Parts::default(), vec![single, multiple])
}

fn disney(m: Disney) -> (Parts, Vec<Lobe>) {
    let m = Arc::new(m);
    let coat = |m: &Disney, wo: Direction, wi: Direction| {
        let facet = half_vector::of_reflection(wo, wi);
        facet.map_or(0.0, |(h, cos)| m.coat.density(h) * h.z / (4.0 * cos))
    };
    let (a, b, c, d) = (m.clone(), m.clone(), m.clone(), m);
    let rest = Lobe {
        name: "the base",
        share: Box::new(move |wo| 1.0 - a.shares(wo)[2]),
        density: Box::new(move |wo, wi| {
            let share = b.shares(wo)[2];
            (b.pdf(wo, wi, Transport::Radiance) - share * coat(&b, wo, wi)) / (1.0 - share)
        }),
        value: Box::new(move |wo, wi, t| c.eval(wo, wi, t)),
        flags: None,
    };
    let clearcoat = Lobe {
        name: "the clearcoat",
        share: Box::new({
            let m = d.clone();
            move |wo| m.shares(wo)[2]
        }),
        density: Box::new(move |wo, wi| coat(&d, wo, wi)),
        value: Box::new(|_, _, _| Spectrum::zero(3)),
        flags: None,
    };
    (Parts::default(), vec![rest, clearcoat])
}
