//! GGX that gives back what its single scattering loses.

use super::{Distribution, Fresnel, GgxLoss, Masking, NormalSampling, Roughness, TorranceSparrow};
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::models::{Metal, mixture};
use crate::registry::{Model, Parameters, Role};
use crate::sphere::sin_cos_turns;
use std::f64::consts::PI;
use std::sync::Arc;

/// The single-scattering GGX lobe (height-correlated Smith masking), plus
/// F_ms (1 − E(μo)) (1 − E(μi))/(π (1 − E_avg)) for light that bounces between
/// facets (C. Kulla and A. Conty, *Revisiting physically based shading at
/// Imageworks*, SIGGRAPH 2017 course; after C. Kelemen and L. Szirmay-Kalos 2001).
/// Reciprocal; lossless where facets reflect everything.
///
/// F_ms = F_avg² E_avg/(1 − F_avg (1 − E_avg)): light that leaves at the k-th
/// bounce was reflected k times, so over k ≥ 2 Σ F_avg^k (1 − E_avg)^(k−2) E_avg
/// (S. Hill, *A multi-faceted exploration*, part 2, 2018: a factor F_avg more than
/// on Kulla and Conty's slides).
#[derive(Clone, Debug)]
pub struct GgxMultiscatter {
    pub(crate) single: TorranceSparrow,
    pub(crate) loss: Arc<GgxLoss>,
    /// F_ms/(π (1 − E_avg)).
    pub(crate) scale: Spectrum,
    /// F_ms over F_avg, both averaged over channels: by how much less a loss is
    /// made good than its light was reflected once.
    made_good: f64,
    lossless: bool,
}

/// Hints around the horizon: denser than the cells that a cubature starts with.
const HINTS: u32 = 64;

/// The registered model `ggx-multiscatter`.
pub(in crate::models) fn model() -> Model {
    Model::new(
        "ggx-multiscatter",
        "GGX with its lost energy returned (Kulla and Conty 2017)",
        GgxMultiscatter::declared,
    )
    .number("alpha", 0.5, 1e-4..=1.0, "roughness")
    .role(Role::Roughness)
    .choice("fresnel", &["none", "schlick", "conductor"], "reflectance F of a facet")
    .number("f0", 0.9, 0.0..=1.0, "reflectance of a facet at normal incidence")
    .only_when("fresnel", &["schlick"])
    .choice("metal", &Metal::NAMES, "whose complex index of refraction")
    .only_when("fresnel", &["conductor"])
}

impl GgxMultiscatter {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        let fresnel = match p.text("fresnel") {
            "schlick" => Fresnel::Schlick(p.number("f0")),
            "conductor" => Fresnel::Conductor(Metal::named(p.text("metal"))),
            _ => Fresnel::None,
        };
        GgxMultiscatter::new(p.number("alpha"), fresnel)
    }

    /// With slope roughness `alpha` in [1e-4, 1], isotropic. Makes the table of
    /// losses (about a millisecond) unless another subject holds it.
    pub fn new(alpha: f64, fresnel: Fresnel) -> Result<Self, String> {
        let single = TorranceSparrow::new(
            Distribution::ggx(Roughness::isotropic(alpha)),
            Masking::Smith,
            fresnel,
            NormalSampling::Visible,
        )?;
        let loss = GgxLoss::of(alpha);
        let lost = loss.average();
        let average = average_reflectance(&single);
        let multiple = average.map(|f| f * f * (1.0 - lost) / (1.0 - f * lost));
        Ok(Self {
            scale: multiple * (1.0 / (PI * lost)),
            made_good: multiple.mean() / average.mean(),
            lossless: fresnel == Fresnel::None,
            single,
            loss,
        })
    }

    /// The probability of drawing from the lobe of many bounces: about its share
    /// of the light.
    #[inline]
    pub(crate) fn share(&self, wo: Direction) -> f64 {
        self.share_of(self.lost(wo))
    }

    #[inline]
    fn share_of(&self, lost: f64) -> f64 {
        let back = lost * self.made_good;
        back / (1.0 - lost + back)
    }

    /// What the single lobe loses of the light from `w`.
    #[inline]
    fn lost(&self, w: Direction) -> f64 {
        self.loss.at(w.z.min(1.0))
    }

    /// The density of wi in the lobe of many bounces.
    #[inline]
    pub(crate) fn multiple_density(&self, wi: Direction) -> f64 {
        self.density_of(self.lost(wi), wi)
    }

    #[inline]
    fn density_of(&self, lost: f64, wi: Direction) -> f64 {
        lost * wi.z / (PI * self.loss.average())
    }
}

/// F_avg = 2∫F μ dμ of each channel: Gauss and Legendre's rule of two points on
/// pieces that shrink towards grazing, where F is steepest.
fn average_reflectance(single: &TorranceSparrow) -> Spectrum {
    const PIECES: u32 = 200;
    let off = 0.5 / 3f64.sqrt();
    let places = (0..PIECES).flat_map(|k| [-off, off].map(|o| (f64::from(k) + 0.5 + o) / f64::from(PIECES)));
    // μ = s².
    let terms = places.map(|s| single.reflected(s * s, 2.0 * s.powi(3) / f64::from(PIECES)));
    terms.fold(Spectrum::zero(single.channels()), |sum, f| Spectrum::from_fn(sum.len(), |c| sum[c] + f[c]))
}

impl Bsdf for GgxMultiscatter {
    fn describe(&self) -> Description {
        let mut description = Bsdf::describe(&self.single).claims(|c| c.lossless = self.lossless);
        description.name = "ggx-multiscatter".into();
        description
    }

    #[inline]
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        let single = Bsdf::eval(&self.single, wo, wi, transport);
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return single;
        }
        let lost = self.lost(wo) * self.lost(wi);
        Spectrum::from_fn(single.len(), |c| single[c] + self.scale[c] * lost)
    }

    #[inline]
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let share = self.share(wo);
        (1.0 - share) * Bsdf::pdf(&self.single, wo, wi, transport) + share * self.multiple_density(wi)
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let lost_o = self.lost(wo);
        let share = self.share_of(lost_o);
        let (chosen, first) = mixture::choose([share, 1.0 - share], u[0]);
        let (wi, single, density, lobe) = if chosen == 0 {
            // From the normal down to the horizon.
            let z = self.loss.sample(1.0 - first);
            let (sin, cos) = sin_cos_turns(u[1]);
            let r = ((1.0 - z) * (1.0 + z)).sqrt();
            let wi = Direction::new(r * cos, r * sin, z);
            let single = Bsdf::eval(&self.single, wo, wi, transport);
            (wi, single, Bsdf::pdf(&self.single, wo, wi, transport), Lobe::DIFFUSE_REFLECTION)
        } else {
            let s = self.single.sample(wo, &[first, u[1]], transport)?;
            (s.wi, s.weight * (s.pdf / s.wi.z), s.pdf, s.lobe)
        };
        let lost_i = self.lost(wi);
        let pdf = (1.0 - share) * density + share * self.density_of(lost_i, wi);
        let lost = lost_o * lost_i;
        let weight = Spectrum::from_fn(single.len(), |c| (single[c] + self.scale[c] * lost) * (wi.z / pdf));
        // Within 1e-150 of the horizon f is beyond f64.
        let valid = pdf > 0.0 && pdf.is_finite() && weight[0].is_finite();
        valid.then_some(Sample { wi, weight, pdf, lobe })
    }

    /// What many bounces return of small α is a ring along the horizon, α wide.
    fn hints(&self, _: Direction) -> Vec<Direction> {
        let theta = self.loss.alpha().acos();
        let azimuth = |k: u32| 2.0 * PI * f64::from(k) / f64::from(HINTS);
        (0..HINTS).map(|k| Direction::from_angles(theta, azimuth(k))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;
    const R: Transport = Transport::Radiance;

    fn view(degrees: f64) -> Direction {
        Direction::from_angles(degrees.to_radians(), 0.7)
    }

    /// ∫f cos θi over the hemisphere, f being seen through `eval` alone: the
    /// trapezoidal rule in the logits of μi, below and above μo, and of Δφ, whose
    /// points gather exponentially at the mirror direction and at the horizon.
    fn flux(model: &GgxMultiscatter, theta: f64) -> f64 {
        const STEP: f64 = 0.4;
        let points: Vec<_> = (-75..=75)
            .map(|k| {
                let (near, far) =
                    (1.0 / (1.0 + (-STEP * f64::from(k)).exp()), 1.0 / (1.0 + (STEP * f64::from(k)).exp()));
                (near, far, STEP * near * far)
            })
            .collect();
        let (sin, mu) = theta.sin_cos();
        let wo = Direction::new(sin, 0.0, mu);
        // Both halves of Δφ, from the mirror direction at −x.
        let ring = |z: f64| {
            let r = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
            let f = |phi: f64| model.eval(wo, Direction::new(-r * phi.cos(), r * phi.sin(), z), R)[0];
            2.0 * PI * z * points.iter().map(|p| p.2 * f(PI * p.0)).sum::<f64>()
        };
        let below: f64 = points.iter().map(|p| mu * p.2 * ring(mu * p.0)).sum();
        let above: f64 = points.iter().map(|p| (1.0 - mu) * p.2 * ring(mu + (1.0 - mu) * p.0)).sum();
        below + above
    }

    #[test]
    fn white_furnace_at_every_roughness_and_angle() {
        let mut worst = (0.0, 0.0, 0.0);
        for alpha in [1e-3, 3e-3, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0] {
            let model = GgxMultiscatter::new(alpha, Fresnel::None).unwrap();
            let angles =
                (0..30).map(|k| 3.0 * f64::from(k)).chain([88.5, 89.0, 89.3, 89.6, 89.8, 89.9, 89.99]);
            for theta in angles {
                let off = flux(&model, theta.to_radians()) - 1.0;
                if f64::abs(off) > f64::abs(worst.0) {
                    worst = (off, alpha, theta);
                }
            }
        }
        let (off, alpha, theta) = worst;
        println!("flux − 1 is {off:.1e} at worst, at alpha {alpha}, {theta}°");
        assert!(off.abs() < 1e-6, "{off:e} at alpha {alpha}, {theta}°");
    }

    /// f of many bounces by itself, over μ: what the single lobe lacks.
    #[test]
    fn many_bounces_carry_the_loss() {
        for alpha in [1e-3, 0.1, 1.0] {
            let model = GgxMultiscatter::new(alpha, Fresnel::None).unwrap();
            for theta in [0.0, 60.0, 89.0] {
                let n = 100_000;
                let sum: f64 = (0..n)
                    .map(|k| {
                        let s = (f64::from(k) + 0.5) / f64::from(n);
                        let wi = Direction::from_angles(s.powi(4).acos(), 2.0);
                        model.scale[0] * model.lost(view(theta)) * model.lost(wi) * s.powi(7) * 4.0
                            / f64::from(n)
                    })
                    .sum();
                let lost = model.loss.at(view(theta).z);
                assert!((2.0 * PI * sum / lost - 1.0).abs() < 1e-6, "{alpha} {theta}");
            }
        }
    }

    #[test]
    fn bounces_take_colour() {
        // 2∫F μ dμ of Schlick's approximation is F0 + (1 − F0)/21.
        let f0 = 0.3;
        let model = GgxMultiscatter::new(0.8, Fresnel::Schlick(f0)).unwrap();
        let average = average_reflectance(&model.single)[0];
        assert!((average - (f0 + (1.0 - f0) / 21.0)).abs() < 1e-8, "{average}");
        let e = 1.0 - model.loss.average();
        let series: f64 = (2..200).map(|k| average.powi(k) * (1.0 - e).powi(k - 2) * e).sum();
        let multiple = model.scale[0] * PI * model.loss.average();
        assert!((series / multiple - 1.0).abs() < 1e-12);
        let gold = GgxMultiscatter::new(0.8, Fresnel::Conductor(Metal::Gold)).unwrap();
        assert!(gold.scale[0] > gold.scale[1] && gold.scale[1] > gold.scale[2]);
        assert_eq!(gold.describe().channels.len(), 3);
        let claims = |m: GgxMultiscatter| m.describe().claims;
        assert!(!claims(gold).lossless && !claims(model).lossless);
        assert!(claims(GgxMultiscatter::new(0.8, Fresnel::None).unwrap()).lossless);
        // Where nothing is lost to a facet, Schlick's is no Fresnel term.
        let one = GgxMultiscatter::new(0.8, Fresnel::Schlick(1.0)).unwrap();
        let none = GgxMultiscatter::new(0.8, Fresnel::None).unwrap();
        let (a, b) = (one.eval(view(40.0), view(70.0), R), none.eval(view(40.0), view(70.0), R));
        assert!((a[0] / b[0] - 1.0).abs() < 1e-12);
    }

    #[test]
    fn sample_eval_and_pdf_agree_and_edges_give_valid_output_or_none() {
        let grazing = Direction::new(1.0, 0.0, 1e-300);
        let horizon = Direction::new(1.0, 0.0, 0.0);
        for alpha in [1e-4, 0.2, 1.0] {
            for fresnel in [Fresnel::None, Fresnel::Schlick(0.0), Fresnel::Conductor(Metal::Copper)] {
                let model = GgxMultiscatter::new(alpha, fresnel).unwrap();
                for wo in [Direction::NORMAL, view(30.0), view(85.0), view(89.99), grazing] {
                    for u0 in [0.0, 1e-9, 0.03, 0.2, 0.5, 0.8, 0.999, LAST] {
                        for u1 in [0.0, 0.4, LAST] {
                            let Some(s) = model.sample(wo, &[u0, u1], R) else { continue };
                            assert!((s.wi.length() - 1.0).abs() < 1e-14 && s.wi.z > 0.0, "{s:?}");
                            let (f, pdf) = (model.eval(wo, s.wi, R), model.pdf(wo, s.wi, R));
                            assert!((s.pdf / pdf - 1.0).abs() < 1e-7, "{model:?} {wo:?} {s:?} {pdf}");
                            for (w, f) in s.weight.iter().zip(f.iter()) {
                                let off = (w * pdf - f * s.wi.z).abs();
                                assert!(off <= 1e-7 * f * s.wi.z, "{model:?} {wo:?} {s:?}");
                            }
                            let swapped = model.eval(s.wi, wo, R);
                            assert!((swapped[0] - f[0]).abs() <= 1e-13 * f[0]);
                        }
                    }
                }
                for (wo, wi) in [(horizon, horizon), (horizon, view(3.0)), (view(3.0), view(100.0))] {
                    assert_eq!((model.eval(wo, wi, R)[0], model.pdf(wo, wi, R)), (0.0, 0.0));
                    assert!(model.sample(wi.flipped(), &[0.5, 0.5], R).is_none() || wi.z <= 0.0);
                }
                for wi in [grazing, grazing.mirrored(), Direction::NORMAL] {
                    assert!(!model.eval(grazing, wi, R)[0].is_nan() && !model.pdf(grazing, wi, R).is_nan());
                }
            }
        }
    }
}
