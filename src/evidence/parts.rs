//! Calls of the parts that BSDFs are made of: distributions of normals and
//! Fresnel functions.

use super::meter::{Halt, Meter};
use super::setup::Setup;
use super::tally::Place;
use crate::bsdf::{
    Direction, FresnelFunction, NormalDistribution, Spectrum, Subject, SubjectError, SubjectKind,
};

/// Cosines at which two Fresnel functions are compared.
pub const COMPARED: usize = 65;

fn normals(subject: &dyn Subject) -> Result<&dyn NormalDistribution, SubjectError> {
    let missing = "it is described as a distribution of normals, and gives none";
    subject.distribution().ok_or_else(|| SubjectError::Broken(missing.into()))
}

fn fresnel(subject: &dyn Subject) -> Result<&dyn FresnelFunction, SubjectError> {
    let missing = "it is described as a Fresnel function, and gives none";
    subject.fresnel().ok_or_else(|| SubjectError::Broken(missing.into()))
}

/// D(m) for each of `m`.
pub fn densities(meter: &Meter, m: &[Direction], out: &mut Vec<f64>) -> Result<(), Halt> {
    meter.part("density", m.len(), |s| {
        let d = normals(s)?;
        out.clear();
        out.extend(m.iter().map(|m| d.density(*m)));
        Ok(())
    })?;
    for (value, m) in out.iter_mut().zip(m) {
        *value = meter.sane("density", *value, || Place { wo: *m, ..Place::default() });
    }
    Ok(())
}

/// G1(w, m) for each of `m`, 0 for those turned away or below the horizon.
pub fn masking(meter: &Meter, w: Direction, m: &[Direction], out: &mut Vec<f64>) -> Result<(), Halt> {
    meter.part("g1", m.len(), |s| {
        let d = normals(s)?;
        out.clear();
        out.extend(m.iter().map(|m| if m.z > 0.0 && w.dot(*m) > 0.0 { d.g1(w, *m) } else { 0.0 }));
        Ok(())
    })?;
    for (value, m) in out.iter_mut().zip(m) {
        *value = meter.sane("g1", *value, || Place::pair(w, *m));
    }
    Ok(())
}

/// Smith's Λ(w), where the masking is Smith's.
pub fn lambda(meter: &Meter, w: Direction) -> Result<Option<f64>, Halt> {
    let value = meter.part("lambda", 1, |s| Ok(normals(s)?.lambda(w)))?;
    Ok(value.map(|v| meter.sane("lambda", v, || Place { wo: w, ..Place::default() })))
}

/// The densities that the author gives for both ways of drawing normals: of all,
/// and of those visible from wo where they can be drawn.
pub fn told(meter: &Meter, wo: Direction, m: &[Direction]) -> Result<[Vec<f64>; 2], Halt> {
    let mut told = meter.part("pdf", 2 * m.len(), |s| {
        let d = normals(s)?;
        let all = m.iter().map(|m| d.pdf(*m)).collect();
        let visible = m.iter().map(|m| d.visible_pdf(wo, *m)).collect();
        Ok([all, if d.draws_visible() { visible } else { Vec::new() }])
    })?;
    for (name, values) in ["pdf", "visible_pdf"].into_iter().zip(&mut told) {
        for (value, m) in values.iter_mut().zip(m) {
            *value = meter.sane(name, *value, || Place::pair(wo, *m));
        }
    }
    Ok(told)
}

/// Normals drawn among all.
pub fn draw(meter: &Meter, u: &[f64]) -> Result<Vec<Direction>, Halt> {
    let dimensions = meter.dimensions();
    meter.part("sample", u.len() / dimensions, |s| {
        let d = normals(s)?;
        Ok(u.chunks_exact(dimensions).map(|u| d.sample(u)).collect())
    })
}

/// What a Fresnel function says of one angle.
pub struct Reflection {
    /// Reflectance by channel.
    pub reflectance: Spectrum,
    /// Transmittance, where it has one.
    pub transmittance: Option<Spectrum>,
    /// Both polarisations, where they are told apart.
    pub polarised: Option<[Spectrum; 2]>,
}

/// What a Fresnel function says of an angle. Values as they come: NaN is judged
/// by the laws.
pub fn reflection(meter: &Meter, cos: f64) -> Result<Reflection, Halt> {
    let channels = meter.channels();
    let length = |function, s: &Spectrum| match s.len() {
        n if n == channels => Ok(()),
        got => Err(SubjectError::WrongLength { function, expected: channels, got }),
    };
    meter.part("reflectance", 1, |s| {
        let f = fresnel(s)?;
        let all = Reflection {
            reflectance: f.reflectance(cos),
            transmittance: f.transmittance(cos),
            polarised: f.polarised(cos),
        };
        length("reflectance", &all.reflectance)?;
        all.transmittance.iter().try_for_each(|t| length("transmittance", t))?;
        all.polarised.iter().flatten().try_for_each(|p| length("polarised", p))?;
        Ok(all)
    })
}

/// What a part says beyond eval, pdf and sample, as numbers to compare: G1 of a
/// distribution at each of `m`, and all that a Fresnel function says over its
/// angles, [`COMPARED`] reflectances first. Nothing of a BSDF.
pub fn values(meter: &Meter, setup: &Setup, m: &[Direction]) -> Result<Vec<f64>, Halt> {
    let mut out = Vec::new();
    match meter.description.kind {
        SubjectKind::Bsdf => {}
        SubjectKind::Distribution if setup.wo.z > 0.0 => masking(meter, setup.wo, m, &mut out)?,
        SubjectKind::Distribution => {}
        SubjectKind::Fresnel => {
            let ends = if setup.claims.transmissive { [-1.0, 1.0] } else { [0.0, 1.0] };
            let mut more = Vec::new();
            for k in 0..COMPARED {
                let cos = ends[0] + (ends[1] - ends[0]) * k as f64 / (COMPARED - 1) as f64;
                let all = reflection(meter, cos)?;
                let add = |to: &mut Vec<f64>, name, spectrum: &Spectrum| {
                    to.extend(spectrum.iter().map(|v| meter.sane(name, *v, || at(setup, cos))));
                };
                add(&mut out, "reflectance", &all.reflectance);
                all.transmittance.iter().for_each(|t| add(&mut more, "transmittance", t));
                all.polarised.iter().flatten().for_each(|p| add(&mut more, "polarised", p));
            }
            out.append(&mut more);
        }
    }
    Ok(out)
}

/// A place that is told by its angle alone.
pub fn at(setup: &Setup, cos: f64) -> Place {
    let theta = cos.clamp(-1.0, 1.0).acos();
    Place { wo: Direction::from_angles(theta, setup.wo.phi()), ..Place::default() }
}
