//! Sharing out the chance of a false alarm.
//!
//! By the union bound, a run in which each test fails a correct subject with probability at most
//! its share has a false alarm with probability at most the sum of the shares, whatever the
//! dependence between the tests. A share a is spent as two independent attempts of size √a, both
//! of which must cross: the product is a, while each threshold stays where the approximations
//! behind it were measured.

/// The chance, per run, that any correct subject is called wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// In (0, 1).
    pub total: f64,
}

impl Budget {
    /// Equal share of each of `tests` tests; their sum, exact or in f64, is at most the total.
    pub fn share(&self, tests: usize) -> f64 {
        divide_down(self.total, tests)
    }
}

/// Size of each of the two attempts at a share: √share, rounded so that its square fits.
pub fn attempt(share: f64) -> f64 {
    let root = share.sqrt();
    if libm::fma(root, root, -share) > 0.0 { root.next_down() } else { root }
}

/// Part of an attempt spent at look `index` of `looks`.
///
/// The last look, with all the samples, gets half; the earlier ones, there to stop early on gross
/// errors, divide the other half. A single look gets everything. The parts sum to at most
/// `attempt`, exactly and in f64; looks past the last get nothing.
pub fn look_share(attempt: f64, looks: usize, index: usize) -> f64 {
    match (looks, index) {
        (looks, index) if index >= looks => 0.0,
        (1, _) => attempt,
        (looks, index) if index + 1 == looks => 0.5 * attempt,
        (looks, _) => divide_down(0.5 * attempt, looks - 1),
    }
}

/// x/n with as many trailing bits cleared as n has, so that adding it up to n times never rounds
/// and never exceeds x.
fn divide_down(x: f64, n: usize) -> f64 {
    let n = n.max(1);
    let width = if n == 1 { 0 } else { usize::BITS - n.leading_zeros() };
    let quotient = x / n as f64;
    // Clearing at least one bit undoes a quotient that rounded up, as long as it moves; step down
    // first so that it always does.
    let lowered = if n.is_power_of_two() { quotient } else { quotient.next_down() };
    f64::from_bits(lowered.to_bits() & !((1u64 << width) - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_never_exceeds_the_whole() {
        for total in [1e-6, 0.05, 1.0 / 3.0, 7.3e-11] {
            for n in [1usize, 2, 3, 7, 10, 49, 1000, 65_537] {
                let share = Budget { total }.share(n);
                let sum: f64 = (0..n).map(|_| share).sum();
                assert!(sum <= total && sum > total * (1.0 - 1e-9), "{total} {n} {sum}");
                let looks: f64 = (0..n).map(|i| look_share(total, n, i)).sum();
                assert!(looks <= total && looks > total * (1.0 - 1e-9), "{total} {n} {looks}");
                let reverse: f64 = (0..n).rev().map(|i| look_share(total, n, i)).sum();
                assert!(reverse <= total, "{total} {n} {reverse}");
            }
        }
    }

    #[test]
    fn looks_by_hand() {
        assert_eq!(look_share(0.25, 1, 0), 0.25);
        assert_eq!([0, 1, 2].map(|i| look_share(0.5, 3, i)), [0.125, 0.125, 0.25]);
        assert_eq!(look_share(0.5, 3, 3), 0.0);
        assert_eq!(look_share(0.5, 0, 0), 0.0);
    }

    #[test]
    fn two_attempts_cost_at_most_the_share() {
        assert_eq!(attempt(0.25), 0.5);
        let mut share = 1e-6;
        for _ in 0..1000 {
            share *= 0.983;
            let a = attempt(share);
            assert!(a * a <= share && a * a > share * (1.0 - 1e-15), "{share}");
        }
    }
}
