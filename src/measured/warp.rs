//! Functions on the unit square that are bilinear between nodes, and densities
//! of that kind that can be drawn from.

use std::borrow::Cow;

/// A weighted sum of slices, between which a function is interpolated linearly
/// in up to two parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    terms: [(usize, f64); 4],
    count: usize,
}

impl Blend {
    /// One slice alone.
    pub fn one(slice: usize) -> Self {
        Self { terms: [(slice, 1.0); 4], count: 1 }
    }

    /// Between slices `k` and `k + 1`, `t` in [0, 1) of the way.
    pub fn between(at: (usize, f64)) -> Self {
        Self::of_two((0, 0.0), at, 1)
    }

    /// Between slices of two parameters, the second of which has `inner` values
    /// and runs fastest.
    pub fn of_two((i, s): (usize, f64), (j, t): (usize, f64), inner: usize) -> Self {
        let mut blend = Self { terms: [(0, 0.0); 4], count: 0 };
        for (i, a) in [(i, 1.0 - s), (i + 1, s)] {
            for (j, b) in [(j, 1.0 - t), (j + 1, t)] {
                if a * b > 0.0 {
                    blend.terms[blend.count] = (i * inner + j, a * b);
                    blend.count += 1;
                }
            }
        }
        blend
    }

    /// The sum over slices of weight times `value` of the slice.
    #[inline(always)]
    fn sum(&self, value: impl Fn(usize) -> f64) -> f64 {
        let (slice, weight) = self.terms[0];
        let mut sum = weight * value(slice);
        for (slice, weight) in &self.terms[1..self.count] {
            sum += weight * value(*slice);
        }
        sum
    }

    /// Its slices with their weights.
    #[inline(always)]
    pub fn terms(&self) -> &[(usize, f64)] {
        &self.terms[..self.count]
    }
}

/// Where `value` lies between increasing `nodes`: the node before it and how far
/// towards the next, in [0, 1); values beyond the ends count as the ends.
pub fn locate(nodes: &[f64], value: f64) -> (usize, f64) {
    let last = nodes.len() - 1;
    if !(value > nodes[0]) {
        return (0, 0.0);
    }
    if value >= nodes[last] {
        return (last, 0.0);
    }
    let k = nodes.partition_point(|n| *n <= value) - 1;
    (k, (value - nodes[k]) / (nodes[k + 1] - nodes[k]))
}

/// Node and fraction on `count` nodes spread evenly over [0, 1], at least two;
/// the last patch is closed.
#[inline]
fn patch(count: usize, x: f64) -> (usize, f64) {
    let at = x.clamp(0.0, 1.0) * (count - 1) as f64;
    let k = (at as usize).min(count - 2);
    (k, at - k as f64)
}

/// Values of `depth` components at nx × ny nodes spread evenly over the unit
/// square, corners included, for each of several slices; bilinear in between.
/// x runs faster than y, components fastest.
#[derive(Clone, Debug)]
pub struct Grid {
    nx: usize,
    ny: usize,
    depth: usize,
    values: Vec<f64>,
}

impl Grid {
    /// From values in the order slice, y, x, component; at least two nodes on
    /// each axis.
    ///
    /// # Panics
    /// If the values do not fill whole slices, or an axis has one node.
    pub fn new([nx, ny]: [usize; 2], depth: usize, values: Vec<f64>) -> Self {
        assert!(nx >= 2 && ny >= 2, "{nx} × {ny} nodes span no square");
        assert_eq!(values.len() % (nx * ny * depth), 0, "values fill whole slices");
        Self { nx, ny, depth, values }
    }

    /// The components at a point of the square into `out`.
    #[inline]
    pub fn at(&self, blend: &Blend, [x, y]: [f64; 2], out: &mut [f64]) {
        let ((i, s), (j, t)) = (patch(self.nx, x), patch(self.ny, y));
        out.fill(0.0);
        for &(slice, weight) in blend.terms() {
            let row = (slice * self.ny + j) * self.nx + i;
            for (node, share) in [
                (row, (1.0 - s) * (1.0 - t)),
                (row + 1, s * (1.0 - t)),
                (row + self.nx, (1.0 - s) * t),
                (row + self.nx + 1, s * t),
            ] {
                let values = &self.values[node * self.depth..(node + 1) * self.depth];
                out.iter_mut().zip(values).for_each(|(sum, v)| *sum += weight * share * v);
            }
        }
    }

    /// The value at a point of one slice, of a grid with one component.
    #[inline]
    pub fn value(&self, slice: usize, [x, y]: [f64; 2]) -> f64 {
        let ((i, s), (j, t)) = (patch(self.nx, x), patch(self.ny, y));
        let row = (slice * self.ny + j) * self.nx + i;
        let along = |row: usize| (1.0 - s) * self.values[row] + s * self.values[row + 1];
        (1.0 - t) * along(row) + t * along(row + self.nx)
    }
}

/// Densities on the unit square, bilinear between nx × ny nodes and linear
/// between slices, drawn from by inverting first the marginal of y, then the
/// conditional of x, both exactly: piecewise linear densities have quadratic
/// distribution functions.
#[derive(Clone, Debug)]
pub struct Warp {
    nx: usize,
    ny: usize,
    /// Densities at nodes, each slice of integral 1.
    density: Vec<f64>,
    /// ∫ density dx from 0 to each node, along each row of nodes.
    conditional: Vec<f64>,
    /// ∫ of the rows' integrals dy from 0 to each row.
    marginal: Vec<f64>,
}

/// What part t in [0, 1] of an interval holds `mass`, in units of its width,
/// where the density runs linearly from `a` to `b`: a t + (b − a) t²/2 = mass.
#[inline]
fn part(a: f64, b: f64, mass: f64) -> f64 {
    // The form without cancellation whichever of a and b is larger.
    let root = (a * a + 2.0 * mass * (b - a)).max(0.0).sqrt();
    let t = 2.0 * mass / (a + root);
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}

/// The mass of the part t of such an interval.
#[inline]
fn mass(a: f64, b: f64, t: f64) -> f64 {
    t * (a + 0.5 * t * (b - a))
}

impl Warp {
    /// From values proportional to densities, in the order slice, y, x. `Err` with
    /// the slice whose values are all zero, or are not densities.
    ///
    /// # Panics
    /// If the values do not fill whole slices, or an axis has one node.
    pub fn new([nx, ny]: [usize; 2], mut density: Vec<f64>) -> Result<Self, usize> {
        assert!(nx >= 2 && ny >= 2, "{nx} × {ny} nodes span no square");
        assert_eq!(density.len() % (nx * ny), 0, "values fill whole slices");
        let slices = density.len() / (nx * ny);
        let mut conditional = vec![0.0; density.len()];
        let mut marginal = vec![0.0; slices * ny];
        let (hx, hy) = (1.0 / (nx - 1) as f64, 1.0 / (ny - 1) as f64);
        for slice in 0..slices {
            let rows = slice * ny..(slice + 1) * ny;
            for row in rows.clone() {
                for k in row * nx..(row + 1) * nx - 1 {
                    conditional[k + 1] = conditional[k] + 0.5 * hx * (density[k] + density[k + 1]);
                }
            }
            let whole = |row: usize, conditional: &[f64]| conditional[(row + 1) * nx - 1];
            for row in rows.start..rows.end - 1 {
                let two = whole(row, &conditional) + whole(row + 1, &conditional);
                marginal[row + 1] = marginal[row] + 0.5 * hy * two;
            }
            let total = marginal[rows.end - 1];
            if !(total > 0.0 && total < f64::INFINITY) {
                return Err(slice);
            }
            let scale = 1.0 / total;
            density[rows.start * nx..rows.end * nx].iter_mut().for_each(|v| *v *= scale);
            conditional[rows.start * nx..rows.end * nx].iter_mut().for_each(|v| *v *= scale);
            marginal[rows].iter_mut().for_each(|v| *v *= scale);
        }
        Ok(Self { nx, ny, density, conditional, marginal })
    }

    /// The blended density. Where so many `calls` are to come that blending its
    /// tables once is cheaper, that is done.
    pub fn slice(&self, blend: Blend, calls: usize) -> Slice<'_> {
        if blend.count == 1 || 8 * calls < self.nx * self.ny {
            return Slice { warp: Cow::Borrowed(self), blend };
        }
        let blended = |values: &[f64], size: usize| {
            let mut sum = vec![0.0; size];
            for &(slice, weight) in blend.terms() {
                let values = &values[slice * size..(slice + 1) * size];
                sum.iter_mut().zip(values).for_each(|(sum, v)| *sum += weight * v);
            }
            sum
        };
        let warp = Self {
            nx: self.nx,
            ny: self.ny,
            density: blended(&self.density, self.nx * self.ny),
            conditional: blended(&self.conditional, self.nx * self.ny),
            marginal: blended(&self.marginal, self.ny),
        };
        Slice { warp: Cow::Owned(warp), blend: Blend::one(0) }
    }

    #[inline]
    fn node(&self, blend: &Blend, values: &[f64], i: usize, j: usize) -> f64 {
        blend.sum(|slice| values[(slice * self.ny + j) * self.nx + i])
    }

    /// ∫ density dx along a row of nodes.
    #[inline]
    fn row(&self, blend: &Blend, j: usize) -> f64 {
        self.node(blend, &self.conditional, self.nx - 1, j)
    }

    /// Densities at the left and right end of a patch, at t of its height.
    #[inline]
    fn ends(&self, blend: &Blend, i: usize, (j, t): (usize, f64)) -> [f64; 2] {
        [i, i + 1].map(|i| {
            let at = |j| self.node(blend, &self.density, i, j);
            (1.0 - t) * at(j) + t * at(j + 1)
        })
    }

    fn density(&self, blend: &Blend, [x, y]: [f64; 2]) -> f64 {
        let (i, s) = patch(self.nx, x);
        let [a, b] = self.ends(blend, i, patch(self.ny, y));
        (1.0 - s) * a + s * b
    }

    fn sample(&self, blend: &Blend, [ux, uy]: [f64; 2]) -> ([f64; 2], f64) {
        let before = |j: usize| blend.sum(|slice| self.marginal[slice * self.ny + j]);
        let j = interval(self.ny, uy, 1.0, before);
        let (r0, r1) = (self.row(blend, j), self.row(blend, j + 1));
        let steps_y = (self.ny - 1) as f64;
        let t = part(r0, r1, (uy - before(j)) * steps_y);
        let before = |i: usize| {
            let at = |j| self.node(blend, &self.conditional, i, j);
            (1.0 - t) * at(j) + t * at(j + 1)
        };
        let whole = (1.0 - t) * r0 + t * r1;
        let target = ux * whole;
        let i = interval(self.nx, target, whole, before);
        let [a, b] = self.ends(blend, i, (j, t));
        let steps_x = (self.nx - 1) as f64;
        let s = part(a, b, (target - before(i)) * steps_x);
        ([(i as f64 + s) / steps_x, (j as f64 + t) / steps_y], (1.0 - s) * a + s * b)
    }

    fn invert(&self, blend: &Blend, [x, y]: [f64; 2]) -> ([f64; 2], f64) {
        let ((i, s), (j, t)) = (patch(self.nx, x), patch(self.ny, y));
        let (r0, r1) = (self.row(blend, j), self.row(blend, j + 1));
        let below = blend.sum(|slice| self.marginal[slice * self.ny + j]);
        let uy = below + mass(r0, r1, t) / (self.ny - 1) as f64;
        let [a, b] = self.ends(blend, i, (j, t));
        let left = |j| self.node(blend, &self.conditional, i, j);
        let left = (1.0 - t) * left(j) + t * left(j + 1);
        let whole = (1.0 - t) * r0 + t * r1;
        let ux = if whole > 0.0 { (left + mass(a, b, s) / (self.nx - 1) as f64) / whole } else { 0.5 };
        ([ux.min(1.0), uy.min(1.0)], (1.0 - s) * a + s * b)
    }
}

/// A density of a [`Warp`], blended of some of its slices.
#[derive(Clone, Debug)]
pub struct Slice<'a> {
    warp: Cow<'a, Warp>,
    blend: Blend,
}

impl Slice<'_> {
    /// The density at a point.
    #[inline]
    pub fn density(&self, point: [f64; 2]) -> f64 {
        self.warp.density(&self.blend, point)
    }

    /// The point that `u` in [0, 1)² leads to, and the density there.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> ([f64; 2], f64) {
        self.warp.sample(&self.blend, u)
    }

    /// The `u` that leads to a point, and the density there.
    #[inline]
    pub fn invert(&self, point: [f64; 2]) -> ([f64; 2], f64) {
        self.warp.invert(&self.blend, point)
    }
}

/// The interval k in 0..n − 1 with cumulative(k) ≤ u < cumulative(k + 1), looked
/// for about where an even density of this `total` has it.
#[inline]
fn interval(n: usize, u: f64, total: f64, cumulative: impl Fn(usize) -> f64) -> usize {
    let (mut lo, mut hi) = (0, n - 1);
    let even = ((u / total * hi as f64) as usize).min(hi - 1);
    let mut step = 1;
    if cumulative(even) <= u {
        lo = even;
        while lo + step < hi && cumulative(lo + step) <= u {
            lo += step;
            step *= 2;
        }
        hi = hi.min(lo + step);
    } else {
        hi = even;
        while step < hi && cumulative(hi - step) > u {
            hi -= step;
            step *= 2;
        }
        lo = lo.max(hi.saturating_sub(step));
    }
    while hi - lo > 1 {
        let middle = (lo + hi) / 2;
        if cumulative(middle) <= u {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    lo
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn two_slices(seed: &[f64]) -> Warp {
        Warp::new([4, 5], seed.iter().map(|v| v * v).collect()).unwrap()
    }

    proptest! {
        #[test]
        fn inverts_what_it_samples(
            seed in proptest::collection::vec(0.05..1.0f64, 40),
            u in [0.0..1.0f64, 0.0..1.0f64],
            t in 0.0..1.0f64,
        ) {
            let warp = two_slices(&seed);
            let slice = warp.slice(Blend::between((0, t)), 0);
            let (point, p) = slice.sample(u);
            let (back, q) = slice.invert(point);
            prop_assert!((p / q - 1.0).abs() < 1e-9 && (slice.density(point) / q - 1.0).abs() < 1e-9);
            // Blending the tables first is the same.
            let (other, r) = warp.slice(Blend::between((0, t)), 1000).sample(u);
            prop_assert!((p / r - 1.0).abs() < 1e-9 && (0..2).all(|k| (point[k] - other[k]).abs() < 1e-9));
            prop_assert!((back[0] - u[0]).abs() < 1e-9 && (back[1] - u[1]).abs() < 1e-9, "{u:?} {back:?}");
        }
    }

    /// Midpoint sums of each quarter of the square against the share of evenly
    /// spread u that lands there.
    #[test]
    fn draws_its_density() {
        let mut seed: Vec<f64> = (0..40).map(|k| (f64::from(k) * 0.618).fract()).collect();
        // Patches and rows of zeros must not be drawn.
        seed[..8].fill(0.0);
        let warp = two_slices(&seed);
        let slice = warp.slice(Blend::between((0, 0.25)), 1000);
        let n = 400;
        let (mut mass, mut found) = ([0.0; 4], [0.0; 4]);
        for k in 0..n * n {
            let at = [k % n, k / n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            let quarter = |[x, y]: [f64; 2]| usize::from(x > 0.5) + 2 * usize::from(y > 0.5);
            let share = 1.0 / f64::from(n * n);
            mass[quarter(at)] += slice.density(at) * share;
            let (point, p) = slice.sample(at);
            assert!(p > 0.0);
            found[quarter(point)] += share;
        }
        assert!((mass.iter().sum::<f64>() - 1.0).abs() < 1e-4);
        for k in 0..4 {
            assert!((mass[k] - found[k]).abs() < 2e-3, "{mass:?} {found:?}");
        }
    }

    #[test]
    fn edges() {
        let warp = two_slices(&[1.0; 40]);
        let last = 1.0 - f64::EPSILON / 2.0;
        for u in [[0.0, 0.0], [last, last], [0.0, last]] {
            let (point, p) = warp.slice(Blend::one(1), 1).sample(u);
            assert!((p - 1.0).abs() < 1e-12 && (0..2).all(|k| (point[k] - u[k]).abs() < 1e-12));
        }
        assert_eq!(Warp::new([2, 2], vec![1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]).unwrap_err(), 1);
        assert_eq!(locate(&[0.0, 1.0, 3.0], 2.0), (1, 0.5));
        assert_eq!(locate(&[0.0, 1.0, 3.0], 3.0), (2, 0.0));
        assert_eq!(locate(&[0.0, 1.0, 3.0], -1.0), (0, 0.0));
    }
}
