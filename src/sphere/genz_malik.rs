//! The rule of Genz and Malik in two dimensions.

use super::chart::Point;

/// Nodes of the rule.
pub const NODES: usize = 17;

/// Genz and Malik's rule of degree 7 with an embedded rule of degree 5 on the
/// unit square ("An adaptive algorithm for numerical integration over an
/// N-dimensional rectangular region", J. Comput. Appl. Math. 6, 1980, §2, at
/// n = 2).
#[derive(Clone, Debug)]
pub struct Rule {
    points: [Point; NODES],
}

// Weights at n = 2: (12824 − 9120n + 400n²)/19683, 980/6561,
// (1820 − 400n)/19683, 200/19683 and 6859/19683/2ⁿ; embedded
// (729 − 950n + 50n²)/729, 245/486, (265 − 100n)/1458, 25/729.
const W7: [f64; 5] =
    [-3816.0 / 19683.0, 980.0 / 6561.0, 1020.0 / 19683.0, 200.0 / 19683.0, 6859.0 / 19683.0 / 4.0];
const W5: [f64; 4] = [-971.0 / 729.0, 245.0 / 486.0, 65.0 / 1458.0, 25.0 / 729.0];

/// λ2² / λ3² = (9/70)/(9/10), which makes the fourth difference of a
/// quadratic vanish.
const RATIO: f64 = 1.0 / 7.0;

impl Default for Rule {
    fn default() -> Self {
        Self::new()
    }
}

impl Rule {
    /// The rule.
    pub fn new() -> Self {
        let (inner, outer, corner) = ((9.0f64 / 70.0).sqrt(), (9.0f64 / 10.0).sqrt(), (9.0f64 / 19.0).sqrt());
        let mut points = [[0.0, 0.0]; NODES];
        // Centre; ±inner and ±outer on x, then on y; ±outer corners; ±corner corners.
        for axis in 0..2 {
            for (k, value) in [inner, -inner, outer, -outer].into_iter().enumerate() {
                points[1 + 4 * axis + k][axis] = value;
            }
        }
        for (k, (sx, sy)) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].into_iter().enumerate() {
            points[9 + k] = [sx * outer, sy * outer];
            points[13 + k] = [sx * corner, sy * corner];
        }
        Self { points: points.map(|[x, y]| [0.5 + 0.5 * x, 0.5 + 0.5 * y]) }
    }

    /// The nodes in the unit square.
    pub fn points(&self) -> &[Point; NODES] {
        &self.points
    }

    /// The mean over the square by degree 7, and its distance from degree 5.
    #[inline]
    pub fn apply(&self, node: impl Fn(usize) -> f64) -> (f64, f64) {
        let sum = |range: [usize; 4]| range.into_iter().map(&node).sum::<f64>();
        let sums =
            [node(0), sum([1, 2, 5, 6]), sum([3, 4, 7, 8]), sum([9, 10, 11, 12]), sum([13, 14, 15, 16])];
        let high: f64 = W7.iter().zip(sums).map(|(w, s)| w * s).sum();
        let low: f64 = W5.iter().zip(sums).map(|(w, s)| w * s).sum();
        (high, (high - low).abs())
    }

    /// The axis along which either function bends more, by fourth differences
    /// scaled to the function's own size; `None` where neither bends.
    pub fn rougher_axis(&self, a: impl Fn(usize) -> f64, b: impl Fn(usize) -> f64) -> Option<u8> {
        let bends = |f: &dyn Fn(usize) -> f64| {
            let difference = |k: usize| {
                let second = |i: usize| f(i) + f(i + 1) - 2.0 * f(0);
                (second(k) - RATIO * second(k + 2)).abs()
            };
            let scale = (0..9).map(|k| f(k).abs()).fold(f64::MIN_POSITIVE, f64::max);
            [difference(1) / scale, difference(5) / scale]
        };
        let (a, b) = (bends(&a), bends(&b));
        let along = [a[0].max(b[0]), a[1].max(b[1])];
        (along != [0.0, 0.0]).then(|| u8::from(along[1] > along[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact on all monomials up to degree 7 (and the embedded rule to 5),
    /// not on degree 8.
    #[test]
    fn has_the_degrees_that_it_claims() {
        let rule = Rule::new();
        for i in 0..=8 {
            for j in 0..=8 {
                let exact = 1.0 / f64::from((i + 1) * (j + 1));
                let f = |k: usize| rule.points()[k][0].powi(i) * rule.points()[k][1].powi(j);
                let (high, distance) = rule.apply(f);
                if i + j <= 7 {
                    assert!((high - exact).abs() < 1e-14, "x^{i} y^{j}: {high}");
                }
                if i + j <= 5 {
                    assert!(distance < 1e-13, "x^{i} y^{j}: {distance}");
                }
            }
        }
        let (eight, _) = rule.apply(|k| rule.points()[k][0].powi(8));
        assert!((eight - 1.0 / 9.0).abs() > 1e-7);
    }

    #[test]
    fn tells_the_rougher_axis() {
        let rule = Rule::new();
        let bent = |axis: usize| move |k: usize| (5.0 * Rule::new().points()[k][axis]).sin();
        assert_eq!(rule.rougher_axis(bent(0), |_| 1.0), Some(0));
        assert_eq!(rule.rougher_axis(|_| 1.0, bent(1)), Some(1));
        assert_eq!(rule.rougher_axis(|_| 1.0, |_| 0.0), None);
    }
}
