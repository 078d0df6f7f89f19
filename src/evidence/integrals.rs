//! Integrals of pdf and f·|cos θi| over the cells of a partition.

use super::draws::CosineDensity;
use super::meter::{Halt, Meter};
use super::setup::Setup;
use crate::bsdf::Direction;
use crate::sphere::{Breaks, Cell, Chart, Goal, Marker, Partition, Point, STERADIANS, integrate_within};
use serde::{Deserialize, Serialize};

/// Points of the base grid on each side of a hemisphere's square. A peak of
/// 2π/64² = 1.5e-3 sr (a cap of 1.3°) or more holds one, and is found
/// whatever the sampler does.
const BASE_GRID: usize = 64;

/// The smallest solid angle, in steradians, of a peak that cannot hide from the
/// cubature even if no sample and no hint is near it.
pub const SMALLEST_PEAK: f64 = STERADIANS / (BASE_GRID * BASE_GRID) as f64;

/// Larger values count as this one, so that their sums stay finite.
const LARGEST: f64 = 1e140;

/// Randomised point sets of the cross-check. The spread of eight tells their
/// standard error to a quarter.
const CROSS_SETS: u32 = 8;

/// Standard errors by which cubature and cross-check may differ: Student's t
/// with 7 degrees of freedom exceeds 10 with probability 2e-5.
const CROSS_DEVIATIONS: f64 = 10.0;

/// Integrals of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Integrals {
    /// ∫ pdf by leaf.
    pub pdf: Vec<f64>,
    /// Errors of these.
    pub pdf_error: Vec<f64>,
    /// ∫ f·|cos θi| by leaf and channel (row-major).
    pub value: Vec<f64>,
    /// Errors of the totals of `value`, by channel.
    pub value_error: Vec<f64>,
    /// ∫ (f·|cos θi|)²/pdf by channel: the second moment of a right weight.
    pub second: Vec<f64>,
    /// Errors of these; where one is not small, the moment may not exist.
    pub second_error: Vec<f64>,
    /// ∫ f·|cos θi| where pdf = 0, channels averaged.
    pub lost: f64,
    /// Largest f·|cos θi|/pdf met.
    pub largest_weight: f64,
    /// Largest f·|cos θi|/(pdf + cosine density) met.
    pub largest_balanced: f64,
    /// Whether the cubature reached its goals.
    pub converged: bool,
    /// ∫ pdf by randomised points, and its standard error.
    pub cross_check: (f64, f64),
    /// Directions evaluated.
    pub evaluations: u64,
}

/// Times its error that a cubature may be off which did not reach its goals.
pub(super) const UNSETTLED: f64 = 10.0;

impl Integrals {
    /// Z = ∫ pdf over the sphere, and its error.
    pub fn mass(&self) -> (f64, f64) {
        (self.pdf.iter().sum(), self.pdf_error.iter().sum())
    }

    /// How many times its error an integral may be off. Where the integrand has jumps,
    /// goals may not be reached, and errors are guesses. `Err` with the reason where
    /// nothing can be told.
    pub fn certainty(&self) -> Result<f64, String> {
        if self.converged { self.reliable().map(|()| 1.0) } else { self.cross_checked().map(|()| UNSETTLED) }
    }

    /// How far the mass may be off where a relative error of `tolerance` is right.
    pub fn slack(&self, tolerance: f64) -> f64 {
        let (mass, error) = self.mass();
        tolerance * mass + error
    }

    /// ∫ f·|cos θi| of a channel, and its error.
    pub fn albedo(&self, channel: usize) -> (f64, f64) {
        let channels = self.value_error.len();
        (self.value.iter().skip(channel).step_by(channels).sum(), self.value_error[channel])
    }

    /// Whether the total mass may be relied on: goals reached, and randomised
    /// points agree with it within ten standard errors and what the tests
    /// tolerate.
    pub fn reliable(&self) -> Result<(), String> {
        if !self.converged {
            let (mass, error) = self.mass();
            return Err(format!(
                "integration unreliable here: ∫pdf = {mass:.6} ± {error:.1e} after {} directions",
                self.evaluations
            ));
        }
        self.cross_checked()
    }

    /// Whether randomised points agree with the total mass.
    fn cross_checked(&self) -> Result<(), String> {
        let (mass, error) = self.mass();
        let (other, deviation) = self.cross_check;
        if !((mass - other).abs() <= CROSS_DEVIATIONS * deviation + error + 1e-3 * mass) {
            return Err(format!(
                "integration unreliable here: cubature gives ∫pdf = {mass:.6}, randomised points {other:.6} ± {deviation:.1e}"
            ));
        }
        Ok(())
    }

    /// Integrates over the leaves of `partition`. `pilot` are directions that the
    /// sampler visits, `draws` the number of draws to be compared with, and
    /// `evaluations` a cap.
    pub fn gather(
        meter: &Meter,
        setup: &Setup,
        partition: &Partition,
        pilot: &[Point],
        draws: u64,
        evaluations: u64,
    ) -> Result<Self, Halt> {
        let channels = meter.channels();
        let tabulated = meter.description.table.is_some();
        let breaks = meter.cells(setup.wo)?.map(|native| Breaks::new(&native));
        // A cell's neighbour knows nothing of it beyond a jump.
        let reaching = breaks.is_none();
        let markers = markers(meter, setup, partition, pilot, reaching)?;
        let goal = Goal {
            // pdf; f·cos and its square over pdf per channel; lost; two ratios.
            components: 1 + 2 * channels + 3,
            controlled: channels,
            draws,
            // Steps and kinks of a table let errors fall slowly. These are a tenth and a
            // half of what masses and means may be off by, and enter what they are judged by.
            mass: if tabulated { 1e-4 } else { 1e-5 },
            value: if tabulated { 5e-4 } else { 2e-5 },
            evaluations,
            independent: tabulated,
            horizon: setup.wo.z.abs(),
        };
        let cosine = CosineDensity::new(setup);
        let mut value = Vec::new();
        let mut density = Vec::new();
        let leaf = integrate_within(breaks.as_ref(), partition, pilot, &markers, &goal, |wi, rows| {
            measure(meter, setup, wi, &mut value, &mut density)?;
            for (k, (wi, row)) in wi.iter().zip(rows.chunks_exact_mut(goal.components)).enumerate() {
                let p = density[k];
                row[0] = p.min(LARGEST);
                let mut mean = 0.0;
                let mut top = 0.0f64;
                for c in 0..channels {
                    let f = (value[k * channels + c] * wi.abs_cos_theta()).min(LARGEST);
                    row[1 + c] = f;
                    row[1 + channels + c] = if p > 0.0 { (f * f / p).min(LARGEST) } else { 0.0 };
                    mean += f / channels as f64;
                    top = top.max(f);
                }
                let tail = &mut row[1 + 2 * channels..];
                tail[0] = if p > 0.0 { 0.0 } else { mean };
                tail[1] = if p > 0.0 { (top / p).min(LARGEST) } else { 0.0 };
                let both = p + cosine.at(*wi);
                tail[2] = if both > 0.0 { top / both } else { 0.0 };
            }
            Ok::<_, Halt>(())
        })?;
        let pick = |c: usize, from: &[f64]| -> Vec<f64> {
            from.iter().skip(c).step_by(goal.components).copied().collect()
        };
        let rows = leaf.values.chunks_exact(goal.components);
        Ok(Self {
            pdf: pick(0, &leaf.values),
            pdf_error: pick(0, &leaf.errors),
            value: rows.flat_map(|row| row[1..1 + channels].to_vec()).collect(),
            value_error: (0..channels).map(|c| leaf.total(1 + c).1).collect(),
            second: (0..channels).map(|c| leaf.total(1 + channels + c).0).collect(),
            second_error: (0..channels).map(|c| leaf.total(1 + channels + c).1).collect(),
            lost: leaf.total(1 + 2 * channels).0,
            largest_weight: leaf.largest[2 + 2 * channels],
            largest_balanced: leaf.largest[3 + 2 * channels],
            converged: leaf.converged,
            cross_check: cross_check(meter, setup, partition, &leaf.patches)?,
            evaluations: leaf.evaluations,
        })
    }

    /// Leaves whose mass is far above what the pilot found there.
    pub fn heavy_leaves(&self, partition: &Partition, pilot: &[Point]) -> Vec<bool> {
        let mut found = vec![0u64; partition.len()];
        let mut leaves = Vec::new();
        partition.locate_all(pilot, &mut leaves);
        for leaf in leaves {
            found[leaf as usize] += 1;
        }
        let size = pilot.len() as f64;
        (0..partition.len())
            .map(|l| {
                let expected = self.pdf[l] * size;
                expected > 2.0 * found[l] as f64 + 5.0 * expected.sqrt() + 5.0
            })
            .collect()
    }
}

/// f (cosine excluded) and pdf at directions.
fn measure(
    meter: &Meter,
    setup: &Setup,
    wi: &[Direction],
    value: &mut Vec<f64>,
    density: &mut Vec<f64>,
) -> Result<(), Halt> {
    if meter.description.has.eval {
        meter.eval(setup.wo, wi, setup.transport, value)?;
    } else {
        value.clear();
        value.resize(wi.len() * meter.channels(), 0.0);
    }
    if meter.description.has.pdf {
        meter.pdf(setup.wo, wi, setup.transport, density)
    } else {
        density.clear();
        density.resize(wi.len(), 0.0);
        Ok(())
    }
}

/// The directions where a lobe is to be expected, whatever the sampler does:
/// mirror, wo and −wo, refracted at the claimed eta, and the subject's hints.
pub fn expected_directions(meter: &Meter, setup: &Setup) -> Result<Vec<Direction>, Halt> {
    let wo = setup.wo;
    let mut directions = vec![wo.mirrored(), wo, -wo, Direction::NORMAL];
    directions.extend(setup.claims.eta.and_then(|eta| refracted(wo, eta)));
    directions.extend(meter.hints(wo)?);
    Ok(directions)
}

/// The direction on the other side by Snell's law, `eta` being the back's index
/// over the front's; `None` beyond the critical angle.
pub fn refracted(wo: Direction, eta: f64) -> Option<Direction> {
    let ratio = if wo.z > 0.0 { 1.0 / eta } else { eta };
    let (x, y) = (-wo.x * ratio, -wo.y * ratio);
    let z2 = 1.0 - x * x - y * y;
    (z2 > 0.0).then(|| Direction::new(x, y, -z2.sqrt().copysign(wo.z)))
}

/// What is known of the integrand before it is integrated: at expected
/// directions, on a base grid, and where the sampler goes (the rim of a narrow
/// lobe over a wide one is too faint for the pilot's counts, not for the pdf).
fn markers(
    meter: &Meter,
    setup: &Setup,
    partition: &Partition,
    pilot: &[Point],
    reaching: bool,
) -> Result<Vec<Marker>, Halt> {
    // Of equal area, whatever the partition's.
    let grid = Chart::new(setup.wo.phi());
    let chart = partition.chart();
    let mut directions = expected_directions(meter, setup)?;
    directions.extend(pilot.iter().map(|p| chart.to_direction(*p)));
    let step = 1.0 / BASE_GRID as f64;
    for column in 0..2 * BASE_GRID {
        for row in 0..BASE_GRID {
            // Off the middles of dyadic cells, where the rule has its own nodes.
            let (u, v) = ((column as f64 + 0.382) * step, (row as f64 + 0.618) * step);
            directions.push(grid.to_direction([u, v]));
        }
    }
    let (mut value, mut density) = (Vec::new(), Vec::new());
    measure(meter, setup, &directions, &mut value, &mut density)?;
    let channels = meter.channels();
    // The distance at which the sampler's next point is to be expected.
    let reach = |wi: &Direction, density: f64| {
        let expected = density * chart.steradians(*wi) * pilot.len().max(1) as f64;
        if reaching { 0.5 / expected.sqrt().max(1e3) } else { 0.0 }
    };
    Ok(directions
        .iter()
        .enumerate()
        .map(|(k, wi)| Marker {
            at: chart.to_point(*wi),
            reach: reach(wi, density[k]),
            density: density[k],
            value: value[k * channels..][..channels].iter().sum::<f64>() * wi.abs_cos_theta(),
        })
        .collect())
}

/// ∫ pdf once more, by scrambled Sobol points (Burley, "Practical hash-based
/// Owen scrambling", 2020), one in each patch and set: the patches make this
/// importance sampling, and the points know nothing of the rule's nodes.
fn cross_check(
    meter: &Meter,
    setup: &Setup,
    partition: &Partition,
    patches: &[Cell],
) -> Result<(f64, f64), Halt> {
    if !meter.description.has.pdf {
        return Ok((0.0, 0.0));
    }
    let mut seed = setup.key.with("stage", "cross-check").block(0);
    let mut density = Vec::new();
    let mut totals = Vec::new();
    for _ in 0..CROSS_SETS {
        let seed = (seed.next_u64() >> 32) as u32;
        let mut directions = Vec::with_capacity(patches.len());
        for (k, cell) in patches.iter().enumerate() {
            let index = k as u32 % (1 << 16);
            let [s, t] = [0, 1].map(|d| f64::from(sobol_burley::sample(index, d, seed)));
            directions.push(partition.chart().to_direction(cell.at(s, t)));
        }
        meter.pdf(setup.wo, &directions, setup.transport, &mut density)?;
        let chart = partition.chart();
        let terms = density.iter().zip(patches).zip(&directions);
        totals.push(terms.map(|((p, cell), wi)| p * cell.area() * chart.steradians(*wi)).sum::<f64>());
    }
    let n = totals.len() as f64;
    let mean = totals.iter().sum::<f64>() / n;
    let variance = totals.iter().map(|t| (t - mean) * (t - mean)).sum::<f64>() / (n - 1.0);
    Ok((mean, (variance / n).sqrt()))
}
