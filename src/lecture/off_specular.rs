//! Rough surfaces are brightest beyond the mirror direction, the more so the
//! more grazing the light: what Torrance and Sparrow's paper set out to explain.

use super::steps;
use crate::bsdf::{Bsdf, Direction, Transport};
use crate::models::Metal;
use crate::models::microfacet::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use crate::report::{Line, LinePlot};

/// exp(−(θm/20°)²): facets within some 20° of the surface.
const WIDTH_DEG: f64 = 20.0;

/// Magnesium oxide at 589 nm: R. E. Stephens and I. H. Malitson, *Index of
/// refraction of magnesium oxide*, J. Res. NBS 49, 249 (1952).
const MAGNESIUM_OXIDE: f64 = 1.7375;

/// f in the plane of incidence over its value in the mirror direction, for light
/// at four angles.
fn plot(title: &str, fresnel: Fresnel) -> LinePlot {
    let model = TorranceSparrow::new(
        Distribution::gaussian(Roughness::isotropic(WIDTH_DEG.to_radians())),
        Masking::VCavity,
        fresnel,
        NormalSampling::All,
    )
    .expect("all normals of a Gaussian can be drawn");
    let line = |(colour, incident): (usize, f64)| {
        let wi = Direction::from_angles(f64::to_radians(incident), 0.0);
        let value = |degrees: f64| {
            let wo = Direction::from_angles(degrees.to_radians(), std::f64::consts::PI);
            // Green light.
            let f = model.eval(wo, wi, Transport::Radiance);
            f[f.len() / 2]
        };
        let mirror = value(incident);
        let points = steps(0.0, 89.9, 899).map(|d| (d, value(d) / mirror)).collect();
        Line::new(format!("light at {incident}°"), colour, points)
    };
    LinePlot {
        title: title.into(),
        note: "Beyond the mirror direction f goes on rising: the peak moves off-specular.".into(),
        x_name: "θ of view, in the plane of incidence, in degrees".into(),
        y_name: "f over f at the mirror direction".into(),
        x: (0.0, 90.0),
        y: (0.0, 5.0),
        lines: [15.0, 30.0, 45.0, 60.0].into_iter().enumerate().map(line).collect(),
    }
}

pub(super) fn magnesium_oxide() -> LinePlot {
    plot("Off-specular peak: magnesium oxide", Fresnel::Dielectric(MAGNESIUM_OXIDE))
}

pub(super) fn aluminium() -> LinePlot {
    plot("Off-specular peak: aluminium", Fresnel::Conductor(Metal::Aluminium))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Degrees by which the peak lies beyond the mirror direction, and its height.
    fn peaks(plot: &LinePlot) -> Vec<(f64, f64)> {
        let mirrors = [15.0, 30.0, 45.0, 60.0];
        plot.lines
            .iter()
            .zip(mirrors)
            .map(|(line, mirror)| line.peak().map(|(x, y)| (x - mirror, y)).unwrap())
            .collect()
    }

    #[test]
    fn the_peak_moves_past_the_mirror_direction_as_the_angle_grows() {
        for plot in [magnesium_oxide(), aluminium()] {
            let peaks = peaks(&plot);
            assert!(peaks[0].0 < 6.0 && peaks[3].0 > 15.0, "{peaks:?}");
            assert!(
                peaks.iter().all(|p| p.0 > 3.0) && peaks.windows(2).all(|w| w[1].1 > w[0].1),
                "{peaks:?}"
            );
        }
        // Fresnel's rise towards grazing, which a metal hardly has, adds to it.
        let (dielectric, metal) = (peaks(&magnesium_oxide()), peaks(&aluminium()));
        assert!((0..4).all(|k| dielectric[k].1 > metal[k].1), "{dielectric:?} {metal:?}");
    }
}
