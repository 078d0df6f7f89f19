//! What the models' tests compare with: sums over many directions.

use crate::bsdf::{Bsdf, Direction, Transport};
use std::f64::consts::{FRAC_PI_2, TAU};

const R: Transport = Transport::Radiance;

/// ∫ f over the upper hemisphere, by the midpoint rule in θ and φ; good to about
/// 1e-5 for what is smooth over degrees.
pub(super) fn hemisphere(mut f: impl FnMut(Direction) -> f64) -> f64 {
    let (n, m) = (800, 400);
    let mut sum = 0.0;
    for i in 0..n {
        let theta = (f64::from(i) + 0.5) / f64::from(n) * FRAC_PI_2;
        for j in 0..m {
            let phi = (f64::from(j) + 0.5) / f64::from(m) * TAU;
            sum += theta.sin() * f(Direction::from_angles(theta, phi));
        }
    }
    sum * FRAC_PI_2 * TAU / f64::from(n * m)
}

/// ∫ f cos θi of a channel.
pub(super) fn albedo(model: &impl Bsdf, wo: Direction, channel: usize) -> f64 {
    hemisphere(|wi| model.eval(wo, wi, R)[channel] * wi.z)
}

/// Asserts that hostile inputs give valid output or none, that the back side is
/// dark, and that what `sample` returns is what `eval` and `pdf` say.
pub(super) fn assert_sound(model: &impl Bsdf) {
    let last = 1.0 - f64::EPSILON / 2.0;
    let grazing = Direction::new(1.0, 0.0, 1e-100);
    let views = [Direction::NORMAL, Direction::from_angles(0.8, 2.0), Direction::from_angles(1.5705, 1.0)];
    let numbers = [0.0, 1e-9, 0.3, 0.5, 0.77, last];
    for wo in views.into_iter().chain([grazing]) {
        for u in numbers.into_iter().flat_map(|a| numbers.map(|b| [a, b])) {
            let Some(s) = model.sample(wo, &u, R) else { continue };
            assert!((s.wi.length() - 1.0).abs() < 1e-14 && s.wi.z > 0.0, "{wo:?} {u:?} {s:?}");
            assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{wo:?} {u:?} {s:?}");
            assert_eq!(s.pdf, model.pdf(wo, s.wi, R));
            for (w, f) in s.weight.iter().zip(model.eval(wo, s.wi, R).iter()) {
                assert!(
                    w.is_finite() && (w * s.pdf - f * s.wi.z).abs() <= 1e-12 * f * s.wi.z,
                    "{wo:?} {s:?}"
                );
            }
        }
    }
    let horizon = Direction::new(1.0, 0.0, 0.0);
    let below = Direction::new(0.6, 0.0, -0.8);
    for (wo, wi) in [(horizon, Direction::NORMAL), (Direction::NORMAL, horizon), (below, Direction::NORMAL)] {
        assert!(model.eval(wo, wi, R).iter().all(|f| *f == 0.0) && model.pdf(wo, wi, R) == 0.0);
        assert!(wo.z > 0.0 || model.sample(wo, &[0.3, 0.4], R).is_none());
    }
    for (wo, wi) in [(grazing, grazing), (grazing, grazing.mirrored()), (grazing, Direction::NORMAL)] {
        assert!(model.eval(wo, wi, R).iter().all(|f| !f.is_nan()) && !model.pdf(wo, wi, R).is_nan());
    }
}
