//! How large an error is, and whether it is certainly larger than a tolerance.
//!
//! D = Σ (qᵢ − pᵢ)²/pᵢ compares the sampler's cell probabilities q with the pdf's p; √D is the
//! root-mean-square relative error of a cell. Pearson's X² from n samples is close to a
//! non-central χ² with λ = n·D.

use super::{noncentral, normal};

/// Chance of missing the true √D on each side of the interval of [`root_d`].
const INTERVAL_TAIL: f64 = 0.025;

/// √D̂ and the ends of its central 95 % interval.
///
/// D̂ = (X² − dof)/n, unbiased before it is floored at 0; the interval inverts the non-central χ²,
/// and both its ends can be 0 when X² is unusually small.
pub fn root_d(x2: f64, dof: f64, n: u64) -> (f64, f64, f64) {
    let n = n as f64;
    let root = |lambda: f64| (lambda / n).sqrt();
    if x2 == f64::INFINITY || x2.is_nan() {
        return (x2, x2, x2);
    }
    (
        root((x2 - dof).max(0.0)),
        root(noncentral::lambda_where_sf(x2, dof, INTERVAL_TAIL)),
        root(noncentral::lambda_where_sf(x2, dof, 1.0 - INTERVAL_TAIL)),
    )
}

/// The X² above which √D certainly exceeds `eps`: sf(x; dof, n·eps²) = e^`ln_tail`.
///
/// Right for an error spread over many cells; see [`guarded_threshold`] for one that is not.
pub fn tolerance_threshold(dof: f64, n: u64, eps: f64, ln_tail: f64) -> f64 {
    noncentral::quantile(ln_tail, dof, n as f64 * eps * eps)
}

/// The larger of [`tolerance_threshold`] and [`normal_bound`]: the threshold to fail by.
pub fn guarded_threshold(dof: f64, n: u64, eps: f64, smallest_p: f64, ln_tail: f64) -> f64 {
    tolerance_threshold(dof, n, eps, ln_tail).max(normal_bound(dof, n, eps, smallest_p, ln_tail))
}

/// Mean + z·sd of X² when the whole error of size `eps` is an excess in one cell of probability
/// `smallest_p`: the case in which the non-central χ² understates the spread most.
///
/// Normal in the tail, so approximate: the count of that cell is skewed to the right. Where it
/// expects 20 samples and errs by as much again, 0.6 % of runs cross at a nominal 0.1 %, against
/// 1.5 % without the guard (simulated in the tests); confirmation has to cover the rest.
pub fn normal_bound(dof: f64, n: u64, eps: f64, smallest_p: f64, ln_tail: f64) -> f64 {
    let (mean, variance) = moments_one_cell(dof, n, eps, smallest_p);
    mean + normal::quantile(ln_tail) * variance.sqrt()
}

/// Exact mean and variance of X² for an excess in one cell of probability p, the other `dof`
/// cells sharing the rest equally.
///
/// Write X² = (1/n) Σₐᵦ ⟨Yₐ, Yᵦ⟩ + 2 Σₐ (g(Xₐ) − D) + n·D over samples a, b, with
/// Yₐ = (1[Xₐ=i] − qᵢ)/√pᵢ and g = (q−p)/p, E g = D. With h = |Y|² and B = Cov Y it follows that
///   mean = Σ qᵢ(1−qᵢ)/pᵢ + nD,
///   variance = 4n Var g + 4 Cov(g, h) + Var(h)/n + 2(1 − 1/n) tr B²,
/// all over q. D = ε² in one cell: q = p + ε√(p(1−p)), the rest scaled by (1−q)/(1−p). The
/// leading terms are dof + ε/√p + nε² and 2 dof + 4nε²(1 + ε/√p).
fn moments_one_cell(dof: f64, n: u64, eps: f64, smallest_p: f64) -> (f64, f64) {
    let n = n as f64;
    let p = smallest_p.clamp(f64::MIN_POSITIVE, 1.0 / (dof + 1.0));
    let q = (p + eps * (p * (1.0 - p)).sqrt()).min(1.0);
    // Two kinds of cell: (how many, p, q) of each.
    let kinds = [(1.0, p, q), (dof, (1.0 - p) / dof, (1.0 - q) / dof)];
    let over_cells =
        |f: &dyn Fn(f64, f64) -> f64| -> f64 { kinds.iter().map(|&(cells, p, q)| cells * f(p, q)).sum() };
    let d = over_cells(&|p, q| (q - p) * (q - p) / p);
    let mean = over_cells(&|p, q| q * (1.0 - q) / p) + n * d;

    let second = over_cells(&|p, q| q * q / p);
    let trace = over_cells(&|p, q| (q / p).powi(2) * (1.0 - 2.0 * q)) + second * second;
    let g = |p: f64, q: f64| (q - p) / p;
    let h = |p: f64, q: f64| (1.0 - 2.0 * q) / p; // up to a constant
    let mean_h = over_cells(&|p, q| q * h(p, q));
    let var_g = over_cells(&|p, q| q * (g(p, q) - d).powi(2));
    let var_h = over_cells(&|p, q| q * (h(p, q) - mean_h).powi(2));
    let covariance = over_cells(&|p, q| q * (g(p, q) - d) * (h(p, q) - mean_h));
    (mean, 4.0 * n * var_g + 4.0 * covariance + var_h / n + 2.0 * (1.0 - 1.0 / n) * trace)
}

/// The smallest √D that a test at `threshold` finds with probability `power` (0.999, say).
pub fn detection_limit(dof: f64, n: u64, threshold: f64, power: f64) -> f64 {
    (noncentral::lambda_where_sf(threshold, dof, power) / n as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::streams::StreamKey;
    use super::*;

    /// X² of n draws from cell probabilities q, against p, many times.
    fn simulate(p: &[f64], q: &[f64], n: u32, runs: u64, name: &str) -> Vec<f64> {
        let mut edges = Vec::new();
        for q in q {
            edges.push(edges.last().unwrap_or(&0.0) + q);
        }
        let key = StreamKey::new(21).with("test", name);
        let one = |run| {
            let mut stream = key.block(run);
            let mut counts = vec![0.0; p.len()];
            for _ in 0..n {
                let u = stream.next_f64();
                counts[edges.partition_point(|e| *e <= u).min(p.len() - 1)] += 1.0;
            }
            let n = f64::from(n);
            counts.iter().zip(p).map(|(c, p)| (c - n * p).powi(2) / (n * p)).sum()
        };
        (0..runs).map(one).collect()
    }

    fn one_cell(k: usize, p: f64, eps: f64) -> (Vec<f64>, Vec<f64>) {
        let q = p + eps * (p * (1.0 - p)).sqrt();
        let fill = |first: f64| {
            let mut cells = vec![(1.0 - first) / (k as f64 - 1.0); k];
            cells[0] = first;
            cells
        };
        (fill(p), fill(q))
    }

    #[test]
    fn moments_match_simulation() {
        for (k, p, eps, n) in [(8usize, 0.01, 0.0, 2000u32), (8, 0.01, 0.05, 2000), (16, 0.005, 0.2, 4000)] {
            let (cells, bent) = one_cell(k, p, eps);
            let runs = 10_000;
            let x2 = simulate(&cells, &bent, n, runs, "moments");
            let mean = x2.iter().sum::<f64>() / runs as f64;
            let square: Vec<f64> = x2.iter().map(|x| (x - mean).powi(2)).collect();
            let variance = square.iter().sum::<f64>() / runs as f64;
            let fourth = square.iter().map(|s| s * s).sum::<f64>() / runs as f64;
            let (m, v) = moments_one_cell(k as f64 - 1.0, u64::from(n), eps, p);
            let (sd_m, sd_v) = ((v / runs as f64).sqrt(), ((fourth - v * v) / runs as f64).sqrt());
            assert!((mean - m).abs() < 4.0 * sd_m, "{k} {eps}: mean {mean}, derived {m}");
            assert!((variance - v).abs() < 4.0 * sd_v, "{k} {eps}: variance {variance}, derived {v}");
        }
    }

    #[test]
    fn null_variance_is_pearsons_published_one() {
        // Haldane 1937: 2(K−1) + (Σ1/p − K² − 2K + 2)/n.
        let (k, n, p) = (10.0, 500u64, 0.02);
        let inverse = 1.0 / p + 9.0 * 9.0 / (1.0 - p);
        let expected = 2.0 * (k - 1.0) + (inverse - k * k - 2.0 * k + 2.0) / n as f64;
        let (mean, variance) = moments_one_cell(k - 1.0, n, 0.0, p);
        assert!((mean - 9.0).abs() < 1e-12 && (variance - expected).abs() < 1e-11, "{variance}");
    }

    #[test]
    fn tolerance_test_keeps_its_size_and_has_power() {
        let (k, n, eps, size) = (32usize, 8000u32, 0.05, 0.01);
        let p = vec![1.0 / k as f64; k];
        let spread = |e: f64| -> Vec<f64> {
            p.iter().enumerate().map(|(i, p)| p * (1.0 + if i % 2 == 0 { e } else { -e })).collect()
        };
        let dof = k as f64 - 1.0;
        let ln_tail = libm::log(size);
        let threshold = guarded_threshold(dof, u64::from(n), eps, 1.0 / k as f64, ln_tail);
        assert!(threshold >= tolerance_threshold(dof, u64::from(n), eps, ln_tail));
        let rate = |e: f64, runs: u64| {
            let x2 = simulate(&p, &spread(e), n, runs, "tolerance");
            x2.iter().filter(|x| **x > threshold).count() as f64 / runs as f64
        };
        let sigma = (size / 4000.0).sqrt();
        assert!(rate(eps, 4000) <= size + 4.0 * sigma, "size at the tolerance");
        assert!(rate(0.0, 1000) <= 0.002, "a correct sampler");
        let limit = detection_limit(dof, u64::from(n), threshold, 0.999);
        assert!(rate(limit, 2000) >= 0.993, "power at {limit}");
    }

    #[test]
    fn guard_helps_where_the_error_sits_in_one_small_cell() {
        let (k, n, eps, p, size) = (64usize, 10_000u32, 0.06, 0.002, 0.001);
        let (cells, bent) = one_cell(k, p, eps);
        let dof = k as f64 - 1.0;
        let plain = tolerance_threshold(dof, u64::from(n), eps, libm::log(size));
        let guarded = guarded_threshold(dof, u64::from(n), eps, p, libm::log(size));
        let x2 = simulate(&cells, &bent, n, 10_000, "guard");
        let beyond = |t: f64| x2.iter().filter(|x| **x > t).count();
        println!("{plain} {guarded}: {} {}", beyond(plain), beyond(guarded));
        assert!(guarded > plain && beyond(guarded) <= beyond(plain), "{plain} {guarded}");
        assert!(beyond(plain) > 10 + 13, "the plain threshold was expected to be too low here");
        assert!(beyond(guarded) <= 80, "{} of 10000 at 0.001", beyond(guarded));
    }

    #[test]
    fn interval_covers_and_estimate_is_unbiased() {
        let (k, n, e) = (16usize, 4000u32, 0.06);
        let p = vec![1.0 / k as f64; k];
        let q: Vec<f64> = p.iter().enumerate().map(|(i, p)| p * (1.0 + if i < 8 { e } else { -e })).collect();
        let x2 = simulate(&p, &q, n, 1000, "interval");
        let intervals: Vec<_> = x2.iter().map(|x| root_d(*x, 15.0, u64::from(n))).collect();
        let covered = intervals.iter().filter(|(_, low, high)| (*low..=*high).contains(&e)).count();
        // 95 % ± 4σ of 1000 runs.
        assert!((922..=978).contains(&covered), "{covered}");
        assert!(intervals.iter().all(|(value, low, high)| low <= value && value <= high || *value == 0.0));
        let mean_d = x2.iter().map(|x| (x - 15.0) / f64::from(n)).sum::<f64>() / 1000.0;
        assert!((mean_d / (e * e) - 1.0).abs() < 0.1, "{mean_d}");
    }

    #[test]
    fn figures_of_the_method() {
        // 1e6 samples at 1e-6, found with 0.999: 2.0 % on 1024 cells, 1.0 % on 16 (eps = 0.3 %).
        let n = 1_000_000;
        for (cells, published) in [(1024.0, 0.020), (16.0, 0.010)] {
            let threshold = tolerance_threshold(cells - 1.0, n, 0.003, libm::log(1e-6));
            let limit = detection_limit(cells - 1.0, n, threshold, 0.999);
            assert!((limit - published).abs() < 0.0015, "{cells}: {limit}");
        }
        assert_eq!(root_d(f64::INFINITY, 3.0, 10).0, f64::INFINITY);
        assert_eq!(root_d(1.0, 15.0, 10), (0.0, 0.0, 0.0));
    }
}
