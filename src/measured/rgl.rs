//! The measurements of J. Dupuy and W. Jakob, *An adaptive parameterization for
//! efficient material acquisition and rendering*, SIGGRAPH Asia 2018 (the RGL
//! material database of EPFL).

use super::half_difference::angle;
use super::per_wo::Reflector;
use super::warp::{Blend, Grid, Slice, Warp, locate};
use crate::bsdf::{Description, Direction, Lobe, Sample, Spectrum, Table};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Below this, 2π² u sin θm counts as this: at the pole the map from the square
/// to microfacet normals m is singular. As the authors' reader has it.
const SMALLEST_AREA: f64 = 1e-6;

/// An RGL measurement: f·cos θi for each wo of a grid, over a square that two
/// warps stretch where light is.
///
/// A point of the square is warped by the luminance (so that it follows f·cos),
/// then by the density of visible normals, to (u, v) of the microfacet normal m:
/// θm = u² π/2, φm = 2π v − π (paper, §5). f·cos θi is the spectrum stored at
/// the point between the warps times D(m)/(4 σ(wo)). The file's ωi is gonio's
/// given direction wo, its ωo gonio's wi. Values between the stored wo are
/// interpolated linearly in φo and θo.
#[derive(Clone, Debug)]
pub struct Rgl {
    pub(super) name: String,
    pub(super) channels: Vec<String>,
    pub(super) phi: Vec<f64>,
    pub(super) theta: Vec<f64>,
    /// D over (u, v) of m; `None` where the stored spectra are f·cos themselves.
    pub(super) scale: Option<Scale>,
    pub(super) vndf: Warp,
    pub(super) luminance: Warp,
    pub(super) spectra: Grid,
    pub(super) isotropic: bool,
    /// Into how many parts of 2π the measured φo fold: 1, 2 or 4.
    pub(super) fold: u32,
}

/// The factor D(m)/(4 σ(wo)) of the stored spectra.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    /// Distribution of normals, over (u, v) of m.
    pub ndf: Grid,
    /// Projected area of the microsurface, over (u, v) of wo.
    pub sigma: Grid,
}

/// sin θm below which m is the surface normal.
const COINCIDENT: f64 = 1e-9;

/// u of a polar angle.
pub(super) fn u_of_theta(theta: f64) -> f64 {
    (theta / FRAC_PI_2).sqrt()
}

/// v in [0, 1) of an azimuth.
pub(super) fn v_of_phi(phi: f64) -> f64 {
    let v = (phi + PI) / TAU;
    v - v.floor()
}

/// The microfacet normal at (u, v), and the solid angle of a unit of area there.
pub(super) fn normal([u, v]: [f64; 2], phi0: f64) -> (Direction, f64) {
    let (sin, cos) = (u * u * FRAC_PI_2).sin_cos();
    let (sin_phi, cos_phi) = (TAU * v - PI + phi0).sin_cos();
    (Direction::new(sin * cos_phi, sin * sin_phi, cos), area(u, sin))
}

/// dω = 2π² u sin θm du dv, see [`SMALLEST_AREA`].
fn area(u: f64, sin_theta: f64) -> f64 {
    (2.0 * PI * PI * u * sin_theta).max(SMALLEST_AREA)
}

/// What depends on wo alone.
pub struct GivenSlices<'a> {
    /// wo within the measured range of azimuths.
    wo: Direction,
    /// What turned it there is applied to wi too.
    signs: [f64; 2],
    /// The azimuth from which φm is counted.
    phi0: f64,
    blend: Blend,
    vndf: Slice<'a>,
    luminance: Slice<'a>,
    /// 1/(4 σ(wo)).
    scale: f64,
}

impl Rgl {
    /// (u, v) of the microfacet normal m of wi, sin θm and wo·m.
    fn place(&self, given: &GivenSlices, wi: Direction) -> ([f64; 2], f64, f64) {
        let wi = Direction::new(wi.x * given.signs[0], wi.y * given.signs[1], wi.z);
        let m = (wi + given.wo).normalized();
        let across = (m.x * m.x + m.y * m.y).sqrt();
        // φ of the normal itself has no meaning.
        let phi = if across < COINCIDENT { 0.0 } else { m.y.atan2(m.x) - given.phi0 };
        ([u_of_theta(angle(across, m.z)), v_of_phi(phi)], across, given.wo.dot(m))
    }

    /// f·cos θi at the point of the square between the warps that belongs to m at
    /// `uv`.
    fn light(&self, given: &GivenSlices, uv: [f64; 2], point: [f64; 2], out: &mut [f64]) {
        self.spectra.at(&given.blend, point, out);
        let scale = match &self.scale {
            Some(scale) => scale.ndf.value(0, uv) * given.scale,
            None => 1.0,
        };
        out.iter_mut().for_each(|v| *v = (*v * scale).max(0.0));
    }
}

impl Reflector for Rgl {
    type Given<'a> = GivenSlices<'a>;

    fn describe(&self) -> Description {
        Description::new(self.name.clone())
            .channels(self.channels.clone())
            .dimensions(2)
            .claims(|c| {
                c.isotropic = self.isotropic;
                // Measured and interpolated for each wo by itself.
                c.reciprocal = false;
            })
            .table(Table::default())
    }

    fn given(&self, wo: Direction, calls: usize) -> GivenSlices<'_> {
        // Measured azimuths begin at −π: directions are turned or mirrored there.
        let to_negative = |x: f64| if x.is_sign_negative() { 1.0 } else { -1.0 };
        let signs = match self.fold {
            4 => [to_negative(wo.x), to_negative(wo.y)],
            2 => [to_negative(wo.y); 2],
            _ => [1.0, 1.0],
        };
        let wo = Direction::new(wo.x * signs[0], wo.y * signs[1], wo.z);
        let (theta, phi) = (wo.theta(), wo.phi());
        let blend = Blend::of_two(locate(&self.phi, phi), locate(&self.theta, theta), self.theta.len());
        let sigma = |scale: &Scale| scale.sigma.value(0, [u_of_theta(theta), v_of_phi(phi)]);
        GivenSlices {
            wo,
            signs,
            phi0: if self.isotropic { phi } else { 0.0 },
            blend,
            vndf: self.vndf.slice(blend, calls),
            luminance: self.luminance.slice(blend, calls),
            scale: self.scale.as_ref().map_or(1.0, |s| 0.25 / sigma(s)),
        }
    }

    fn eval(&self, given: &GivenSlices, wi: Direction, out: &mut [f64]) {
        let (uv, ..) = self.place(given, wi);
        let (point, _) = given.vndf.invert(uv);
        self.light(given, uv, point, out);
        out.iter_mut().for_each(|v| *v /= wi.z);
    }

    fn pdf(&self, given: &GivenSlices, wi: Direction) -> f64 {
        let (uv, sin_theta, cosine) = self.place(given, wi);
        let (point, visible) = given.vndf.invert(uv);
        visible * given.luminance.density(point) / (area(uv[0], sin_theta) * 4.0 * cosine)
    }

    fn sample(&self, given: &GivenSlices, u: [f64; 2]) -> Option<Sample> {
        let (point, bright) = given.luminance.sample(u);
        let (uv, visible) = given.vndf.sample(point);
        let (m, area) = normal(uv, given.phi0);
        let cosine = given.wo.dot(m);
        let wi = given.wo.reflected(m);
        let pdf = bright * visible / (area * 4.0 * cosine);
        if !(cosine > 0.0 && wi.z > 0.0 && pdf > 0.0) {
            return None;
        }
        let mut weight = Spectrum::zero(self.channels.len());
        self.light(given, uv, point, &mut weight);
        let wi = Direction::new(wi.x * given.signs[0], wi.y * given.signs[1], wi.z);
        Some(Sample { wi, weight: weight * (1.0 / pdf), pdf, lobe: Lobe::GLOSSY_REFLECTION })
    }
}
