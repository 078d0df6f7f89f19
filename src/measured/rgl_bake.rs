//! RGL files of other BSDFs.

use super::rgl::{Rgl, normal};
use super::tensor_file::{Content, write};
use super::warp::{Blend, Grid, Warp};
use crate::bsdf::{Direction, Spectrum};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Of what resolution a file is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolution {
    /// Azimuths of the stored wo in radians: one for an isotropic subject; else from
    /// −π over a whole, a half or a quarter turn.
    pub phi: Vec<f64>,
    /// Number of polar angles of the stored wo, from 0 to 89°.
    pub theta: usize,
    /// Nodes along each axis of the density of visible normals.
    pub normals: usize,
    /// Nodes along each axis of luminance and spectra.
    pub spectra: usize,
}

impl Default for Resolution {
    /// As the database's isotropic files are made, with more polar angles.
    fn default() -> Self {
        Self { phi: vec![0.0], theta: 32, normals: 128, spectra: 64 }
    }
}

/// Nodes along u of D and σ.
const PLANE: usize = 256;

/// The isotropic GGX of roughness `alpha` that guides the warps; any distribution
/// may.
struct Guide {
    alpha2: f64,
}

impl Guide {
    fn ndf(&self, theta: f64) -> f64 {
        let (sin, cos) = theta.sin_cos();
        let s = sin * sin + self.alpha2 * cos * cos;
        self.alpha2 / (PI * s * s)
    }

    /// Projected area cos θ (1 + Λ) (E. Heitz 2014, eq. 72).
    fn sigma(&self, theta: f64) -> f64 {
        let (sin, cos) = theta.sin_cos();
        0.5 * (cos + (cos * cos + self.alpha2 * sin * sin).sqrt())
    }
}

impl Rgl {
    /// The content of a file that tabulates `value`, f in sr⁻¹ of (wo, wi), guided
    /// by a GGX distribution of roughness `alpha`. With `wavelengths` in nm as many
    /// as channels a spectral file, with none an RGB one.
    ///
    /// # Panics
    /// If the resolution has fewer than two nodes on an axis.
    pub fn bake(
        description: &str,
        wavelengths: &[f32],
        alpha: f64,
        resolution: &Resolution,
        value: impl Fn(Direction, Direction) -> Spectrum,
    ) -> Vec<u8> {
        let guide = Guide { alpha2: alpha * alpha };
        let Resolution { phi, theta, normals, spectra } = resolution;
        let channels = if wavelengths.is_empty() { 3 } else { wavelengths.len() };
        let isotropic = phi.len() <= 2;
        let thetas: Vec<f64> =
            (0..*theta).map(|k| 89f64.to_radians() * k as f64 / (theta - 1).max(1) as f64).collect();
        let rounded = |x: f64| f64::from(x as f32);
        let along_u = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let one: Vec<f64> = (0..PLANE)
                .map(|i| rounded(of((i as f64 / (PLANE - 1) as f64).powi(2) * FRAC_PI_2)))
                .collect();
            one.repeat(2)
        };
        let ndf = along_u(&|theta| guide.ndf(theta));
        let sigma = along_u(&|theta| guide.sigma(theta));
        let d = Grid::new([PLANE, 2], 1, ndf.clone());
        let (mut vndf, mut luminance, mut layers) = (Vec::new(), Vec::new(), Vec::new());
        for phi in phi {
            for theta in &thetas {
                let wo = Direction::from_angles(*theta, *phi);
                let phi0 = if isotropic { *phi } else { 0.0 };
                let node = |k: usize, n: usize| [k % n, k / n].map(|i| i as f64 / (n - 1) as f64);
                // Visible normals: D max(0, wo·m)/σ, per unit of (u, v).
                let visible: Vec<f64> = (0..normals * normals)
                    .map(|k| {
                        let uv = node(k, *normals);
                        let (m, _) = normal(uv, phi0);
                        let area = TAU * PI * uv[0] * m.x.hypot(m.y);
                        rounded(d.value(0, uv) * wo.dot(m).max(0.0) * area)
                    })
                    .collect();
                let warp = Warp::new([*normals; 2], visible.clone()).expect("some normals are visible");
                vndf.extend(visible);
                // What the reader will multiply by, so that nodes are met.
                let u = (theta / FRAC_PI_2).sqrt();
                let area = Grid::new([PLANE, 2], 1, sigma.clone()).value(0, [u, 0.5]);
                let mut slice = vec![0.0; channels * spectra * spectra];
                for k in 0..spectra * spectra {
                    let (uv, _) = warp.slice(Blend::one(0), 1).sample(node(k, *spectra));
                    let (m, _) = normal(uv, phi0);
                    let wi = wo.reflected(m);
                    let above = wi.z > 0.0 && wo.dot(m) > 0.0;
                    let f = if above { value(wo, wi) * wi.z } else { Spectrum::zero(channels) };
                    let scale = d.value(0, uv) / (4.0 * area);
                    for (c, f) in f.iter().enumerate() {
                        slice[c * spectra * spectra + k] = f / scale;
                    }
                }
                // Relative to visible normals, f·cos is what the spectra are.
                let mean = |k: usize| slice.iter().skip(k).step_by(spectra * spectra).sum::<f64>();
                let bright: Vec<f64> = (0..spectra * spectra).map(mean).collect();
                let least = 1e-3 * bright.iter().sum::<f64>() / bright.len() as f64;
                luminance.extend(bright.iter().map(|v| v.max(least).max(f64::from(f32::MIN_POSITIVE))));
                layers.extend(slice);
            }
        }
        let floats = |values: &[f64]| Content::Floats(values.iter().map(|v| *v as f32).collect());
        let given = [phi.len(), thetas.len()];
        let square = |n: usize| vec![given[0], given[1], n, n];
        let mut fields = vec![
            ("description", vec![description.len()], Content::Bytes(description.as_bytes().to_vec())),
            ("phi_i", vec![phi.len()], floats(phi)),
            ("theta_i", vec![thetas.len()], floats(&thetas)),
            ("ndf", vec![2, PLANE], floats(&ndf)),
            ("sigma", vec![2, PLANE], floats(&sigma)),
            ("vndf", square(*normals), floats(&vndf)),
            ("luminance", square(*spectra), floats(&luminance)),
        ];
        let shape = vec![given[0], given[1], channels, *spectra, *spectra];
        if wavelengths.is_empty() {
            fields.push(("rgb", shape, floats(&layers)));
        } else {
            fields.push(("wavelengths", vec![channels], Content::Floats(wavelengths.to_vec())));
            fields.push(("spectra", shape, floats(&layers)));
        }
        fields.push(("jacobian", vec![1], Content::Bytes(vec![1])));
        write(&fields)
    }
}
