//! The smooth interface between two dielectrics.

use super::fresnel;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport, TransportModes};
use crate::registry::{Model, Parameters, Role};

/// A smooth interface: mirror reflection with the probability F of Fresnel's
/// equations, else refraction by Snell's law (Born and Wolf, *Principles of
/// Optics*, §1.5). Two discrete lobes, so eval and pdf are 0. In radiance mode
/// what is transmitted carries (η_o/η_i)² (E. Veach, *Robust Monte Carlo
/// Methods for Light Transport Simulation*, 1997, §5.2).
#[derive(Clone, Copy, Debug)]
pub struct Dielectric {
    /// Index of refraction of the back side (z < 0) over that of the front, > 0.
    pub eta: f64,
}

/// The registered model `dielectric`.
pub(super) fn model() -> Model {
    Model::new("dielectric", "smooth dielectric interface (Fresnel 1823, Snell)", Dielectric::declared)
        .number("eta", 1.5, 1.0..=4.0, "index of refraction of the back side over the front side")
        .role(Role::Eta)
}

impl Dielectric {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self { eta: p.number("eta") })
    }

    /// The index of the far over the near side.
    #[inline]
    pub(crate) fn relative_eta(&self, wo: Direction) -> f64 {
        if wo.z > 0.0 { self.eta } else { 1.0 / self.eta }
    }
}

impl Bsdf for Dielectric {
    fn describe(&self) -> Description {
        Description::new("dielectric").dimensions(1).claims(|c| {
            c.transmissive = true;
            c.isotropic = true;
            c.lossless = true;
            c.eta = Some(self.eta);
            c.transport = TransportModes::Both;
        })
    }

    fn eval(&self, _: Direction, _: Direction, _: Transport) -> Spectrum {
        Spectrum::zero(1)
    }

    fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
        0.0
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if wo.z == 0.0 {
            return None;
        }
        let eta = self.relative_eta(wo);
        let cos_o = wo.z.abs();
        let reflected = fresnel::dielectric(cos_o, eta);
        if u[0] < reflected {
            return Some(Sample {
                wi: wo.mirrored(),
                weight: Spectrum::from(1.0),
                pdf: reflected,
                lobe: Lobe::DISCRETE_REFLECTION,
            });
        }
        let cos_i = fresnel::refracted_cosine(cos_o, eta)?;
        let wi = Direction::new(-wo.x / eta, -wo.y / eta, -cos_i.copysign(wo.z));
        let weight = match transport {
            Transport::Radiance => 1.0 / (eta * eta),
            Transport::Importance => 1.0,
        };
        Some(Sample {
            wi,
            weight: Spectrum::from(weight),
            pdf: 1.0 - reflected,
            lobe: Lobe::DISCRETE_TRANSMISSION,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAST: f64 = 1.0 - f64::EPSILON / 2.0;

    #[test]
    fn lobes_share_the_flux_and_obey_snell() {
        let glass = Dielectric { eta: 1.5 };
        for theta in [0.0, 0.5, 0.7, 1.2, 1.57, 1.6, 2.0, 2.5, 3.1] {
            let wo = Direction::from_angles(theta, 2.4);
            let claims = glass.describe().claims;
            for transport in [Transport::Radiance, Transport::Importance] {
                let mut flux = 0.0;
                for u in [0.0, LAST] {
                    let s = glass.sample(wo, &[u], transport).unwrap();
                    assert!((s.wi.length() - 1.0).abs() < 1e-15);
                    if u > 0.0 && s.lobe == Lobe::DISCRETE_REFLECTION {
                        continue;
                    }
                    flux += s.pdf * s.weight[0] * claims.flux_factor(wo.z > 0.0, s.wi.z > 0.0, transport);
                    if s.lobe == Lobe::DISCRETE_TRANSMISSION {
                        let (front, back) = if wo.z > 0.0 { (wo, s.wi) } else { (s.wi, wo) };
                        let tangential = front + back * 1.5;
                        assert!(tangential.x.hypot(tangential.y) < 1e-15);
                    }
                }
                assert!((flux - 1.0).abs() < 1e-15, "{theta}: {flux}");
            }
        }
    }

    #[test]
    fn equal_indices_do_nothing() {
        for z in [1.0, 1e-300, -0.3] {
            let wo = Direction::new((1.0f64 - z * z).sqrt(), 0.0, z);
            let s = Dielectric { eta: 1.0 }.sample(wo, &[0.0], Transport::Radiance).unwrap();
            assert_eq!((s.pdf, s.weight[0], s.lobe), (1.0, 1.0, Lobe::DISCRETE_TRANSMISSION));
            assert!((s.wi + wo).length() < 1e-15);
        }
    }

    #[test]
    fn nothing_at_the_horizon() {
        assert!(
            Dielectric { eta: 1.5 }
                .sample(Direction::new(1.0, 0.0, 0.0), &[0.5], Transport::Radiance)
                .is_none()
        );
    }
}
