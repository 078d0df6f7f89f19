//! Interpolation in Chebyshev points.

use std::f64::consts::PI;

/// Coefficients c of Σ c_k T_k(x) through `values` at [`points`] of the same
/// number, without those at the end that are below 1e-16 of the largest.
pub(super) fn coefficients(values: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let mut c: Vec<f64> = (0..values.len())
        .map(|k| {
            let sum: f64 = values
                .iter()
                .enumerate()
                .map(|(j, v)| v * (PI * k as f64 * (j as f64 + 0.5) / n).cos())
                .sum();
            sum * if k == 0 { 1.0 } else { 2.0 } / n
        })
        .collect();
    let largest = c.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    while c.len() > 1 && c.last().is_some_and(|v| v.abs() < 1e-16 * largest) {
        c.pop();
    }
    c
}

/// The `n` Chebyshev points of [−1, 1], from the largest to the smallest.
pub(super) fn points(n: usize) -> impl Iterator<Item = f64> {
    (0..n).map(move |j| (PI * (j as f64 + 0.5) / n as f64).cos())
}

/// Σ c_k T_k(x) by Clenshaw's recurrence, each coefficient by `c`.
pub(super) fn sum(n: usize, x: f64, c: impl Fn(usize) -> f64) -> f64 {
    let (mut a, mut b) = (0.0, 0.0);
    for k in (1..n).rev() {
        (a, b) = (c(k) + 2.0 * x * a - b, a);
    }
    c(0) + x * a - b
}

/// Coefficients of 1, x, x², … of Σ c_k T_k(x). For short or fast falling
/// series: the largest grows by 1 + √2 a degree.
pub(super) fn powers(c: &[f64]) -> Vec<f64> {
    // Clenshaw's recurrence on polynomials.
    let n = c.len();
    let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
    for k in (0..n).rev() {
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let mut next: Vec<f64> = b.iter().map(|b| -b).collect();
        next[0] += c[k];
        for i in 1..n {
            next[i] += factor * a[i - 1];
        }
        (a, b) = (next, a);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reproduces_a_smooth_function() {
        let f = |x: f64| (3.0 * x).sin() + 1.0 / (2.0 + x);
        let c = coefficients(&points(40).map(f).collect::<Vec<_>>());
        for i in 0..=100 {
            let x = f64::from(i) / 50.0 - 1.0;
            assert!((sum(c.len(), x, |k| c[k]) - f(x)).abs() < 1e-14);
        }
    }

    #[test]
    fn powers_of_chebyshev_polynomials() {
        assert_eq!(powers(&[1.0, 0.0, 0.0, 2.0]), [1.0, -6.0, 0.0, 8.0]);
        assert_eq!(powers(&[0.0, 0.0, 0.0, 0.0, 1.0]), [1.0, 0.0, -8.0, 0.0, 8.0]);
        assert_eq!(powers(&[3.0]), [3.0]);
    }
}
