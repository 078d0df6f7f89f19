//! A table as a subject, with an importance sampler made from it.

use super::survey::flux;
use super::table::{Side, Table};
use crate::bsdf::{
    Description, Direction, Lobe, NativeCells, Rectangle, Samples, Subject, SubjectError, Transport,
    TransportModes,
};
use crate::sphere::Chart;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

/// Relative asymmetry up to which a table claims to be reciprocal: the pointwise
/// tolerance of f64 subjects.
const RECIPROCAL: f64 = 1e-6;

/// Pairs that are looked at before that is claimed.
const PAIRS: usize = 1 << 16;

/// Draws stay this share of its width away from the edges of a cell: farther than
/// directions are moved when their cell is looked for.
const OFF_EDGE: f64 = 1e-6;

/// Slices kept: more than the directions that a case looks along.
const KEPT: usize = 64;

/// A [`Table`] with `pdf` and `sample`.
///
/// Light arrives along wo. A cell of wi, on either side, is drawn by its share of
/// ∫ f cos, and a direction in it by the cosine: the density is f cos over the
/// incident patch's flux, and the weight is that flux.
pub struct Measured {
    table: Table,
    reciprocal: bool,
    slices: Mutex<HashMap<(Side, usize, usize), Arc<Slice>>>,
    most: OnceLock<String>,
    #[cfg(test)]
    pub(super) tamper: Option<Tamper>,
}

/// Plants a bug in the sampler of a direction.
#[cfg(test)]
pub(super) type Tamper = Box<dyn Fn(Direction, &mut Slice) + Send + Sync>;

/// The cells of wi for one incident cell.
pub(super) struct Slice {
    /// Rectangles of the two squares, and f in each.
    pub cells: Vec<(Rectangle, f64)>,
    /// Sums of ∫ f cos up to and with each cell.
    pub cumulative: Vec<f64>,
    /// Σ f Λ.
    pub flux: f64,
}

impl Measured {
    /// Claims what the data shows.
    pub fn new(table: Table) -> Self {
        Self {
            reciprocal: table.largest_asymmetry(PAIRS) <= RECIPROCAL,
            table,
            slices: Mutex::default(),
            most: OnceLock::new(),
            #[cfg(test)]
            tamper: None,
        }
    }

    /// The table.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// The chart whose rectangles the cells of wi are, if light comes in at all.
    fn chart(&self, wo: Direction) -> Option<Chart> {
        let from = Side::of(wo)?;
        self.table.scattered(from).next().map(|(_, d)| d.chart(wo))
    }

    /// The cells of wi, on both sides.
    fn slice(&self, wo: Direction) -> Option<Arc<Slice>> {
        let from = Side::of(wo)?;
        let cell = |to| self.table.distribution(from, to).map_or(0, |d| 1 + d.incident(wo).0);
        let key = (from, cell(Side::Front), cell(Side::Back));
        let mut slices = self.slices.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(slice) = slices.get(&key) {
            return Some(slice.clone());
        }
        let slice = Arc::new(self.make_slice(from, wo));
        if slices.len() >= KEPT {
            slices.clear();
        }
        slices.insert(key, slice.clone());
        Some(slice)
    }

    pub(super) fn make_slice(&self, from: Side, wo: Direction) -> Slice {
        let mut cells = Vec::new();
        for to in Side::BOTH {
            let right = if to == Side::Front { 0.0 } else { 1.0 };
            let whole = || vec![(Rectangle { lo: [0.0, 0.0], hi: [1.0, 1.0] }, 0.0)];
            let outgoing = self.table.distribution(from, to).map_or_else(whole, |d| d.outgoing(wo));
            cells.extend(outgoing.into_iter().map(|(r, f)| {
                let shifted = |[u, v]: [f64; 2]| [u + right, v];
                (Rectangle { lo: shifted(r.lo), hi: shifted(r.hi) }, f)
            }));
        }
        let mut sum = 0.0;
        let mut cumulative = Vec::with_capacity(cells.len());
        for cell in &cells {
            sum += flux(std::slice::from_ref(cell));
            cumulative.push(sum);
        }
        #[cfg_attr(not(test), expect(unused_mut, reason = "tests plant bugs in it"))]
        let mut slice = Slice { cells, cumulative, flux: sum };
        #[cfg(test)]
        if let Some(tamper) = &self.tamper {
            tamper(wo, &mut slice);
        }
        slice
    }

    /// Where the largest sum of all incident patches is.
    fn most(&self) -> &str {
        self.most.get_or_init(|| {
            let all = Side::BOTH.into_iter().flat_map(|side| {
                self.table.incident_fluxes(side).into_iter().map(move |flux| (side, flux))
            });
            let most = all.max_by(|a, b| a.1.total().total_cmp(&b.1.total()));
            most.map_or_else(String::new, |(side, flux)| {
                let (theta, phi) = (flux.wo.theta().to_degrees(), flux.wo.phi().to_degrees().rem_euclid(360.0));
                let (total, patch) = (flux.total(), flux.patch);
                format!(
                    "; of all incident patches the most flux, {total:.5}, leaves of {side} {patch}, at --theta {theta:.2} --phi {phi:.1}"
                )
            })
        })
    }
}

impl Slice {
    /// The cell and the place in it that u leads to; none where nothing leaves.
    fn draw(&self, u: &[f64]) -> Option<[f64; 2]> {
        if !(self.flux > 0.0) {
            return None;
        }
        let target = u[0] * self.flux;
        let last = self.cumulative.partition_point(|c| *c < self.flux);
        let cell = self.cumulative.partition_point(|c| *c <= target).min(last);
        let Rectangle { lo, hi } = self.cells[cell].0;
        let inside = |k: usize| lo[k] + (hi[k] - lo[k]) * u[1 + k].clamp(OFF_EDGE, 1.0 - OFF_EDGE);
        Some([inside(0), inside(1)])
    }
}

impl Subject for Measured {
    fn describe(&self) -> Description {
        let (reflective, transmissive) = self.table.has();
        Description::new("lbnl").channels([self.table.wavelength.to_lowercase()]).claims(|c| {
            c.reciprocal = self.reciprocal;
            c.reflective = reflective;
            c.transmissive = transmissive;
            // Rank 3 is isotropic by its parameters, which no check can break, but
            // at wo = n, where its axes have no azimuth to turn with.
            c.isotropic = false;
            c.transport = TransportModes::Importance;
        })
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        wi.iter().zip(out).for_each(|(wi, f)| *f = self.table.value(wo, *wi));
        Ok(())
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        let flux = self.slice(wo).map_or(0.0, |s| s.flux);
        for (wi, p) in wi.iter().zip(out) {
            *p = if flux > 0.0 { self.table.value(wo, *wi) * wi.abs_cos_theta() / flux } else { 0.0 };
        }
        Ok(())
    }

    fn sample(&self, wo: Direction, u: &[f64], _: Transport, out: &mut Samples) -> Result<(), SubjectError> {
        let lit = self.slice(wo).zip(self.chart(wo));
        for u in u.chunks_exact(3) {
            let draw = lit.as_ref().and_then(|(slice, chart)| {
                let wi = chart.to_direction(slice.draw(u)?);
                let lobe = if wi.same_side(wo) { Lobe::GLOSSY_REFLECTION } else { Lobe::GLOSSY_TRANSMISSION };
                let pdf = self.table.value(wo, wi) * wi.abs_cos_theta() / slice.flux;
                Some(crate::bsdf::Sample { wi, weight: slice.flux.into(), pdf, lobe })
            });
            out.push(draw.as_ref());
        }
        Ok(())
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        let from = Side::of(wo)?;
        let (_, first) = self.table.scattered(from).next()?;
        let slice = self.slice(wo)?;
        let notes: String = self.table.notes.iter().map(|note| format!("; {note}")).collect();
        Some(NativeCells {
            projection: first.projection(),
            phi0: first.phi0(wo),
            cells: slice.cells.iter().map(|c| c.0).collect(),
            given: format!("{from} incident {}{}{notes}", first.describe_incident(wo), self.most()),
        })
    }
}
