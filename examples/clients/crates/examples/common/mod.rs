//! Quadrature, random numbers and histograms without gonio.
#![allow(dead_code)]

use std::f64::consts::PI;

pub type Vector = [f64; 3];

pub fn at(theta_deg: f64, phi_deg: f64) -> Vector {
    let (theta, phi) = (theta_deg.to_radians(), phi_deg.to_radians());
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// ∫ f dω over polar angles `from` to `to` (degrees), midpoint rule.
pub fn integral(from: f64, to: f64, steps: usize, f: impl Fn(Vector) -> f64) -> f64 {
    let width = (to - from) / steps as f64;
    let mut sum = 0.0;
    for j in 0..steps {
        let theta = from + (j as f64 + 0.5) * width;
        let ring: f64 = (0..2 * steps).map(|k| f(at(theta, (k as f64 + 0.5) * 180.0 / steps as f64))).sum();
        sum += ring * theta.to_radians().sin();
    }
    sum * width.to_radians() * PI / steps as f64
}

/// SplitMix64 (G. Steele et al. 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
