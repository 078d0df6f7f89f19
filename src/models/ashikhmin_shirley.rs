//! Ashikhmin and Shirley's anisotropic Phong model.

use super::lambert::sample_cosine;
use super::microfacet::half_vector;
use super::{fresnel, mixture};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::Model;
use crate::sphere::sin_cos_turns;
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
/// diffuse part by the cosine, with shares of what both reflect at θo. The weight of
/// the lobe is F cos θi/max(cos θo, cos θi) ≤ F, and smooth surfaces come closest to
/// reflecting all: F + (1 − rs)(1 − (1 − cos θo/2)⁵) ≤ 1.
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
        let (y, x) = sin_cos_turns(u[1]);
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
        let Some((h, om)) = half_vector::of_reflection(wo, wi) else {
            return Spectrum::zero(1);
        };
        let base = 28.0 / (23.0 * PI) * self.rd * (1.0 - self.rs);
        let diffuse = base * Self::rise(wo.z) * Self::rise(wi.z);
        let lobe = self.density(h) / (4.0 * om * wo.z.max(wi.z));
        Spectrum::from(diffuse + lobe * fresnel::schlick(om.min(1.0), self.rs))
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        let Some((h, om)) = half_vector::of_reflection(wo, wi) else {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::brute_force::{albedo, assert_sound, hemisphere};

    const R: Transport = Transport::Radiance;

    #[test]
    fn density_of_half_vectors_is_normalised() {
        for (nu, nv) in [(0.0, 0.0), (10.0, 10.0), (3.0, 200.0)] {
            let mass = hemisphere(|h| AshikhminShirley::new(0.0, 1.0, nu, nv).density(h));
            assert!((mass - 1.0).abs() < 1e-5, "{nu} {nv}: {mass}");
        }
    }

    /// The area that u covers, by central differences, is the density's inverse.
    #[test]
    fn half_vectors_follow_their_density_in_each_quadrant() {
        let h = 1e-6;
        for (nu, nv) in [(0.0, 0.0), (3.0, 300.0), (1e5, 10.0)] {
            let model = AshikhminShirley::new(0.0, 1.0, nu, nv);
            for (u, v) in [(0.1, 0.1), (0.4, 0.3), (0.9, 0.6), (0.5, 0.95)] {
                let at = |u: f64, v: f64| model.half(&[u, v]);
                let area = (at(u + h, v) - at(u - h, v)).cross(at(u, v + h) - at(u, v - h)).length();
                let jacobian = area / (4.0 * h * h) * model.density(at(u, v));
                assert!((jacobian - 1.0).abs() < 1e-4, "{nu} {nv} {u} {v}: {jacobian}");
                // The paper's azimuth lies in the quadrant of 2πu.
                let turn = TAU * v;
                assert!(at(u, v).x * turn.cos() > 0.0 && at(u, v).y * turn.sin() > 0.0);
            }
        }
    }

    /// 2π ∫(1 − (1 − μ/2)⁵) μ dμ = 23π/28, so that the base reflects rd (1 − rs)(1 −
    /// (1 − cos θo/2)⁵).
    #[test]
    fn base_reflects_what_the_paper_says() {
        for theta in [0.0f64, 0.8, 1.4] {
            let wo = Direction::from_angles(theta, 0.2);
            let with = |rd| albedo(&AshikhminShirley::new(rd, 0.3, 10.0, 10.0), wo, 0);
            let expected = 0.6 * 0.7 * (1.0 - (1.0 - theta.cos() / 2.0).powi(5));
            assert!((with(0.6) - with(0.0) - expected).abs() < 1e-5, "{theta}");
        }
    }

    /// With rs = 1 and wo = n the weight is cos θi = 2c² − 1 at c = cos θh with density
    /// (n + 1) cⁿ: the mean is 2 (n + 1)/(n + 3) (1 − 2^(−(n+3)/2)) − 1 + 2^(−(n+1)/2).
    #[test]
    fn albedo_at_normal_incidence_is_as_in_closed_form() {
        for n in [0.0f64, 1.0, 20.0] {
            let expected = 2.0 * (n + 1.0) / (n + 3.0) * (1.0 - 0.5f64.powf(0.5 * (n + 3.0))) - 1.0
                + 0.5f64.powf(0.5 * (n + 1.0));
            let a = albedo(&AshikhminShirley::new(0.0, 1.0, n, n), Direction::NORMAL, 0);
            assert!((a - expected).abs() < 1e-4, "{n}: {a} {expected}");
        }
    }

    #[test]
    fn conserves_energy_and_is_reciprocal() {
        for (rs, n) in [(0.0, 3.0), (0.04, 100.0), (0.5, 20.0)] {
            let model = AshikhminShirley::new(1.0, rs, n, 2.0 * n);
            for theta in [0.0, 0.7, 1.2, 1.5] {
                let wo = Direction::from_angles(theta, 0.9);
                assert!(albedo(&model, wo, 0) < 1.0);
                let wi = Direction::from_angles(0.4, 2.0);
                let (f, g) = (model.eval(wo, wi, R)[0], model.eval(wi, wo, R)[0]);
                assert!((f / g - 1.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn edges_are_sound() {
        for (rd, rs, nu, nv) in [(1.0, 0.0, 0.0, 0.0), (0.5, 0.04, 1e5, 3.0), (0.0, 1.0, 1e5, 1e5)] {
            assert_sound(&AshikhminShirley::new(rd, rs, nu, nv));
        }
    }
}
