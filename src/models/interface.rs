//! Fresnel functions as subjects of their own.

use super::microfacet::Fresnel;
use super::{Metal, fresnel};
use crate::bsdf::{Description, FresnelFunction, Spectrum};
use crate::registry::{Model, Parameters};

/// The registered model `fresnel`.
pub(super) fn model() -> Model {
    Model::fresnel(
        "fresnel",
        "reflectance of an interface by angle (Fresnel 1823; Schlick 1994)",
        Fresnel::declared,
    )
    .choice("kind", &["dielectric", "conductor", "schlick"], "which equations")
    .number("eta", 1.5, 0.25..=4.0, "index of refraction of the inside over the outside")
    .only_when("kind", &["dielectric"])
    .choice("metal", &Metal::NAMES, "whose complex index of refraction")
    .only_when("kind", &["conductor"])
    .number("f0", 0.04, 0.0..=1.0, "reflectance at normal incidence")
    .only_when("kind", &["schlick"])
}

impl Fresnel {
    /// As the registered model `fresnel` reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(match p.text("kind") {
            "conductor" => Self::Conductor(Metal::named(p.text("metal"))),
            "schlick" => Self::Schlick(p.number("f0")),
            _ => Self::Dielectric(p.number("eta")),
        })
    }
}

/// Index beyond over the index on the side that the light comes from.
fn relative(eta: f64, cos: f64) -> f64 {
    if cos < 0.0 { 1.0 / eta } else { eta }
}

/// What facets of [`TorranceSparrow`](super::microfacet::TorranceSparrow)
/// reflect. Only the dielectric is seen from both sides.
impl FresnelFunction for Fresnel {
    fn describe(&self) -> Description {
        let description = Description::new("fresnel");
        match self {
            Self::None => description.claims(|c| c.lossless = true),
            Self::Schlick(_) => description,
            Self::Conductor(_) => description.channels(Metal::WAVELENGTHS),
            Self::Dielectric(eta) => description.claims(|c| {
                c.transmissive = true;
                c.lossless = true;
                c.eta = Some(*eta);
            }),
        }
    }

    fn reflectance(&self, cos: f64) -> Spectrum {
        match self {
            Self::None => Spectrum::from(1.0),
            Self::Schlick(f0) => Spectrum::from(fresnel::schlick(cos.abs(), *f0)),
            Self::Dielectric(eta) => Spectrum::from(fresnel::dielectric(cos.abs(), relative(*eta, cos))),
            Self::Conductor(metal) => {
                let index = metal.index();
                Spectrum::from_fn(index.len(), |c| fresnel::conductor(cos.abs(), index[c].0, index[c].1))
            }
        }
    }

    fn transmittance(&self, cos: f64) -> Option<Spectrum> {
        match self {
            Self::None => Some(Spectrum::from(0.0)),
            Self::Dielectric(eta) => {
                let t = fresnel::dielectric_transmittance(cos.abs(), relative(*eta, cos));
                Some(Spectrum::from(t))
            }
            Self::Schlick(_) | Self::Conductor(_) => None,
        }
    }

    fn polarised(&self, cos: f64) -> Option<[Spectrum; 2]> {
        match self {
            Self::None | Self::Schlick(_) => None,
            Self::Dielectric(eta) => {
                let both = fresnel::dielectric_polarised(cos.abs(), relative(*eta, cos));
                Some(both.map(Spectrum::from))
            }
            Self::Conductor(metal) => {
                let index = metal.index();
                let both = index.map(|(n, k)| fresnel::conductor_polarised(cos.abs(), n, k));
                Some([0, 1].map(|of| Spectrum::from_fn(index.len(), |c| both[c][of])))
            }
        }
    }
}
