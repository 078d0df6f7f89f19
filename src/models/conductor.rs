//! The smooth metal mirror.

use super::fresnel;
use super::metal::Metal;
use crate::bsdf::{Bsdf, Description, Direction, Lobe, Sample, Spectrum, Transport};
use crate::registry::{Model, Parameters};

/// What part of the light a [`Conductor`] reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConductorFresnel {
    /// Fresnel's equations with a complex index, one channel a wavelength.
    Exact(Metal),
    /// Schlick's approximation from the reflectance at normal incidence in [0, 1].
    Schlick(f64),
}

/// A smooth mirror on the front side: one discrete lobe, so eval and pdf are 0
/// (Born and Wolf, *Principles of Optics*, §14.2; C. Schlick 1994).
#[derive(Clone, Copy, Debug)]
pub struct Conductor {
    /// The reflectance.
    pub fresnel: ConductorFresnel,
}

/// The registered model `conductor`.
pub(super) fn model() -> Model {
    Model::new("conductor", "smooth metal mirror (Fresnel 1823; Schlick 1994)", Conductor::declared)
        .choice("fresnel", &["exact", "schlick"], "reflectance by angle")
        .choice("metal", &Metal::NAMES, "whose complex index of refraction")
        .only_when("fresnel", &["exact"])
        .number("f0", 0.9, 0.0..=1.0, "reflectance at normal incidence")
        .only_when("fresnel", &["schlick"])
}

impl Bsdf for Conductor {
    fn describe(&self) -> Description {
        let description = Description::new("conductor").dimensions(1).claims(|c| {
            c.isotropic = true;
            c.lossless = self.fresnel == ConductorFresnel::Schlick(1.0);
        });
        match self.fresnel {
            ConductorFresnel::Exact(_) => description.channels(Metal::WAVELENGTHS),
            ConductorFresnel::Schlick(_) => description,
        }
    }

    fn eval(&self, _: Direction, _: Direction, _: Transport) -> Spectrum {
        self.black()
    }

    fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
        0.0
    }

    fn sample(&self, wo: Direction, _: &[f64], _: Transport) -> Option<Sample> {
        if wo.z <= 0.0 {
            return None;
        }
        let weight = match self.fresnel {
            ConductorFresnel::Exact(metal) => {
                let index = metal.index();
                Spectrum::from_fn(index.len(), |c| fresnel::conductor(wo.z, index[c].0, index[c].1))
            }
            ConductorFresnel::Schlick(f0) => Spectrum::from(fresnel::schlick(wo.z, f0)),
        };
        Some(Sample { wi: wo.mirrored(), weight, pdf: 1.0, lobe: Lobe::DISCRETE_REFLECTION })
    }
}

impl Conductor {
    /// As the registered model reads its parameters.
    pub(crate) fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self {
            fresnel: match p.text("fresnel") {
                "schlick" => ConductorFresnel::Schlick(p.number("f0")),
                _ => ConductorFresnel::Exact(Metal::named(p.text("metal"))),
            },
        })
    }

    fn black(&self) -> Spectrum {
        Spectrum::zero(match self.fresnel {
            ConductorFresnel::Exact(metal) => metal.index().len(),
            ConductorFresnel::Schlick(_) => 1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_the_front_side_only() {
        let gold = Conductor { fresnel: ConductorFresnel::Exact(Metal::Gold) };
        let wo = Direction::from_angles(1.0, 0.3);
        let s = gold.sample(wo, &[0.5], Transport::Radiance).unwrap();
        assert_eq!(s.wi, wo.mirrored());
        assert_eq!(s.weight.len(), gold.describe().channels.len());
        // Gold is yellow: it reflects red more than blue.
        assert!(s.weight[0] > s.weight[1] && s.weight[1] > s.weight[2]);
        for below in [wo.flipped(), Direction::new(1.0, 0.0, 0.0)] {
            assert!(gold.sample(below, &[0.5], Transport::Radiance).is_none());
        }
    }

    #[test]
    fn schlick_is_exact_at_both_ends() {
        let mirror = Conductor { fresnel: ConductorFresnel::Schlick(0.7) };
        let weight = |wo| mirror.sample(wo, &[0.0], Transport::Radiance).unwrap().weight[0];
        assert_eq!(weight(Direction::NORMAL), 0.7);
        assert!((weight(Direction::new(1.0, 0.0, 1e-17)) - 1.0).abs() < 1e-15);
    }
}
