//! How much light a surface of facets reflects, tabulated.

use super::{Distribution, chebyshev};
use crate::bsdf::Direction;
use crate::models::gauss_legendre;
use std::f64::consts::PI;

/// Directional albedo ∫ f cos θi dωi of the reflection F D G2/(4 cos θo cos θi) of
/// isotropic facets under Smith's masking, at the cosine `cos_o` > 0; `fresnel` is F
/// of the cosine at the facet.
///
/// Over facets by their slope in polar form, up to where they reflect below the
/// horizon: that slope has a closed form, so that the integrand is smooth.
fn directional(
    distribution: &Distribution,
    fresnel: impl Fn(f64) -> f64,
    cos_o: f64,
    [azimuths, radii]: &[Vec<(f64, f64)>; 2],
) -> f64 {
    let alpha = distribution.alpha().x;
    let sin_o = ((1.0 - cos_o) * (1.0 + cos_o)).sqrt();
    let wo = Direction::new(sin_o, 0.0, cos_o);
    let area_o = distribution.backfacing_area(wo);
    let mut sum = 0.0;
    for side in [1.0, -1.0] {
        for (x, w) in azimuths {
            // From across the view, where the last slope changes fastest, towards
            // and away from it.
            let from_across = 0.5 * PI * x * x * x;
            let (cos, sin) = (side * from_across.sin(), from_across.cos());
            let towards = sin_o * cos;
            // wi.z = 0: cos θo s² − 2 towards s − cos θo = 0.
            let root = towards.hypot(cos_o);
            let last = if towards > 0.0 { (towards + root) / cos_o } else { cos_o / (root - towards) };
            // Slope s = α tan β.
            let end = (last / alpha).atan();
            let radial: f64 = radii
                .iter()
                .map(|(y, w)| {
                    // Towards the last slope, where the tail of GGX changes fastest.
                    let rest = 1.0 - y;
                    let beta = end * (1.0 - rest * rest);
                    let s = alpha * beta.tan();
                    let m = Direction::new(s * cos, s * sin, 1.0).normalized();
                    let om = wo.dot(m);
                    let wi = wo.reflected(m);
                    if om <= 0.0 || wi.z <= 0.0 {
                        return 0.0;
                    }
                    let area_i = distribution.backfacing_area(wi);
                    let geometry = 1.0 / (cos_o * wi.z + area_o * wi.z + area_i * cos_o);
                    // D m.z³ ds is the measure of D dm; s ds of the slopes.
                    let facets = distribution.density(m) * m.z.powi(3) * s * alpha / beta.cos().powi(2);
                    w * 2.0 * rest * facets * fresnel(om.min(1.0)) * om * geometry * wi.z
                })
                .sum();
            // Both halves left and right of the view.
            sum += 2.0 * w * 1.5 * PI * x * x * end * radial;
        }
    }
    sum
}

/// Points of [`directional`] on each side of across the view, and along the slope:
/// as many as hold the digits of [`Transmittance`].
const AZIMUTHS: usize = 24;
const RADII: usize = 48;

/// 1 − the albedo of isotropic facets, by the cosine: to 5e-6 up to 89.9°, to 1e-4
/// beyond.
#[derive(Clone, Debug)]
pub(super) struct Transmittance {
    /// α·[`BEND`].
    scale: f64,
    /// [`STEPS`] over the largest of ln(1 + cos/scale).
    per_step: f64,
    /// By equal steps of ln(1 + cos/scale), with one more beyond each end.
    values: Vec<f64>,
    /// ∫ T cos θ/π over the hemisphere.
    pub mean: f64,
}

/// Masking changes the albedo where the cosine is like α, Fresnel's equations where
/// it is like 1: over the logarithm of 1 + cos/(α·BEND) both are smooth.
const BEND: f64 = 0.5;

/// Cosines at which the integral is taken, and steps of the table.
const NODES: usize = 48;
const STEPS: usize = 512;

impl Transmittance {
    /// Of the facets of `distribution` with the reflectance `fresnel` of the cosine.
    pub(super) fn new(distribution: &Distribution, fresnel: impl Fn(f64) -> f64) -> Self {
        let scale = BEND * distribution.alpha().x;
        let range = (1.0 / scale).ln_1p();
        let cosine = |share: f64| (scale * (share * range).exp_m1()).min(1.0);
        let rules = [AZIMUTHS, RADII].map(gauss_legendre::rule);
        let albedos: Vec<f64> = chebyshev::points(NODES)
            .map(|x| directional(distribution, &fresnel, cosine(0.5 * (1.0 + x)), &rules))
            .collect();
        let series = chebyshev::coefficients(&albedos);
        let at = |share: f64| {
            (1.0 - chebyshev::sum(series.len(), 2.0 * share - 1.0, |k| series[k])).clamp(0.0, 1.0)
        };
        let mut table = Self {
            scale,
            per_step: STEPS as f64 / range,
            values: (0..STEPS + 3).map(|k| at((k as f64 - 1.0) / STEPS as f64)).collect(),
            mean: 0.0,
        };
        let mean = gauss_legendre::rule(NODES).into_iter().map(|(x, w)| {
            let mu = cosine(x);
            w * 2.0 * mu * (mu + scale) * range * table.at(mu)
        });
        table.mean = mean.sum();
        table
    }

    /// At a direction of this cosine in [0, 1].
    #[inline]
    pub(super) fn at(&self, cos: f64) -> f64 {
        let place = (cos / self.scale).ln_1p() * self.per_step;
        let step = (place as usize).min(STEPS - 1);
        let x = place - step as f64;
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.values[step + k]);
        // The cubic through four values, at −1, 0, 1, 2.
        let (y, z) = (x - 1.0, x - 2.0);
        let v = x * y * (d * (x + 1.0) - a * z) / 6.0 + (x + 1.0) * z * (b * y - c * x) / 2.0;
        v.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::fresnel;
    use crate::models::microfacet::Roughness;

    fn both(alpha: f64) -> [Distribution; 2] {
        let alpha = Roughness::isotropic(alpha);
        [Distribution::ggx(alpha), Distribution::beckmann(alpha)]
    }

    /// E(GGX, α = 1, normal) = 1 − ln 2, and brute force elsewhere: the mean weight
    /// F G2/G1 over drawn visible normals.
    #[test]
    fn equals_known_and_drawn_albedos() {
        let rules = [AZIMUTHS, RADII].map(gauss_legendre::rule);
        let one = directional(&both(1.0)[0], |_| 1.0, 1.0, &rules);
        assert!((one - (1.0 - 2f64.ln())).abs() < 1e-9, "{one}");
        let eta = 1.5;
        for alpha in [0.03, 0.3, 1.0] {
            for d in both(alpha) {
                for cos_o in [1.0, 0.3, 0.02] {
                    let wo = Direction::new(f64::sqrt(1.0 - cos_o * cos_o), 0.0, cos_o);
                    let o = d.backfacing_area(wo);
                    let n = 1 << 18;
                    // Roberts's R2 sequence.
                    let weight = |k: i32| {
                        let u = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2]
                            .map(|a| (0.5 + a * f64::from(k)).fract());
                        let m = d.sample_visible(wo, &u).unwrap();
                        let wi = wo.reflected(m);
                        if wi.z <= 0.0 {
                            return 0.0;
                        }
                        let i = d.backfacing_area(wi);
                        let masked = (cos_o + o) * wi.z / (cos_o * wi.z + o * wi.z + i * cos_o);
                        masked * fresnel::dielectric(wo.dot(m).min(1.0), eta)
                    };
                    let drawn = (0..n).map(weight).sum::<f64>() / f64::from(n);
                    let table = directional(&d, |c| fresnel::dielectric(c, eta), cos_o, &rules);
                    assert!((table - drawn).abs() < 3e-5, "{d:?} {cos_o}: {table} {drawn}");
                }
            }
        }
    }

    /// The table against the integral by 20 times as many points.
    #[test]
    fn table_holds_its_digits() {
        let rules = [160, 192].map(gauss_legendre::rule);
        for alpha in [1e-4, 1e-3, 0.01, 0.1, 0.4, 1.0] {
            for d in both(alpha) {
                for eta in [1.01, 1.5, 4.0] {
                    let f = |c: f64| fresnel::dielectric(c, eta);
                    let table = Transmittance::new(&d, f);
                    for k in 1..=20 {
                        let cos = (f64::from(k) / 20.0).powi(4);
                        let error: f64 = 1.0 - table.at(cos) - directional(&d, f, cos, &rules);
                        let tolerance = if cos > 1.7e-3 { 5e-6 } else { 1e-4 };
                        assert!(error.abs() < tolerance, "{d:?} {eta} {cos:.2e}: {error:.1e}");
                    }
                }
            }
        }
    }
}
