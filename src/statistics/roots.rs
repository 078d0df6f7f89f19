//! The one root finder the quantiles share.

/// Zero of a function with opposite signs at `a` and `b`, to 1e-15·(1+|root|).
///
/// T. R. Chandrupatla, *A new hybrid quadratic/bisection algorithm*, Adv. Eng. Software 28, 1997.
/// Infinite values at the ends are allowed: they make it bisect.
pub fn find_root(mut f: impl FnMut(f64) -> f64, a: f64, b: f64) -> f64 {
    let (mut a, mut b) = (a, b);
    let (mut fa, mut fb) = (f(a), f(b));
    debug_assert!(
        (fa > 0.0) != (fb > 0.0) || fa == 0.0 || fb == 0.0,
        "no sign change: {fa} at {a}, {fb} at {b}"
    );
    let mut t = 0.5;
    for _ in 0..200 {
        let x = a + t * (b - a);
        let fx = f(x);
        let (c, fc);
        if (fx > 0.0) == (fa > 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc) = (b, fb);
            (b, fb) = (a, fa);
        }
        (a, fa) = (x, fx);
        let best = if fa.abs() < fb.abs() { a } else { b };
        let t_min = 1e-15 * (1.0 + best.abs()) / (b - a).abs();
        if t_min > 0.5 || fa == 0.0 {
            return best;
        }
        let (xi, phi) = ((a - b) / (c - b), (fa - fb) / (fc - fb));
        let inverse_quadratic = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        t = if inverse_quadratic {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        } else {
            0.5
        };
        t = t.clamp(t_min, 1.0 - t_min);
    }
    a
}

/// A point beyond `from`, in steps that double from `step`, where `f` no longer has its sign.
///
/// `None` when 60 doublings do not reach one.
pub fn bracket(mut f: impl FnMut(f64) -> f64, from: f64, step: f64) -> Option<f64> {
    let positive = f(from) > 0.0;
    let mut step = step;
    for _ in 0..60 {
        if (f(from + step) > 0.0) != positive {
            return Some(from + step);
        }
        step *= 2.0;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_known_roots() {
        assert!((find_root(|x| x * x - 2.0, 0.0, 2.0) - std::f64::consts::SQRT_2).abs() < 3e-15);
        assert!(
            (find_root(|x| libm::exp(x) - 1e9, 0.0, 100.0) - 9.0 * std::f64::consts::LN_10).abs() < 1e-13
        );
        let infinite_end = find_root(libm::log, 0.0, 5.0);
        assert!((infinite_end - 1.0).abs() < 3e-15);
    }

    #[test]
    fn brackets_in_both_directions() {
        assert!(bracket(|x| x - 1000.0, 0.0, 1.0).is_some_and(|x| x >= 1000.0));
        assert!(bracket(|x| x + 1000.0, 0.0, -1.0).is_some_and(|x| x <= -1000.0));
        assert_eq!(bracket(|_| 1.0, 0.0, 1.0), None);
    }
}
