//! How much light an interface reflects: Fresnel's equations and Schlick's fit.
//!
//! Unpolarised light: the mean of the reflectances of both polarisations
//! (A. Fresnel, *Mémoire sur la loi des modifications que la réflexion imprime
//! à la lumière polarisée*, 1823; in the form of Born and Wolf, *Principles of
//! Optics*, §1.5 and §14.2). Cosines are those of the incident angle, in [0, 1].

/// cos θt by Snell's law of light that comes in at `cos_i` and passes into a
/// medium `eta` times as dense; `None` where it is totally reflected.
#[inline]
pub fn refracted_cosine(cos_i: f64, eta: f64) -> Option<f64> {
    // η² cos²θt = η² − 1 + cos²θi, without forming 1 − cos².
    let g2 = (eta - 1.0) * (eta + 1.0) + cos_i * cos_i;
    (g2 >= 0.0).then(|| g2.sqrt() / eta)
}

/// Reflectance of a dielectric interface in [0, 1]; `eta` > 0 is the index
/// beyond over the index on the incident side.
#[inline]
pub fn dielectric(cos_i: f64, eta: f64) -> f64 {
    let [s, p] = dielectric_polarised(cos_i, eta);
    (0.5 * (s + p)).min(1.0)
}

/// As [`dielectric`], of light polarised perpendicular to the plane of incidence
/// (s) and parallel to it (p).
#[inline]
pub fn dielectric_polarised(cos_i: f64, eta: f64) -> [f64; 2] {
    if eta == 1.0 {
        return [0.0; 2];
    }
    let Some(cos_t) = refracted_cosine(cos_i, eta) else {
        return [1.0; 2];
    };
    // Both amplitudes with the difference in the numerator multiplied out, so
    // that nothing cancels as eta goes to 1 or at Brewster's angle.
    let g = eta * cos_t;
    let contrast = (eta - 1.0) * (eta + 1.0);
    let eta2 = eta * eta;
    let s = contrast / ((cos_i + g) * (cos_i + g));
    let p = contrast * ((eta2 + 1.0) * cos_i * cos_i - 1.0) / ((eta2 * cos_i + g) * (eta2 * cos_i + g));
    [s * s, p * p]
}

/// Transmittance of a dielectric interface in [0, 1], a part of the flux, from
/// the transmitted amplitudes 2 cos θi/(cos θi + η cos θt) and
/// 2 η cos θi/(η² cos θi + η cos θt), squared, times η cos θt/cos θi.
#[inline]
pub fn dielectric_transmittance(cos_i: f64, eta: f64) -> f64 {
    let Some(cos_t) = refracted_cosine(cos_i, eta) else {
        return 0.0;
    };
    let g = eta * cos_t;
    if g == 0.0 || cos_i == 0.0 {
        // Grazing light passes where there is no interface.
        return if eta == 1.0 { 1.0 } else { 0.0 };
    }
    let s = 4.0 * cos_i * g / ((cos_i + g) * (cos_i + g));
    let p = 4.0 * eta * eta * cos_i * g / ((eta * eta * cos_i + g) * (eta * eta * cos_i + g));
    0.5 * (s + p)
}

/// What a dielectric interface lets through, 1 − [`dielectric`], without the
/// cancellation: from the cosines on both sides that Snell's law joins, `eta` as
/// there. Exchanging the sides (cosines, and 1/eta for `eta`) gives the same.
#[inline]
pub fn transmitted(cos_i: f64, cos_t: f64, eta: f64) -> f64 {
    let (s, p) = (cos_i + eta * cos_t, eta * cos_i + cos_t);
    2.0 * eta * ((cos_i / s) * (cos_t / s) + (cos_i / p) * (cos_t / p))
}

/// Reflectance of a conductor of complex index n + ik seen from vacuum.
#[inline(always)]
pub fn conductor(cos_i: f64, n: f64, k: f64) -> f64 {
    let [s, p] = conductor_polarised(cos_i, n, k);
    0.5 * (s + p)
}

/// As [`conductor`], of light polarised perpendicular to the plane of incidence
/// (s) and parallel to it (p).
#[inline(always)]
pub fn conductor_polarised(cos_i: f64, n: f64, k: f64) -> [f64; 2] {
    let cos2 = cos_i * cos_i;
    let sin2 = 1.0 - cos2;
    // a + ib is the square root of (n + ik)² − sin²θ; ab = nk gives the
    // smaller of the two without cancellation.
    let re = (n - k) * (n + k) - sin2;
    // No index is so large or small that squares leave f64.
    let im = 2.0 * n * k;
    let modulus = (re * re + im * im).sqrt();
    let larger = (0.5 * (modulus + re.abs())).sqrt();
    let smaller = if larger > 0.0 { n * k / larger } else { 0.0 };
    let (a, b) = if re < 0.0 { (smaller, larger) } else { (larger, smaller) };
    let b2 = b * b;
    let s = ((a - cos_i).powi(2) + b2) / ((a + cos_i).powi(2) + b2);
    let q = a * cos_i;
    let p = s * ((q - sin2).powi(2) + b2 * cos2) / ((q + sin2).powi(2) + b2 * cos2);
    [s, p]
}

/// Schlick's approximation F₀ + (1 − F₀)(1 − cos θ)⁵ (C. Schlick, *An
/// inexpensive BRDF model for physically-based rendering*, 1994), with the
/// reflectance `f0` at normal incidence in [0, 1].
#[inline]
pub fn schlick(cos_i: f64, f0: f64) -> f64 {
    let m = 1.0 - cos_i;
    let m2 = m * m;
    f0 + (1.0 - f0) * m2 * m2 * m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence() {
        for eta in [1.0, 1.0 + 1e-9, 1.33, 1.5, 2.4, 1.0 / 1.5] {
            let r: f64 = (eta - 1.0) / (eta + 1.0);
            assert!((dielectric(1.0, eta) - r * r).abs() <= 1e-15 * r * r);
        }
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-16);
    }

    #[test]
    fn brewster_reflects_half_of_one_polarisation() {
        // At tan θ = η, p vanishes and s is ((η² − 1)/(η² + 1))².
        let eta: f64 = 1.5;
        let s: f64 = (eta * eta - 1.0) / (eta * eta + 1.0);
        let cos = 1.0 / (1.0 + eta * eta).sqrt();
        assert!((dielectric(cos, eta) - 0.5 * s * s).abs() < 1e-15);
    }

    #[test]
    fn total_reflection_and_grazing() {
        // The critical angle of 1.5 → 1 is 41.81°.
        assert_eq!(dielectric(42f64.to_radians().cos(), 1.0 / 1.5), 1.0);
        assert!(dielectric(41.5f64.to_radians().cos(), 1.0 / 1.5) < 1.0);
        assert!((dielectric(0.0, 1.5) - 1.0).abs() < 1e-15);
        assert_eq!(conductor(0.0, 0.2, 3.0), 1.0);
        assert_eq!(dielectric(0.0, 1.0), 0.0);
    }

    #[test]
    fn the_same_from_both_sides() {
        for i in 0..=100 {
            let cos = f64::from(i) / 100.0;
            let below = refracted_cosine(cos, 1.5).unwrap();
            assert!((dielectric(cos, 1.5) - dielectric(below, 1.0 / 1.5)).abs() < 1e-13);
        }
    }

    #[test]
    fn what_is_not_reflected_is_transmitted() {
        for eta in [1.0 + 1e-9, 1.1, 1.5, 4.0, 1.0 / 1.5] {
            for i in 1..=100 {
                let cos = f64::from(i) / 100.0;
                let Some(cos_t) = refracted_cosine(cos, eta) else { continue };
                let through = transmitted(cos, cos_t, eta);
                assert!((through + dielectric(cos, eta) - 1.0).abs() < 1e-14, "{eta} {cos}: {through}");
                assert!((transmitted(cos_t, cos, 1.0 / eta) / through - 1.0).abs() < 1e-14);
            }
        }
        // Towards grazing it goes like 2η (1/η² + 1)/cos θt times cos θi.
        let cos_t = refracted_cosine(0.0, 1.5).unwrap();
        let slope = 2.0 * 1.5 * (1.0 / 2.25 + 1.0) / cos_t;
        let cos_t = refracted_cosine(1e-12, 1.5).unwrap();
        assert!((transmitted(1e-12, cos_t, 1.5) / (1e-12 * slope) - 1.0).abs() < 1e-10);
    }

    #[test]
    fn a_conductor_that_does_not_absorb_is_a_dielectric() {
        for i in 0..=100 {
            let cos = f64::from(i) / 100.0;
            assert!((conductor(cos, 1.5, 0.0) - dielectric(cos, 1.5)).abs() < 1e-14);
        }
    }
}
