//! A density of one variable that is a quadratic spline.

/// The places of a quadratic spline on some knots, and what belongs to them. In
/// each interval the spline is a quadratic Bézier curve, whose middle coefficient
/// belongs to the interval's middle, and whose ends lie on the line between the
/// middle coefficients left and right: it is smooth in its first derivative,
/// nowhere below 0 if no coefficient is, and exact where a function is linear.
#[derive(Clone, Debug, PartialEq)]
pub struct Knots {
    at: Vec<f64>,
    periodic: bool,
}

impl Knots {
    /// Rising knots, three or more. Periodic: the last is the first again, and the
    /// intervals are of equal width. Otherwise either end has a coefficient too.
    pub fn new(at: Vec<f64>, periodic: bool) -> Self {
        assert!(at.len() >= 3, "two intervals or more");
        Self { at, periodic }
    }

    /// The knots.
    pub fn at(&self) -> &[f64] {
        &self.at
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.at.len() - 1
    }

    /// Where the function is asked for the coefficients: in the middle of each
    /// interval, and at both ends unless periodic.
    pub fn sites(&self) -> Vec<f64> {
        let middles = self.at.windows(2).map(|k| 0.5 * (k[0] + k[1]));
        if self.periodic {
            return middles.collect();
        }
        [self.at[0]].into_iter().chain(middles).chain([self.at[self.intervals()]]).collect()
    }

    /// The integral that each coefficient adds to the spline's.
    pub fn weights(&self) -> Vec<f64> {
        let n = self.intervals();
        let width = |k: usize| self.at[k + 1] - self.at[k];
        if self.periodic {
            return (0..n).map(width).collect();
        }
        let neighbours = |k: usize| {
            width(k) + if k > 0 { width(k - 1) } else { 0.0 } + if k + 1 < n { width(k + 1) } else { 0.0 }
        };
        let third = |w: f64| w / 3.0;
        [width(0)].into_iter().chain((0..n).map(neighbours)).chain([width(n - 1)]).map(third).collect()
    }

    /// The spline's values at the knots.
    pub fn values(&self, coefficients: &[f64]) -> Vec<f64> {
        let n = self.intervals();
        if self.periodic {
            return (0..=n).map(|k| 0.5 * (coefficients[(k + n - 1) % n] + coefficients[k % n])).collect();
        }
        let value = |k: usize| {
            let (before, after) = (self.at[k] - self.at[k - 1], self.at[k + 1] - self.at[k]);
            (coefficients[k] * after + coefficients[k + 1] * before) / (before + after)
        };
        [coefficients[0]].into_iter().chain((1..n).map(value)).chain([coefficients[n + 1]]).collect()
    }

    /// The coefficients in the middle of the intervals.
    pub fn middles<'a>(&self, coefficients: &'a [f64]) -> &'a [f64] {
        if self.periodic { coefficients } else { &coefficients[1..=self.intervals()] }
    }
}

/// A density that is a quadratic spline and integrates to 1. It is sampled exactly,
/// by the root of a cubic.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineDensity {
    knots: Knots,
    values: Vec<f64>,
    middles: Vec<f64>,
    cumulative: Vec<f64>,
}

impl SplineDensity {
    /// In proportion to the spline with these `coefficients` ≥ 0, one for each site;
    /// `None` where the integral is not a positive number.
    pub fn new(knots: &Knots, coefficients: &[f64]) -> Option<Self> {
        let (values, middles) = (knots.values(coefficients), knots.middles(coefficients));
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for (k, x) in knots.at.windows(2).enumerate() {
            sum += (values[k] + middles[k] + values[k + 1]) / 3.0 * (x[1] - x[0]);
            cumulative.push(sum);
        }
        let scaled = |v: &[f64]| v.iter().map(|y| y / sum).collect::<Vec<_>>();
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            values: scaled(&values),
            middles: scaled(middles),
            cumulative: scaled(&cumulative),
            knots: knots.clone(),
        })
    }

    /// The density at knot `k`.
    pub fn value(&self, k: usize) -> f64 {
        self.values[k]
    }

    /// The middle coefficient of interval `k`.
    pub fn middle(&self, k: usize) -> f64 {
        self.middles[k]
    }

    /// The point below which a share `u` in [0, 1) of the mass lies.
    pub fn sample(&self, u: f64) -> f64 {
        self.sample_evened(u, 0.0)
    }

    /// The same of the mixture with a share `even` in [0, 1] of the uniform density.
    pub fn sample_evened(&self, u: f64, even: f64) -> f64 {
        let at = &self.knots.at;
        let last = at.len() - 1;
        let density = even / (at[last] - at[0]);
        let mixed = |value: f64| density + (1.0 - even) * value;
        let below = |k: usize| density * (at[k] - at[0]) + (1.0 - even) * self.cumulative[k];
        let (mut k, mut end) = (0, last);
        while end - k > 1 {
            let middle = (k + end) / 2;
            *if below(middle) <= u { &mut k } else { &mut end } = middle;
        }
        let curve = [self.values[k], self.middles[k], self.values[k + 1]].map(mixed);
        let width = at[k + 1] - at[k];
        at[k] + width * root(curve, (u - below(k)).max(0.0) / width)
    }
}

/// The value at `a` in [0, 1] of a quadratic Bézier curve.
#[inline]
pub fn bezier([left, middle, right]: [f64; 3], a: f64) -> f64 {
    let b = 1.0 - a;
    b * b * left + 2.0 * a * b * middle + a * a * right
}

/// The point in [0, 1] below which the integral of a curve is `mass`: Newton's
/// method, held between bounds.
fn root(curve: [f64; 3], mass: f64) -> f64 {
    let [x, y, z] = curve;
    // The integral is a cubic curve with the coefficients 0, x/3, (x+y)/3, (x+y+z)/3.
    let integral = |a: f64| {
        let b = 1.0 - a;
        a * (b * b * x + a * b * (x + y) + a * a * (x + y + z) / 3.0)
    };
    let (mut low, mut high) = (0.0, 1.0);
    let mut a: f64 = (3.0 * mass / (x + y + z)).clamp(0.0, 1.0);
    for _ in 0..100 {
        let error = integral(a) - mass;
        *if error > 0.0 { &mut high } else { &mut low } = a;
        let next = a - error / bezier(curve, a);
        let next = if next >= low && next <= high { next } else { 0.5 * (low + high) };
        // The error of the next is like the square of this step.
        if (next - a).abs() <= 1e-10 * a {
            return next;
        }
        a = next;
    }
    // NaN of a curve without mass.
    if a.is_finite() { a } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The distribution function, by Simpson's rule, which is exact for quadratics.
    fn below(d: &SplineDensity, x: f64) -> f64 {
        let at = d.knots.at();
        let piece = |k: usize| {
            let share = ((x - at[k]) / (at[k + 1] - at[k])).clamp(0.0, 1.0);
            let curve = [d.value(k), d.middle(k), d.value(k + 1)];
            let sum = bezier(curve, 0.0) + 4.0 * bezier(curve, 0.5 * share) + bezier(curve, share);
            sum / 6.0 * share * (at[k + 1] - at[k])
        };
        (0..d.knots.intervals()).map(piece).sum()
    }

    #[test]
    fn a_ramp_is_a_ramp_and_is_sampled_by_square_roots() {
        let knots = Knots::new(vec![0.0, 0.1, 0.5, 1.3, 2.0], false);
        let ramp = SplineDensity::new(&knots, &knots.sites()).unwrap();
        for (k, x) in knots.at().iter().enumerate() {
            assert!((ramp.value(k) - 0.5 * x).abs() < 1e-15);
        }
        for u in [0.0, 1e-9, 0.25, 0.5, 0.81, 1.0 - f64::EPSILON / 2.0] {
            assert!((ramp.sample(u) - 2.0 * u.sqrt()).abs() < 1e-12, "{u}");
        }
    }

    #[test]
    fn sampling_inverts_the_distribution_function() {
        let open = Knots::new(vec![-1.0, -0.5, 0.0, 0.01, 2.0], false);
        let round = Knots::new(vec![-1.0, 0.0, 1.0, 2.0], true);
        for (knots, coefficients) in
            [(open, vec![0.0, 0.0, 3.0, 40.0, 0.1, 0.0]), (round, vec![0.0, 2.0, 0.1])]
        {
            let density = SplineDensity::new(&knots, &coefficients).unwrap();
            assert!((below(&density, 2.0) - 1.0).abs() < 1e-15);
            for (even, k) in [0.0, 0.3, 1.0].iter().flat_map(|e| (0..1000).map(move |k| (*e, k))) {
                let u = f64::from(k) / 1000.0;
                let x = density.sample_evened(u, even);
                let mass = even * (x + 1.0) / 3.0 + (1.0 - even) * below(&density, x);
                assert!((mass - u).abs() < 1e-14, "{even} {u} {x}");
            }
            for u in [0.0, f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0] {
                assert!((-1.0..=2.0).contains(&density.sample(u)));
            }
        }
    }

    #[test]
    fn weights_are_what_coefficients_add() {
        for knots in [Knots::new(vec![0.0, 0.2, 0.5, 1.5], false), Knots::new(vec![0.0, 1.0, 2.0, 3.0], true)]
        {
            let n = knots.sites().len();
            for k in 0..n {
                let mut one = vec![0.0; n];
                one[k] = 1.0;
                let values = knots.values(&one);
                let middles = knots.middles(&one);
                let piece = |i: usize| {
                    (values[i] + middles[i] + values[i + 1]) / 3.0 * (knots.at()[i + 1] - knots.at()[i])
                };
                let sum: f64 = (0..knots.intervals()).map(piece).sum();
                assert!((sum - knots.weights()[k]).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_slope_does_not_jump() {
        let knots = Knots::new(vec![0.0, 0.2, 0.5, 1.5], false);
        let c = [0.3, 1.0, 4.0, 0.5, 0.0];
        let (values, middles) = (knots.values(&c), knots.middles(&c));
        for k in 1..3 {
            let width = |i: usize| knots.at()[i + 1] - knots.at()[i];
            let before = (values[k] - middles[k - 1]) / width(k - 1);
            let after = (middles[k] - values[k]) / width(k);
            assert!((before - after).abs() < 1e-12);
        }
    }

    #[test]
    fn no_mass_is_no_density() {
        let knots = Knots::new(vec![0.0, 1.0, 2.0], true);
        assert_eq!(SplineDensity::new(&knots, &[0.0, 0.0]), None);
        assert_eq!(SplineDensity::new(&knots, &[0.0, f64::NAN]), None);
    }
}
