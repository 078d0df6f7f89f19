//! The largest directional albedo of a model, for claims that depend on it.

use crate::bsdf::{Bsdf, Direction, Transport};

/// Draws for each wo.
const DRAWS: u32 = 256;

/// Directions of wo: the cosines, where many models reflect most (towards
/// grazing), close together.
const COSINES: [f64; 10] = [1.0, 0.9, 0.75, 0.6, 0.45, 0.3, 0.2, 0.1, 0.03, 0.003];

/// The largest albedo of any channel on a grid of wo at these `azimuths` (radians),
/// good to a few percent: mean weights over a lattice of two random numbers
/// (M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018:
/// steps of 1/g and 1/g², g³ = g + 1).
pub(super) fn largest_albedo(model: &impl Bsdf, azimuths: &[f64]) -> f64 {
    const G: f64 = 1.324_717_957_244_746;
    let mut largest = 0.0f64;
    for (cos, phi) in COSINES.into_iter().flat_map(|cos| azimuths.iter().map(move |phi| (cos, *phi))) {
        let wo = Direction::from_angles(cos.acos(), phi);
        let mut sums = [0.0; 3];
        for k in 0..DRAWS {
            let u = [1.0 / G, 1.0 / (G * G)].map(|step| (0.5 + f64::from(k) * step).fract());
            if let Some(sample) = model.sample(wo, &u, Transport::Radiance) {
                sums.iter_mut().zip(sample.weight.iter()).for_each(|(sum, w)| *sum += w);
            }
        }
        largest = sums.into_iter().fold(largest, |a, sum| a.max(sum / f64::from(DRAWS)));
    }
    largest
}
