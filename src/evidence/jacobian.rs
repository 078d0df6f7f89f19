//! The density of a smooth sampler from its derivative.

use super::meter::{Halt, Meter};
use super::setup::Setup;
use super::tally::{Place, Tally, relative_error};
use crate::bsdf::{Direction, RandomNumbers, Samples};
use serde::{Deserialize, Serialize};

/// Points at which the derivative is taken.
const POINTS: usize = 128;

/// Fewer usable points than this decide nothing.
const FEWEST: usize = 16;

/// Step of the central differences. Truncation ~h² and rounding ~ε/h are both
/// about 1e-10 relative here; Richardson's difference of steps h and 2h tells
/// where a point is worse.
const STEP: f64 = 1e-5;

/// Points whose derivatives at h and 2h differ by more are not used.
const ROUGH: f64 = 1e-4;

/// Tolerance on 1/|∂ω/∂u| = pdf: ten times the roughness that is let in.
const TOLERANCE: f64 = 1e-3;

/// Scans for jumps: lines along each dimension, points on each, halvings of
/// the widest steps.
const LINES: usize = 6;
const LINE_POINTS: usize = 128;
const HALVINGS: usize = 24;

/// Towards the ends of a line it is scanned at 2^−6, within the even scan, to
/// 2^−28 from them: a lobe drawn more rarely does not show in the density of others.
const RIM: u32 = 6;
const RIM_END: u32 = 29;

/// Values of the unused random numbers at which a branch is looked for.
const BRANCHES: usize = 64;

/// What the derivative of u → wi says of the density.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Jacobian {
    /// It says nothing, for this reason.
    Skipped(String),
    /// 1/|∂ω/∂u| against pdf.
    Measured {
        /// Errors: of equality if `one_to_one`, of pdf ≥ branch/|∂ω/∂u| if not.
        tally: Tally,
        /// Whether the map is continuous and keeps its orientation wherever it
        /// was scanned, and is therefore taken as one to one.
        one_to_one: bool,
    },
}

struct Point {
    u: Vec<f64>,
    wi: Direction,
    pdf: f64,
    /// ∂ω/∂u_j, by dimension.
    slopes: Vec<Direction>,
}

impl Jacobian {
    /// Differentiates the sampler at random points.
    pub fn gather(meter: &Meter, setup: &Setup) -> Result<Self, Halt> {
        if meter.description.claims.rng == RandomNumbers::Internal {
            return Ok(Self::Skipped("the subject draws its own random numbers".into()));
        }
        if meter.coarse_u() {
            return Ok(Self::Skipped("f32 leaves no digits for differences of u".into()));
        }
        let points = slopes(meter, setup)?;
        if points.len() < FEWEST {
            return Ok(Self::Skipped(format!(
                "u → wi is smooth at {} of {POINTS} points only",
                points.len()
            )));
        }
        let d = meter.dimensions();
        let active: Vec<usize> =
            (0..d).filter(|j| points.iter().any(|p| p.slopes[*j].length() > 1e-9)).collect();
        let &[i, j] = &active[..] else {
            return Ok(Self::Skipped(format!("wi moves with {} of {d} random numbers, not 2", active.len())));
        };
        let oriented: Vec<f64> = points.iter().map(|p| p.slopes[i].cross(p.slopes[j]).dot(p.wi)).collect();
        let same_turn = oriented.iter().all(|o| *o > 0.0) || oriented.iter().all(|o| *o < 0.0);
        let shares = points.iter().map(|p| branch(meter, setup, p, [i, j])).collect::<Result<Vec<_>, _>>()?;
        let one_branch = shares.iter().all(|(_, slack)| *slack == 0.0);
        let mut one_to_one = same_turn && one_branch && !has_jump(meter, setup, [i, j])?;
        // Before equality is found broken: continuous and oriented maps may
        // still meet a direction twice.
        let short = |p: &Point, oriented: &f64| p.pdf * oriented.abs() > 1.0 + TOLERANCE;
        if one_to_one && points.iter().zip(&oriented).any(|(p, o)| short(p, o)) {
            one_to_one = !has_second_origin(meter, setup, &points, [i, j])?;
        }
        let mut tally = Tally::new(TOLERANCE);
        for ((point, oriented), (share, slack)) in points.iter().zip(oriented).zip(shares) {
            let density = share / oriented.abs();
            let least = (share - slack).max(0.0) / oriented.abs();
            let error = if one_to_one {
                relative_error(density, point.pdf, setup.floor())
            } else if point.pdf >= least {
                0.0
            } else {
                relative_error(least, point.pdf, setup.floor())
            };
            tally.look(error, || {
                Place::pair(setup.wo, point.wi)
                    .drawn_by(&point.u)
                    .value("pdf", point.pdf)
                    .value("1/|∂ω/∂u|", density)
            });
        }
        Ok(Self::Measured { tally, one_to_one })
    }
}

/// Points with their derivatives, where these are well defined.
fn slopes(meter: &Meter, setup: &Setup) -> Result<Vec<Point>, Halt> {
    let d = meter.dimensions();
    let mut stream = setup.key.with("stage", "jacobian").block(0);
    let offsets = [-2.0 * STEP, -STEP, STEP, 2.0 * STEP];
    let (mut u, mut samples, mut density) = (Vec::new(), Samples::default(), Vec::new());
    for _ in 0..POINTS {
        // Away from the rim by more than the widest difference.
        let centre: Vec<f64> = (0..d).map(|_| 0.01 + 0.98 * stream.next_f64()).collect();
        u.extend_from_slice(&centre);
        for j in 0..d {
            for offset in offsets {
                let mut row = centre.clone();
                row[j] += offset;
                u.extend(row);
            }
        }
    }
    meter.sample(setup.wo, &u, setup.transport, &mut samples)?;
    let mut usable: Vec<usize> = (0..samples.len()).step_by(1 + 4 * d).collect();
    usable.retain(|first| {
        (*first..first + 1 + 4 * d)
            .all(|r| samples.lobe[r].is_continuous() && samples.lobe[r] == samples.lobe[*first])
    });
    let centres: Vec<Direction> = usable.iter().map(|first| samples.wi[*first]).collect();
    meter.pdf(setup.wo, &centres, setup.transport, &mut density)?;
    let mut points = Vec::new();
    for (first, pdf) in usable.into_iter().zip(density) {
        let mut rough = 0.0f64;
        let slopes: Vec<Direction> = (0..d)
            .map(|j| {
                let at = |o: usize| samples.wi[first + 1 + 4 * j + o];
                let near = (at(2) - at(1)) * (0.5 / STEP);
                let far = (at(3) - at(0)) * (0.25 / STEP);
                rough = rough.max((near - far).length() / near.length().max(1e-6));
                // Richardson: the errors of second order cancel.
                near * (4.0 / 3.0) - far * (1.0 / 3.0)
            })
            .collect();
        if rough < ROUGH {
            let row = &u[first * d..(first + 1) * d];
            points.push(Point { u: row.to_vec(), wi: samples.wi[first], pdf, slopes });
        }
    }
    Ok(points)
}

/// Whether wi jumps anywhere on lines through the unit square: to another kind of
/// lobe, or by a step that does not shrink when it is halved again and again. Looked
/// for in even steps, and in ones that halve towards both ends, where a rare lobe may
/// have its share. All lines are walked side by side, in few calls of many rows.
fn has_jump(meter: &Meter, setup: &Setup, active: [usize; 2]) -> Result<bool, Halt> {
    let d = meter.dimensions();
    let mut stream = setup.key.with("stage", "jumps").block(0);
    let even: Vec<f64> = (0..LINE_POINTS).map(|k| (k as f64 + 0.5) / LINE_POINTS as f64).collect();
    let low: Vec<f64> = (RIM..RIM_END).rev().map(|k| (-f64::from(k)).exp2()).collect();
    let high: Vec<f64> = (RIM..RIM_END).map(|k| 1.0 - (-f64::from(k)).exp2()).collect();
    let mut scans = Vec::new();
    for axis in active {
        for _ in 0..LINES {
            let line: Vec<f64> = (0..d).map(|_| 0.01 + 0.98 * stream.next_f64()).collect();
            scans.extend([&even, &low, &high].map(|places| (Line { u: line.clone(), axis }, places)));
        }
    }
    let mut samples = Samples::default();
    let u: Vec<f64> =
        scans.iter().flat_map(|(line, places)| places.iter().flat_map(|s| line.row(*s))).collect();
    meter.sample(setup.wo, &u, setup.transport, &mut samples)?;
    let mut steps = Vec::new();
    let mut first = 0;
    for (line, places) in scans {
        let mut lobes = samples.lobe[first..first + places.len()].iter().filter(|l| l.is_valid());
        if lobes.next().is_some_and(|one| lobes.any(|l| l != one)) {
            return Ok(true);
        }
        let widest = (1..places.len())
            .filter(|k| [k - 1, *k].iter().all(|k| samples.lobe[first + k].is_valid()))
            .map(|k| ((samples.wi[first + k] - samples.wi[first + k - 1]).length(), k))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        first += places.len();
        steps.extend(widest.map(|(width, k)| Step {
            line,
            ends: [places[k - 1], places[k]],
            start: width,
            width,
        }));
    }
    for _ in 0..HALVINGS {
        let u: Vec<f64> = steps.iter().flat_map(Step::rows).collect();
        if u.is_empty() {
            break;
        }
        meter.sample(setup.wo, &u, setup.transport, &mut samples)?;
        let mut first = 0;
        steps.retain_mut(|step| {
            let rows = first..first + 3;
            first += 3;
            let valid = samples.lobe[rows.clone()].iter().all(|l| l.is_valid());
            step.halve(&samples.wi[rows]);
            valid
        });
    }
    // 24 halvings shrink a smooth step by 6e-8, a square root's by 2e-4. Steps
    // of rounding do not shrink.
    Ok(steps.iter().any(|step| step.width > 0.01 * step.start && step.start > 1e-6))
}

/// A line through the unit square along one of its axes.
struct Line {
    u: Vec<f64>,
    axis: usize,
}

impl Line {
    fn row(&self, s: f64) -> Vec<f64> {
        let mut row = self.u.clone();
        row[self.axis] = s;
        row
    }
}

/// The widest step of wi on a line, as it is halved.
struct Step {
    line: Line,
    ends: [f64; 2],
    start: f64,
    width: f64,
}

impl Step {
    fn middle(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    fn rows(&self) -> Vec<f64> {
        let [lo, hi] = self.ends;
        [lo, self.middle(), hi].iter().flat_map(|s| self.line.row(*s)).collect()
    }

    /// Goes on with the wider half, of wi at both ends and between them.
    fn halve(&mut self, wi: &[Direction]) {
        let middle = self.middle();
        let halves = [1, 2].map(|r| (wi[r] - wi[r - 1]).length());
        self.ends[usize::from(halves[0] > halves[1])] = middle;
        self.width = halves[0].max(halves[1]);
    }
}

/// Points whose other origins are looked for, draws among which, starts for
/// each, and steps of Newton's method from each.
const SOUGHT: usize = 8;
const ORIGINS: usize = 4096;
const STARTS: usize = 24;
const STEPS: usize = 20;

/// Whether another u leads to the same wi: Newton's method towards it, inside
/// of the unit square, from draws that fell near it with another u.
fn has_second_origin(
    meter: &Meter,
    setup: &Setup,
    points: &[Point],
    active: [usize; 2],
) -> Result<bool, Halt> {
    let d = meter.dimensions();
    let mut u = vec![0.0; ORIGINS * d];
    setup.key.with("stage", "origins").block(0).fill(false, &mut u);
    let (mut draws, mut around) = (Samples::default(), Samples::default());
    meter.sample(setup.wo, &u, setup.transport, &mut draws)?;
    let apart = |a: &[f64], b: &[f64]| active.iter().map(|k| (a[*k] - b[*k]).abs()).fold(0.0, f64::max);
    // Every walk from a draw to a point, side by side.
    let mut walks: Vec<(&Point, Vec<f64>)> = Vec::new();
    for point in points.iter().take(SOUGHT) {
        let mut starts: Vec<usize> = (0..ORIGINS)
            .filter(|k| draws.lobe[*k].is_continuous() && apart(&u[k * d..(k + 1) * d], &point.u) > 0.02)
            .collect();
        starts.sort_by(|a, b| {
            let far = |k: &usize| (draws.wi[*k] - point.wi).length();
            far(a).total_cmp(&far(b))
        });
        walks.extend(starts.into_iter().take(STARTS).map(|k| (point, u[k * d..(k + 1) * d].to_vec())));
    }
    for _ in 0..STEPS {
        let mut rows = Vec::new();
        for (_, at) in &walks {
            rows.extend_from_slice(at);
            for k in active {
                for step in [STEP, -STEP] {
                    let mut row = at.clone();
                    row[k] += step;
                    rows.extend(row);
                }
            }
        }
        if rows.is_empty() {
            break;
        }
        meter.sample(setup.wo, &rows, setup.transport, &mut around)?;
        let mut arrived = false;
        let mut first = 0;
        walks.retain_mut(|(point, at)| {
            let rows = first..first + 5;
            first += 5;
            if !around.lobe[rows.clone()].iter().all(|l| l.is_continuous()) {
                return false;
            }
            let wi = &around.wi[rows];
            let rest = point.wi - wi[0];
            if rest.length() < 1e-9 {
                arrived |= apart(at, &point.u) > 1e-3;
                return false;
            }
            let slope = |k: usize| (wi[k] - wi[k + 1]) * (0.5 / STEP);
            let (a, b) = (slope(1), slope(3));
            // Least squares in the two numbers that move wi.
            let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
            let (ar, br) = (a.dot(rest), b.dot(rest));
            let determinant = aa * bb - ab * ab;
            let steps = [(ar * bb - br * ab) / determinant, (br * aa - ar * ab) / determinant];
            for (k, step) in active.into_iter().zip(steps) {
                at[k] += step.clamp(-0.1, 0.1);
            }
            active.iter().all(|k| at[*k] > 2.0 * STEP && at[*k] < 1.0 - 2.0 * STEP)
        });
        if arrived {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The share of the other random numbers that lead to the same wi, and the
/// uncertainty of that share.
fn branch(meter: &Meter, setup: &Setup, point: &Point, active: [usize; 2]) -> Result<(f64, f64), Halt> {
    let d = meter.dimensions();
    if d == 2 {
        return Ok((1.0, 0.0));
    }
    // A branch rarer than the spacing is most often at one of the ends.
    let middles = (0..BRANCHES).map(|k| (k as f64 + 0.5) / BRANCHES as f64);
    let mut u = Vec::with_capacity((BRANCHES + 2) * d);
    for free in middles.chain([0.0, 1.0 - f64::EPSILON / 2.0]) {
        u.extend((0..d).map(|j| if active.contains(&j) { point.u[j] } else { free }));
    }
    let mut samples = Samples::default();
    meter.sample(setup.wo, &u, setup.transport, &mut samples)?;
    let is_same = |k: usize| samples.lobe[k].is_valid() && (samples.wi[k] - point.wi).length() < 1e-9;
    let same = (0..BRANCHES).filter(|k| is_same(*k)).count();
    let alone = (0..BRANCHES + 2).all(is_same);
    let slack = if alone { 0.0 } else { 1.5 / BRANCHES as f64 };
    Ok((same as f64 / BRANCHES as f64, slack))
}
