//! Non-negative factorisation of matrices.

/// A matrix of non-negative numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// Numbers in a row.
    pub columns: usize,
    /// `values[row * columns + column]`.
    pub values: Vec<f64>,
}

/// Two non-negative matrices whose product is near a third.
#[derive(Clone, Debug, PartialEq)]
pub struct Factors {
    /// rows × rank.
    pub left: Matrix,
    /// rank × columns.
    pub right: Matrix,
}

/// Beside what the start puts into a factor, this share is spread evenly: a zero
/// would stay one under multiplicative updates.
const SPREAD: f64 = 1e-2;

/// Updates end where ten of them lower the divergence by less than this share of
/// the mass: a hundred such would gain a thousandth of a nat, about a tenth of a
/// per cent of efficiency.
const CONVERGED: f64 = 1e-5;

impl Matrix {
    /// From rows of equal length.
    pub fn new(columns: usize, values: Vec<f64>) -> Self {
        assert_eq!(values.len() % columns, 0, "rows have {columns} numbers");
        Self { columns, values }
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.values.len() / self.columns
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Row `k`.
    pub fn row(&self, k: usize) -> &[f64] {
        &self.values[k * self.columns..][..self.columns]
    }

    /// All rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.columns)
    }

    /// Its factors of `rank` columns and rows, with the smallest Kullback–Leibler
    /// divergence Σ v ln(v/w) − v + w that at most `updates` multiplicative updates
    /// reach (D. D. Lee and H. S. Seung, *Algorithms for non-negative matrix
    /// factorization*, 2001, theorem 2). Densities want this measure: it costs more
    /// to have too little somewhere than too much. No random numbers: the start are
    /// the rows that are farthest from each other.
    pub fn factored(&self, rank: usize, updates: usize) -> Factors {
        let mut factors = self.start(rank);
        self.converge(&mut factors, updates, |factors| {
            update_right(factors, self);
            update_left(factors, self);
        });
        factors
    }

    /// The left factor that goes best with a given right one: for each row the
    /// weights of a mixture, a convex problem.
    pub fn weights(&self, right: &Self, updates: usize) -> Self {
        let even = vec![1.0 / right.len() as f64; right.len() * self.len()];
        let mut factors = Factors { left: Self::new(right.len(), even), right: right.clone() };
        self.converge(&mut factors, updates, |factors| update_left(factors, self));
        factors.left
    }

    /// Calls `update` as often as it helps, at most `updates` times.
    fn converge(&self, factors: &mut Factors, updates: usize, update: impl Fn(&mut Factors)) {
        let mass: f64 = self.values.iter().sum();
        let mut last = f64::INFINITY;
        for k in 1..=updates {
            update(factors);
            if k % 10 == 0 {
                let now = self.divergence(factors);
                if !(last - now > CONVERGED * mass) {
                    return;
                }
                last = now;
            }
        }
    }

    /// The Kullback–Leibler divergence of the factors' product from this.
    pub fn divergence(&self, factors: &Factors) -> f64 {
        let product = factors.product();
        let term = |(v, w): (&f64, &f64)| if *v > 0.0 { v * (v / w).ln() - v + w } else { *w };
        self.values.iter().zip(&product.values).map(term).sum()
    }

    fn start(&self, rank: usize) -> Factors {
        let mass: Vec<f64> = self.rows().map(|r| r.iter().sum()).collect();
        let total: f64 = mass.iter().sum();
        // Of rows scaled to mass 1: how much they have in common.
        let common = |a: usize, b: usize| -> f64 {
            let (x, y) = (1.0 / mass[a].max(f64::MIN_POSITIVE), 1.0 / mass[b].max(f64::MIN_POSITIVE));
            self.row(a).iter().zip(self.row(b)).map(|(v, w)| (v * x).min(w * y)).sum()
        };
        let heaviest = (0..self.len()).max_by(|a, b| mass[*a].total_cmp(&mass[*b])).unwrap_or(0);
        let mut overlaps = vec![(0..self.len()).map(|r| common(r, heaviest)).collect::<Vec<f64>>()];
        let mut seeds = vec![heaviest];
        while seeds.len() < rank {
            let nearest = |r: &usize| overlaps.iter().map(|o| o[*r]).fold(0.0, f64::max);
            let lit = (0..self.len()).filter(|r| mass[*r] > 0.0);
            let seed = lit.min_by(|a, b| nearest(a).total_cmp(&nearest(b))).unwrap_or(heaviest);
            overlaps.push((0..self.len()).map(|r| common(r, seed)).collect());
            seeds.push(seed);
        }
        let even = SPREAD * total / (self.values.len() as f64);
        let right = seeds.iter().flat_map(|s| self.row(*s).iter().map(|v| v + even)).collect();
        let left = (0..self.len()).flat_map(|r| overlaps.iter().map(move |o| o[r] + SPREAD)).collect();
        Factors { left: Self::new(rank, left), right: Self::new(self.columns, right) }
    }
}

impl Factors {
    /// left · right.
    pub fn product(&self) -> Matrix {
        let columns = self.right.columns;
        let mut values = vec![0.0; self.left.len() * columns];
        for (row, left) in values.chunks_exact_mut(columns).zip(self.left.rows()) {
            product_row(left, &self.right, row);
        }
        Matrix { columns, values }
    }
}

#[inline(always)]
fn product_row(left: &[f64], right: &Matrix, out: &mut [f64]) {
    out.fill(0.0);
    for (l, right) in left.iter().zip(right.rows()) {
        out.iter_mut().zip(right).for_each(|(sum, r)| *sum += l * r);
    }
}

/// Less is no divisor: what has no part in a product does not divide by 0.
const LEAST: f64 = 1e-150;

/// One update of the left factor of `v`: l ← l · Σ_c r_c v_c/(l r)_c / Σ_c r_c.
fn update_left(Factors { left, right }: &mut Factors, v: &Matrix) {
    let sums: Vec<f64> = right.rows().map(|r| r.iter().sum::<f64>().max(LEAST)).collect();
    let mut ratio = vec![0.0; v.columns];
    for (row, mine) in v.rows().zip(left.values.chunks_exact_mut(right.len())) {
        pulp::Arch::new().dispatch(Ratio { mine, right, row, ratio: &mut ratio });
        for ((l, right), sum) in mine.iter_mut().zip(right.rows()).zip(&sums) {
            *l *= pulp::Arch::new().dispatch(|| dot(right, &ratio)) / sum;
        }
    }
}

/// And of the right one: r ← r · Σ_i l_i v_i/(l r)_i / Σ_i l_i.
fn update_right(Factors { left, right }: &mut Factors, v: &Matrix) {
    let mut sums = vec![0.0; right.len()];
    let mut gains = Matrix::new(right.columns, vec![0.0; right.values.len()]);
    let mut ratio = vec![0.0; v.columns];
    for (row, mine) in v.rows().zip(left.rows()) {
        pulp::Arch::new().dispatch(Ratio { mine, right, row, ratio: &mut ratio });
        for ((l, gains), sum) in mine.iter().zip(gains.values.chunks_exact_mut(v.columns)).zip(&mut sums) {
            *sum += l;
            pulp::Arch::new().dispatch(|| gains.iter_mut().zip(&ratio).for_each(|(g, q)| *g += l * q));
        }
    }
    let rows = right.values.chunks_exact_mut(v.columns).zip(gains.rows());
    for ((row, gains), sum) in rows.zip(sums) {
        let sum = sum.max(LEAST);
        row.iter_mut().zip(gains).for_each(|(r, g)| *r *= g / sum);
    }
}

/// v/(l r) of a row of v, with `mine` of l, into `ratio`.
struct Ratio<'a> {
    mine: &'a [f64],
    right: &'a Matrix,
    row: &'a [f64],
    ratio: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Ratio<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        product_row(self.mine, self.right, self.ratio);
        let ratios = self.ratio.iter_mut().zip(self.row);
        ratios.for_each(|(q, v)| *q = v / if *q > LEAST { *q } else { LEAST });
    }
}

/// Σ a b, in lanes that a processor adds at once.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a.zip(b) {
        for k in 0..LANES {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values without structure.
    fn scattered(rows: usize, columns: usize, step: f64) -> Matrix {
        let value = |k: usize| (0.5 + k as f64 * step).fract().powi(2);
        Matrix::new(columns, (0..rows * columns).map(value).collect())
    }

    fn error(a: &Matrix, b: &Matrix) -> f64 {
        let largest = a.values.iter().copied().fold(0.0, f64::max);
        a.values.iter().zip(&b.values).map(|(x, y)| (x - y).abs() / largest).fold(0.0, f64::max)
    }

    #[test]
    fn an_outer_product_is_found_exactly() {
        let v = Factors { left: scattered(7, 1, 0.618), right: scattered(1, 12, 0.414) }.product();
        assert!(error(&v, &v.factored(1, 2).product()) < 1e-14);
    }

    #[test]
    fn blocks_come_apart() {
        // Rank 3 with one factorisation only: three blocks that share nothing.
        let mut v = Matrix::new(9, vec![0.0; 81]);
        for (row, column) in (0..9).flat_map(|r| (0..9).map(move |c| (r, c))).filter(|(r, c)| r / 3 == c / 3)
        {
            v.values[row * 9 + column] = (1.0 + row as f64) * (2.0 + (column % 3) as f64);
        }
        let factors = v.factored(3, 500);
        assert!(error(&v, &factors.product()) < 1e-6);
        for right in factors.right.rows() {
            let sums: Vec<f64> = right.chunks(3).map(|b| b.iter().sum()).collect();
            let largest = sums.iter().copied().fold(0.0, f64::max);
            assert!(sums.iter().filter(|s| **s > 1e-6 * largest).count() == 1, "{sums:?}");
        }
    }

    #[test]
    fn low_ranks_are_recovered_and_updates_never_do_worse() {
        let v = Factors { left: scattered(20, 3, 0.618), right: scattered(3, 30, 0.7548) }.product();
        let mass: f64 = v.values.iter().sum();
        let divergence = |updates| v.divergence(&v.factored(3, updates)) / mass;
        let steps = [0, 1, 2, 5, 10, 40, 160].map(divergence);
        assert!(steps.windows(2).all(|s| s[1] <= s[0] * (1.0 + 1e-12)), "{steps:?}");
        assert!(steps[6] < 2e-4 && divergence(0) > 0.01, "{steps:?}");
        // A rank too low cannot.
        assert!(v.divergence(&v.factored(1, 1000)) / mass > 100.0 * steps[6]);
    }

    #[test]
    fn weights_of_a_known_mixture() {
        let hump = |k: usize| if k / 12 == k % 12 / 4 { 1.0 } else { 0.1 };
        let right = Matrix::new(12, (0..36).map(hump).collect());
        let known = Matrix::new(3, vec![0.2, 0.3, 0.5, 0.9, 0.05, 0.05]);
        let v = Factors { left: known.clone(), right: right.clone() }.product();
        assert!(error(&known, &v.weights(&right, 100)) < 1e-2);
    }

    #[test]
    fn rows_without_light_do_no_harm() {
        let v = Matrix::new(3, vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
        let factors = v.factored(2, 50);
        assert!(error(&v, &factors.product()) < 1e-6 && factors.left.values.iter().all(|x| x.is_finite()));
        let dark = Matrix::new(2, vec![0.0; 4]).factored(2, 50);
        assert!(dark.product().values.iter().all(|x| *x == 0.0));
    }
}
