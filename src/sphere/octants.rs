//! Angles in units of π/4, without a call or a branch, so that the compiler can work on
//! several at once.

use std::f64::consts::FRAC_PI_4;

/// (4/π) arctan(√t)/√t on 0 ≤ t ≤ tan²(π/8), interpolated at 12 Chebyshev nodes in
/// 50 digits; its error there is 1.6e-18.
const OCTANT: [f64; 12] = [
    1.2732395447351628,
    -0.42441318157838487,
    0.2546479089462799,
    -0.18189136345129195,
    0.1414710558636348,
    -0.11574889314407025,
    0.09793816295200183,
    -0.08483533733777557,
    0.07444476661415464,
    -0.06410891559538259,
    0.04833886711631351,
    -0.022670535831656992,
];

/// (4/π) arctan(minor/major) for 0 ≤ minor ≤ major; 0 where both are 0. Without a
/// call or a branch, since it is half of the cost of finding a cell.
#[inline(always)]
pub fn octants(minor: f64, major: f64) -> f64 {
    // tan(π/8); beyond it arctan(s) = π/4 − arctan((1−s)/(1+s)).
    let beyond = minor > (std::f64::consts::SQRT_2 - 1.0) * major;
    let numerator = if beyond { minor - major } else { minor };
    let denominator = if beyond { minor + major } else { major };
    let s = numerator / denominator.max(f64::MIN_POSITIVE);
    let t = s * s;
    let t2 = t * t;
    let t4 = t2 * t2;
    let pair = |k: usize| OCTANT[k] + OCTANT[k + 1] * t;
    let quad = |k: usize| pair(k) + pair(k + 2) * t2;
    let polynomial = quad(0) + (quad(4) + quad(8) * t4) * t4;
    (if beyond { 1.0 } else { 0.0 }) + s * polynomial
}

/// sin(π/4 x)/x by powers of x², and cos(π/4 x): Taylor's series, whose next terms are
/// 8e-20 and 3e-21 at x = 1.
const SINE: [f64; 9] = [
    FRAC_PI_4,
    -0.08074551218828079,
    0.0024903945701927202,
    -3.657620418217725e-05,
    3.1336168903781217e-07,
    -1.757247673443401e-09,
    6.948453273886629e-12,
    -2.0410263396641442e-14,
    4.628704628834683e-17,
];
const COSINE: [f64; 10] = [
    1.0,
    -0.30842513753404244,
    0.015854344243815502,
    -0.00032599188692739,
    3.59086044859151e-06,
    -2.4611369504942e-08,
    1.1501159127974052e-10,
    -3.8980731712596753e-13,
    1.001886461636272e-15,
    -2.019653396886682e-18,
];

/// sin and cos of π/4 x for |x| ≤ 1, without a call or a branch.
#[inline(always)]
pub(super) fn sin_cos_octants(x: f64) -> (f64, f64) {
    let t = x * x;
    let t2 = t * t;
    let t4 = t2 * t2;
    let quad = |a: &[f64], k: usize| (a[k] + a[k + 1] * t) + (a[k + 2] + a[k + 3] * t) * t2;
    let sin = quad(&SINE, 0) + (quad(&SINE, 4) + SINE[8] * t4) * t4;
    let cos = quad(&COSINE, 0) + (quad(&COSINE, 4) + (COSINE[8] + COSINE[9] * t) * t4) * t4;
    (x * sin, cos)
}

/// sin and cos of 2πx for 0 ≤ x < 1.
#[inline(always)]
pub fn sin_cos_turns(x: f64) -> (f64, f64) {
    // The nearest quarter turn, and what is left of it, both exact.
    let quarter = f64::from((4.0 * x + 0.5) as i32);
    let (sin, cos) = sin_cos_octants(2.0 * (4.0 * x - quarter));
    let crossed = (quarter == 1.0) | (quarter == 3.0);
    let (sin, cos) = if crossed { (cos, sin) } else { (sin, cos) };
    let sin_sign = if (quarter == 2.0) | (quarter == 3.0) { -1.0 } else { 1.0 };
    let cos_sign = if (quarter == 1.0) | (quarter == 2.0) { -1.0 } else { 1.0 };
    (sin_sign * sin, cos_sign * cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn octants_are_arctangents() {
        for k in 0..=10_000 {
            let s = f64::from(k) * 1e-4;
            assert!((octants(s * 3.0, 3.0) - s.atan() / FRAC_PI_4).abs() < 4.5e-16, "{s}");
        }
        assert_eq!(octants(0.0, 0.0), 0.0);
    }

    #[test]
    fn sines_and_cosines_of_octants_and_turns() {
        for k in -10_000..=10_000 {
            let x = f64::from(k) * 1e-4;
            let (sin, cos) = sin_cos_octants(x);
            let (right_sin, right_cos) = (FRAC_PI_4 * x).sin_cos();
            assert!((sin - right_sin).abs() < 2.3e-16 && (cos - right_cos).abs() < 2.3e-16, "{x}");
        }
        for k in 0..10_000 {
            let turns = f64::from(k) * 1e-4;
            let (sin, cos) = sin_cos_turns(turns);
            let (right_sin, right_cos) = (2.0 * PI * turns).sin_cos();
            assert!((sin - right_sin).abs() < 1e-15 && (cos - right_cos).abs() < 1e-15, "{turns}");
        }
        for (quarter, right) in [(0.0, (0.0, 1.0)), (1.0, (1.0, 0.0)), (2.0, (0.0, -1.0)), (3.0, (-1.0, 0.0))]
        {
            assert_eq!(sin_cos_turns(0.25 * quarter), right);
        }
    }
}
