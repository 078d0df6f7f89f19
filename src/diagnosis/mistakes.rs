//! Factors that code gets wrong, with what they mean.

use super::deviation::Free;
use super::parts::At;
use crate::bsdf::Direction;
use crate::cause::Cause::{
    self, ConstantFactor, EtaSide, FresnelArgument, HalfVectorJacobian, ImplementationDrift, Masking,
    NdfMeasure, NdfVndfMismatch, Normalization, RefractionJacobian, SwappedArguments, TransportMode, Weight,
    WrongMeasure,
};
use crate::models::fresnel;
use crate::models::microfacet::Fresnel;
use std::f64::consts::{PI, TAU};

/// A factor by which a function may be off.
pub struct Mistake {
    /// What it is off by, where that is defined.
    pub factor: fn(&At) -> Option<f64>,
    /// What may be fitted along.
    pub free: Free,
    /// What kind of bug it is.
    pub cause: Cause,
    /// What is wrong: follows the name of the function.
    pub what: &'static str,
    /// How to mend it.
    pub repair: &'static str,
}

const fn exact(
    factor: fn(&At) -> Option<f64>,
    cause: Cause,
    what: &'static str,
    repair: &'static str,
) -> Mistake {
    Mistake { factor, free: Free::Nothing, cause, what, repair }
}

const fn power(
    factor: fn(&At) -> Option<f64>,
    cause: Cause,
    what: &'static str,
    repair: &'static str,
) -> Mistake {
    Mistake { factor, free: Free::Power, cause, what, repair }
}

const fn scaled(
    factor: fn(&At) -> Option<f64>,
    cause: Cause,
    what: &'static str,
    repair: &'static str,
) -> Mistake {
    Mistake { factor, free: Free::Scale, cause, what, repair }
}

fn sin_h(at: &At) -> Option<f64> {
    let m = at.half()?.m;
    Some(m.x.hypot(m.y))
}

fn sin_i(at: &At) -> Option<f64> {
    Some(at.wi.x.hypot(at.wi.y))
}

/// (1 − F) of a smooth coat for a direction.
fn passing(at: &At, cos: f64) -> Option<f64> {
    Some(1.0 - fresnel::dielectric(cos, at.parts.eta?))
}

/// F with the complex index of a metal under a coat of index 1.5.
fn coated_metal(at: &At) -> Option<f64> {
    let (Fresnel::Conductor(metal), cos) = (at.parts.fresnel?, at.half()?.cos_o) else { return None };
    let (n, k) = *metal.index().get(at.channel)?;
    Some(fresnel::conductor(cos, n / 1.5, k / 1.5) / fresnel::conductor(cos, n, k))
}

/// cos θt/cos θi below a smooth coat.
fn below_coat(at: &At) -> Option<f64> {
    at.half()?;
    Some(fresnel::refracted_cosine(at.cos_i(), at.parts.eta?)? / at.cos_i())
}

/// F of light polarised perpendicular to the plane of incidence, over that of both.
fn perpendicular_alone(at: &At) -> Option<f64> {
    let (Fresnel::Dielectric(eta), cos) = (at.parts.fresnel?, at.half()?.cos_o.min(1.0)) else { return None };
    Some(fresnel::dielectric_polarised(cos, eta)[0] / fresnel::dielectric(cos, eta))
}

/// Smith's Λ where tan θ of `w` is another number.
fn lambda_of(at: &At, tan: f64) -> Option<f64> {
    let w = Direction::new(tan, 0.0, 1.0).normalized();
    Some(1.0 / at.g1(w)? - 1.0)
}

/// G2 with sin θ in place of tan θ, over G2; of one roughness.
fn masked_by_sines(at: &At) -> Option<f64> {
    at.parts.distribution.as_ref().filter(|d| d.alpha().is_isotropic())?;
    let sin = |w: Direction| w.x.hypot(w.y);
    Some(1.0 / (1.0 + lambda_of(at, sin(at.wo))? + lambda_of(at, sin(at.wi))?) / at.g2()?)
}

/// G2 with Λ of the half vector twice, over G2.
fn masked_by_half_vector(at: &At) -> Option<f64> {
    let of_h = 1.0 / at.g1(at.half()?.m)? - 1.0;
    Some(1.0 / (1.0 + 2.0 * of_h) / at.g2()?)
}

/// G1 of grooves.
fn groove(at: &At, cos: f64) -> Option<f64> {
    let h = at.half()?;
    Some((2.0 * h.m.z * cos / h.cos_o).min(1.0))
}

/// Of densities.
pub const PDF: &[Mistake] = &[
    exact(
        |at| Some(4.0 * at.half()?.cos_o),
        HalfVectorJacobian,
        "lacks the Jacobian 1/(4 wo·h) of reflection about the half vector",
        "divide the density of h by 4 wo·h",
    ),
    exact(
        |at| Some(at.half()?.cos_o),
        HalfVectorJacobian,
        "has 1/4 where the Jacobian 1/(4 wo·h) must be",
        "divide by wo·h too",
    ),
    exact(
        |at| Some(0.25 / at.half()?.cos_o),
        HalfVectorJacobian,
        "is divided by 4 wo·h twice",
        "divide once: perhaps the density of the distribution has done so already",
    ),
    exact(
        |at| Some(at.half()?.cos_o / at.half()?.m.z),
        HalfVectorJacobian,
        "has 1/(4 n·h) where the Jacobian 1/(4 wo·h) must be",
        "take the cosine between h and wo, not that between h and the normal",
    ),
    exact(
        |at| Some(1.0 / at.half()?.m.z),
        NdfMeasure,
        "has D(h) where the density D(h) cos θh of normals must be",
        "multiply by n·h: D is facet area per area of surface, and is no density by itself",
    ),
    exact(|at| Some(at.half()?.m.z), NdfMeasure, "has cos θh twice", "multiply D by n·h once"),
    exact(
        |at| Some(at.half()?.cos_o / at.cos_o()),
        SwappedArguments,
        "has n·wo where wo·h must be, in the Jacobian 1/(4 wo·h)",
        "take the cosine between wo and the half vector",
    ),
    exact(
        |at| Some(at.half()?.cos_o / at.cos_i()),
        SwappedArguments,
        "has n·wi where wo·h must be, in the Jacobian 1/(4 wo·h)",
        "take the cosine between wo and the half vector",
    ),
    exact(
        |at| Some(at.g1_i()? / at.g1_o()?),
        SwappedArguments,
        "has G1(wi) where G1(wo) must be",
        "visible normals are those that wo sees: give G1 the direction wo",
    ),
    exact(
        |at| {
            let mixed = crate::bsdf::Direction::new(at.wo.x, at.wo.y, at.cos_i());
            Some(at.g1(mixed)? / at.g1_o()?)
        },
        SwappedArguments,
        "takes G1(wo) with the cosine of wi and the tangents of wo",
        "take all three components from wo",
    ),
    exact(
        |at| {
            let d = at.parts.distribution.as_ref()?;
            let stretched = d.alpha().scale(at.wo).normalized();
            let m = at.half()?.m;
            Some(d.visible_density(stretched, m) / d.visible_density(at.wo, m))
        },
        SwappedArguments,
        "is that of normals visible from wo stretched by α",
        "give the density wo itself: the stretched direction belongs to the sampler alone",
    ),
    exact(
        |at| Some(at.refracting()?.cos_o / at.refracting()?.cos_i),
        SwappedArguments,
        "has |wo·h| where |wi·h| must be, in the Jacobian of refraction",
        "take the cosine between the facet and the refracted direction",
    ),
    exact(
        |at| Some(TAU * sin_h(at)?),
        WrongMeasure,
        "is the density of the angle θh, 2π sin θh too large, where one per steradian must be",
        "divide by 2π sin θh",
    ),
    exact(
        sin_h,
        WrongMeasure,
        "is a density in (θh, φh): it has sin θh too much",
        "divide by sin θh to have it per steradian",
    ),
    exact(
        |at| Some(TAU * sin_i(at)?),
        WrongMeasure,
        "is the density of the angle θi, 2π sin θi too large, where one per steradian must be",
        "divide by 2π sin θi",
    ),
    exact(
        sin_i,
        WrongMeasure,
        "is a density in (θi, φi): it has sin θi too much",
        "divide by sin θi to have it per steradian",
    ),
    exact(
        |at| Some(at.cos_i()),
        WrongMeasure,
        "has cos θi too much",
        "leave out the cosine: pdf is per solid angle, not per projected solid angle times cosine",
    ),
    exact(
        |at| Some(1.0 / at.cos_i()),
        WrongMeasure,
        "is per projected solid angle: cos θi is missing",
        "multiply by cos θi",
    ),
    exact(
        |at| at.half().map(|_| 0.5 / at.cos_i()),
        WrongMeasure,
        "is that of even directions, 1/2π, where sample() draws by the cosine",
        "return cos θi/π",
    ),
    exact(
        |at| at.half().map(|_| 2.0 * at.cos_i()),
        WrongMeasure,
        "is that of the cosine, cos θi/π, where sample() draws evenly",
        "return 1/2π",
    ),
    power(
        |at| Some(1.0 / at.g1_o()?),
        NdfVndfMismatch,
        "lacks the masking G1(wo) of visible normals",
        "multiply by G1(wo): visible normals have the density G1(wo) max(0, wo·h) D(h)/cos θo",
    ),
    exact(
        |at| Some(at.half()?.m.z * at.cos_o() / (at.half()?.cos_o * at.g1_o()?)),
        NdfVndfMismatch,
        "is that of all normals, D cos θh/(4 wo·h), where sample() draws visible ones",
        "return G1(wo) D/(4 cos θo), or draw by D cos θh",
    ),
    exact(
        |at| Some(at.half()?.cos_o * at.g1_o()? / (at.half()?.m.z * at.cos_o())),
        NdfVndfMismatch,
        "is that of visible normals, G1(wo) D/(4 cos θo), where sample() draws all",
        "return D cos θh/(4 wo·h), or draw visible normals",
    ),
    exact(
        |at| Some(at.facet()?.cos_o * at.g1_o()? / (at.facet()?.m.z * at.cos_o())),
        NdfVndfMismatch,
        "is that of visible normals where sample() draws all",
        "replace G1(wo) (wo·h)/cos θo by cos θh, or draw visible normals",
    ),
    exact(
        |at| Some(at.facet()?.m.z * at.cos_o() / (at.facet()?.cos_o * at.g1_o()?)),
        NdfVndfMismatch,
        "is that of all normals where sample() draws visible ones",
        "replace cos θh by G1(wo) (wo·h)/cos θo, or draw all normals",
    ),
    exact(|at| Some(1.0 / at.d()?), NdfVndfMismatch, "lacks the distribution D(h)", "multiply by D(h)"),
    exact(
        |at| Some(at.g2()? / at.g1_o()?),
        NdfVndfMismatch,
        "has G2(wo, wi) where G1(wo) must be",
        "only masking of wo is in the density of visible normals",
    ),
    power(
        |at| at.refracting().and(at.eta).map(|eta| eta * eta),
        RefractionJacobian,
        "of the refracted lobe is off by a power of η²",
        "the Jacobian of refraction is η² |wi·h|/|wo + η wi|², η being the index of the far over the near side",
    ),
    exact(
        |at| Some(at.refracting()?.jacobian.recip() * 0.25 / at.refracting()?.cos_o),
        RefractionJacobian,
        "of the refracted lobe has the Jacobian of reflection, 1/(4 wo·h)",
        "use η² |wi·h|/|wo + η wi|² on the side of transmission",
    ),
    exact(
        |at| Some(1.0 / at.refracting()?.cos_i),
        RefractionJacobian,
        "of the refracted lobe lacks the factor |wi·h| of the Jacobian",
        "multiply by |wi·h|",
    ),
    exact(
        |at| Some(1.0 / at.refracting()?.jacobian),
        RefractionJacobian,
        "of the refracted lobe lacks the Jacobian of refraction",
        "multiply by η² |wi·h|/|wo + η wi|²",
    ),
    exact(
        below_coat,
        RefractionJacobian,
        "is the density below the coat, and is not changed where the direction leaves it",
        "multiply by dωt/dωi = cos θi/(η² cos θt)",
    ),
    scaled(
        |_| Some(1.0),
        ConstantFactor,
        "is off by a constant factor, whatever wo and wi",
        "look for a missing or doubled π, 2 or 4, or for a normalisation of something else",
    ),
];

/// Of values.
pub const VALUE: &[Mistake] = &[
    exact(|_| Some(PI), Normalization, "lacks 1/π", "divide by π"),
    exact(|_| Some(1.0 / PI), Normalization, "is divided by π twice", "divide by π once"),
    scaled(
        |_| Some(1.0),
        Normalization,
        "is off by a constant factor, whatever wo and wi",
        "look for a reflectance, a tint or a π that is there twice or not at all",
    ),
    exact(
        |at| Some(at.half()?.m.z),
        NdfMeasure,
        "has D cos θh where D(h) must be",
        "use D itself: the density of drawn normals is D cos θh, the distribution is D",
    ),
    exact(|at| Some(1.0 / at.half()?.m.z), NdfMeasure, "has D/cos θh where D(h) must be", "use D itself"),
    exact(
        |at| Some(1.0 / (at.cos_o() * at.cos_i())),
        NdfMeasure,
        "is divided by cos θo cos θi twice",
        "one of D, G and 1/(4 cos θo cos θi) holds these cosines already",
    ),
    exact(
        |at| Some(at.cos_o() / at.cos_i()),
        SwappedArguments,
        "is divided by (n·wi)² where n·wo n·wi must be",
        "use both directions once",
    ),
    exact(
        |at| Some(at.cos_i() / at.cos_o()),
        SwappedArguments,
        "is divided by (n·wo)² where n·wo n·wi must be",
        "use both directions once",
    ),
    exact(
        |at| Some(at.cos_o() * at.cos_o()),
        Masking,
        "is multiplied by cos θo where it must be divided by it",
        "put the denominator 4 cos θo cos θi in parentheses",
    ),
    exact(
        |at| Some(at.cos_i() * at.cos_i()),
        Masking,
        "is multiplied by cos θi where it must be divided by it",
        "put the denominator 4 cos θo cos θi in parentheses",
    ),
    exact(
        |at| Some(at.cos_i()),
        Normalization,
        "contains cos θi, which it is declared not to",
        "leave the cosine out, or declare that it is included",
    ),
    exact(
        |at| Some(at.fresnel(at.cos_o())? / at.fresnel(at.half()?.cos_o)?),
        FresnelArgument,
        "takes F at n·wo where wo·h must be",
        "a facet reflects by the angle to its own normal: give F the cosine wo·h",
    ),
    exact(
        |at| Some(at.fresnel(at.cos_i())? / at.fresnel(at.half()?.cos_o)?),
        FresnelArgument,
        "takes F at n·wi where wi·h must be",
        "a facet reflects by the angle to its own normal: give F the cosine wi·h",
    ),
    exact(
        |at| Some(at.fresnel(at.half()?.m.z)? / at.fresnel(at.half()?.cos_o)?),
        FresnelArgument,
        "takes F at n·h where wo·h must be",
        "give F the cosine wo·h",
    ),
    exact(
        |at| Some(1.0 / at.fresnel(at.half()?.cos_o)?),
        FresnelArgument,
        "lacks the Fresnel term",
        "multiply by F(wo·h)",
    ),
    exact(
        |at| at.fresnel(at.half()?.cos_o),
        FresnelArgument,
        "has the Fresnel term twice",
        "multiply by F(wo·h) once",
    ),
    exact(
        perpendicular_alone,
        FresnelArgument,
        "has Rs where Rp must be: F is that of one polarisation",
        "Rp has η on the other side: (η cos θi − cos θt)/(η cos θi + cos θt)",
    ),
    exact(
        coated_metal,
        EtaSide,
        "takes the metal's index relative to a coat of 1.5 that is not there",
        "use the index relative to the medium that the light comes from",
    ),
    exact(
        |at| Some(at.g1_o()?.powi(2) / at.g2()?),
        Masking,
        "has G1(wo) twice where G2(wo, wi) must be",
        "the second factor belongs to wi",
    ),
    exact(
        |at| Some(at.g1_i()?.powi(2) / at.g2()?),
        Masking,
        "has G1(wi) twice where G2(wo, wi) must be",
        "one factor belongs to wo",
    ),
    exact(
        |at| Some(at.g1_o()? / at.g2()?),
        Masking,
        "has G1(wo) where G2(wo, wi) must be: shadowing is missing",
        "multiply by the shadowing of wi",
    ),
    exact(
        |at| Some(at.g1_i()? / at.g2()?),
        Masking,
        "has G1(wi) where G2(wo, wi) must be: masking is missing",
        "multiply by the masking of wo",
    ),
    exact(
        masked_by_sines,
        Masking,
        "has sin θ where tan θ must be, in the masking function",
        "Smith's Λ is a function of α tan θ",
    ),
    exact(
        masked_by_half_vector,
        Masking,
        "takes the masking function at the half vector, where wo and wi must be",
        "G2 masks wo and shadows wi: give Λ their angles to the normal",
    ),
    power(|at| at.g2(), Masking, "has G2(wo, wi) to a wrong power", "multiply by G2 once"),
    exact(
        |at| Some(groove(at, at.cos_o())? / groove(at, at.cos_o())?.min(groove(at, at.cos_i())?)),
        Masking,
        "masks grooves for wo and does not shadow them for wi",
        "take the smaller of 2 n·h n·wo/(wo·h) and 2 n·h n·wi/(wo·h)",
    ),
    exact(
        |at| Some(groove(at, at.cos_i())? / groove(at, at.cos_o())?.min(groove(at, at.cos_i())?)),
        Masking,
        "shadows grooves for wi and does not mask them for wo",
        "take the smaller of 2 n·h n·wo/(wo·h) and 2 n·h n·wi/(wo·h)",
    ),
    power(
        |at| if at.reflects() { None } else { at.eta.map(|eta| eta * eta) },
        TransportMode,
        "of what is transmitted is off by a power of η²: radiance and importance are mixed up",
        "divide by η² in radiance mode, and only there, η being the index of the far over the near side",
    ),
    exact(
        |at| below_coat(at).map(|b| 1.0 / b),
        TransportMode,
        "has a factor cos θi/cos θt: it is converted into the coat by flux, and that is done twice",
        "leave the cosines out",
    ),
    exact(
        below_coat,
        TransportMode,
        "has a factor cos θt/cos θi: it is converted out of the coat by flux, and that is done twice",
        "leave the cosines out",
    ),
    power(
        |at| Some(at.half().and(passing(at, at.cos_o()))? * passing(at, at.cos_i())?),
        Normalization,
        "has the coat's transmittance (1 − F(wo)) (1 − F(wi)) to a wrong power",
        "the base is lit through the coat once and seen through it once",
    ),
    scaled(
        |at| Some(1.0 / (at.half().and(passing(at, at.cos_o()))? * passing(at, at.cos_i())?)),
        Normalization,
        "adds the coat to a base that gets all the light: the transmittance of the coat is missing",
        "multiply the base by (1 − F(wo)) (1 − F(wi))",
    ),
    exact(
        |at| Some(1.0 / at.half().and(passing(at, at.cos_o()))?),
        FresnelArgument,
        "lights the base through the coat, and sees it without: 1 − F(wo) is missing",
        "multiply the base by the transmittance at both angles",
    ),
    exact(
        |at| Some(1.0 / at.half().and(passing(at, at.cos_i()))?),
        FresnelArgument,
        "sees the base through the coat, and lights it without: 1 − F(wi) is missing",
        "multiply the base by the transmittance at both angles",
    ),
];

/// Of weights, over f |cos θi|/pdf.
pub const WEIGHT: &[Mistake] = &[
    exact(|at| Some(1.0 / at.cos_i()), Weight, "lacks |cos θi|", "the weight is f |cos θi|/pdf"),
    exact(
        |at| Some(at.cos_i()),
        Weight,
        "has |cos θi| twice",
        "the weight is f |cos θi|/pdf, with one cosine",
    ),
    exact(
        |at| at.g1_o(),
        Weight,
        "has G2 where G2/G1(wo) must be",
        "divide by G1(wo): it is in the density of visible normals",
    ),
    exact(|at| Some(1.0 / at.g1_o()?), Weight, "is divided by G1(wo) twice", "divide once"),
    exact(
        |at| Some(at.cos_o() / at.cos_i()),
        Weight,
        "has cos θi where cos θo must be",
        "the weight of all normals is F G2 wo·h/(cos θo cos θh)",
    ),
    exact(
        |at| Some(at.cos_i() / at.cos_o()),
        Weight,
        "has cos θo where cos θi must be",
        "the weight is f |cos θi|/pdf",
    ),
    exact(
        |at| Some(at.fresnel(at.cos_o())? / at.fresnel(at.half()?.cos_o)?),
        ImplementationDrift,
        "takes F at n·wo, eval() at wo·h",
        "compute F once, from the half vector, for both",
    ),
    exact(
        |at| {
            let Fresnel::Dielectric(eta) = at.parts.fresnel? else { return None };
            let (cos, f0) = (at.half()?.cos_o.min(1.0), ((eta - 1.0) / (eta + 1.0)).powi(2));
            Some(fresnel::schlick(cos, f0) / fresnel::dielectric(cos, eta))
        },
        ImplementationDrift,
        "takes Schlick's approximation of F, eval() Fresnel's equations",
        "use one of them in both",
    ),
    scaled(|_| Some(1.0), Weight, "is off by a constant factor", "compute it as f |cos θi|/pdf"),
];
