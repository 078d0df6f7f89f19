//! What a class did, in numbers.

use super::super::{Grade, ItemGrade, ItemKind};
use super::gradebook::{causes, item_ids};

/// An item over the class.
#[derive(Clone, Debug, PartialEq)]
pub struct ItemStatistics<'a> {
    /// One of the class's own, for title, kind and points.
    pub item: &'a ItemGrade,
    /// Mean of what was earned, submissions that could not be measured included.
    pub mean: f64,
    /// How many lost something of it, of those that could be measured.
    pub lost: usize,
    /// How many of these were not scored for want of another item.
    pub unmet: usize,
}

/// Items over the class, in the rubric's order.
pub fn items<'a>(grades: &[&'a Grade]) -> Vec<ItemStatistics<'a>> {
    let of = |id: &str| {
        let all: Vec<(&Grade, &'a ItemGrade)> =
            grades.iter().filter_map(|g| Some((*g, g.items.iter().find(|item| item.id == id)?))).collect();
        let lost = || all.iter().filter(|(grade, item)| grade.broken.is_none() && item.is_lost());
        ItemStatistics {
            item: all[0].1,
            mean: all.iter().map(|(_, item)| item.earned).sum::<f64>() / all.len() as f64,
            lost: lost().count(),
            unmet: lost().filter(|(_, item)| item.unmet.is_some()).count(),
        }
    };
    item_ids(grades).into_iter().map(of).collect()
}

/// A cause over the class.
#[derive(Clone, Debug)]
pub struct Bug<'a> {
    /// Its slug.
    pub slug: &'a str,
    /// Submissions that have it.
    pub sure: Vec<&'a Grade>,
    /// Those that may have it.
    pub unsure: Vec<&'a Grade>,
}

/// Causes with the submissions that have them, the most frequent first.
pub fn bugs<'a>(grades: &[&'a Grade]) -> Vec<Bug<'a>> {
    let mut bugs: Vec<Bug> = Vec::new();
    for grade in grades {
        for (slug, sure) in causes(grade) {
            let at = bugs.iter().position(|bug| bug.slug == slug).unwrap_or_else(|| {
                bugs.push(Bug { slug, sure: Vec::new(), unsure: Vec::new() });
                bugs.len() - 1
            });
            if sure { bugs[at].sure.push(grade) } else { bugs[at].unsure.push(grade) }
        }
    }
    let counts = |bug: &Bug| (bug.sure.len(), bug.unsure.len());
    bugs.sort_by(|a, b| counts(b).cmp(&counts(a)).then(a.slug.cmp(b.slug)));
    bugs
}

/// Those that lost points and of which no cause is known.
pub fn unexplained<'a>(grades: &[&'a Grade]) -> Vec<&'a Grade> {
    let told = |grade: &&&Grade| {
        let found = grade.items.iter().any(|item| item.kind != ItemKind::Bonus && !item.lost.is_empty());
        grade.broken.is_none() && found && causes(grade).is_empty()
    };
    grades.iter().filter(told).copied().collect()
}

/// Mean and median of the scores.
pub fn middle(grades: &[&Grade]) -> Option<(f64, f64)> {
    let mut scores: Vec<f64> = grades.iter().map(|g| g.score).collect();
    scores.sort_by(f64::total_cmp);
    let n = scores.len();
    let at = |k: usize| scores.get(k).copied();
    let median = 0.5 * (at(n.checked_sub(1)? / 2)? + at(n / 2)?);
    Some((scores.iter().sum::<f64>() / n as f64, median))
}

/// Counts of scores in bins of `width` points from 0: each holds its lower end, the last
/// of the maximum its upper end too, and what is beyond has bins of its own.
pub fn bins(grades: &[&Grade], max: f64, width: f64) -> Vec<u64> {
    let top = grades.iter().fold(max, |top, g| top.max(g.score));
    // Thousandths of a bin aside, which sums of thirds are off.
    let number = |value: f64| (value / width + 1e-6).floor().max(0.0) as usize;
    let full = ((max / width - 1e-6).ceil().max(1.0)) as usize;
    let all = if top > max + 1e-9 { number(top) + 1 } else { full };
    let mut counts = vec![0; all.max(full)];
    for grade in grades {
        let within = grade.score <= max + 1e-9;
        let at = if within { number(grade.score).min(full - 1) } else { number(grade.score) };
        counts[at] += 1;
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::super::examples::{broken, grade, whole};
    use super::*;

    fn scored(scores: &[f64]) -> Vec<Grade> {
        scores.iter().map(|score| Grade { score: *score, max: 10.0, ..grade() }).collect()
    }

    fn counted(scores: &[f64], max: f64, width: f64) -> Vec<u64> {
        let grades = scored(scores);
        bins(&grades.iter().collect::<Vec<_>>(), max, width)
    }

    #[test]
    fn items_and_bugs_are_counted_over_the_class() {
        let all = [whole(""), whole(""), broken()];
        let grades: Vec<&Grade> = all.iter().collect();
        let items = items(&grades);
        let of = |id: &str| items.iter().find(|s| s.item.id == id).unwrap();
        assert!((of("builds").mean - 2.0 / 3.0).abs() < 1e-12 && of("builds").lost == 0);
        assert_eq!((of("pdf").lost, of("pdf").unmet, of("sampling").unmet), (2, 0, 2));
        let bugs: Vec<(&str, usize, usize)> =
            bugs(&grades).into_iter().map(|b| (b.slug, b.sure.len(), b.unsure.len())).collect();
        assert_eq!(bugs, [("half-vector-jacobian", 2, 0), ("masking", 0, 2)]);
        assert!(unexplained(&grades).is_empty());
        let unknown = Grade { diagnoses: Vec::new(), ..whole("") };
        assert_eq!(unexplained(&[&unknown]).len(), 1);
    }

    #[test]
    fn middles_of_odd_and_even_classes() {
        let of = |scores: &[f64]| {
            let grades = scored(scores);
            middle(&grades.iter().collect::<Vec<_>>())
        };
        assert_eq!(of(&[1.0, 10.0, 4.0]), Some((5.0, 4.0)));
        assert_eq!(of(&[1.0, 3.0]), Some((2.0, 2.0)));
        assert_eq!(of(&[]), None);
    }

    #[test]
    fn the_maximum_is_in_the_last_bin_and_a_bonus_beyond() {
        assert_eq!(counted(&[0.0, 0.99, 1.0, 10.0, 9.0], 10.0, 1.0), [2, 1, 0, 0, 0, 0, 0, 0, 0, 2]);
        assert_eq!(counted(&[11.0, 10.0], 10.0, 5.0), [0, 1, 1]);
        assert_eq!(counted(&[1.0 / 3.0 + 2.0 / 3.0], 2.0, 1.0), [0, 1]);
        assert_eq!(counted(&[0.0], 0.0, 1.0), [1]);
        assert_eq!(counted(&[], 3.0, 2.0), [0, 0]);
    }
}
