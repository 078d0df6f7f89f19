//! Directions at which identities between pairs are tried.

use super::meter::{Halt, Meter};
use super::samples::Pilot;
use super::setup::Setup;
use crate::bsdf::Direction;
use crate::sphere::{Breaks, Chart};

/// So near to a jump, in units of a square's side, rounding of a turned or
/// exchanged direction decides on which side it falls.
const EDGE: f64 = 1e-9;

/// Those of `wi` at which identities between pairs can be expected of a table: not
/// on the edge of a cell, where the mirror direction of an isotropic one lies.
pub fn off_edges(meter: &Meter, setup: &Setup, mut wi: Vec<Direction>) -> Result<Vec<Direction>, Halt> {
    if let Some(native) = meter.cells(setup.wo)? {
        let breaks = Breaks::new(&native);
        wi.retain(|wi| !breaks.is_edge(*wi, EDGE));
    }
    Ok(wi)
}

/// `spread` directions that cover every side where light may leave (scrambled
/// Sobol points of an equal-area map), as many drawn by the sampler (uniform
/// ones never meet a narrow lobe), and the special ones.
pub fn directions(setup: &Setup, pilot: &Pilot, spread: usize) -> Vec<Direction> {
    let chart = Chart::new(setup.wo.phi());
    let wo = setup.wo;
    let mut seed = setup.key.with("stage", "probes").block(0);
    let seed = (seed.next_u64() >> 32) as u32;
    let mut all = vec![wo, wo.mirrored(), Direction::NORMAL * 1f64.copysign(wo.z)];
    let sides = [(setup.claims.reflective, wo.z > 0.0), (setup.claims.transmissive, wo.z <= 0.0)];
    let count = sides.iter().filter(|(leaves, _)| *leaves).count().max(1);
    for (_, front) in sides.iter().filter(|(leaves, _)| *leaves) {
        for k in 0..spread / count {
            let [u, v] = [0, 1].map(|d| f64::from(sobol_burley::sample(k as u32, d, seed)));
            all.push(chart.to_direction([if *front { u } else { 1.0 + u }, v]));
        }
    }
    let step = (pilot.wi.len() / spread.max(1)).max(1);
    all.extend(pilot.wi.iter().step_by(step).take(spread));
    all
}
