//! A rough dielectric coat over a diffuse base.

use super::albedo::Transmittance;
use super::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::models::coated_base::{CoatedBase, Lobes};
use crate::models::fresnel;
use crate::models::lambert::sample_cosine;
use crate::models::memo::Memo;
use crate::registry::{Model, Parameters};
use std::f64::consts::PI;
use std::mem::{Discriminant, discriminant};
use std::sync::Arc;

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
    pub(crate) reflectance: f64,
    pub(crate) coat: TorranceSparrow,
    passing: Arc<Transmittance>,
    base: CoatedBase,
}

/// The registered model `rough-plastic`.
pub(in crate::models) fn model() -> Model {
    Model::new(
        "rough-plastic",
        "rough dielectric coat over a diffuse base (Kelemen 2001)",
        RoughPlastic::declared,
    )
    .number("alpha", 0.2, 1e-3..=1.0, "roughness of the coat")
    .choice("distribution", &["ggx", "beckmann"], "distribution D of the coat's facet normals")
    .number("eta", 1.5, 1.01..=4.0, "index of refraction of the coat")
    .number("reflectance", 0.5, 0.0..=1.0, "reflectance of the base")
}

impl RoughPlastic {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        let alpha = Roughness::isotropic(p.number("alpha"));
        let distribution = match p.text("distribution") {
            "beckmann" => Distribution::beckmann(alpha),
            _ => Distribution::ggx(alpha),
        };
        RoughPlastic::new(distribution, p.number("eta"), p.number("reflectance"))
    }

    /// With an isotropic coat of index `eta` > 1 over a base of `reflectance` in
    /// [0, 1]; makes a table in about 10 ms, once. `Err` with the reason for an anisotropic
    /// coat, and where [`TorranceSparrow`] cannot be drawn by visible normals.
    pub fn new(distribution: Distribution, eta: f64, reflectance: f64) -> Result<Self, String> {
        if !distribution.alpha().is_isotropic() {
            return Err("the coat must be as rough along both tangents: its albedo has no azimuth".into());
        }
        static KNOWN: Memo<(Discriminant<Distribution>, [u64; 2]), Transmittance> = Memo::new();
        let key = (discriminant(&distribution), [distribution.alpha().x, eta].map(f64::to_bits));
        let passing =
            KNOWN.of(key, || Transmittance::new(&distribution, |cos| fresnel::dielectric(cos, eta)));
        let base = CoatedBase::new(reflectance, eta, passing.mean);
        let facets = Fresnel::Dielectric(eta);
        let coat = TorranceSparrow::new(distribution, Masking::Smith, facets, NormalSampling::Visible)?;
        Ok(Self { reflectance, coat, passing, base })
    }

    /// The coat's lobe and the base's, with what passes the coat at wo.
    #[inline]
    pub(crate) fn lobes(&self, cos_o: f64) -> (Lobes, f64) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::Plastic;

    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    const R: Transport = Transport::Radiance;

    fn all() -> Vec<RoughPlastic> {
        let mut all = Vec::new();
        for alpha in [1e-4, 0.1, 1.0] {
            let alpha = Roughness::isotropic(alpha);
            for d in [Distribution::ggx(alpha), Distribution::beckmann(alpha)] {
                for (eta, reflectance) in [(1.01, 1.0), (1.5, 0.0), (1.5, 0.6), (4.0, 1.0)] {
                    all.push(RoughPlastic::new(d.clone(), eta, reflectance).unwrap());
                }
            }
        }
        all
    }

    #[test]
    fn sample_eval_and_pdf_agree() {
        for model in all() {
            for theta in [0.0f64, 40.0, 85.0] {
                let wo = Direction::from_angles(theta.to_radians(), 0.7);
                for k in 0..200 {
                    let u = [0.618_033_988_749_895, 0.754_877_666_246_692_7]
                        .map(|a| (0.5 + a * f64::from(k)).fract());
                    let Some(s) = model.sample(wo, &u, R) else { continue };
                    let (f, pdf) = (model.eval(wo, s.wi, R)[0], model.pdf(wo, s.wi, R));
                    assert!((s.pdf / pdf - 1.0).abs() < 1e-7, "{model:?} {theta} {s:?} {pdf}");
                    assert!((s.weight[0] * pdf / (f * s.wi.z) - 1.0).abs() < 1e-7 || f == 0.0);
                    assert!((model.eval(s.wi, wo, R)[0] / f - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    /// Away from the mirror direction, where the coat's lobe is nothing.
    #[test]
    fn goes_to_smooth_plastic() {
        let alpha = Roughness::isotropic(1e-4);
        let rough = RoughPlastic::new(Distribution::beckmann(alpha), 1.5, 0.6).unwrap();
        let smooth = Plastic::new(0.6, 1.5);
        for (to, ti) in [(0.0, 0.5), (1.0, 0.2), (1.4, 1.2)] {
            let (wo, wi) = (Direction::from_angles(to, 0.0), Direction::from_angles(ti, 1.0));
            let ratio = rough.eval(wo, wi, R)[0] / smooth.eval(wo, wi, R)[0];
            assert!((ratio - 1.0).abs() < 1e-5, "{to} {ti}: {ratio}");
        }
    }

    /// What was drawn of a white base is all of the light; of a grey one, less.
    #[test]
    fn a_white_base_is_lossless() {
        for (reflectance, lossless) in [(1.0, true), (0.7, false)] {
            for alpha in [0.05, 0.5, 1.0] {
                let d = Distribution::ggx(Roughness::isotropic(alpha));
                let model = RoughPlastic::new(d, 1.5, reflectance).unwrap();
                assert_eq!(model.describe().claims.lossless, lossless);
                let wo = Direction::from_angles(1.2, 0.7);
                let n = 1 << 16;
                let weight = |k: i32| {
                    let u = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2]
                        .map(|a| (0.5 + a * f64::from(k)).fract());
                    model.sample(wo, &u, R).map_or(0.0, |s| s.weight[0])
                };
                let albedo = (0..n).map(weight).sum::<f64>() / f64::from(n);
                assert!(
                    if lossless { (albedo - 1.0).abs() < 2e-3 } else { albedo < 0.9 },
                    "{alpha}: {albedo}"
                );
            }
        }
    }

    #[test]
    fn edges() {
        let horizon = Direction::new(1.0, 0.0, 0.0);
        let grazing = Direction::new(1.0, 0.0, 1e-300);
        for model in all() {
            for wo in [horizon, -Direction::NORMAL] {
                assert!(model.sample(wo, &[0.5, 0.5], R).is_none());
                assert_eq!((model.eval(wo, Direction::NORMAL, R)[0], model.pdf(wo, grazing, R)), (0.0, 0.0));
            }
            for wo in [Direction::NORMAL, grazing] {
                for u in [[0.0, 0.0], [LAST, LAST], [LAST, 0.0], [0.0, LAST]] {
                    let Some(s) = model.sample(wo, &u, R) else { continue };
                    assert!(s.pdf > 0.0 && s.weight[0].is_finite(), "{model:?} {wo:?} {u:?}: {s:?}");
                }
                for wi in [grazing, grazing.mirrored(), wo, Direction::NORMAL] {
                    assert!(!model.eval(wo, wi, R)[0].is_nan() && !model.pdf(wo, wi, R).is_nan());
                }
            }
        }
        let brushed = Distribution::ggx(Roughness { x: 0.1, y: 0.2 });
        assert!(RoughPlastic::new(brushed, 1.5, 0.5).unwrap_err().contains("both tangents"));
    }
}
