//! A subject's f·cos θi on a grid.

use super::{Given, Grid, Matrix};
use crate::bsdf::{Cosine, Direction, Subject};

/// f·cos θi dωi/dωp of a subject, channels averaged, at the knots of a grid and in
/// the middle of its cells, one row a direction wo.
pub struct Table {
    /// At the knots: `row[theta * φ cells + phi]`.
    pub knots: Matrix,
    /// In the middle of the cells, in the same order.
    pub middles: Matrix,
}

impl Table {
    /// Asks a subject. `Err` with the place where a value is not finite.
    pub fn of(subject: &dyn Subject, grid: &Grid, given: &Given) -> Result<Self, String> {
        let middle = |knots: &[f64]| knots.windows(2).map(|k| 0.5 * (k[0] + k[1])).collect::<Vec<_>>();
        let (t, phi) = (middle(&grid.t), middle(&grid.phi));
        Ok(Self {
            knots: tabulated(subject, grid, given, &grid.t, &grid.phi[..phi.len()])?,
            middles: tabulated(subject, grid, given, &t, &phi)?,
        })
    }

    /// What share of the light at row `row` linear interpolation between the knots
    /// puts elsewhere than it is, as far as the middles of cells tell: 0 to 1.
    pub fn misplaced(&self, grid: &Grid, row: usize) -> f64 {
        let (knots, middles) = (self.knots.row(row), self.middles.row(row));
        let cells = grid.phi.len() - 1;
        let (mut apart, mut sum) = (0.0, 0.0);
        for (k, value) in middles.iter().enumerate() {
            let (i, j) = (k / cells, k % cells);
            let corner = |i: usize, j: usize| knots[i * cells + j % cells];
            let linear = 0.25 * (corner(i, j) + corner(i + 1, j) + corner(i, j + 1) + corner(i + 1, j + 1));
            let area = grid.t[i + 1] - grid.t[i];
            apart += (value - linear).abs() * area;
            sum += (value + linear) * area;
        }
        if sum > 0.0 { apart / sum } else { 0.0 }
    }
}

fn tabulated(
    subject: &dyn Subject,
    grid: &Grid,
    given: &Given,
    t: &[f64],
    phi: &[f64],
) -> Result<Matrix, String> {
    let description = subject.describe();
    let channels = description.channels.len();
    let transport = description.claims.transport.modes()[0];
    let columns = t.len() * phi.len();
    let mut values = vec![0.0; given.len() * columns];
    for (row, out) in values.chunks_exact_mut(columns).enumerate() {
        let wo = given.direction(row);
        let places = t.iter().flat_map(|t| phi.iter().map(|phi| Grid::direction(*t, *phi)));
        let reached: Vec<(usize, (Direction, f64))> =
            places.enumerate().filter_map(|(k, wp)| Some((k, grid.over.backward(wo, wp)?))).collect();
        let wi: Vec<Direction> = reached.iter().map(|(_, (wi, _))| *wi).collect();
        let mut value = vec![0.0; wi.len() * channels];
        subject.eval(wo, &wi, transport, &mut value).map_err(|e| e.to_string())?;
        for ((k, (wi, jacobian)), value) in reached.into_iter().zip(value.chunks_exact(channels)) {
            let mean = value.iter().map(|v| v.max(0.0)).sum::<f64>() / channels as f64;
            if !mean.is_finite() {
                let degrees = |w: Direction| (w.theta().to_degrees(), w.phi().to_degrees());
                let ((a, b), (c, d)) = (degrees(wo), degrees(wi));
                return Err(format!(
                    "its eval is {value:?} at wo = (θ {a:.2}°, φ {b:.2}°), wi = (θ {c:.2}°, φ {d:.2}°): only what is \
                     finite can be factored"
                ));
            }
            let cosine = if description.claims.cosine == Cosine::Included { 1.0 } else { wi.z };
            out[k] = mean * cosine / jacobian;
        }
    }
    Ok(Matrix::new(columns, values))
}
