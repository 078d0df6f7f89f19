//! What a distribution of normals integrates to.

use super::meter::{Halt, Meter};
use super::parts;
use super::probes;
use super::samples::Pilot;
use super::setup::Setup;
use super::tally::{Place, Tally, relative_error};
use crate::bsdf::Direction;
use crate::sphere::{Chart, Goal, LeafIntegrals, Marker, Partition, integrate};
use serde::{Deserialize, Serialize};

/// Normals that show where D is, from all of its draws.
const PILOT: usize = 8192;

/// Leaves over which is integrated; only their sum is asked for.
const LEAVES: usize = 256;

/// Points of the base grid along a side, of each hemisphere, at which a peak
/// is looked for that no draw is near.
const BASE_GRID: usize = 32;

/// Relative errors that the cubature aims at.
const GOAL: f64 = 1e-5;

/// The cubature stops at this many directions.
const MOST_EVALUATIONS: u64 = 600_000;

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
    /// ∫G1 max(0, wo·m) D, which must be 1 (E. Heitz, *Understanding the
    /// masking-shadowing function*, JCGT 2014).
    pub visible: Estimate,
    /// ∫max(0, wo·m) D, as if no facet hid another: 1 + Λ under Smith's masking.
    pub facing: Estimate,
    /// ∫max(0, −wo·m) D, which is Λ under Smith's masking.
    pub averted: Estimate,
    /// The weak white furnace, ∫D(h) G1(wo, h)/(4 cos θo) over all directions wi
    /// of which h is the half vector with wo, those below the horizon with
    /// them: 1 (Heitz 2014).
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

        let (mut density, mut masking) = (Vec::new(), Vec::new());
        // D cos θm leads; the two that follow steer as well.
        let of_normals = integral(setup, &drawn, &[Direction::NORMAL, wo], 6, |m, rows| {
            parts::densities(meter, m, &mut density)?;
            parts::masking(meter, wo, m, &mut masking)?;
            for (k, (m, row)) in m.iter().zip(rows.chunks_exact_mut(6)).enumerate() {
                let (d, cos) = (density[k], m.z.abs());
                let (facing, averted) = (wo.dot(*m).max(0.0) / wo.z, (-wo.dot(*m)).max(0.0) / wo.z);
                row.copy_from_slice(&[
                    d * cos,
                    masking[k] * facing * d,
                    facing * d,
                    averted * d,
                    d,
                    d * cos * cos,
                ]);
            }
            Ok(())
        })?;
        let reflected: Vec<Direction> =
            drawn.iter().filter(|m| wo.dot(**m) > 0.0).map(|m| wo.reflected(*m)).collect();
        let of_directions = integral(setup, &reflected, &[wo.mirrored(), wo], 2, |wi, rows| {
            let halves: Vec<Direction> = wi.iter().map(|wi| half(wo, *wi)).collect();
            parts::densities(meter, &halves, &mut density)?;
            parts::masking(meter, wo, &halves, &mut masking)?;
            for (k, row) in rows.chunks_exact_mut(2).enumerate() {
                row.fill(density[k] * masking[k] / (4.0 * wo.z));
            }
            Ok(())
        })?;
        let estimate = |of: &LeafIntegrals, c: usize| {
            let (value, error) = of.total(c);
            Estimate { value, error }
        };
        let mut found = Self {
            projected: estimate(&of_normals, 0),
            visible: estimate(&of_normals, 1),
            facing: estimate(&of_normals, 2),
            averted: estimate(&of_normals, 3),
            total: estimate(&of_normals, 4),
            twice_projected: estimate(&of_normals, 5),
            furnace: estimate(&of_directions, 0),
            lambda: parts::lambda(meter, wo)?,
            masking: Tally::new(setup.tolerance()),
            smith: None,
            densities: Tally::new(setup.tolerance()),
            converged: of_normals.converged && of_directions.converged,
            evaluations: of_normals.evaluations + of_directions.evaluations,
        };
        found.look(meter, setup, pilot)?;
        Ok(found)
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

/// The half vector; any direction below the horizon where there is none.
fn half(wo: Direction, wi: Direction) -> Direction {
    let sum = wo + wi;
    let length = sum.length();
    if length > 0.0 { sum * (1.0 / length) } else { -Direction::NORMAL }
}

/// Integrals over the sphere. `pilot` shows where they lie, and `special` are
/// directions where a peak may be.
fn integral(
    setup: &Setup,
    pilot: &[Direction],
    special: &[Direction],
    components: usize,
    mut f: impl FnMut(&[Direction], &mut [f64]) -> Result<(), Halt>,
) -> Result<LeafIntegrals, Halt> {
    let chart = Chart::new(setup.wo.phi());
    let points: Vec<_> = pilot.iter().map(|d| chart.to_point(*d)).collect();
    let partition = Partition::build(chart, points.clone(), LEAVES);
    let goal = Goal {
        components,
        controlled: (components - 1).min(2),
        // Cells are compared with no draws.
        draws: 1,
        mass: GOAL,
        value: GOAL,
        evaluations: MOST_EVALUATIONS,
    };
    let chart = partition.chart();
    let mut directions = special.to_vec();
    let step = 1.0 / BASE_GRID as f64;
    for (column, row) in (0..2 * BASE_GRID).flat_map(|c| (0..BASE_GRID).map(move |r| (c, r))) {
        // Off the middles of dyadic cells, where the rule has its own nodes.
        directions.push(chart.to_direction([(column as f64 + 0.382) * step, (row as f64 + 0.618) * step]));
    }
    let mut rows = vec![0.0; directions.len() * components];
    f(&directions, &mut rows)?;
    let markers: Vec<Marker> = directions
        .iter()
        .zip(rows.chunks_exact(components))
        .map(|(d, row)| Marker {
            at: chart.to_point(*d),
            density: row[0],
            value: row[1..1 + goal.controlled].iter().sum(),
        })
        .collect();
    integrate(&partition, &points, &markers, &goal, f)
}
