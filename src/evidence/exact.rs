//! Identities that need no statistics: hostile inputs, repetition, rotation.

use super::meter::{Halt, Meter};
use super::parts;
use super::probes;
use super::samples::Pilot;
use super::setup::Setup;
use super::tally::{Place, Tally, relative_error};
use crate::bsdf::{Direction, Precision, RandomNumbers, Samples};
use serde::{Deserialize, Serialize};

/// Calls all functions with hostile inputs; what comes back is judged by the
/// meter. Returns the number of calls' rows.
pub fn corners(meter: &Meter, setup: &Setup) -> Result<u64, Halt> {
    let before = meter.evaluations().total();
    let horizontal = Direction::from_angles(std::f64::consts::FRAC_PI_2, 0.297);
    let horizontal = Direction::new(horizontal.x, horizontal.y, 0.0);
    let grazing = Direction::from_angles(std::f64::consts::FRAC_PI_2 - 1e-7, 0.297);
    let side = 1f64.copysign(setup.wo.z);
    let tilted = Direction::from_angles(1e-4, 2.4);
    let given = [
        setup.wo,
        Direction::NORMAL * side,
        tilted * side,
        grazing,
        horizontal,
        setup.wo.flipped(),
        -Direction::NORMAL * side,
    ];
    let u = hostile_u(meter.dimensions(), meter.description.precision);
    let (mut value, mut samples) = (Vec::new(), Samples::default());
    for wo in given {
        let wi = [
            wo,
            -wo,
            wo.mirrored(),
            wo.flipped(),
            Direction::NORMAL,
            -Direction::NORMAL,
            horizontal,
            grazing,
            grazing.flipped(),
            tilted,
        ];
        if meter.description.has.eval {
            meter.eval(wo, &wi, setup.transport, &mut value)?;
        }
        if meter.description.has.pdf {
            meter.pdf(wo, &wi, setup.transport, &mut value)?;
        }
        if meter.description.has.sample && meter.description.claims.rng == RandomNumbers::External {
            meter.sample(wo, &u, setup.transport, &mut samples)?;
        }
    }
    Ok(meter.evaluations().total() - before)
}

/// All corners, edges and the middle of the unit cube, as far as three
/// dimensions go; further ones follow the first.
fn hostile_u(dimensions: usize, precision: Precision) -> Vec<f64> {
    let almost_one = match precision {
        Precision::F64 => 1.0 - f64::EPSILON / 2.0,
        Precision::F32 => 1.0 - f64::from(f32::EPSILON) / 2.0,
    };
    let values = [0.0, 0.5, almost_one];
    let free = dimensions.min(3) as u32;
    let mut u = Vec::new();
    for code in 0..3usize.pow(free) {
        for d in 0..dimensions {
            u.push(values[code / 3usize.pow(d as u32 % free) % 3]);
        }
    }
    u
}

/// Rows of the calls that repeat samples, over and over: alone, and in numbers that no
/// width of vector divides.
const BATCHES: [usize; 8] = [1, 1, 2, 3, 5, 7, 11, 13];

/// Equal calls give equal numbers, whatever was called between them and whatever
/// rows stand beside them. Code that works on several rows at once may round the last
/// of a batch otherwise than the first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Repeats {
    /// sample() of equal u.
    pub sample: Tally,
    /// eval() and pdf() of equal directions.
    pub value: Tally,
}

impl Repeats {
    /// Repeats a few hundred calls in another order and batch.
    pub fn gather(meter: &Meter, setup: &Setup, pilot: &Pilot) -> Result<Self, Halt> {
        const ROWS: usize = 256;
        let tolerance = setup.tolerance();
        let mut found = Self { sample: Tally::new(tolerance), value: Tally::new(tolerance) };
        let has = meter.description.has;
        let wi = probes::directions(setup, pilot, ROWS / 2);
        let (d, channels) = (meter.dimensions(), meter.channels());
        let mut u = vec![0.0; ROWS * d];
        setup.key.with("stage", "repeats").block(0).fill(meter.coarse_u(), &mut u);
        let (mut first, mut again) = (Samples::default(), Samples::default());
        let (mut values, mut others) = ([vec![], vec![]], [vec![], vec![]]);
        let samples = has.sample && meter.description.claims.rng == RandomNumbers::External;
        if samples {
            meter.sample(setup.wo, &u, setup.transport, &mut first)?;
        }
        let all = |wi: &[Direction], values: &mut [Vec<f64>; 2]| -> Result<(), Halt> {
            if has.eval {
                meter.eval(setup.wo, wi, setup.transport, &mut values[0])?;
            }
            if has.pdf {
                meter.pdf(setup.wo, wi, setup.transport, &mut values[1])?;
            }
            Ok(())
        };
        all(&wi, &mut values)?;
        let backwards: Vec<Direction> = wi.iter().rev().copied().collect();
        all(&backwards, &mut others)?;
        for (k, wi) in wi.iter().enumerate() {
            let mirrored = backwards.len() - 1 - k;
            for (name, width, which) in [("eval", channels, 0), ("pdf", 1, 1)] {
                if values[which].is_empty() {
                    continue;
                }
                for c in 0..width {
                    let (a, b) = (values[which][k * width + c], others[which][mirrored * width + c]);
                    found.value.look(
                        if a.to_bits() == b.to_bits() { 0.0 } else { relative_error(a, b, 0.0) },
                        || Place::pair(setup.wo, *wi).value(name, a).value("again", b),
                    );
                }
            }
        }
        let (first_values, others) = (parts::values(meter, setup, &wi)?, parts::values(meter, setup, &wi)?);
        for (a, b) in first_values.into_iter().zip(others) {
            let same = a.to_bits() == b.to_bits();
            found.value.look(if same { 0.0 } else { relative_error(a, b, 0.0) }, || Place {
                wo: setup.wo,
                ..Place::default()
            });
        }
        if samples {
            let mut sizes = BATCHES.iter().cycle();
            let mut end = ROWS;
            while let Some(size) = sizes.next().filter(|_| end > 0) {
                let rows = end.saturating_sub(*size)..end;
                meter.sample(setup.wo, &u[rows.start * d..end * d], setup.transport, &mut again)?;
                end = rows.start;
                for (row, k) in rows.enumerate() {
                    found.sample.look(difference(&first, k, &again, row), || {
                        Place::pair(setup.wo, first.wi[k])
                            .drawn_by(&u[k * d..(k + 1) * d])
                            .value("sample.pdf", first.pdf[k])
                            .value("again", again.pdf[row])
                    });
                }
            }
        }
        Ok(found)
    }
}

/// How far row `k` of `first` is from row `row` of `again`.
fn difference(first: &Samples, k: usize, again: &Samples, row: usize) -> f64 {
    if first.lobe[k] != again.lobe[row] {
        return 1.0;
    }
    if !first.lobe[k].is_valid() {
        return 0.0;
    }
    let weights =
        first.weight_of(k).iter().zip(again.weight_of(row)).map(|(a, b)| relative_error(*a, *b, 0.0));
    let apart = (first.wi[k] - again.wi[row]).length();
    // A number that is none counts as different, unless both are.
    let worst = |most: f64, x: f64| if x <= most { most } else { x };
    weights.fold(worst(apart, relative_error(first.pdf[k], again.pdf[row], 0.0)), worst)
}

/// Turning wo and wi together about the normal changes neither eval nor pdf.
pub fn rotations(meter: &Meter, setup: &Setup, pilot: &Pilot) -> Result<Tally, Halt> {
    const ANGLES: usize = 8;
    const ROWS: usize = 64;
    let mut tally = Tally::new(setup.tolerance());
    let wi = probes::off_edges(meter, setup, probes::directions(setup, pilot, ROWS))?;
    let has = meter.description.has;
    let (mut value, mut density) = (Vec::new(), Vec::new());
    let (mut turned_value, mut turned_density) = (Vec::new(), Vec::new());
    if has.eval {
        meter.eval(setup.wo, &wi, setup.transport, &mut value)?;
    }
    if has.pdf {
        meter.pdf(setup.wo, &wi, setup.transport, &mut density)?;
    }
    let mut stream = setup.key.with("stage", "rotations").block(0);
    for _ in 0..ANGLES {
        let angle = std::f64::consts::TAU * stream.next_f64();
        let wo = setup.wo.rotated(angle);
        let turned: Vec<Direction> = wi.iter().map(|w| w.rotated(angle)).collect();
        if has.eval {
            meter.eval(wo, &turned, setup.transport, &mut turned_value)?;
        }
        if has.pdf {
            meter.pdf(wo, &turned, setup.transport, &mut turned_density)?;
        }
        for (name, width, a, b) in
            [("eval", meter.channels(), &value, &turned_value), ("pdf", 1, &density, &turned_density)]
        {
            for (k, (a, b)) in a.iter().zip(b).enumerate() {
                tally.look(relative_error(*a, *b, setup.floor()), || {
                    Place::pair(setup.wo, wi[k / width])
                        .value(name, *a)
                        .value("turned", *b)
                        .value("angle", angle.to_degrees())
                });
            }
        }
    }
    Ok(tally)
}
