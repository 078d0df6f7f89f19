//! What a distribution of normals integrates to.

use super::integrals::UNSETTLED;
use super::meter::{Halt, Meter};
use super::parts;
use super::probes;
use super::samples::Pilot;
use super::setup::Setup;
use super::slopes::{Slice, Slopes};
use super::tally::{Place, Tally, relative_error};
use crate::bsdf::Direction;
use crate::sphere::{Cell, Chart, Goal, LeafIntegrals, Marker, Partition, Point, STERADIANS, integrate};
use serde::{Deserialize, Serialize};

/// Normals that show where D is, from all of its draws.
const PILOT: usize = 8192;

/// Leaves over which is integrated; only their sum is asked for.
const LEAVES: usize = 256;

/// Points of the base grid along a side, of each slice, at which a peak
/// is looked for that no draw is near.
const BASE_GRID: u32 = 32;

/// Integrals that are taken together, and how many after the first steer the
/// cubature.
const COMPONENTS: usize = 6;
const CONTROLLED: usize = 3;

/// Relative errors that the cubature aims at.
const GOAL: f64 = 1e-6;

/// The cubature stops at this many directions.
const MOST_EVALUATIONS: u64 = 600_000;

/// Randomised point sets of the cross-check, and standard errors by which it may
/// differ: Student's t with 7 degrees of freedom exceeds 10 with probability
/// 2e-5.
const CROSS_SETS: u32 = 8;
const CROSS_DEVIATIONS: f64 = 10.0;

/// Larger values of D count as this one, so that their sums stay finite.
const LARGEST: f64 = 1e100;

/// Normals at which identities are looked at, spread and drawn each.
const PROBES: usize = 256;

/// A value with the error of its cubature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Its error.
    pub error: f64,
}

/// Integrals over the normals m of a distribution, and its identities. Those
/// with wo are over cos θo.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Facets {
    /// ∫D cos θm, which must be 1.
    pub projected: Estimate,
    /// ∫D, the facet area.
    pub total: Estimate,
    /// ∫D cos² θm.
    pub twice_projected: Estimate,
    /// Normals below the horizon, and the largest D there, which must be 0.
    pub below: Tally,
    /// ∫G1 max(0, wo·m) D, which must be 1 (E. Heitz, *Understanding the
    /// masking-shadowing function*, JCGT 2014).
    pub visible: Estimate,
    /// ∫max(0, wo·m) D, as if no facet hid another: 1 + Λ under Smith's masking.
    pub facing: Estimate,
    /// ∫max(0, −wo·m) D, which is Λ under Smith's masking.
    pub averted: Estimate,
    /// ∫D cos θm by randomised points, with its standard error.
    pub cross_check: Estimate,
    /// The weak white furnace, ∫D(h) G1(wo, h)/(4 cos θo) over all directions wi
    /// of which h is the half vector with wo, those below the horizon with
    /// them: 1 (Heitz 2014). It is [`visible`](Self::visible) by dωi = 4 (wo·m)
    /// dωm; taken from half vectors at randomised points, with its standard
    /// error.
    pub furnace: Estimate,
    /// Smith's Λ(wo), where it is told.
    pub lambda: Option<f64>,
    /// G1 ≤ 1.
    pub masking: Tally,
    /// G1 (1 + Λ) = 1.
    pub smith: Option<Tally>,
    /// The told densities are D cos θm and G1 max(0, wo·m) D/cos θo.
    pub densities: Tally,
    /// Whether the cubature reached its goals.
    pub converged: bool,
    /// Directions evaluated.
    pub evaluations: u64,
}

impl Facets {
    /// Integrates, and looks at identities, from wo, wo.z > 0.
    pub fn gather(meter: &Meter, setup: &Setup, pilot: &Pilot) -> Result<Self, Halt> {
        let wo = setup.wo;
        let mut u = vec![0.0; PILOT * meter.dimensions()];
        setup.key.with("stage", "facets").block(0).fill(meter.coarse_u(), &mut u);
        let mut drawn = parts::draw(meter, &u)?;
        drawn.retain(|m| (m.length() - 1.0).abs() < 1e-3);

        let slopes = Slopes::of(wo, &drawn);
        let mut sums = [Estimate::default(); COMPONENTS];
        let mut cross_check = CrossCheck::new(setup);
        let (mut converged, mut evaluations) = (true, 0);
        for slice in slopes.slices() {
            let integrals = integral(meter, wo, &slopes, &slice, &drawn)?;
            for (c, sum) in sums.iter_mut().enumerate() {
                let (value, error) = integrals.total(c);
                sum.value += value;
                sum.error += error;
            }
            converged &= integrals.converged;
            evaluations += integrals.evaluations;
            cross_check.add(meter, wo, &slopes, &slice, &integrals.patches)?;
        }
        let [projected, visible, facing, averted, total, twice_projected] = sums;
        let [projected_again, furnace] = cross_check.estimates();
        let mut found = Self {
            projected,
            total,
            twice_projected,
            below: below(meter, setup)?,
            visible,
            facing,
            averted,
            cross_check: projected_again,
            furnace,
            lambda: parts::lambda(meter, wo)?,
            masking: Tally::new(setup.tolerance()),
            smith: None,
            densities: Tally::new(setup.tolerance()),
            converged,
            evaluations,
        };
        found.look(meter, setup, pilot)?;
        Ok(found)
    }

    /// Whether the integrals may be relied on: goals reached, and randomised
    /// points agree within ten standard errors and what the check tolerates.
    pub fn reliable(&self, tolerance: f64) -> Result<(), String> {
        if !self.converged {
            return Err(format!(
                "integration unreliable here: ∫D cos θm = {:.6} ± {:.1e}, visible {:.6} ± {:.1e} after {} normals",
                self.projected.value,
                self.projected.error,
                self.visible.value,
                self.visible.error,
                self.evaluations
            ));
        }
        self.cross_checked(tolerance)
    }

    /// As [`certainty`](super::Integrals::certainty).
    pub fn certainty(&self, tolerance: f64) -> Result<f64, String> {
        self.cross_checked(tolerance).map(|()| if self.converged { 1.0 } else { UNSETTLED })
    }

    /// Whether randomised points agree.
    fn cross_checked(&self, tolerance: f64) -> Result<(), String> {
        for (name, a, b) in [
            ("∫D cos θm", self.projected, self.cross_check),
            ("∫G1 max(0, wo·m) D / cos θo", self.visible, self.furnace),
        ] {
            if !((a.value - b.value).abs() <= CROSS_DEVIATIONS * b.error + a.error + tolerance) {
                return Err(format!(
                    "integration unreliable here: cubature gives {name} = {:.6}, randomised points {:.6} ± {:.1e}",
                    a.value, b.value, b.error
                ));
            }
        }
        Ok(())
    }

    /// Identities at single normals.
    fn look(&mut self, meter: &Meter, setup: &Setup, pilot: &Pilot) -> Result<(), Halt> {
        let wo = setup.wo;
        let mut normals = probes::directions(setup, pilot, PROBES);
        normals.retain(|m| m.z > 0.0 && wo.dot(*m) > 0.0);
        let (mut density, mut masking) = (Vec::new(), Vec::new());
        parts::densities(meter, &normals, &mut density)?;
        parts::masking(meter, wo, &normals, &mut masking)?;
        let told = parts::told(meter, wo, &normals)?;
        let mut smith = Tally::new(setup.tolerance());
        for (k, m) in normals.iter().enumerate() {
            let g1 = masking[k];
            let place = || Place::pair(wo, *m).value("g1", g1).value("density", density[k]);
            self.masking.look((g1 - 1.0).max(0.0), place);
            if let Some(lambda) = self.lambda {
                let product = g1 * (1.0 + lambda);
                smith.look(relative_error(product, 1.0, 0.0), || place().value("lambda", lambda));
            }
            let right = [density[k] * m.z, g1 * wo.dot(*m) * density[k] / wo.z];
            for (name, told, right) in [("pdf", &told[0], right[0]), ("visible_pdf", &told[1], right[1])] {
                let Some(told) = told.get(k) else { continue };
                self.densities.look(relative_error(*told, right, setup.floor()), || {
                    place().value(name, *told).value("from D and G1", right)
                });
            }
        }
        self.smith = self.lambda.is_some().then_some(smith);
        Ok(())
    }
}

/// ∫D cos θm and the weak white furnace once more, by scrambled Sobol points, one
/// in each patch and set: importance sampling that knows nothing of the rule's
/// nodes.
struct CrossCheck {
    seeds: Vec<u32>,
    /// By set.
    projected: Vec<f64>,
    furnace: Vec<f64>,
}

impl CrossCheck {
    fn new(setup: &Setup) -> Self {
        let mut stream = setup.key.with("stage", "facets-cross-check").block(0);
        let seeds: Vec<u32> = (0..CROSS_SETS).map(|_| (stream.next_u64() >> 32) as u32).collect();
        let none = vec![0.0; seeds.len()];
        Self { seeds, projected: none.clone(), furnace: none }
    }

    fn add(
        &mut self,
        meter: &Meter,
        wo: Direction,
        slopes: &Slopes,
        slice: &Slice,
        patches: &[Cell],
    ) -> Result<(), Halt> {
        let patches: Vec<&Cell> = patches.iter().filter(|cell| cell.is_front()).collect();
        let (mut density, mut at_half, mut masking) = (Vec::new(), Vec::new(), Vec::new());
        for (set, seed) in self.seeds.iter().enumerate() {
            let points = patches.iter().enumerate().map(|(k, cell)| {
                let [a, b] = [0, 1].map(|d| f64::from(sobol_burley::sample(k as u32 % (1 << 16), d, *seed)));
                slopes.normal(slice, cell.at(a, b))
            });
            let (normals, steradians): (Vec<Direction>, Vec<f64>) = points.unzip();
            let halves: Vec<Direction> = normals.iter().map(|m| half(wo, wo.reflected(*m))).collect();
            parts::densities(meter, &normals, &mut density)?;
            parts::densities(meter, &halves, &mut at_half)?;
            parts::masking(meter, wo, &halves, &mut masking)?;
            for (k, (m, cell)) in normals.iter().zip(&patches).enumerate() {
                let solid_angle = cell.area() * steradians[k];
                self.projected[set] += density[k] * m.z.abs() * solid_angle;
                // Normals turned away are no half vectors.
                let jacobian = 4.0 * wo.dot(*m).max(0.0);
                self.furnace[set] += at_half[k] * masking[k] / (4.0 * wo.z) * jacobian * solid_angle;
            }
        }
        Ok(())
    }

    fn estimates(self) -> [Estimate; 2] {
        [self.projected, self.furnace].map(|sets| {
            let n = sets.len() as f64;
            let value = sets.iter().sum::<f64>() / n;
            let variance = sets.iter().map(|t| (t - value) * (t - value)).sum::<f64>() / (n - 1.0);
            Estimate { value, error: (variance / n).sqrt() }
        })
    }
}

/// The half vector; any direction below the horizon where there is none.
fn half(wo: Direction, wi: Direction) -> Direction {
    let sum = wo + wi;
    let length = sum.length();
    if length > 0.0 { sum * (1.0 / length) } else { -Direction::NORMAL }
}

/// Integrals over a slice of the normals, as if it were the front square of a
/// chart; `drawn` ones show where they lie.
fn integral(
    meter: &Meter,
    wo: Direction,
    slopes: &Slopes,
    slice: &Slice,
    drawn: &[Direction],
) -> Result<LeafIntegrals, Halt> {
    let points: Vec<Point> = drawn.iter().filter_map(|m| slopes.point(slice, *m)).collect();
    let partition = Partition::build(Chart::new(0.0), points.clone(), LEAVES);
    let goal = Goal {
        components: COMPONENTS,
        controlled: CONTROLLED,
        // Cells are compared with no draws.
        draws: 1,
        mass: GOAL,
        value: GOAL,
        evaluations: MOST_EVALUATIONS,
        independent: false,
        horizon: 0.0,
    };
    // The pilot's counts are of this slice alone, and so is its mass.
    let share = points.len().max(1) as f64 / drawn.len().max(1) as f64;
    let mut normals = Vec::new();
    let mut rows_at = |points: &[Point], rows: &mut [f64]| {
        let (at, steradians): (Vec<_>, Vec<_>) =
            points.iter().map(|p| slopes.normal(slice, [p[0].min(1.0), p[1]])).unzip();
        normals = at;
        integrands(meter, wo, &normals, rows)?;
        for ((p, steradians), row) in points.iter().zip(&steradians).zip(rows.chunks_exact_mut(COMPONENTS)) {
            // The back square is no part of the slice.
            let scale = if p[0] < 1.0 { steradians / STERADIANS } else { 0.0 };
            row.iter_mut().for_each(|v| *v *= scale);
            row[0] /= share;
        }
        Ok::<_, Halt>(())
    };
    let mut grid: Vec<Point> =
        [Direction::NORMAL, wo].iter().filter_map(|m| slopes.point(slice, *m)).collect();
    let step = 1.0 / f64::from(BASE_GRID);
    for (column, row) in (0..BASE_GRID).flat_map(|c| (0..BASE_GRID).map(move |r| (c, r))) {
        // Off the middles of dyadic cells, where the rule has its own nodes.
        grid.push([(f64::from(column) + 0.382) * step, (f64::from(row) + 0.618) * step]);
    }
    let mut rows = vec![0.0; grid.len() * COMPONENTS];
    rows_at(&grid, &mut rows)?;
    let markers: Vec<Marker> = grid
        .iter()
        .zip(rows.chunks_exact(COMPONENTS))
        .map(|(p, row)| Marker {
            at: *p,
            reach: 0.0,
            density: row[0],
            value: row[1..=CONTROLLED].iter().sum(),
        })
        .collect();
    let chart = *partition.chart();
    let mut integrals = integrate(&partition, &points, &markers, &goal, |directions, rows| {
        let at: Vec<Point> = directions.iter().map(|d| chart.to_point(*d)).collect();
        rows_at(&at, rows)
    })?;
    for sums in [&mut integrals.values, &mut integrals.errors] {
        sums.iter_mut().step_by(COMPONENTS).for_each(|v| *v *= share);
    }
    Ok(integrals)
}

/// D at spread directions below the horizon.
fn below(meter: &Meter, setup: &Setup) -> Result<Tally, Halt> {
    let chart = Chart::new(setup.wo.phi());
    let points = (0..PROBES as u32).map(|k| [0, 1].map(|d| f64::from(sobol_burley::sample(k, d, 0))));
    let normals: Vec<Direction> = points.map(|[u, v]| chart.to_direction([1.0 + u, v])).collect();
    let mut density = Vec::new();
    parts::densities(meter, &normals, &mut density)?;
    let mut tally = Tally::new(0.0);
    for (m, d) in normals.iter().zip(density) {
        tally.look(d, || Place::pair(setup.wo, *m).value("density", d));
    }
    Ok(tally)
}

/// A row for each normal: D cos θm, which leads; visible, facing and averted,
/// which steer as well; D; and D cos² θm.
fn integrands(meter: &Meter, wo: Direction, normals: &[Direction], rows: &mut [f64]) -> Result<(), Halt> {
    let (mut density, mut masking) = (Vec::new(), Vec::new());
    parts::densities(meter, normals, &mut density)?;
    parts::masking(meter, wo, normals, &mut masking)?;
    for (k, (m, row)) in normals.iter().zip(rows.chunks_exact_mut(COMPONENTS)).enumerate() {
        let (d, cos) = (density[k].min(LARGEST), m.z.abs());
        let (facing, averted) = (wo.dot(*m).max(0.0) / wo.z, (-wo.dot(*m)).max(0.0) / wo.z);
        row.copy_from_slice(&[d * cos, masking[k] * facing * d, facing * d, averted * d, d, d * cos * cos]);
    }
    Ok(())
}
