//! Oren and Nayar's rough diffuse reflector, with its lost energy returned.

use super::clipped_cosine::ClippedCosine;
use super::lambert::{sample_cosine, sample_uniform};
use super::mixture;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};
use std::f64::consts::PI;

/// The directional albedo of one bounce at grazing, less A, over B: 1/2 − 2/(3π).
const GRAZING: f64 = 0.5 - 2.0 / (3.0 * PI);

/// The mean of the same over the hemisphere: 2/3 − 28/(15π).
const MEAN: f64 = 2.0 / 3.0 - 28.0 / (15.0 * PI);

/// How [`OrenNayarEon`] draws directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EonSampling {
    /// The paper's: a cosine, linearly transformed to the shape of f and clipped
    /// to the hemisphere, and some of uniform.
    ClippedCosine,
    /// p = cos θi/π.
    Cosine,
    /// p = 1/2π.
    Uniform,
}

/// ρ/π (A + B s/t) + ρ_ms/π (1 − E(μo)) (1 − E(μi))/(1 − E_avg) on the front side,
/// with s = sin θo sin θi cos Δφ, t = max(μo, μi) where s > 0 and 1 elsewhere, A =
/// 1/(1 + (1/2 − 2/3π) r), B = r A, and E = A + B G/π the directional albedo of
/// the first lobe at ρ = 1 (J. Portsmouth, P. Kutz and S. Hill, *EON: a practical
/// energy-preserving rough diffuse BRDF*, JCGT 14, 2025; the first lobe is
/// Y. Fujii's). ρ_ms = ρ² E_avg/(1 − ρ (1 − E_avg)). Reciprocal; lossless at ρ = 1.
#[derive(Clone, Copy, Debug)]
pub struct OrenNayarEon {
    reflectance: f64,
    pub(crate) roughness: f64,
    sampling: EonSampling,
    /// A.
    a: f64,
    /// ρ_ms/π A r/(1/2 − 2/3π − mean): so written, nothing is 0/0 at r = 0.
    pub(crate) multiple: f64,
}

/// The registered model `oren-nayar-eon`.
pub(super) fn model() -> Model {
    Model::new(
        "oren-nayar-eon",
        "rough diffuse reflection, energy-preserving (Portsmouth et al. 2025)",
        OrenNayarEon::declared,
    )
    .number("reflectance", 0.8, 0.0..=1.0, "share of the light that a facet reflects")
    .number("roughness", 0.5, 0.0..=1.0, "0: Lambert's; 1: the roughest")
    .choice(
        "sampling",
        &["cltc", "cosine", "uniform"],
        "density of sampled directions (cltc: the paper's)",
    )
}

impl OrenNayarEon {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        let sampling = match p.text("sampling") {
            "cosine" => EonSampling::Cosine,
            "uniform" => EonSampling::Uniform,
            _ => EonSampling::ClippedCosine,
        };
        Ok(Self::new(p.number("reflectance"), p.number("roughness"), sampling))
    }

    /// With facets of `reflectance` ρ and a `roughness` r, each in [0, 1].
    pub fn new(reflectance: f64, roughness: f64, sampling: EonSampling) -> Self {
        let a = 1.0 / (1.0 + GRAZING * roughness);
        let average = a * (1.0 + MEAN * roughness);
        let bounced = reflectance * reflectance * average / (1.0 - reflectance * (1.0 - average));
        let multiple = bounced / PI * a * roughness / (GRAZING - MEAN);
        Self { reflectance, roughness, sampling, a, multiple }
    }

    /// (1 − E(μ))/(A r).
    #[inline]
    pub(crate) fn lost(&self, mu: f64) -> f64 {
        // 0 at grazing but for rounding.
        (GRAZING - gained(mu)).max(0.0)
    }

    /// The share of the light that comes back at cos θo = `mu`.
    pub fn directional_albedo(&self, mu: f64) -> f64 {
        let single = self.reflectance * self.a * (1.0 + self.roughness * gained(mu));
        single + self.multiple * PI * self.lost(mu) * (GRAZING - MEAN)
    }

    /// The probability of drawing uniformly, and the other lobe, whose x is along
    /// wo's azimuth: the paper's fits (listing 2 and §4). d is kept from the 0.003
    /// that its fit rises above 0 within 1° of the normal. At the normal itself,
    /// where there is no azimuth, the lobe is round, as the fits are only nearly.
    #[inline]
    fn lobes(&self, wo: Direction) -> (f64, ClippedCosine) {
        let (r, mu) = (self.roughness, wo.z.min(1.0));
        let a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
        let b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
        let c = 1.0 + r * (0.20013 + (-0.506373 + 0.261777 * mu) * mu);
        let d = r * (0.540852 + (-1.01625 + 0.475392 * mu) * mu) / (-1.0743 + (0.0725628 + mu) * mu);
        let uniform = r.powf(0.1) * (0.162925 + (-0.372058 + (0.538233 - 0.290822 * mu) * mu) * mu);
        let round = wo.x == 0.0 && wo.y == 0.0;
        let (a, b, d) = if round { (c, 0.0, 0.0) } else { (a, b, d.min(0.0)) };
        (uniform, ClippedCosine::new(a, b, c, d))
    }
}

/// G(θ)/π, by which E exceeds A over B: sin θ (θ − sin θ cos θ) + ⅔ (tan θ
/// (1 − sin³θ) − sin θ) over π; by tan θ (1 − sin θ) = sin θ cos θ/(1 + sin θ)
/// without a division by cos θ.
#[inline]
fn gained(mu: f64) -> f64 {
    let sin = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
    let theta = sin.atan2(mu);
    let tail = mu * (1.0 + sin + sin * sin) / (1.0 + sin) - 1.0;
    sin / PI * (theta - sin * mu + 2.0 / 3.0 * tail)
}

/// (x, y) turned so that wo's azimuth is 0, and back by `sign` −1.
#[inline]
fn turned(w: Direction, wo: Direction, sign: f64) -> Direction {
    let sin = wo.x.hypot(wo.y);
    let (x, y) = if sin > 0.0 { (wo.x / sin, sign * wo.y / sin) } else { (1.0, 0.0) };
    Direction::new(x * w.x + y * w.y, x * w.y - y * w.x, w.z)
}

impl Bsdf for OrenNayarEon {
    fn describe(&self) -> Description {
        Description::new("oren-nayar-eon").dimensions(2).claims(|c| {
            c.isotropic = true;
            c.lossless = self.reflectance == 1.0;
        })
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> Spectrum {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Spectrum::zero(1);
        }
        let s = wo.x * wi.x + wo.y * wi.y;
        let s = if s > 0.0 { s / wo.z.max(wi.z) } else { s };
        // At r = 1 it is 0 for opposite directions along the horizon.
        let single = self.reflectance / PI * self.a * (1.0 + self.roughness * s).max(0.0);
        Spectrum::from(single + self.multiple * (self.lost(wo.z.min(1.0)) * self.lost(wi.z.min(1.0))))
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, _: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        match self.sampling {
            EonSampling::Cosine => wi.z / PI,
            EonSampling::Uniform => 0.5 / PI,
            EonSampling::ClippedCosine => {
                let (uniform, clipped) = self.lobes(wo);
                uniform * 0.5 / PI + (1.0 - uniform) * clipped.pdf(turned(wi, wo, 1.0))
            }
        }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = match self.sampling {
            EonSampling::Cosine => sample_cosine(u),
            EonSampling::Uniform => sample_uniform(u),
            EonSampling::ClippedCosine => {
                let (uniform, clipped) = self.lobes(wo);
                let (chosen, first) = mixture::choose([uniform, 1.0 - uniform], u[0]);
                let rest = [first, u[1]];
                if chosen == 0 { sample_uniform(&rest) } else { turned(clipped.sample(&rest), wo, -1.0) }
            }
        };
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z / pdf);
        (pdf > 0.0).then_some(Sample { wi, weight, pdf, lobe: Lobe::DIFFUSE_REFLECTION })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    const R: Transport = Transport::Radiance;

    fn eon(reflectance: f64, roughness: f64) -> OrenNayarEon {
        OrenNayarEon::new(reflectance, roughness, EonSampling::ClippedCosine)
    }

    /// ∫f cos θi over the hemisphere. f is elementary in Δφ on both sides of
    /// Δφ = π/2, and its slope in θi jumps at θi = θo: Simpson's rule between.
    fn albedo(model: &OrenNayarEon, theta_o: f64) -> f64 {
        let wo = Direction::from_angles(theta_o, 0.0);
        let over_azimuth = |theta: f64| {
            simpson(0.0, PI / 2.0, 60, |phi| model.eval(wo, Direction::from_angles(theta, phi), R)[0])
                + simpson(PI / 2.0, PI, 60, |phi| model.eval(wo, Direction::from_angles(theta, phi), R)[0])
        };
        let ring = |theta: f64| 2.0 * over_azimuth(theta) * theta.sin() * theta.cos();
        simpson(0.0, theta_o, 200, ring) + simpson(theta_o, PI / 2.0, 200, ring)
    }

    fn simpson(from: f64, to: f64, n: i32, f: impl Fn(f64) -> f64) -> f64 {
        let h = (to - from) / f64::from(n);
        let at = |k: i32| f(from + h * f64::from(k));
        (0..n).step_by(2).map(|k| h / 3.0 * (at(k) + 4.0 * at(k + 1) + at(k + 2))).sum()
    }

    fn angles() -> impl Iterator<Item = f64> {
        (0..30).map(|k| 3.0 * f64::from(k)).chain([89.0, 89.5, 89.9]).map(f64::to_radians)
    }

    #[test]
    fn white_furnace_at_every_roughness_and_angle() {
        let mut worst = (0.0, 0.0, 0.0);
        for roughness in [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0] {
            for theta in angles() {
                let off = albedo(&eon(1.0, roughness), theta) - 1.0;
                if f64::abs(off) > f64::abs(worst.0) {
                    worst = (off, roughness, theta.to_degrees());
                }
            }
        }
        let (off, roughness, theta) = worst;
        println!("flux − 1 is {off:.1e} at worst, at roughness {roughness}, {theta}°");
        assert!(off.abs() < 1e-8, "{off:e} at roughness {roughness}, {theta}°");
    }

    #[test]
    fn albedos_are_those_of_the_lobe() {
        for model in [eon(0.6, 1.0), eon(0.9, 0.4)] {
            for theta in angles() {
                let (sum, closed) = (albedo(&model, theta), model.directional_albedo(theta.cos()));
                assert!((sum - closed).abs() < 1e-6, "{model:?} {theta}: {sum} {closed}");
            }
        }
        let mean = simpson(0.0, PI / 2.0, 2000, |t| 2.0 * gained(t.cos()) * t.cos() * t.sin());
        assert!((mean - MEAN).abs() < 1e-9 && (gained(0.0) - GRAZING).abs() < 1e-15, "{mean}");
        assert!(eon(1.0, 0.5).describe().claims.lossless && !eon(0.9, 0.5).describe().claims.lossless);
    }

    #[test]
    fn without_roughness_it_is_lambert() {
        let f = eon(0.7, 0.0).eval(Direction::from_angles(1.2, 0.0), Direction::from_angles(0.4, 2.0), R)[0];
        assert!((f - 0.7 / PI).abs() < 1e-16);
        let wi = Direction::from_angles(0.4, 2.0);
        assert!((eon(0.7, 0.0).pdf(Direction::from_angles(1.2, 0.0), wi, R) - wi.z / PI).abs() < 1e-15);
    }

    /// [`ClippedCosine`] takes them, and uniform draws reach what it clips.
    #[test]
    fn fitted_lobes_are_valid() {
        for i in 0..=200 {
            for j in 0..=50 {
                let (mu, r) = (f64::from(i) / 200.0, f64::from(j) / 50.0);
                let wo = Direction::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                let (uniform, lobe) = eon(1.0, r).lobes(wo);
                assert!(lobe.is_valid(), "{mu} {r} {lobe:?}");
                assert!((0.0..0.2).contains(&uniform) && (uniform > 0.0) == (r > 0.0), "{mu} {r} {uniform}");
            }
        }
    }

    #[test]
    fn edges() {
        let grazing = Direction::new(0.6, -0.8, 1e-300);
        for r in [0.0, 0.5, 1.0] {
            for sampling in [EonSampling::ClippedCosine, EonSampling::Cosine, EonSampling::Uniform] {
                let model = OrenNayarEon::new(1.0, r, sampling);
                for wo in [Direction::NORMAL, Direction::from_angles(1.0, 2.0), grazing] {
                    for u in [[0.0, 0.0], [LAST, LAST], [LAST, 0.0], [1e-9, 0.5], [0.1, 0.3], [0.6, 0.8]] {
                        let Some(s) = model.sample(wo, &u, R) else { panic!("{model:?} {wo:?} {u:?}") };
                        assert!(
                            s.wi.z > 0.0 && (s.wi.length() - 1.0).abs() < 1e-14,
                            "{model:?} {wo:?} {s:?}"
                        );
                        assert!(s.weight[0].is_finite() && s.weight[0] >= 0.0 && s.pdf > 0.0);
                        let f = model.eval(wo, s.wi, R)[0];
                        assert!((s.weight[0] * s.pdf - f * s.wi.z).abs() <= 1e-14 * f * s.wi.z);
                        assert_eq!(f, model.eval(s.wi, wo, R)[0]);
                    }
                }
                let horizon = Direction::new(1.0, 0.0, 0.0);
                assert_eq!(model.eval(horizon, grazing, R)[0], 0.0);
                assert_eq!(model.pdf(grazing, grazing.flipped(), R), 0.0);
                assert!(model.sample(horizon, &[0.5, 0.5], R).is_none());
                assert!(model.eval(grazing, grazing.mirrored(), R)[0] >= 0.0);
                assert!(model.eval(grazing, grazing, R)[0].is_finite());
            }
        }
    }
}
