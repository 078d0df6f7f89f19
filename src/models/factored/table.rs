//! A subject's f·cos θi on a grid.

use super::{Given, Grid, Matrix, bezier};
use crate::bsdf::{Cosine, Direction, Subject};

/// f·cos θi dωi/dωp of a subject, channels averaged, at the sites of a grid and
/// between them, one row a direction wo. What is negative counts as 0.
pub struct Table {
    /// At the sites: `row[t * φ sites + φ]`.
    pub sites: Matrix,
    /// A quarter into each cell in t, at the knots in φ, in the same order.
    between: Matrix,
}

/// Where in a cell of t the splines are compared with the subject: far from its
/// sites, the ends and the middle.
const QUARTER: f64 = 0.25;

impl Table {
    /// Asks a subject. `Err` with the place where a value is not finite.
    pub fn of(subject: &dyn Subject, grid: &Grid, given: &Given) -> Result<Self, String> {
        let phi = &grid.phi.at()[..grid.phi.intervals()];
        let quarters: Vec<f64> = grid.t.at().windows(2).map(|t| t[0] + QUARTER * (t[1] - t[0])).collect();
        Ok(Self {
            sites: tabulated(subject, grid, given, &grid.t.sites(), &grid.phi.sites())?,
            between: tabulated(subject, grid, given, &quarters, phi)?,
        })
    }

    /// What share of the light at row `row` the splines through the sites put
    /// elsewhere than it is, as far as the places between tell: 0 to 1.
    pub fn misplaced(&self, grid: &Grid, row: usize) -> f64 {
        let sites = self.sites.row(row);
        let columns = grid.phi.intervals();
        // Along φ at each site in t, then along t at each knot in φ.
        let along_phi: Vec<Vec<f64>> = sites.chunks(columns).map(|v| grid.phi.values(v)).collect();
        let (mut apart, mut sum) = (0.0, 0.0);
        for k in 0..columns {
            let column: Vec<f64> = along_phi.iter().map(|v| v[k]).collect();
            let (values, middles) = (grid.t.values(&column), grid.t.middles(&column));
            for (i, t) in grid.t.at().windows(2).enumerate() {
                let spline = bezier([values[i], middles[i], values[i + 1]], QUARTER);
                let value = self.between.row(row)[i * columns + k];
                apart += (value - spline).abs() * (t[1] - t[0]);
                sum += (value + spline) * (t[1] - t[0]);
            }
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
            if value.iter().any(|v| !v.is_finite()) {
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
