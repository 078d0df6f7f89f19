//! Points in words and in cells.

use super::super::{Grade, ItemKind};
use super::feedback::ItemTold;

/// At most `decimals` of them, and no zeros at their end.
fn trimmed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".into() } else { text.into() }
}

/// For people: at most two decimals, with a minus that is as wide as a plus.
pub fn points(value: f64) -> String {
    trimmed(value, 2).replace('-', "−")
}

/// For cells: at most four decimals, as programs read numbers.
pub fn number(value: f64) -> String {
    trimmed(value, 4)
}

/// `1 point`, `2.5 points`.
pub fn counted(value: f64) -> String {
    format!("{} point{}", points(value), if value == 1.0 { "" } else { "s" })
}

/// The score in per cent of what can be reached without a bonus.
pub fn percent(grade: &Grade) -> f64 {
    100.0 * share(grade)
}

/// The score over what can be reached without a bonus; more than 1 with a bonus. Where
/// nothing can be reached without one, any point is all.
pub fn share(grade: &Grade) -> f64 {
    match grade.max > 0.0 {
        true => grade.score / grade.max,
        false => f64::from(grade.score > 0.0),
    }
}

/// What was earned of an item: `1.33 of 2`, `+1 of 1 bonus`, `−1`.
pub fn earned(item: &ItemTold) -> String {
    match item.kind {
        ItemKind::Regular => format!("{} of {}", points(item.earned), points(item.points)),
        ItemKind::Bonus => format!("+{} of {} bonus", points(item.earned), points(item.points)),
        ItemKind::Penalty if item.earned < 0.0 => points(item.earned),
        ItemKind::Penalty => "0".into(),
    }
}

/// Points that are missing or were taken.
pub fn missing(item: &ItemTold) -> f64 {
    match item.kind {
        ItemKind::Penalty => -item.earned,
        ItemKind::Regular | ItemKind::Bonus => item.points - item.earned,
    }
}

/// The same as a fact: `2 points lost`, `bonus of 1 point not earned`, `1 point taken`.
pub fn loss(item: &ItemTold) -> String {
    let size = counted(missing(item));
    match item.kind {
        ItemKind::Regular => format!("{size} lost"),
        ItemKind::Bonus => format!("{size} of a bonus not earned"),
        ItemKind::Penalty => format!("{size} taken"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::ItemGrade;
    use super::super::examples::{grade, item};
    use super::*;

    #[test]
    fn numbers_are_short_and_their_own() {
        assert_eq!([2.0, 4.0 / 3.0, -1.0, 100.0, -0.001].map(points), ["2", "1.33", "−1", "100", "0"]);
        assert_eq!([2.0, 4.0 / 3.0, -1.0].map(number), ["2", "1.3333", "-1"]);
        assert_eq!(counted(1.0) + ", " + &counted(0.5), "1 point, 0.5 points");
    }

    #[test]
    fn a_score_is_told_by_what_counts_how() {
        let made = |kind, earned| ItemGrade { kind, earned, ..item("a", 2.0) };
        let all = [
            made(ItemKind::Regular, 1.5),
            made(ItemKind::Bonus, 2.0),
            made(ItemKind::Penalty, -2.0),
            made(ItemKind::Bonus, 1.0),
        ];
        let told: Vec<ItemTold> = all.iter().map(ItemTold::of).collect();
        assert_eq!(earned(&told[0]), "1.5 of 2");
        assert_eq!(earned(&told[1]), "+2 of 2 bonus");
        assert_eq!(earned(&told[2]), "−2");
        assert_eq!(loss(&told[0]), "0.5 points lost");
        assert_eq!(loss(&told[3]), "1 point of a bonus not earned");
        assert_eq!(loss(&told[2]), "2 points taken");
    }

    #[test]
    fn a_share_of_nothing_is_all_or_nothing() {
        let of = |score, max| Grade { score, max, ..grade() };
        assert_eq!(
            [of(3.0, 4.0), of(5.0, 4.0), of(1.0, 0.0), of(0.0, 0.0)].map(|g| share(&g)),
            [0.75, 1.25, 1.0, 0.0]
        );
    }
}
