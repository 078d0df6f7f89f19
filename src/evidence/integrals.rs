//! Integrals of pdf and f·|cos θi| over the cells of a partition.

use super::draws::CosineDensity;
use super::meter::{Halt, Meter};
use super::samples::Pilot;
use super::setup::Setup;
use crate::bsdf::Direction;
use crate::sphere::{Breaks, Cell, Chart, Goal, Marker, Partition, Patches, Point, STERADIANS, integrate_on};
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
    /// ∫ f·|cos θi| by leaf and channel (row-major); this and what follows of f is empty
    /// or 0 where no check read eval.
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
    /// Largest f·|cos θi|/(pdf + cosine density) met, the latter as MIS counts it.
    pub largest_balanced: f64,
    /// Whether the cubature of pdf reached its goals.
    pub converged: bool,
    /// Whether that of the values did.
    #[serde(default = "reached")]
    pub values_converged: bool,
    /// ∫ pdf by randomised points, and its standard error.
    pub cross_check: (f64, f64),
    /// Directions at which pdf was evaluated.
    pub evaluations: u64,
}

/// Evidence of earlier versions tells of both at once.
fn reached() -> bool {
    true
}

/// Where pdf was integrated, from where the values are.
pub struct Integrated {
    patches: Patches,
    markers: Vec<Marker>,
    /// The directions of the first markers; the pilot's follow.
    directions: Vec<Direction>,
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
        let settled = self.converged && self.values_converged;
        self.cross_checked().map(|()| if settled { 1.0 } else { UNSETTLED })
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

    /// Whether masses and values may be relied on.
    pub fn reliable(&self) -> Result<(), String> {
        self.masses_reliable()?;
        if self.values_converged {
            return Ok(());
        }
        let totals = (0..self.value_error.len()).map(|c| self.albedo(c));
        let (value, error) = totals.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        Err(format!("integration unreliable here: ∫f|cos θi| = {value:.6} ± {error:.1e}"))
    }

    /// Whether the total mass may be relied on: goals reached, and randomised
    /// points agree with it within ten standard errors and what the tests
    /// tolerate.
    pub fn masses_reliable(&self) -> Result<(), String> {
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

    /// Integrates pdf over the leaves of `partition`. `pilot` are directions that the
    /// sampler visits, and their points, and `evaluations` a cap. The values are not there
    /// yet; what they are integrated from on, so that the masses are the same whether they
    /// are asked for or not.
    pub fn masses(
        meter: &Meter,
        setup: &Setup,
        partition: &Partition,
        (pilot, points): (&Pilot, &[Point]),
        evaluations: u64,
    ) -> Result<(Self, Integrated), Halt> {
        let breaks = meter.cells(setup.wo)?.map(|native| Breaks::new(&native));
        // A cell's neighbour knows nothing of it beyond a jump.
        let reaching = breaks.is_none();
        let (markers, directions) = markers(meter, setup, partition, (pilot, points), reaching)?;
        let goal = Goal { draws: setup.draws, evaluations, ..goal(meter, setup, 0) };
        let patches = Patches::new(breaks.as_ref(), partition, points, &markers, goal.horizon);
        let mut density = Vec::new();
        let (leaf, patches) = integrate_on(patches, partition, points.len(), &markers, &goal, |wi, rows| {
            densities(meter, setup, wi, &mut density)?;
            rows.iter_mut().zip(&density).for_each(|(row, p)| *row = p.min(LARGEST));
            Ok::<_, Halt>(())
        })?;
        let integrals = Self {
            cross_check: cross_check(meter, setup, partition, &leaf.patches)?,
            pdf: leaf.values,
            pdf_error: leaf.errors,
            value: Vec::new(),
            value_error: Vec::new(),
            second: Vec::new(),
            second_error: Vec::new(),
            lost: 0.0,
            largest_weight: 0.0,
            largest_balanced: 0.0,
            converged: leaf.converged,
            values_converged: true,
            evaluations: leaf.evaluations,
        };
        Ok((integrals, Integrated { patches, markers, directions }))
    }

    /// Integrates the values, of which eval tells, on the patches of pdf and below.
    pub fn add_values(
        &mut self,
        meter: &Meter,
        setup: &Setup,
        partition: &Partition,
        pilot: &Pilot,
        integrated: Integrated,
        evaluations: u64,
    ) -> Result<(), Halt> {
        let channels = meter.channels();
        let Integrated { patches, mut markers, directions } = integrated;
        let mut value = Vec::new();
        values(meter, setup, &directions, &mut value)?;
        if pilot.value.len() == pilot.wi.len() * channels {
            value.extend(&pilot.value);
        } else {
            let mut drawn = Vec::new();
            values(meter, setup, &pilot.wi, &mut drawn)?;
            value.extend(drawn);
        }
        let cosines = directions.iter().chain(&pilot.wi).map(|wi| wi.abs_cos_theta());
        for ((marker, row), cosine) in markers.iter_mut().zip(value.chunks_exact(channels)).zip(cosines) {
            // pdf has been integrated.
            (marker.density, marker.value) = (0.0, row.iter().sum::<f64>() * cosine);
        }
        let goal = Goal { evaluations, ..goal(meter, setup, channels) };
        let cosine = CosineDensity::new(setup);
        let mut density = Vec::new();
        let patches = patches.without_pilot();
        let (leaf, _) = integrate_on(patches, partition, 0, &markers, &goal, |wi, rows| {
            values(meter, setup, wi, &mut value)?;
            densities(meter, setup, wi, &mut density)?;
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
        let rows = leaf.values.chunks_exact(goal.components);
        self.value = rows.flat_map(|row| row[1..1 + channels].to_vec()).collect();
        self.value_error = (0..channels).map(|c| leaf.total(1 + c).1).collect();
        self.second = (0..channels).map(|c| leaf.total(1 + channels + c).0).collect();
        self.second_error = (0..channels).map(|c| leaf.total(1 + channels + c).1).collect();
        self.lost = leaf.total(1 + 2 * channels).0;
        self.largest_weight = leaf.largest[2 + 2 * channels];
        self.largest_balanced = leaf.largest[3 + 2 * channels];
        self.values_converged = leaf.converged;
        Ok(())
    }

    /// Leaves whose mass is far above what the pilot found there.
    pub fn heavy_leaves(&self, integrated: &Integrated) -> Vec<bool> {
        let found = integrated.patches.pilot(self.pdf.len());
        let size = found.iter().sum::<u64>() as f64;
        let is_heavy = |(p, found): (&f64, u64)| {
            let expected = p * size;
            expected > 2.0 * found as f64 + 5.0 * expected.sqrt() + 5.0
        };
        self.pdf.iter().zip(found).map(is_heavy).collect()
    }
}

/// What is asked of the cubature of pdf, or with it of that of the values of so many
/// channels, where pdf's own errors ask for nothing.
fn goal(meter: &Meter, setup: &Setup, channels: usize) -> Goal {
    let tabulated = meter.description.table.is_some();
    Goal {
        // pdf; f·cos and its square over pdf per channel; lost; two ratios.
        components: if channels > 0 { 1 + 2 * channels + 3 } else { 1 },
        controlled: channels,
        draws: 0,
        // Steps and kinks of a table let errors fall slowly. These are a tenth and a
        // half of what masses and means may be off by, and enter what they are judged by.
        mass: match channels {
            0 if tabulated => 1e-4,
            0 => 1e-5,
            _ => f64::MAX,
        },
        value: if tabulated { 5e-4 } else { 2e-5 },
        evaluations: 0,
        independent: tabulated,
        horizon: setup.wo.z.abs(),
    }
}

/// f (cosine excluded) at directions; 0 where there is no eval.
pub(super) fn values(
    meter: &Meter,
    setup: &Setup,
    wi: &[Direction],
    value: &mut Vec<f64>,
) -> Result<(), Halt> {
    if meter.description.has.eval {
        return meter.eval(setup.wo, wi, setup.transport, value);
    }
    value.clear();
    value.resize(wi.len() * meter.channels(), 0.0);
    Ok(())
}

/// pdf at directions; 0 where there is none.
pub(super) fn densities(
    meter: &Meter,
    setup: &Setup,
    wi: &[Direction],
    density: &mut Vec<f64>,
) -> Result<(), Halt> {
    if meter.description.has.pdf {
        return meter.pdf(setup.wo, wi, setup.transport, density);
    }
    density.clear();
    density.resize(wi.len(), 0.0);
    Ok(())
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

/// What is known of pdf before it is integrated, and at which directions: expected ones,
/// a base grid, and where the sampler goes (the rim of a narrow lobe over a wide one is
/// too faint for the pilot's counts, not for the pdf), whose directions the pilot has.
fn markers(
    meter: &Meter,
    setup: &Setup,
    partition: &Partition,
    (pilot, points): (&Pilot, &[Point]),
    reaching: bool,
) -> Result<(Vec<Marker>, Vec<Direction>), Halt> {
    // Of equal area, whatever the partition's.
    let grid = Chart::new(setup.wo.phi());
    let chart = partition.chart();
    let mut directions = expected_directions(meter, setup)?;
    let step = 1.0 / BASE_GRID as f64;
    // Off the middles of dyadic cells, where the rule has its own nodes.
    let node = |k: usize| {
        let (column, row) = ((k / BASE_GRID) as f64, (k % BASE_GRID) as f64);
        [(column + 0.382) * step, (row + 0.618) * step]
    };
    let nodes: Vec<Point> = (0..2 * BASE_GRID * BASE_GRID).map(node).collect();
    grid.to_directions(&nodes, &mut directions);
    let mut density = Vec::new();
    densities(meter, setup, &directions, &mut density)?;
    let (mut places, mut drawn) = (Vec::new(), Vec::new());
    chart.to_points(&directions, &mut places);
    if pilot.pdf.len() != pilot.wi.len() {
        densities(meter, setup, &pilot.wi, &mut drawn)?;
    }
    // The distance at which the sampler's next point is to be expected.
    let reach = |wi: &Direction, density: f64| {
        let expected = density * chart.steradians(*wi) * points.len().max(1) as f64;
        if reaching { 0.5 / expected.sqrt().max(1e3) } else { 0.0 }
    };
    let mut markers = Vec::with_capacity(places.len() + points.len());
    let mut mark = |wi: &[Direction], places: &[Point], density: &[f64]| {
        let rows = wi.iter().zip(places).zip(density);
        markers.extend(rows.map(|((wi, at), density)| Marker {
            at: *at,
            reach: reach(wi, *density),
            density: *density,
            value: 0.0,
        }));
    };
    mark(&directions, &places, &density);
    mark(&pilot.wi, points, if drawn.is_empty() { &pilot.pdf } else { &drawn });
    Ok((markers, directions))
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
    let (mut points, mut directions) = (Vec::new(), Vec::new());
    for _ in 0..CROSS_SETS {
        let seed = (seed.next_u64() >> 32) as u32;
        points.clear();
        directions.clear();
        points.extend(patches.iter().enumerate().map(|(k, cell)| {
            let index = k as u32 % (1 << 16);
            let [s, t, ..] = sobol_burley::sample_4d(index, 0, seed);
            cell.at(s.into(), t.into())
        }));
        partition.chart().to_directions(&points, &mut directions);
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
