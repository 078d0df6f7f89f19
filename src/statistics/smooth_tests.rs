use super::super::streams::{Stream, StreamKey};
use super::super::{chi_square, effect, noncentral};
use super::*;

/// Cells of these densities and masses, with `n` draws from `probabilities`.
fn drawn(stream: &mut Stream, told: &[(f64, f64)], probabilities: &[f64], n: u64) -> Vec<Ordered> {
    let mut edges: Vec<f64> = Vec::new();
    for p in probabilities {
        edges.push(edges.last().unwrap_or(&0.0) + p);
    }
    let mut counts = vec![0; told.len()];
    for _ in 0..n {
        let u = stream.next_f64() * edges.last().unwrap();
        counts[edges.partition_point(|e| *e <= u).min(told.len() - 1)] += 1;
    }
    let cell = |(&(density, mass), observed): (&(f64, f64), u64)| Ordered { density, mass, observed };
    told.iter().zip(counts).map(cell).collect()
}

fn squares(cells: Vec<Ordered>) -> Vec<(f64, f64)> {
    nested(&components(&classes(cells)))
}

/// Rings of GGX's slopes: u = α²/(α² + t²) is uniform for α = 1. Density and mass of each, if
/// told with a roughness of `alpha`.
fn ggx(rings: usize, alpha: f64) -> Vec<(f64, f64)> {
    // t² at the inner and outer edge of a ring, whose share below is 1/(1 + t²/α²).
    let square = |k: usize| rings as f64 / k as f64 - 1.0;
    let share = |k: usize| if k == 0 { 0.0 } else { alpha * alpha / (alpha * alpha + square(k)) };
    (0..rings)
        .map(|k| {
            let mass = share(k + 1) - share(k);
            let area = if k == 0 { f64::INFINITY } else { square(k) - square(k + 1) };
            (mass / area, mass)
        })
        .collect()
}

fn masses(cells: &[(f64, f64)]) -> Vec<f64> {
    cells.iter().map(|c| c.1).collect()
}

#[test]
fn two_classes_by_hand() {
    let cells = [(1.0, 0.25, 210u64), (3.0, 0.5, 590), (3.0, 0.25, 200)];
    let cells = cells.map(|(density, mass, observed)| Ordered { density, mass, observed });
    let classes = classes(cells.to_vec());
    assert_eq!(classes, [Class { expected: 250.0, observed: 210 }, Class { expected: 750.0, observed: 790 }]);
    // A standardised binomial: φ is √(1/3) above and −√3 below.
    let z = components(&classes);
    assert!(z.len() == 1 && (z[0] - 40.0 / (1000.0 * 0.25 * 0.75f64).sqrt()).abs() < 1e-12, "{z:?}");
    assert_eq!(nested(&z).len(), 1);
    let split = largest_split(&classes).unwrap();
    assert_eq!((split.share, split.above, split.below), (0.75, 40.0 / 750.0, -40.0 / 250.0));
}

#[test]
fn without_a_density_to_follow_there_is_nothing_to_test() {
    let equal = |n| vec![Ordered { density: 0.3, mass: 0.1, observed: n }; 10];
    assert_eq!(squares(equal(1000)), []);
    // Up to rounding.
    let mut rounded = equal(1000);
    rounded[3].density *= 1.0 + 1e-9;
    assert_eq!(squares(rounded), []);
    assert_eq!(squares(equal(0)), []);
    assert_eq!(squares(vec![Ordered { density: 2.0, mass: 1.0, observed: 500 }]), []);
    assert_eq!(squares(vec![Ordered { density: 0.0, mass: 0.0, observed: 5 }]), []);
    assert_eq!(squares(Vec::new()), []);
    assert_eq!(largest_split(&classes(equal(1000))), None);
}

#[test]
fn ranks_do_not_depend_on_the_order_of_cells_and_are_cut_where_density_steps() {
    let mut stream = StreamKey::new(5).with("test", "order").block(0);
    let told = ggx(200, 1.0);
    let cells = drawn(&mut stream, &told, &masses(&told), 20_000);
    let z = components(&classes(cells.clone()));
    let turned: Vec<Ordered> = cells.into_iter().rev().collect();
    let of_turned = components(&classes(turned));
    assert!(
        z.len() == DEGREES && z.iter().zip(&of_turned).all(|(a, b)| (a - b).abs() < 1e-9),
        "{of_turned:?}"
    );
    // A plateau of 60 % between two slopes stays whole.
    let plateau: Vec<Ordered> = (0..100)
        .map(|k: u32| Ordered {
            density: f64::from(if k < 80 { k.min(20) } else { k }),
            mass: 0.01,
            observed: 100,
        })
        .collect();
    let expected: Vec<f64> = classes(plateau).iter().map(|c| c.expected).collect();
    assert!(expected.iter().any(|e| *e > 5999.0) && expected.iter().all(|e| *e >= 10_000.0 / CLASSES));
    assert!((expected.iter().sum::<f64>() - 10_000.0).abs() < 1e-6);
}

/// Tails of both sums under the null, for smooth lobes, sharp ones of which a cell expects few
/// samples, a small peak on a constant, and few samples in all.
#[test]
fn null_tails_are_nominal() {
    let peak: Vec<(f64, f64)> = (0..500).map(|k| if k < 40 { (9.0, 0.001) } else { (1.0, 0.002) }).collect();
    let steep: Vec<(f64, f64)> = (0..1000).map(|k| (f64::from(k).exp2(), 1.0 + f64::from(k % 9))).collect();
    let cases = [
        ("ggx", ggx(400, 1.0), 4096u64, 10_000u32),
        ("steep", steep, 1024, 20_000),
        ("peak", peak, 4096, 10_000),
        ("few", ggx(50, 1.0), 100, 40_000),
    ];
    for (name, told, n, runs) in cases {
        let key = StreamKey::new(31).with("test", name);
        let probabilities = masses(&told);
        let sizes = [0.01, 0.001];
        let mut below = [[0u32; 2]; 2];
        for run in 0..runs {
            let cells = drawn(&mut key.block(u64::from(run)), &told, &probabilities, n);
            for (test, (x2, dof)) in squares(cells).into_iter().enumerate() {
                let p = chi_square::sf(x2, dof);
                sizes.iter().zip(&mut below).for_each(|(s, row)| row[test] += u32::from(p < *s));
            }
        }
        println!("{name}: {below:?} of {runs}");
        for (size, row) in sizes.iter().zip(below) {
            let expected = f64::from(runs) * size;
            // 4σ of the simulation, and the 20 % that discreteness is allowed.
            let slack = 4.0 * expected.sqrt() + 0.2 * expected;
            for (test, count) in row.into_iter().enumerate() {
                let alone = name == "peak" && test == 1;
                assert!(alone || (f64::from(count) - expected).abs() < slack, "{name} {size}: {row:?}");
            }
        }
    }
}

/// The score of ln α is 2 − 4u with variance 4/3: z₁ has the mean ε√(4n/3).
#[test]
fn power_against_a_wrong_roughness_is_that_of_the_score() {
    let (n, epsilon, runs, size) = (20_000u64, 0.03, 2000u32, 1e-3);
    let told = ggx(1024, 1.0 + epsilon);
    let probabilities = masses(&ggx(1024, 1.0));
    let key = StreamKey::new(32).with("test", "roughness");
    let (mut sum, mut found) = (0.0, [0u32; 2]);
    for run in 0..runs {
        let cells = drawn(&mut key.block(u64::from(run)), &told, &probabilities, n);
        let z = components(&classes(cells));
        sum += z[0];
        for (k, (x2, dof)) in nested(&z).into_iter().enumerate() {
            found[k] += u32::from(chi_square::sf(x2, dof) < size);
        }
    }
    let mean = epsilon * (4.0 * n as f64 / 3.0).sqrt();
    // What is told is wider, so more samples lie where it is high; to first order in ε.
    let of_mean = sum / f64::from(runs) / mean;
    assert!((of_mean - 1.0).abs() < 0.04, "{of_mean}");
    let power = |dof| noncentral::sf(chi_square::quantile(libm::log(size), dof), dof, mean * mean);
    for (found, dof) in found.into_iter().zip([1.0, DEGREES as f64]) {
        let (share, power) = (f64::from(found) / f64::from(runs), power(dof));
        println!("{dof} degrees: found {share}, derived {power:.4}");
        assert!((share - power).abs() < 0.05, "{dof}: {share} {power}");
    }
}

/// No error within the tolerance crosses more often than nominal, wherever it lies; and one
/// along the density crosses as often, as it must.
#[test]
fn a_tolerated_error_is_tolerated() {
    let (n, epsilon, runs, size) = (20_000u64, 0.03, 4000u32, 0.01);
    let told = ggx(256, 1.0);
    let line = |k: usize| 3f64.sqrt() * (2.0 * (k as f64 + 0.5) / 256.0 - 1.0);
    let errors: [(&str, Vec<f64>); 3] = [
        ("line", (0..256).map(line).collect()),
        ("step", (0..256).map(|k| if k < 128 { 1.0 } else { -1.0 }).collect()),
        ("chequered", (0..256).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect()),
    ];
    for (name, error) in errors {
        let bent: Vec<f64> = told.iter().zip(&error).map(|(c, e)| c.1 * (1.0 + epsilon * e)).collect();
        let key = StreamKey::new(33).with("test", name);
        let mut beyond = [0u32; 2];
        for run in 0..runs {
            let cells = drawn(&mut key.block(u64::from(run)), &told, &bent, n);
            for (k, (x2, dof)) in squares(cells).into_iter().enumerate() {
                let threshold = effect::tolerance_threshold(dof, n, epsilon, libm::log(size));
                beyond[k] += u32::from(x2 > threshold);
            }
        }
        println!("{name}: {beyond:?} of {runs}");
        let nominal = f64::from(runs) * size;
        assert!(beyond.iter().all(|b| f64::from(*b) < nominal + 4.0 * nominal.sqrt()), "{name}: {beyond:?}");
        let least = nominal - 4.0 * nominal.sqrt();
        assert!(name != "line" || f64::from(beyond[0]) > least, "{name}: {beyond:?}");
    }
}
