//! What a Fresnel function is to gonio, and how it becomes a subject.

use super::{Description, Direction, Has, Samples, Spectrum, Subject, SubjectError, SubjectKind, Transport};

/// What an author of a Fresnel function implements: how much of unpolarised
/// light an interface reflects, by angle. [`Interface`] makes it a [`Subject`].
///
/// Angles are told by the signed cosine of the incident direction with the
/// normal, in [−1, 1]: light with a negative one arrives on the back side, from
/// inside. Only where `transmissive` is claimed is the inside looked at.
///
/// Claims say what it is held to: `eta` that it follows Fresnel's equations for
/// that index of the inside over the outside (an approximation does not claim
/// it), `lossless` that R + T = 1, `energy_conserving` that R + T ≤ 1,
/// `reciprocal` that both ways along a refracted ray reflect the same.
pub trait FresnelFunction: Send + Sync {
    /// Name, channels, precision, claims.
    fn describe(&self) -> Description;

    /// Reflected part of the flux, in [0, 1] per channel.
    fn reflectance(&self, cos: f64) -> Spectrum;

    /// Transmitted part of the flux (not of radiance), in [0, 1] per channel,
    /// where it has a formula of its own.
    fn transmittance(&self, _cos: f64) -> Option<Spectrum> {
        None
    }

    /// Reflectances of both polarisations, s (perpendicular to the plane of
    /// incidence) and p (parallel), where they are told apart.
    fn polarised(&self, _cos: f64) -> Option<[Spectrum; 2]> {
        None
    }
}

/// A Fresnel function as a subject. It has no directions to draw, and so none of
/// the three functions of a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct Interface<F>(pub F);

fn missing() -> SubjectError {
    SubjectError::Broken("a Fresnel function has no eval, pdf or sample".into())
}

impl<F: FresnelFunction> Subject for Interface<F> {
    fn describe(&self) -> Description {
        let mut description =
            self.0.describe().dimensions(0).has(Has { eval: false, pdf: false, sample: false });
        description.kind = SubjectKind::Fresnel;
        description
    }

    fn eval(&self, _: Direction, _: &[Direction], _: Transport, _: &mut [f64]) -> Result<(), SubjectError> {
        Err(missing())
    }

    fn pdf(&self, _: Direction, _: &[Direction], _: Transport, _: &mut [f64]) -> Result<(), SubjectError> {
        Err(missing())
    }

    fn sample(&self, _: Direction, _: &[f64], _: Transport, _: &mut Samples) -> Result<(), SubjectError> {
        Err(missing())
    }

    fn fresnel(&self) -> Option<&dyn FresnelFunction> {
        Some(&self.0)
    }
}
