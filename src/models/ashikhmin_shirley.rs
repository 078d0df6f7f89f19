//! Ashikhmin and Shirley's anisotropic Phong model.

use super::lambert::sample_cosine;
use super::microfacet::torrance_sparrow::half_vector;
use super::{fresnel, mixture};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::Model;
use std::f64::consts::{PI, TAU};

/// On the front side, with the half vector h, Schlick's F from rs, and e(φh) = nu
/// cos²φh + nv sin²φh (M. Ashikhmin and P. Shirley, *An anisotropic Phong BRDF
/// model*, Journal of Graphics Tools 5(2), 2000):
///
/// - specular: √((nu + 1)(nv + 1))/8π · cosᵉθh F(wo·h)/((wo·h) max(cos θo, cos θi));
/// - diffuse: 28 rd/23π · (1 − rs)(1 − (1 − cos θo/2)⁵)(1 − (1 − cos θi/2)⁵), whose
///   albedo rd (1 − rs)(1 − (1 − cos θo/2)⁵) leaves what Fresnel's term takes.
///
/// Half vectors are drawn with the density √((nu + 1)(nv + 1))/2π cosᵉθh, the
/// diffuse part by the cosine, with shares of what both reflect at θo.
#[derive(Clone, Copy, Debug)]
pub struct AshikhminShirley {
    rd: f64,
    rs: f64,
    nu: f64,
    nv: f64,
    /// √((nu + 1)(nv + 1))/2π.
    normalisation: f64,
}

/// The registered model `ashikhmin-shirley`.
pub(super) fn model() -> Model {
    Model::new("ashikhmin-shirley", "anisotropic Phong lobe over a diffuse base (2000)", |p| {
        Ok(AshikhminShirley::new(p.number("rd"), p.number("rs"), p.number("nu"), p.number("nv")))
    })
    .number("rd", 0.6, 0.0..=1.0, "reflectance of the diffuse base")
    .only_if("rs < 1", |p| p.number("rs") < 1.0)
    .number("rs", 0.04, 0.0..=1.0, "specular reflectance at normal incidence")
    .number("nu", 100.0, 0.0..=1e5, "exponent along the tangent: the larger, the narrower the lobe")
    .number("nv", 100.0, 0.0..=1e5, "exponent along the bitangent")
}

impl AshikhminShirley {
    /// Reflectances in [0, 1], exponents ≥ 0.
    pub fn new(rd: f64, rs: f64, nu: f64, nv: f64) -> Self {
        Self { rd, rs, nu, nv, normalisation: ((nu + 1.0) * (nv + 1.0)).sqrt() / TAU }
    }

    /// Density of half vectors per steradian.
    #[inline]
    fn density(&self, h: Direction) -> f64 {
        let (x2, y2) = (h.x * h.x, h.y * h.y);
        let sin2 = x2 + y2;
        if sin2 == 0.0 {
            return self.normalisation;
        }
        let exponent = (self.nu * x2 + self.nv * y2) / sin2;
        // cosᵉ from the sine, which is precise where the lobe is narrow.
        let ln_cos = if sin2 < 0.5 { 0.5 * (-sin2).ln_1p() } else { h.z.ln() };
        self.normalisation * (exponent * ln_cos).exp()
    }

    /// A half vector with this density. The paper's φ = atan(√((nu + 1)/(nv + 1))
    /// tan(π u/2)), quadrant by quadrant, is the azimuth of a stretched circle.
    #[inline]
    fn half(&self, u: &[f64]) -> Direction {
        let (y, x) = (TAU * u[1]).sin_cos();
        let (x, y) = (x / (self.nu + 1.0).sqrt(), y / (self.nv + 1.0).sqrt());
        let r2 = x * x + y * y;
        let exponent = (self.nu * x * x + self.nv * y * y) / r2;
        let ln_cos = (-u[0]).ln_1p() / (exponent + 1.0);
        let scale = (-(2.0 * ln_cos).exp_m1() / r2).sqrt();
        Direction::new(x * scale, y * scale, ln_cos.exp())
    }

    /// 1 − (1 − cos θ/2)⁵.
    #[inline]
    fn rise(cos: f64) -> f64 {
        1.0 - (1.0 - 0.5 * cos).powi(5)
    }

    /// Shares of the half vectors and of the cosine.
    #[inline]
    fn shares(&self, wo: Direction) -> [f64; 2] {
        let diffuse = self.rd * (1.0 - self.rs) * Self::rise(wo.z);
        // Even where F(θo) = 0, some facets reflect.
        let specular = fresnel::schlick(wo.z.min(1.0), self.rs).max(f64::MIN_POSITIVE);
        mixture::shares([specular, diffuse])
    }
}

impl Bsdf for AshikhminShirley {
    fn describe(&self) -> Description {
        Description::new("ashikhmin-shirley").dimensions(2).claims(|c| {
            c.isotropic = self.nu == self.nv;
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        let Some((h, om)) = half_vector(wo, wi) else {
            return Spectrum::zero(1);
        };
        let base = 28.0 / (23.0 * PI) * self.rd * (1.0 - self.rs);
        let diffuse = base * Self::rise(wo.z) * Self::rise(wi.z);
        let lobe = self.density(h) / (4.0 * om * wo.z.max(wi.z));
        Spectrum::from(diffuse + lobe * fresnel::schlick(om.min(1.0), self.rs))
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let Some((h, om)) = half_vector(wo, wi) else {
            return 0.0;
        };
        let [specular, diffuse] = self.shares(wo);
        specular * self.density(h) / (4.0 * om) + diffuse * wi.z / PI
    }

    #[inline]
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (chosen, first) = mixture::choose(self.shares(wo), u[0]);
        let (wi, lobe) = if chosen == 0 {
            let h = self.half(&[first, u[1]]);
            if wo.dot(h) <= 0.0 {
                return None;
            }
            (wo.reflected(h), Lobe::GLOSSY_REFLECTION)
        } else {
            (sample_cosine(&[first, u[1]]), Lobe::DIFFUSE_REFLECTION)
        };
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        let valid = pdf > 0.0 && pdf.is_finite() && weight[0].is_finite();
        valid.then_some(Sample { wi, weight, pdf, lobe })
    }
}
