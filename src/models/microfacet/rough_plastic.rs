//! A rough dielectric coat over a diffuse base.

use super::albedo::Transmittance;
use super::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::models::coated_base::{CoatedBase, Lobes};
use crate::models::fresnel;
use crate::models::lambert::sample_cosine;
use crate::registry::Model;
use std::f64::consts::PI;

/// [Torrance and Sparrow's](TorranceSparrow) reflection of dielectric facets, and
/// through them a Lambertian base: f = F D G2/(4 cos θo cos θi) + T(wo) T(wi) ρ/(π η²
/// (1 − ρ r)). T(w) = 1 − E(w) is what the facets do not reflect at once, by their
/// directional albedo E (C. Kelemen and L. Szirmay-Kalos, *A microfacet based coupled
/// specular-matte BRDF model*, Eurographics 2001), r = 1 − T̄/η² what the coat sends
/// back from inside (Saunderson 1942, as in [`Plastic`](crate::models::Plastic), to
/// which this goes as α → 0).
///
/// So no more light leaves than arrives for any α, η and ρ, and all of it where
/// ρ = 1: what a facet sends to another counts as passing the coat.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    reflectance: f64,
    coat: TorranceSparrow,
    passing: Transmittance,
    base: CoatedBase,
}

/// The registered model `rough-plastic`.
pub(in crate::models) fn model() -> Model {
    Model::new("rough-plastic", "rough dielectric coat over a diffuse base (Kelemen 2001)", |p| {
        let alpha = Roughness::isotropic(p.number("alpha"));
        let distribution = match p.text("distribution") {
            "beckmann" => Distribution::beckmann(alpha),
            _ => Distribution::ggx(alpha),
        };
        RoughPlastic::new(distribution, p.number("eta"), p.number("reflectance"))
    })
    .number("alpha", 0.2, 1e-4..=1.0, "roughness of the coat")
    .choice("distribution", &["ggx", "beckmann"], "distribution D of the coat's facet normals")
    .number("eta", 1.5, 1.01..=4.0, "index of refraction of the coat")
    .number("reflectance", 0.5, 0.0..=1.0, "reflectance of the base")
}

impl RoughPlastic {
    /// With an isotropic coat of index `eta` > 1 over a base of `reflectance` in
    /// [0, 1]; makes a table in about 10 ms. `Err` with the reason for an anisotropic
    /// coat, and where [`TorranceSparrow`] cannot be drawn by visible normals.
    pub fn new(distribution: Distribution, eta: f64, reflectance: f64) -> Result<Self, String> {
        if !distribution.alpha().is_isotropic() {
            return Err("the coat must be as rough along both tangents: its albedo has no azimuth".into());
        }
        let passing = Transmittance::new(&distribution, |cos| fresnel::dielectric(cos, eta));
        let base = CoatedBase::new(reflectance, eta, passing.mean);
        let facets = Fresnel::Dielectric(eta);
        let coat = TorranceSparrow::new(distribution, Masking::Smith, facets, NormalSampling::Visible)?;
        Ok(Self { reflectance, coat, passing, base })
    }

    /// The coat's lobe and the base's, with what passes the coat at wo.
    #[inline]
    fn lobes(&self, cos_o: f64) -> (Lobes, f64) {
        let passing = self.passing.at(cos_o);
        (Lobes::by_albedo(1.0 - passing, self.base.albedo(passing)), passing)
    }
}

impl Bsdf for RoughPlastic {
    fn describe(&self) -> Description {
        Description::new("rough-plastic").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.lossless = self.reflectance == 1.0;
        })
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let diffuse = self.base.value(self.passing.at(wo.z), self.passing.at(wi.z));
        Spectrum::from(self.coat.eval(wo, wi, transport)[0] + diffuse)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let (lobes, _) = self.lobes(wo.z);
        lobes.first * self.coat.pdf(wo, wi, transport) + lobes.second * wi.z / PI
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (lobes, passing) = self.lobes(wo.z);
        let (glossy, rest) = lobes.choose(u[0]);
        // Density and f cos θi of the coat, drawn or not.
        let (wi, coat_pdf, coat_value, lobe) = if glossy {
            let s = self.coat.sample(wo, &[rest, u[1]], transport)?;
            (s.wi, s.pdf, s.weight[0] * s.pdf, Lobe::GLOSSY_REFLECTION)
        } else {
            let wi = sample_cosine(&[rest, u[1]]);
            let value = self.coat.eval(wo, wi, transport)[0] * wi.z;
            (wi, self.coat.pdf(wo, wi, transport), value, Lobe::DIFFUSE_REFLECTION)
        };
        let pdf = lobes.first * coat_pdf + lobes.second * wi.z / PI;
        let diffuse = self.base.value(passing, self.passing.at(wi.z)) * wi.z;
        let weight = (coat_value + diffuse) / pdf;
        let valid = pdf > 0.0 && pdf.is_finite() && weight.is_finite();
        valid.then_some(Sample { wi, weight: Spectrum::from(weight), pdf, lobe })
    }
}
