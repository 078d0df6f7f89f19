//! By how much chance decides grades.

/// The chance that correct submissions lose points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fairness {
    /// A correct submission loses any point with at most this probability.
    pub budget: f64,
    /// Submissions that were graded.
    pub students: usize,
    /// Any of so many correct submissions loses a point with at most this probability.
    pub chance: f64,
}

impl Fairness {
    /// Of a class whose rubric has this budget: probabilities add up at most.
    pub fn new(budget: f64, students: usize) -> Self {
        Self { budget, students, chance: (budget * students as f64).min(1.0) }
    }

    /// In words.
    pub fn sentence(&self) -> String {
        let Self { budget, students, chance } = self;
        let one = format!("a correct submission loses a point by chance with probability at most {budget:e}");
        let any = match students {
            0 | 1 => String::new(),
            n => format!("; were all {n} correct, any of them would with at most {chance:.2e}"),
        };
        format!("{one}{any}; equal seeds make identical code fail together")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_add_up_to_one_at_most() {
        assert_eq!(Fairness::new(2e-4, 200).chance, 0.04);
        assert_eq!(Fairness::new(0.5, 200).chance, 1.0);
        assert_eq!(
            Fairness::new(2e-4, 200).sentence(),
            "a correct submission loses a point by chance with probability at most 2e-4; were all 200 correct, \
             any of them would with at most 4.00e-2; equal seeds make identical code fail together"
        );
        assert!(!Fairness::new(1e-4, 1).sentence().contains("were all"));
    }
}
