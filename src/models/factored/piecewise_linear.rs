//! A density of one variable that is linear between knots.

/// A density that is linear between knots, continuous, and integrates to 1. It is
/// sampled exactly: its distribution function is quadratic between knots.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseLinear {
    knots: Vec<f64>,
    values: Vec<f64>,
    cumulative: Vec<f64>,
}

impl PiecewiseLinear {
    /// In proportion to `values` ≥ 0 at rising `knots` (two or more, equally many of
    /// both); `None` where the integral is not a positive number.
    pub fn new(knots: &[f64], values: &[f64]) -> Option<Self> {
        assert_eq!(knots.len(), values.len(), "a value belongs to each knot");
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for (x, y) in knots.windows(2).zip(values.windows(2)) {
            sum += 0.5 * (y[0] + y[1]) * (x[1] - x[0]);
            cumulative.push(sum);
        }
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            knots: knots.to_vec(),
            values: values.iter().map(|y| y / sum).collect(),
            cumulative: cumulative.iter().map(|c| c / sum).collect(),
        })
    }

    /// The density at knot `k`.
    #[inline]
    pub fn value(&self, k: usize) -> f64 {
        self.values[k]
    }

    /// The point below which a share `u` in [0, 1) of the mass lies.
    pub fn sample(&self, u: f64) -> f64 {
        let inner = &self.cumulative[1..self.cumulative.len() - 1];
        let k = inner.partition_point(|c| *c <= u);
        let (a, b, width) = (self.values[k], self.values[k + 1], self.knots[k + 1] - self.knots[k]);
        let mass = (u - self.cumulative[k]).max(0.0);
        // The root of a s + (b − a) s²/(2 width) = mass, in the form that does not cancel.
        let root = a + (a * a + 2.0 * mass * (b - a) / width).max(0.0).sqrt();
        let s = if root > 0.0 { (2.0 * mass / root).min(width) } else { 0.0 };
        self.knots[k] + s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distribution function, by the definition.
    fn below(density: &PiecewiseLinear, x: f64) -> f64 {
        let mut sum = 0.0;
        for k in 0..density.knots.len() - 1 {
            let (l, r) = (density.knots[k], density.knots[k + 1]);
            let to = x.clamp(l, r);
            let (a, b) = (density.values[k], density.values[k + 1]);
            let there = a + (b - a) * (to - l) / (r - l);
            sum += 0.5 * (a + there) * (to - l);
        }
        sum
    }

    #[test]
    fn a_ramp_is_sampled_by_square_roots() {
        let up = PiecewiseLinear::new(&[0.0, 2.0], &[0.0, 7.0]).unwrap();
        let down = PiecewiseLinear::new(&[0.0, 2.0], &[7.0, 0.0]).unwrap();
        for u in [0.0, 1e-12, 0.25, 0.5, 0.81, 1.0 - f64::EPSILON / 2.0] {
            assert!((up.sample(u) - 2.0 * u.sqrt()).abs() < 1e-14);
            assert!((down.sample(u) - 2.0 * (1.0 - (1.0 - u).sqrt())).abs() < 1e-8);
        }
        assert_eq!(up.value(1), 1.0);
    }

    #[test]
    fn sampling_inverts_the_distribution_function() {
        let density =
            PiecewiseLinear::new(&[-1.0, -0.5, 0.0, 0.01, 2.0, 3.0], &[0.0, 0.0, 3.0, 40.0, 0.1, 0.1])
                .unwrap();
        assert!((below(&density, 3.0) - 1.0).abs() < 1e-15);
        for k in 0..10_000 {
            let u = f64::from(k) / 10_000.0;
            let x = density.sample(u);
            assert!((below(&density, x) - u).abs() < 1e-14, "{u} {x}");
        }
        // Where there is no mass, nothing is drawn.
        assert!(density.sample(0.0) >= -0.5);
        assert!(density.sample(1.0 - f64::EPSILON / 2.0) <= 3.0);
    }

    #[test]
    fn no_mass_is_no_density() {
        assert_eq!(PiecewiseLinear::new(&[0.0, 1.0], &[0.0, 0.0]), None);
        assert_eq!(PiecewiseLinear::new(&[0.0, 1.0], &[0.0, f64::NAN]), None);
    }
}
