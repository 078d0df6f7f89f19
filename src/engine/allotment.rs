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

/// Draws of a case within a budget: the first look, and what takes hours.
const LEAST: f64 = (1u64 << 14) as f64;
const MOST: f64 = (1u64 << 28) as f64;

/// A case may be planned to take this part of its time limit.
const OF_LIMIT: f64 = 0.5;

/// Weight of the guesses against what was measured, in seconds of work.
const FAITH: f64 = 0.2;

/// Deals draws to cases.
///
/// A detection limit goes with 1/√N, so that with costs c a draw the sum of all limits is
/// least, within a given time, for N ∝ c^(−2/3) (Lagrange: all have the same gain a
/// second, N^(−3/2)/c). What cases took corrects what the rest is expected to.
pub struct Allotment {
    draws: Draws,
    costs: Vec<Cost>,
    state: Mutex<State>,
}

struct State {
    /// When no further case is begun.
    end: Instant,
    threads: f64,
    /// Sums over cases that are not begun: of fixed costs, and of c^(1/3).
    fixed: f64,
    roots: f64,
    /// Cases under way: what they are expected to take, and since when.
    running: BTreeMap<usize, (f64, Instant)>,
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
        let mut end = start;
        let mut costs = Vec::new();
        let (mut fixed, mut roots) = (0.0, 0.0);
        if let Draws::Within(budget) = draws {
            end += *budget;
            let mut known: BTreeMap<&str, Cost> = BTreeMap::new();
            let cost = |case: &'_ Arc<Case<'static>>| Cost::of(case);
            costs = vec![Cost { fixed: 0.0, draw: 0.0 }; plan.cases.len()];
            for &index in chosen {
                let case = &plan.cases[index];
                costs[index] = *known.entry(&case.spelling).or_insert_with(|| cost(case));
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
        Self { draws: draws.clone(), costs, state: Mutex::new(state) }
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
                self.state().deal(index, self.costs[index], limit).ok_or("time was up before this case")?
            }
        };
        if draws == 0 {
            return Err("it was not begun in the run whose allocation this one follows");
        }
        let mut case = Case::clone(case);
        case.settings.samples = draws;
        Ok(Arc::new(case))
    }

    /// Takes down what a case took.
    pub fn settle(&self, index: usize, seconds: f64) {
        let Draws::Within(_) = self.draws else { return };
        let mut state = self.state();
        let expected = state.running.remove(&index);
        state.guessed += expected.map_or(0.0, |(seconds, _)| seconds);
        state.taken += seconds;
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
    /// Draws for the next case, whole blocks; `None` when time is up.
    fn deal(&mut self, index: usize, cost: Cost, limit: f64) -> Option<u64> {
        let now = Instant::now();
        let left = self.end.checked_duration_since(now)?.as_secs_f64();
        if left <= 0.0 {
            return None;
        }
        // What guesses must be multiplied by.
        let correction = (self.taken + FAITH) / (self.guessed + FAITH);
        let rest = |(expected, since): &(f64, Instant)| {
            (expected * correction - now.duration_since(*since).as_secs_f64()).max(0.0)
        };
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

    fn state(seconds: f64, costs: &[Cost]) -> State {
        State {
            end: Instant::now() + Duration::from_secs_f64(seconds),
            threads: 1.0,
            fixed: costs.iter().map(|c| c.fixed).sum(),
            roots: costs.iter().map(|c| c.draw.cbrt()).sum(),
            running: BTreeMap::new(),
            guessed: 0.0,
            taken: 0.0,
            dealt: vec![0; costs.len()],
        }
    }

    /// All costs together fill the budget, and dear draws are fewer by the 2/3 power.
    #[test]
    fn fills_the_budget_where_it_buys_most() {
        let costs = [1e-6, 1e-6, 8e-6].map(|draw| Cost { fixed: 0.1, draw });
        let mut state = state(100.0, &costs);
        let dealt: Vec<f64> =
            (0..3).map(|k| state.deal(k, costs[k], 1e9).unwrap() as f64).collect();
        let spent: f64 = (0..3).map(|k| costs[k].with(dealt[k])).sum();
        assert!((spent - 100.0).abs() < 1.0, "{spent} {dealt:?}");
        assert!((dealt[0] / dealt[2] - 4.0).abs() < 0.05, "{dealt:?}");
        assert!((dealt[0] / dealt[1] - 1.0).abs() < 0.05, "{dealt:?}");
    }

    #[test]
    fn what_cases_take_corrects_the_guesses() {
        let costs = [Cost { fixed: 0.0, draw: 1e-6 }; 2];
        let mut state = state(10.0, &costs);
        let first = state.deal(0, costs[0], 1e9).unwrap();
        let (guessed, _) = state.running.remove(&0).unwrap();
        (state.guessed, state.taken) = (guessed, 3.0 * guessed);
        let second = state.deal(1, costs[1], 1e9).unwrap();
        // Ten seconds are left, and cases take about three times as long.
        assert!((first as f64 / 5e6 - 1.0).abs() < 0.02, "{first}");
        assert!((second as f64 / 3.4e6 - 1.0).abs() < 0.1, "{second}");
    }

    #[test]
    fn little_time_gives_the_least_and_none_nothing() {
        let cost = Cost { fixed: 5.0, draw: 1e-6 };
        assert_eq!(state(1.0, &[cost]).deal(0, cost, 1e9), Some(1 << 14));
        assert_eq!(state(0.0, &[cost]).deal(0, cost, 1e9), None);
        let limited = state(1000.0, &[cost]).deal(0, cost, 20.0).unwrap();
        assert!((limited as f64 / 5e6 - 1.0).abs() < 0.05, "half of the time limit: {limited}");
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
