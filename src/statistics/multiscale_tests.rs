use super::super::streams::{Stream, StreamKey};
use super::super::{chi_square, normal};
use super::*;

type Arrays = (Vec<Option<(usize, usize)>>, Vec<f64>, Vec<u64>);

/// A complete tree over `leaf_mass` (a power of two of them) filled with `leaf_counts`.
fn complete(leaf_mass: &[f64], leaf_counts: &[u64]) -> Arrays {
    let leaves = leaf_mass.len();
    let inner = leaves - 1;
    let children = (0..inner + leaves).map(|v| (v < inner).then_some((2 * v + 1, 2 * v + 2))).collect();
    let mut mass = vec![0.0; inner];
    let mut counts = vec![0; inner];
    mass.extend_from_slice(leaf_mass);
    counts.extend_from_slice(leaf_counts);
    for v in (0..inner).rev() {
        mass[v] = mass[2 * v + 1] + mass[2 * v + 2];
        counts[v] = counts[2 * v + 1] + counts[2 * v + 2];
    }
    (children, mass, counts)
}

fn draw(stream: &mut Stream, probabilities: &[f64], n: u64) -> Vec<u64> {
    let mut edges: Vec<f64> = Vec::new();
    for p in probabilities {
        edges.push(edges.last().unwrap_or(&0.0) + p);
    }
    let mut counts = vec![0; probabilities.len()];
    for _ in 0..n {
        let u = stream.next_f64();
        counts[edges.partition_point(|e| *e <= u).min(probabilities.len() - 1)] += 1;
    }
    counts
}

#[test]
fn four_cells_by_hand() {
    let (children, mass, counts) = complete(&[1.0, 3.0, 2.0, 2.0], &[110, 290, 180, 220]);
    let pooled = Tree::new(&children, &mass, &counts).unwrap().pool_shape(MIN_EXPECTED);
    let cut = level_cut(&pooled, 2);
    assert_eq!(pooled.counts(&cut), [(110, 100.0), (290, 300.0), (180, 200.0), (220, 200.0)]);
    let (x2, dof) = pearson(&pooled.counts(&cut));
    assert!((x2 - (1.0 + 1.0 / 3.0 + 2.0 + 2.0)).abs() < 1e-12 && dof == 3.0);
    // Root 400 : 400, left 110 of 400 at 1/4, right 180 of 400 at 1/2.
    let splits = pooled.haar();
    let z: Vec<f64> = splits.iter().map(|s| s.z).collect();
    assert!(z[0] == 0.0 && (z[1] - 10.0 / 75f64.sqrt()).abs() < 1e-12 && (z[2] + 2.0).abs() < 1e-12);
    let levels = haar_levels(&splits);
    assert!(levels[0] == (0.0, 1.0) && (levels[1].0 - (4.0 + 100.0 / 75.0)).abs() < 1e-12);
    assert_eq!(haar_largest(&splits).map(|s| (s.node, s.depth)), Some((2, 1)));
    assert_eq!(level_cut(&pooled, 0), [0]);
    assert_eq!(pooled.depth(), 2);
}

#[test]
fn a_lobe_deep_in_empty_cells_stays_resolved_and_strays_are_counted() {
    // All mass lies left of the first split; 30 samples stray to the right.
    let children = [Some((1, 2)), Some((3, 4)), Some((5, 6)), None, None, None, None];
    let mass = [1.0, 1.0, 0.0, 0.5, 0.5, 0.0, 0.0];
    let counts = [1030u64, 1000, 30, 500, 500, 10, 20];
    let pooled = Tree::new(&children, &mass, &counts).unwrap().pool_shape(MIN_EXPECTED);
    let cells = pooled.counts(&level_cut(&pooled, 1));
    assert_eq!(cells, [(530, 515.0), (500, 515.0)]);
    assert_eq!(pooled.nodes[1].absorbed, [2]);
    assert_eq!(pooled.nodes[0].node, 1);
    assert_eq!(pooled.nodes[0].observed, 1030);
}

#[test]
fn light_pairs_become_one_cell() {
    let (children, mass, counts) = complete(&[0.5, 0.47, 0.015, 0.015], &[500, 470, 10, 20]);
    let pooled = Tree::new(&children, &mass, &counts).unwrap().pool(1000.0, MIN_EXPECTED);
    let observed: Vec<u64> = pooled.counts(&level_cut(&pooled, 9)).iter().map(|c| c.0).collect();
    assert_eq!(observed, [500, 470, 30]);
}

#[test]
fn every_sample_is_in_one_cell_of_every_cut() {
    let mut stream = StreamKey::new(1).with("test", "cuts").block(0);
    for _ in 0..50 {
        let mass: Vec<f64> = (0..64).map(|_| (20.0 * stream.next_f64() - 16.0).exp()).collect();
        let counts: Vec<u64> = (0..64).map(|_| stream.next_u64() >> 56).collect();
        let (children, mass, counts) = complete(&mass, &counts);
        let pooled = Tree::new(&children, &mass, &counts).unwrap().pool_shape(MIN_EXPECTED);
        for depth in 0..8 {
            let cells = pooled.counts(&level_cut(&pooled, depth));
            assert_eq!(cells.iter().map(|c| c.0).sum::<u64>(), counts[0]);
            let expected: f64 = cells.iter().map(|c| c.1).sum();
            assert!((expected / counts[0] as f64 - 1.0).abs() < 1e-9);
            assert!(cells.iter().all(|c| c.1 >= MIN_EXPECTED));
        }
    }
}

#[test]
fn arrays_that_are_no_tree_are_refused() {
    let pair = [Some((1, 2)), None, None];
    let check = |c: &[Option<(usize, usize)>], m: &[f64], n: &[u64]| Tree::new(c, m, n).err();
    assert_eq!(check(&pair, &[1.0, 0.5, 0.5], &[2, 1, 1]), None);
    assert_eq!(check(&pair, &[1.0, 0.5], &[2, 1, 1]), Some(TreeError::Length));
    assert_eq!(check(&pair, &[1.0, 0.5, 0.4], &[2, 1, 1]), Some(TreeError::Mass(0)));
    assert_eq!(check(&pair, &[1.0, f64::NAN, 0.5], &[2, 1, 1]), Some(TreeError::Mass(0)));
    assert_eq!(check(&pair, &[1.0, 0.5, 0.5], &[3, 1, 1]), Some(TreeError::Count(0)));
    assert_eq!(check(&[Some((0, 1)), None], &[1.0, 1.0], &[1, 1]), Some(TreeError::Children(0)));
}

#[test]
fn pearson_with_empty_expectation() {
    assert_eq!(pearson(&[(5, 5.0), (1, 0.0)]).0, f64::INFINITY);
    assert_eq!(pearson(&[(5, 5.0), (7, 7.0), (0, 0.0)]), (0.0, 1.0));
    assert!(pearson(&[(5, f64::NAN)]).0.is_nan());
}

/// Tail frequencies of Pearson's X², of each Haar level, of their sum, and of the largest |z|.
#[test]
fn null_tails_are_nominal() {
    let mass: Vec<f64> = (0..32).map(|i| 1.0 + f64::from(i % 7)).collect();
    let total: f64 = mass.iter().sum();
    let p: Vec<f64> = mass.iter().map(|m| m / total).collect();
    let (runs, n) = (20_000u32, 4000);
    let key = StreamKey::new(11).with("test", "null tails");
    let mut below = [[0u32; 8]; 2];
    let sizes = [0.01, 0.001];
    for run in 0..runs {
        let counts = draw(&mut key.block(u64::from(run)), &p, n);
        let (children, mass, counts) = complete(&mass, &counts);
        let pooled = Tree::new(&children, &mass, &counts).unwrap().pool_shape(MIN_EXPECTED);
        let splits = pooled.haar();
        let mut tests = haar_levels(&splits);
        tests.push(tests.iter().fold((0.0, 0.0), |s, t| (s.0 + t.0, s.1 + t.1)));
        tests.push(pearson(&pooled.counts(&level_cut(&pooled, 5))));
        let mut p: Vec<f64> = tests.iter().map(|(x2, dof)| chi_square::sf(*x2, *dof)).collect();
        let z = haar_largest(&splits).unwrap().z.abs();
        p.push((2.0 * normal::ln_sf(z).exp() * splits.len() as f64).min(1.0));
        assert_eq!(p.len(), 8);
        for (size, row) in sizes.iter().zip(&mut below) {
            row.iter_mut().zip(&p).for_each(|(count, p)| *count += u32::from(p < size));
        }
    }
    for (size, row) in sizes.iter().zip(below) {
        let expected = f64::from(runs) * size;
        // 4σ of the simulation, and the 20 % that discreteness is allowed.
        let slack = 4.0 * expected.sqrt() + 0.2 * expected;
        for count in row {
            assert!((f64::from(count) - expected).abs() < slack, "{size}: {row:?} of {runs}");
        }
    }
}

#[test]
fn a_small_shift_is_seen_and_located() {
    let p = [1.0 / 64.0; 64];
    let mut bent = p;
    bent[..32].iter_mut().for_each(|q| *q *= 1.01);
    bent[32..].iter_mut().for_each(|q| *q *= 0.99);
    let counts = draw(&mut StreamKey::new(2).with("test", "shift").block(0), &bent, 1_000_000);
    let (children, mass, counts) = complete(&p, &counts);
    let pooled = Tree::new(&children, &mass, &counts).unwrap().pool_shape(MIN_EXPECTED);
    let worst = haar_largest(&pooled.haar()).unwrap();
    assert!(worst.node == 0 && worst.z > 7.0, "{worst:?}");
}
