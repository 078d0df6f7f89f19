//! Is a sample uniform on (0, 1)?

use std::f64::consts::PI;

/// Kolmogorov–Smirnov statistic D and its two-sided p-value; sorts `values`.
///
/// p is Kolmogorov's limit at (√n + 0.12 + 0.11/√n)·D (M. A. Stephens, *EDF statistics for
/// goodness of fit*, JASA 69, 1974): within about 0.01 for n ≥ 5, and a few per cent of itself
/// for p between 1e-4 and 1 and n ≥ 40. No values: (0, 1). A NaN among them is not a uniform
/// variable: (1, 0).
pub fn kolmogorov_smirnov(values: &mut [f64]) -> (f64, f64) {
    if values.is_empty() {
        return (0.0, 1.0);
    }
    if values.iter().any(|v| v.is_nan()) {
        return (1.0, 0.0);
    }
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len() as f64;
    let mut statistic = 0.0f64;
    for (i, value) in values.iter().enumerate() {
        let cdf = value.clamp(0.0, 1.0);
        statistic = statistic.max(cdf - i as f64 / n).max((i + 1) as f64 / n - cdf);
    }
    let root = n.sqrt();
    (statistic, kolmogorov_sf((root + 0.12 + 0.11 / root) * statistic))
}

/// P(K > t) for Kolmogorov's limiting distribution; absolute error below 1e-15.
pub fn kolmogorov_sf(t: f64) -> f64 {
    if t <= 0.0 {
        return 1.0;
    }
    // Two forms of the same theta function (Feller 1948); each needs four terms on its side.
    if t < 1.0 {
        let exponent = -PI * PI / (8.0 * t * t);
        let sum: f64 = [1.0, 9.0, 25.0, 49.0].iter().map(|k| libm::exp(k * exponent)).sum();
        return 1.0 - (2.0 * PI).sqrt() / t * sum;
    }
    let term = |k: f64| libm::exp(-2.0 * k * k * t * t);
    2.0 * (term(1.0) - term(2.0) + term(3.0) - term(4.0))
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "tables keep the digits they were printed with")]
mod tests {
    use super::super::streams::StreamKey;
    use super::*;

    #[test]
    fn limiting_distribution_matches_scipy() {
        // scipy.special.kolmogorov(t)
        for (t, expected) in KOLMOGOROV {
            assert!((kolmogorov_sf(t) - expected).abs() < 1e-14, "{t}");
        }
        // Smirnov's published 5 % and 1 % points.
        assert!((kolmogorov_sf(1.3581) - 0.05).abs() < 2e-5);
        assert!((kolmogorov_sf(1.6276) - 0.01).abs() < 2e-5);
    }

    #[test]
    fn statistic_by_hand() {
        // Steps at 0.1, 0.4, 0.9: the largest gap is 2/3 − 0.4.
        let (d, _) = kolmogorov_smirnov(&mut [0.9, 0.1, 0.4]);
        assert!((d - (2.0 / 3.0 - 0.4)).abs() < 1e-15);
        assert_eq!(kolmogorov_smirnov(&mut []), (0.0, 1.0));
        assert_eq!(kolmogorov_smirnov(&mut [0.5, f64::NAN]), (1.0, 0.0));
        assert_eq!(kolmogorov_smirnov(&mut [7.0, 8.0]).0, 1.0);
    }

    #[test]
    fn null_tail_frequencies_are_nominal_and_a_bias_is_seen() {
        let mut stream = StreamKey::new(3).with("test", "ks").block(0);
        let (runs, mut below) = (4000, 0);
        for _ in 0..runs {
            let mut values: Vec<f64> = (0..100).map(|_| stream.next_f64()).collect();
            below += usize::from(kolmogorov_smirnov(&mut values).1 < 0.01);
        }
        let sigma = (f64::from(runs) * 0.01 * 0.99).sqrt();
        assert!((below as f64 - 40.0).abs() < 4.0 * sigma, "{below}");
        let mut bent: Vec<f64> = (0..1000).map(|_| stream.next_f64().powf(1.3)).collect();
        assert!(kolmogorov_smirnov(&mut bent).1 < 1e-6);
    }
    const KOLMOGOROV: [(f64, f64); 9] = [
        (0.1, 1.0),
        (0.3, 0.99999069419866543),
        (0.5, 0.96394524366487509),
        (0.8, 0.54414241157419808),
        (0.99, 0.28087383922554892),
        (1.0, 0.26999967167735452),
        (1.2, 0.11224966667072498),
        (2.0, 6.7092525577969535e-4),
        (3.5, 4.5794696912911058e-11),
    ];
}
