//! All-pairs covering arrays.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// Rows of levels, one level a factor, in which every two levels of two factors
/// that meet in some admissible row meet at least once. `levels` has at least
/// two factors.
///
/// Greedy: the row that covers most pairs not covered yet, the first of equals.
/// What a row adds never grows, so that a row still ahead after counting again
/// is ahead of all.
pub(super) fn cover(levels: &[usize], admissible: impl Fn(&[usize]) -> bool) -> Vec<Vec<usize>> {
    let rows: Vec<Vec<usize>> = product(levels).filter(|row| admissible(row)).collect();
    let mut missing: HashSet<Pair> = rows.iter().flat_map(|row| pairs(row)).collect();
    let of_row = levels.len() * (levels.len() - 1) / 2;
    let mut queue: BinaryHeap<_> = (0..rows.len()).map(|k| (of_row, Reverse(k))).collect();
    let mut chosen = Vec::new();
    while !missing.is_empty() {
        let Some((_, Reverse(k))) = queue.pop() else { break };
        let adds = pairs(&rows[k]).filter(|p| missing.contains(p)).count();
        let now = (adds, Reverse(k));
        if queue.peek().is_some_and(|next| *next > now) {
            queue.push(now);
            continue;
        }
        pairs(&rows[k]).for_each(|p| {
            missing.remove(&p);
        });
        chosen.push(rows[k].clone());
    }
    chosen
}

/// Two factors and a level of each.
type Pair = (usize, usize, usize, usize);

fn pairs(row: &[usize]) -> impl Iterator<Item = Pair> {
    (0..row.len()).flat_map(move |a| (a + 1..row.len()).map(move |b| (a, row[a], b, row[b])))
}

/// Every row, the last factor fastest.
pub(super) fn product(levels: &[usize]) -> impl Iterator<Item = Vec<usize>> {
    (0..levels.iter().product::<usize>()).map(move |mut index| {
        let mut row = vec![0; levels.len()];
        for (level, n) in row.iter_mut().zip(levels).rev() {
            *level = index % n;
            index /= n;
        }
        row
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pair_that_can_meet_meets() {
        let levels = [3, 2, 4, 1, 6, 3];
        // Level 2 of the first factor and level 1 of the second never meet.
        let admissible = |row: &[usize]| !(row[0] == 2 && row[1] == 1);
        let rows = cover(&levels, admissible);
        assert!(rows.iter().all(|row| admissible(row)));
        for a in 0..levels.len() {
            for b in a + 1..levels.len() {
                for (i, j) in (0..levels[a]).flat_map(|i| (0..levels[b]).map(move |j| (i, j))) {
                    let met = rows.iter().any(|row| row[a] == i && row[b] == j);
                    assert_eq!(met, !(a == 0 && b == 1 && i == 2 && j == 1), "{a}={i} {b}={j}");
                }
            }
        }
        // At least the two largest factors' product, and not much more.
        assert!((24..=30).contains(&rows.len()), "{}", rows.len());
        assert_eq!(rows, cover(&levels, admissible), "the same rows again");
    }

    #[test]
    fn nothing_admissible_gives_no_row() {
        assert!(cover(&[2, 2], |_| false).is_empty());
    }

    #[test]
    fn products_are_in_order() {
        let rows: Vec<_> = product(&[2, 3]).collect();
        assert_eq!(rows, [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]);
    }
}
