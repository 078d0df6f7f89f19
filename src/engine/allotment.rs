//! How many draws each case gets.

use super::cost::Cost;
use crate::evidence::BLOCK;
use crate::suite::{Case, Plan};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How many draws cases get.
#[derive(Clone, Debug, Default)]
pub enum Draws {
    /// What the plan says.
    #[default]
    Planned,
    /// As many as a run within a budget gave: one number a case, 0 for none at all.
    Given(Vec<u64>),
    /// As many as this time buys.
    Within(Duration),
}

/// Why a case is not run; the same where a later run follows the allocation.
const LATE: &str = "time was up before this case";

/// Draws of a case within a budget: the first look, and what takes hours.
const LEAST: f64 = (1u64 << 14) as f64;
const MOST: f64 = (1u64 << 28) as f64;

/// A case may be planned to take this part of its time limit.
const OF_LIMIT: f64 = 0.5;

/// What guesses are taken to be off by until cases say better, and how many seconds of
/// work outweigh that. Rather too much than too little: time that is left over goes to
/// later cases, time that is overdrawn leaves them with none.
const CAUTION: f64 = 2.0;
const FAITH: f64 = 1.0;

/// Deals draws to cases.
///
/// A detection limit goes with 1/√N, so that with costs c a draw the sum of all limits is
/// least, within a given time, for N ∝ c^(−2/3) (Lagrange: all have the same gain a
/// second, N^(−3/2)/c). What cases took corrects what the rest is expected to.
pub struct Allotment {
    draws: Draws,
    start: Instant,
    costs: Vec<Cost>,
    state: Mutex<State>,
}

struct State {
    /// Seconds from the start after which no further case is begun.
    end: f64,
    threads: f64,
    /// Sums over cases that are not begun: of fixed costs, and of c^(1/3).
    fixed: f64,
    roots: f64,
    /// Cases under way: what they are expected to take, and since when.
    running: BTreeMap<usize, (f64, f64)>,
    /// What ended cases were guessed to take, and what they took.
    guessed: f64,
    taken: f64,
    /// Draws by case.
    dealt: Vec<u64>,
}

impl Allotment {
    /// For the `chosen` cases of a plan. Within a budget this calls each subject a few
    /// times.
    pub fn new(draws: &Draws, plan: &Plan<'static>, chosen: &[usize], threads: usize) -> Self {
        let start = Instant::now();
        let mut end = 0.0;
        let mut costs = Vec::new();
        let (mut fixed, mut roots) = (0.0, 0.0);
        if let Draws::Within(budget) = draws {
            end = budget.as_secs_f64();
            let mut known: BTreeMap<&str, Cost> = BTreeMap::new();
            costs = vec![Cost { fixed: 0.0, draw: 0.0 }; plan.cases.len()];
            for &index in chosen {
                let case = &plan.cases[index];
                costs[index] = *known.entry(&case.spelling).or_insert_with(|| Cost::of(case));
                fixed += costs[index].fixed;
                roots += costs[index].draw.cbrt();
            }
        }
        let state = State {
            end,
            threads: threads as f64,
            fixed,
            roots,
            running: BTreeMap::new(),
            guessed: 0.0,
            taken: 0.0,
            dealt: vec![0; plan.cases.len()],
        };
        Self { draws: draws.clone(), start, costs, state: Mutex::new(state) }
    }

    /// In which order cases are begun: as planned, or, where time may end before all are,
    /// one of each subject, another of each, and so on.
    pub fn order(&self, plan: &Plan, chosen: &[usize]) -> Vec<usize> {
        let Draws::Within(_) = self.draws else { return chosen.to_vec() };
        let mut of_subject: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for &index in chosen {
            of_subject.entry(&plan.cases[index].spelling).or_default().push(index);
        }
        let turns = of_subject.values().flat_map(|cases| turns(cases.len()).into_iter().zip(cases));
        let mut ranked: Vec<(usize, usize)> = turns.map(|(turn, index)| (turn, *index)).collect();
        ranked.sort_unstable();
        ranked.into_iter().map(|(_, index)| index).collect()
    }

    /// The case as it is to be run; `None` with the reason where it is not.
    pub fn grant(&self, index: usize, case: &Arc<Case<'static>>) -> Result<Arc<Case<'static>>, &'static str> {
        let draws = match &self.draws {
            Draws::Planned => return Ok(case.clone()),
            Draws::Given(draws) => draws.get(index).copied().unwrap_or(0),
            Draws::Within(_) => {
                let limit = case.settings.time_limit.as_secs_f64();
                self.state()
                    .deal(index, self.costs[index], limit, self.start.elapsed().as_secs_f64())
                    .ok_or(LATE)?
            }
        };
        if draws == 0 {
            return Err(LATE);
        }
        let mut case = Case::clone(case);
        case.settings.samples = draws;
        Ok(Arc::new(case))
    }

    /// Takes down what a case took.
    pub fn settle(&self, index: usize, seconds: f64) {
        let Draws::Within(_) = self.draws else { return };
        let mut state = self.state();
        state.settle(index, seconds);
    }

    /// Draws by case, if this was more than the plan.
    pub fn dealt(&self) -> Option<Vec<u64>> {
        match &self.draws {
            Draws::Planned => None,
            Draws::Given(draws) => Some(draws.clone()),
            Draws::Within(_) => Some(self.state().dealt.clone()),
        }
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn settle(&mut self, index: usize, seconds: f64) {
        self.guessed += self.running.remove(&index).map_or(0.0, |(expected, _)| expected);
        self.taken += seconds;
    }

    /// Draws for the next case, whole blocks; `None` when time is up.
    fn deal(&mut self, index: usize, cost: Cost, limit: f64, now: f64) -> Option<u64> {
        let left = self.end - now;
        if left <= 0.0 {
            return None;
        }
        // What guesses must be multiplied by.
        let correction = (self.taken + CAUTION * FAITH) / (self.guessed + FAITH);
        let rest = |(expected, since): &(f64, f64)| (expected * correction - (now - since)).max(0.0);
        let busy: f64 = self.running.values().map(rest).sum();
        let free = (left * self.threads - busy) / correction - self.fixed;
        let draws = free / self.roots / cost.draw.powf(2.0 / 3.0);
        let most = (OF_LIMIT * limit / correction - cost.fixed) / cost.draw;
        let draws = draws.min(most).clamp(LEAST, MOST);
        let draws = (draws / BLOCK as f64).floor() * BLOCK as f64;
        self.fixed -= cost.fixed;
        self.roots = (self.roots - cost.draw.cbrt()).max(f64::MIN_POSITIVE);
        self.running.insert(index, (cost.with(draws), now));
        self.dealt[index] = draws as u64;
        Some(draws as u64)
    }
}

/// For each of `n` in a row its turn, such that the first few turns are far apart in the
/// row: steps of the golden ratio, a sequence of low discrepancy.
fn turns(n: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let place = |turn: &usize| (*turn as f64 * GOLDEN).fract();
    let mut turns: Vec<usize> = (0..n).collect();
    turns.sort_by(|a, b| place(a).total_cmp(&place(b)));
    turns
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(seconds: f64, threads: f64, costs: &[Cost]) -> State {
        State {
            end: seconds,
            threads,
            fixed: costs.iter().map(|c| c.fixed).sum(),
            roots: costs.iter().map(|c| c.draw.cbrt()).sum(),
            running: BTreeMap::new(),
            guessed: 0.0,
            taken: 0.0,
            dealt: vec![0; costs.len()],
        }
    }

    /// A run on two threads in which cases take `factor` times what is guessed: when it
    /// ends, and the draws of each.
    fn simulated(budget: f64, costs: &[Cost], factor: f64) -> (f64, Vec<f64>) {
        let mut state = state(budget, 2.0, costs);
        let mut free = [0.0f64; 2];
        let mut under_way: Vec<(f64, usize, f64)> = Vec::new();
        for (k, cost) in costs.iter().enumerate() {
            let thread = usize::from(free[1] < free[0]);
            let now = free[thread];
            under_way.retain(|(end, index, took)| {
                if *end <= now {
                    state.settle(*index, *took);
                }
                *end > now
            });
            let Some(draws) = state.deal(k, *cost, 1e9, now) else { break };
            let took = factor * cost.with(draws as f64);
            free[thread] += took;
            under_way.push((free[thread], k, took));
        }
        (free[0].max(free[1]), state.dealt.iter().map(|n| *n as f64).collect())
    }

    /// Guesses may be off by much in both ways, and no case is left out for it.
    #[test]
    fn the_budget_is_met_and_no_case_starves() {
        let costs: Vec<Cost> = (0..40).map(|k| Cost { fixed: 0.05, draw: [1e-7, 4e-7][k % 2] }).collect();
        for factor in [0.5, 1.0, 2.0, 5.0] {
            let (end, dealt) = simulated(60.0, &costs, factor);
            assert!((45.0..66.0).contains(&end), "{factor}: {end} s");
            for kind in 0..2 {
                let of_kind: Vec<f64> = dealt.iter().skip(kind).step_by(2).copied().collect();
                let mean = of_kind.iter().sum::<f64>() / of_kind.len() as f64;
                let least = of_kind.iter().fold(f64::INFINITY, |a, b| a.min(*b));
                assert!(least > 0.2 * mean, "{factor}: {least} of {mean}: {of_kind:?}");
            }
        }
    }

    /// Dear draws are fewer by the power 2/3.
    #[test]
    fn time_goes_where_it_buys_most() {
        let costs: Vec<Cost> = (0..200).map(|k| Cost { fixed: 0.0, draw: [1e-6, 8e-6][k % 2] }).collect();
        let (_, dealt) = simulated(1000.0, &costs, 1.0);
        let ratio = dealt[150] / dealt[151];
        assert!((ratio / 4.0 - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn little_time_gives_the_least_and_none_nothing() {
        let cost = Cost { fixed: 5.0, draw: 1e-6 };
        assert_eq!(state(1.0, 1.0, &[cost]).deal(0, cost, 1e9, 0.0), Some(1 << 14));
        assert_eq!(state(1.0, 1.0, &[cost]).deal(0, cost, 1e9, 1.0), None);
        let free = Cost { fixed: 0.0, ..cost };
        let limited = state(1e6, 1.0, &[free]).deal(0, free, 20.0, 0.0).unwrap() as f64;
        let half = OF_LIMIT * 20.0 / CAUTION / free.draw;
        assert!((limited / half - 1.0).abs() < 0.01, "half of the time limit: {limited}");
    }

    #[test]
    fn early_turns_are_far_apart() {
        for n in [1, 2, 7, 18] {
            let turns = turns(n);
            let mut sorted = turns.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..n).collect::<Vec<_>>());
        }
        let turns = turns(18);
        let place = |turn: usize| turns.iter().position(|t| *t == turn).unwrap() as i32;
        let gaps = [(0, 1), (1, 2), (0, 2)].map(|(a, b)| (place(a) - place(b)).abs());
        assert!(gaps.iter().all(|gap| *gap >= 4), "{gaps:?} of {turns:?}");
    }
}
