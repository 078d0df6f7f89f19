//! The factored density, and how it comes from a table.

use super::table::Table;
use super::{Conditional, Given, Grid, Matrix, SplineDensity};
use crate::bsdf::Direction;

/// How a table is factored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factorisation {
    /// J: terms F_j(ωo) G_j(ωp).
    pub outer: usize,
    /// K: terms u_jk(θp) v_jk(φp) of each G_j.
    pub inner: usize,
    /// Share in (0, 1) of the draws that follow the cosine, so that no direction
    /// is left out.
    pub floor: f64,
}

/// One term u(θp) v(φp); what u has of its first coefficient, the pole's, is even in φ.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Density in t = 1 − cos θp.
    pub t: SplineDensity,
    /// Density in φp, per radian.
    pub phi: SplineDensity,
}

/// p(ωp | ωo) = Σ_l F_l(ωo) u_l(θp) v_l(φp), each u and v a density and each F a
/// probability (Lawrence et al. 2004), and a share of cosine.
#[derive(Clone, Debug, PartialEq)]
pub struct FactoredDensity {
    pub(super) grid: Grid,
    pub(super) given: Given,
    pub(super) isotropic: bool,
    pub(super) floor: f64,
    terms: Vec<Term>,
    /// `probabilities[row * terms + l]` = F_l at direction `row` of `given`; a row
    /// adds up to 1, or to 0 where the subject is black.
    probabilities: Matrix,
    pub(super) t: Curves,
    pub(super) phi: Curves,
}

/// The splines of all terms, side by side.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curves {
    terms: usize,
    values: Vec<f64>,
    middles: Vec<f64>,
}

impl Curves {
    fn new(terms: &[Term], intervals: usize, of: fn(&Term) -> &SplineDensity) -> Self {
        let all = |n: usize, number: fn(&SplineDensity, usize) -> f64| {
            (0..n).flat_map(|k| terms.iter().map(move |term| number(of(term), k))).collect()
        };
        Self {
            terms: terms.len(),
            values: all(intervals + 1, SplineDensity::value),
            middles: all(intervals, SplineDensity::middle),
        }
    }

    /// Of interval `k`: left values, middle coefficients and right values, by term.
    #[inline]
    pub(super) fn interval(&self, k: usize) -> [&[f64]; 3] {
        let n = self.terms;
        [&self.values[k * n..][..n], &self.middles[k * n..][..n], &self.values[(k + 1) * n..][..n]]
    }
}

/// Most updates of each factorisation.
const UPDATES: usize = 100;

impl FactoredDensity {
    /// Factors a table: its rows, scaled to a mass of 1, by [`Matrix::factored`] into
    /// F_j G_j, and each G_j, a matrix of θp and φp, again. Last, each u v gets the
    /// probability of its own that goes best with each wo.
    pub(super) fn new(table: &Table, grid: Grid, given: Given, isotropic: bool, by: Factorisation) -> Self {
        let cells = grid.phi.intervals();
        let (t_weights, phi_weights) = (grid.t.weights(), grid.phi.weights());
        let mut mass = table.sites.clone();
        for row in mass.values.chunks_exact_mut(mass.columns) {
            row.iter_mut().enumerate().for_each(|(k, v)| *v *= t_weights[k / cells] * phi_weights[k % cells]);
            let sum: f64 = row.iter().sum();
            row.iter_mut().for_each(|v| *v = if sum > 0.0 { *v / sum } else { 0.0 });
        }
        // u v of masses at the sites.
        let term = |u: &[f64], v: &[f64]| -> Option<Term> {
            let density = |masses: &[f64], weights: &[f64]| -> Vec<f64> {
                masses.iter().zip(weights).map(|(m, w)| m / w).collect()
            };
            Some(Term {
                t: SplineDensity::new(&grid.t, &density(u, &t_weights))?,
                phi: SplineDensity::new(&grid.phi, &density(v, &phi_weights))?,
            })
        };
        let mut terms = Vec::new();
        let mut products = Vec::new();
        // An isotropic subject does not know azimuths at normal incidence: a term
        // of its own, and no other there.
        let alone = usize::from(isotropic);
        if isotropic {
            let u: Vec<f64> = mass.row(0).chunks(cells).map(|v| v.iter().sum()).collect();
            terms.extend(term(&u, &vec![1.0; cells]));
        }
        let poles = terms.len();
        let mass = Matrix::new(mass.columns, mass.values.split_off(alone * mass.columns));
        for g in mass.factored(by.outer, UPDATES).right.rows() {
            let factors = Matrix::new(cells, g.to_vec()).factored(by.inner, UPDATES);
            for (k, v) in factors.right.rows().enumerate() {
                let u: Vec<f64> = factors.left.rows().map(|l| l[k]).collect();
                let Some(term) = term(&u, v) else { continue };
                let scale = 1.0 / (u.iter().sum::<f64>() * v.iter().sum::<f64>());
                products.extend(u.iter().flat_map(|u| v.iter().map(move |v| u * v * scale)));
                terms.push(term);
            }
        }
        let mut probabilities = vec![0.0; alone * terms.len()];
        probabilities.iter_mut().take(poles).for_each(|p| *p = 1.0);
        let own = terms.len() - poles;
        if own > 0 {
            let weights = mass.weights(&Matrix::new(mass.columns, products), UPDATES);
            for row in weights.rows() {
                let sum: f64 = row.iter().sum();
                probabilities.extend(vec![0.0; poles]);
                probabilities.extend(row.iter().map(|w| if sum > 0.0 { w / sum } else { 0.0 }));
            }
        } else {
            probabilities.resize(given.len() * terms.len(), 0.0);
        }
        Self {
            t: Curves::new(&terms, grid.t.intervals(), |term| &term.t),
            phi: Curves::new(&terms, cells, |term| &term.phi),
            probabilities: Matrix { columns: terms.len().max(1), values: probabilities },
            terms,
            grid,
            given,
            isotropic,
            floor: by.floor,
        }
    }

    /// The density of ωp, and with it of wi, given `wo`.
    pub fn given(&self, wo: Direction) -> Conditional<'_> {
        Conditional::new(self, wo)
    }

    /// The grid of ωp.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The terms.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// F_l(`wo`) by term: probabilities that add up to 1, and to less near a wo at
    /// which the subject is black. Between tabulated directions they are
    /// interpolated, which keeps their sum.
    pub fn probabilities(&self, wo: Direction) -> Vec<f64> {
        let mut sum = vec![0.0; self.terms.len()];
        for (row, share) in self.given.around(wo).into_iter().filter(|(_, share)| *share > 0.0) {
            let row = &self.probabilities.values[row * self.terms.len()..][..self.terms.len()];
            sum.iter_mut().zip(row).for_each(|(s, p)| *s += share * p);
        }
        sum
    }
}
