//! The isotropic tables of W. Matusik, H. Pfister, M. Brand and L. McMillan, *A
//! data-driven reflectance model*, SIGGRAPH 2003 (the MERL database).

use super::half_difference::HalfDifference;
use super::per_wo::Reflector;
use super::sampler::{GivenLobe, IsotropicSampler};
use crate::bsdf::{Description, Direction, Lobe, Sample, Spectrum, Table};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// Cells along θh, θd and φd of every file of the database.
pub const DIMENSIONS: [usize; 3] = [90, 90, 180];

/// What a stored number is multiplied by to be f in sr⁻¹, for r, g and b, as the
/// database's own reader has it.
pub const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Cells begin this part of a cell early, so that rounding does not choose between
/// two where directions of whole degrees lie on an edge.
const EDGE: f64 = 1e-9;

/// How a table is read between the centres of its cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Linearly in its own coordinates, which makes f continuous.
    Linear,
    /// The value of the cell, as the database's own reader does.
    Nearest,
}

/// A table of f over θh, θd and φd. θh is divided finely towards 0, cell k
/// beginning at (k/n)² π/2; θd and φd evenly over [0, π/2] and [0, π).
#[derive(Clone, Debug, PartialEq)]
pub struct MerlTable {
    dimensions: [usize; 3],
    /// r, g and b in sr⁻¹, φd fastest; 0 where data are missing.
    values: Vec<[f64; 3]>,
    missing: f64,
}

/// The angles of cell (i, j, k)'s centre.
pub(super) fn centre([h, d, p]: [usize; 3], [i, j, k]: [usize; 3]) -> HalfDifference {
    let middle = |index: usize, count: usize| (index as f64 + 0.5) / count as f64;
    HalfDifference {
        theta_h: middle(i, h).powi(2) * FRAC_PI_2,
        theta_d: middle(j, d) * FRAC_PI_2,
        phi_d: middle(k, p) * PI,
    }
}

impl MerlTable {
    /// From values in sr⁻¹, φd fastest and θh slowest; negative ones are missing
    /// and count as 0.
    ///
    /// # Panics
    /// If there are not as many values as cells.
    pub(super) fn new(dimensions: [usize; 3], mut values: Vec<[f64; 3]>) -> Self {
        assert_eq!(values.len(), dimensions.iter().product::<usize>());
        let reach = Reach::new(dimensions);
        let (mut reachable, mut missing) = (0u64, 0u64);
        let [_, d, p] = dimensions;
        for (index, cell) in values.iter_mut().enumerate() {
            let lacks = cell.iter().any(|v| *v < 0.0);
            let within = reach.holds([index / (d * p), index / p % d, index % p]);
            reachable += u64::from(within);
            missing += u64::from(within && lacks);
            *cell = cell.map(|v| v.max(0.0));
        }
        Self { dimensions, values, missing: missing as f64 / reachable.max(1) as f64 }
    }

    /// Share in [0, 1] of missing data among the cells whose centre a pair of
    /// directions above the horizon can have.
    pub fn missing(&self) -> f64 {
        self.missing
    }

    /// f in sr⁻¹ of directions on the front side.
    #[inline]
    pub fn value(&self, wo: Direction, wi: Direction, interpolation: Interpolation) -> [f64; 3] {
        let angles = HalfDifference::new(wo, wi);
        let [h, d, p] = self.dimensions;
        let i = (angles.theta_h / FRAC_PI_2).sqrt() * h as f64;
        let j = angles.theta_d / FRAC_PI_2 * d as f64;
        let k = angles.phi_d / PI * p as f64;
        match interpolation {
            Interpolation::Nearest => {
                let cell = |at: f64, count: usize| ((at + EDGE) as usize).min(count - 1);
                self.values[(cell(i, h) * d + cell(j, d)) * p + cell(k, p)]
            }
            Interpolation::Linear => self.linear([i, j, k]),
        }
    }

    #[inline]
    fn linear(&self, [i, j, k]: [f64; 3]) -> [f64; 3] {
        let [h, d, p] = self.dimensions;
        // Beyond the outer centres the outer values go on.
        let ends = |at: f64, count: usize| {
            let at = (at - 0.5).clamp(0.0, (count - 1) as f64);
            let first = (at as usize).min(count.saturating_sub(2));
            (first, (first + 1).min(count - 1), at - first as f64)
        };
        let ((i0, i1, s), (j0, j1, t)) = (ends(i, h), ends(j, d));
        // φd + π is the exchanged pair: the last cell meets the first.
        let at = k - 0.5;
        let at = if at < 0.0 { at + p as f64 } else { at };
        let k0 = (at as usize).min(p - 1);
        let (k1, w) = (if k0 + 1 == p { 0 } else { k0 + 1 }, at - k0 as f64);
        let mut sum = [0.0; 3];
        for (i, share) in [(i0, 1.0 - s), (i1, s)] {
            for (j, share) in [(j0, share * (1.0 - t)), (j1, share * t)] {
                let row = (i * d + j) * p;
                let (a, b) = (self.values[row + k0], self.values[row + k1]);
                for c in 0..3 {
                    sum[c] += share * ((1.0 - w) * a[c] + w * b[c]);
                }
            }
        }
        sum
    }
}

/// Which cells have a centre that two directions above the horizon can have.
struct Reach {
    dimensions: [usize; 3],
    /// cos and sin of θh and θd, cos of φd.
    theta_h: Vec<(f64, f64)>,
    theta_d: Vec<(f64, f64)>,
    cos_phi: Vec<f64>,
}

impl Reach {
    fn new(dimensions: [usize; 3]) -> Self {
        let [h, d, p] = dimensions;
        let cos_sin = |angle: f64| (angle.cos(), angle.sin());
        Self {
            dimensions,
            theta_h: (0..h).map(|i| cos_sin(centre(dimensions, [i, 0, 0]).theta_h)).collect(),
            theta_d: (0..d).map(|j| cos_sin(centre(dimensions, [0, j, 0]).theta_d)).collect(),
            cos_phi: (0..p).map(|k| centre(dimensions, [0, 0, k]).phi_d.cos()).collect(),
        }
    }

    /// cos θo and cos θi are cos θh cos θd ± sin θh sin θd cos φd.
    fn holds(&self, [i, j, k]: [usize; 3]) -> bool {
        debug_assert!(i < self.dimensions[0]);
        let ((cos_h, sin_h), (cos_d, sin_d)) = (self.theta_h[i], self.theta_d[j]);
        cos_h * cos_d > (sin_h * sin_d * self.cos_phi[k]).abs()
    }
}

/// A MERL table as a BSDF: its values, and a sampler made for them. A subject
/// within [`PerWo`](super::PerWo).
#[derive(Clone, Debug)]
pub struct Merl {
    table: Arc<MerlTable>,
    sampler: Arc<IsotropicSampler>,
    interpolation: Interpolation,
}

impl Merl {
    /// Of a table. The sampler is made from its linear interpolation, however it
    /// is read.
    pub fn new(table: MerlTable, interpolation: Interpolation) -> Self {
        let mean = |v: [f64; 3]| (v[0] + v[1] + v[2]) / 3.0;
        let sampler = IsotropicSampler::new(|wo, wi| mean(table.value(wo, wi, Interpolation::Linear)));
        Self { table: Arc::new(table), sampler: Arc::new(sampler), interpolation }
    }

    /// The same table read in another way.
    pub fn read_by(&self, interpolation: Interpolation) -> Self {
        Self { interpolation, ..self.clone() }
    }

    /// The table.
    pub fn table(&self) -> &MerlTable {
        &self.table
    }
}

impl Reflector for Merl {
    type Given<'a> = (Direction, GivenLobe<'a>);

    fn describe(&self) -> Description {
        Description::new("merl")
            .channels(["r", "g", "b"])
            .dimensions(2)
            .claims(|c| c.isotropic = true)
            .by_construction(
                "reciprocity",
                "the table is stored over θh, θd and φd in [0, π), where a pair of directions and the \
                 exchanged pair are one place",
            )
            .table(Table { missing: self.table.missing })
    }

    fn given(&self, wo: Direction, calls: usize) -> Self::Given<'_> {
        (wo, self.sampler.given(wo, calls).expect("wo is on the front side"))
    }

    #[inline]
    fn eval(&self, (wo, _): &Self::Given<'_>, wi: Direction, out: &mut [f64]) {
        out.copy_from_slice(&self.table.value(*wo, wi, self.interpolation));
    }

    #[inline]
    fn pdf(&self, (_, lobe): &Self::Given<'_>, wi: Direction) -> f64 {
        lobe.pdf(wi)
    }

    #[inline]
    fn sample(&self, (wo, lobe): &Self::Given<'_>, u: [f64; 2]) -> Option<Sample> {
        let (wi, pdf) = lobe.sample(u)?;
        let f = self.table.value(*wo, wi, self.interpolation);
        let weight = Spectrum::from(&f[..]) * (wi.z / pdf);
        Some(Sample { wi, weight, pdf, lobe: Lobe::GLOSSY_REFLECTION })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table whose value tells the cell.
    fn counted(dimensions: [usize; 3]) -> MerlTable {
        let count = dimensions.iter().product::<usize>();
        MerlTable::new(dimensions, (0..count).map(|k| [k as f64, 2.0 * k as f64, 3.0]).collect())
    }

    /// The database's reader takes θh's cell as ⌊√(θh 90/(π/2) · 90)⌋, θd's as
    /// ⌊θd 90/(π/2)⌋ and φd's as ⌊φd 180/π⌋.
    #[test]
    fn nearest_is_the_cell_of_the_reference_reader() {
        let dimensions = [9, 5, 6];
        let table = counted(dimensions);
        for theta_h in [0.01f64, 0.3, 0.7, 1.2] {
            for theta_d in [0.05f64, 0.2, 0.35] {
                for phi_d in [0.1f64, 1.0, 2.0, 3.0] {
                    let [wo, wi] = HalfDifference { theta_h, theta_d, phi_d }.pair();
                    let i = (theta_h * 9.0 / FRAC_PI_2 * 9.0).sqrt() as usize;
                    let j = (theta_d * 5.0 / FRAC_PI_2) as usize;
                    let k = (phi_d * 6.0 / PI) as usize;
                    let found = table.value(wo, wi, Interpolation::Nearest);
                    let index = ((i * 5 + j) * 6 + k) as f64;
                    assert_eq!(found, [index, 2.0 * index, 3.0], "{theta_h} {theta_d} {phi_d}");
                }
            }
        }
    }

    #[test]
    fn linear_meets_the_cells_at_their_centres_and_wraps() {
        let dimensions = [4, 5, 6];
        let table = counted(dimensions);
        for index in [0usize, 7, 33, 64, 119] {
            let cell = [index / 30, index / 6 % 5, index % 6];
            let [wo, wi] = centre(dimensions, cell).pair();
            let found = table.value(wo, wi, Interpolation::Linear);
            assert!((found[0] - index as f64).abs() < 1e-9, "{cell:?}: {found:?}");
        }
        let value = |phi_d: f64| {
            let [wo, wi] = HalfDifference { theta_h: 0.4, theta_d: 0.4, phi_d }.pair();
            table.value(wo, wi, Interpolation::Linear)[0]
        };
        assert!((value(1e-7) - value(PI - 1e-7)).abs() < 1e-5);
    }

    #[test]
    fn is_reciprocal_to_the_bit() {
        let table = counted([9, 9, 18]);
        for k in 0..1000 {
            let turn = |a: f64, b: f64| {
                Direction::from_angles(1.5 * (a * f64::from(k)).fract(), 6.0 * (b * f64::from(k)).fract())
            };
            let (wo, wi) = (turn(0.618, 0.414), turn(0.732, 0.236));
            for interpolation in [Interpolation::Linear, Interpolation::Nearest] {
                assert_eq!(table.value(wo, wi, interpolation), table.value(wi, wo, interpolation));
            }
        }
    }

    /// At normal incidence every pair has φd = 0 or π, and rounding must not
    /// choose between the first and the last cell.
    #[test]
    fn normal_incidence_is_round() {
        let table = counted([9, 9, 18]);
        let first = table.value(Direction::NORMAL, Direction::from_angles(0.7, 0.0), Interpolation::Nearest);
        for k in 0..1000 {
            let wi = Direction::from_angles(0.7, 0.0063 * f64::from(k));
            assert_eq!(table.value(Direction::NORMAL, wi, Interpolation::Nearest), first);
        }
    }

    #[test]
    fn missing_data_count_as_zero_and_are_told() {
        let dimensions = [3, 4, 6];
        let full = MerlTable::new(dimensions, vec![[0.5; 3]; 72]);
        assert_eq!(full.missing(), 0.0);
        let mut values = vec![[0.5; 3]; 72];
        values[0] = [-1.0, 0.5, 0.5];
        let table = MerlTable::new(dimensions, values);
        assert_eq!(table.values[0], [0.0, 0.5, 0.5]);
        let reach = Reach::new(dimensions);
        let reachable = (0..72).filter(|k| reach.holds([k / 24, k / 6 % 4, k % 6])).count();
        assert!(reachable > 10 && reachable < 72);
        assert_eq!(table.missing(), 1.0 / reachable as f64);
        // Cells that only directions below the horizon have need no data.
        let below = (0..72usize).find(|k| !reach.holds([k / 24, k / 6 % 4, k % 6])).unwrap();
        let mut values = vec![[0.5; 3]; 72];
        values[below] = [-1.0; 3];
        assert_eq!(MerlTable::new(dimensions, values).missing(), 0.0);
    }
}
