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
        let one = format!(
            "a correct submission loses a point by chance with probability at most {}",
            above(*budget)
        );
        let any = match students {
            0 | 1 => String::new(),
            n => format!("; were all {n} correct, any of them would with at most {}", above(*chance)),
        };
        format!("{one}{any}; equal seeds make identical code fail together")
    }
}

/// Two digits, rounded up: never less likely than it is.
fn above(p: f64) -> String {
    if p <= 0.0 {
        return "0".into();
    }
    let unit = 10f64.powf(p.log10().floor() - 1.0);
    let up = (p / unit - 1e-6).ceil() * unit;
    format!("{up:.1e}").replace(".0e", "e")
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
             any of them would with at most 4e-2; equal seeds make identical code fail together"
        );
        assert_eq!([0.00010941, 1.0, 0.0, 0.999e-3].map(above), ["1.1e-4", "1e0", "0", "1e-3"]);
        assert!(!Fairness::new(1e-4, 1).sentence().contains("were all"));
    }
}
