//! Gauss and Legendre's rule.

/// Nodes in (0, 1), ascending, with their weights: exact for polynomials of
/// degree 2n − 1. Newton's method on Legendre's recurrence (Abramowitz and Stegun
/// 1964, 25.4.29 and 22.7.10).
pub(super) fn rule(n: usize) -> Vec<(f64, f64)> {
    let count = n as f64;
    (0..n)
        .map(|k| {
            let mut x = -(std::f64::consts::PI * (k as f64 + 0.75) / (count + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut p, mut before) = (1.0, 0.0);
                for j in 1..=n {
                    let j = j as f64;
                    (p, before) = (((2.0 * j - 1.0) * x * p - (j - 1.0) * before) / j, p);
                }
                slope = count * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::rule;

    #[test]
    fn is_exact_for_polynomials() {
        for n in [1, 2, 5, 16, 40] {
            for degree in 0..2 * n as i32 {
                let sum: f64 = rule(n).iter().map(|(x, w)| w * x.powi(degree)).sum();
                assert!((sum * f64::from(degree + 1) - 1.0).abs() < 1e-13, "{n} {degree}: {sum}");
            }
        }
    }
}
