//! What a student learns from a grade. This is the one place that decides what they may
//! see: everything for students is made of it, and nothing else of a grade.

use super::super::{Broken, Grade, Hints, Incident, ItemGrade, ItemKind, Phase};
use super::found::{self, Found, listed};
use super::points::missing;
use crate::cause::Cause;
use crate::report::Diagnosis;
use crate::report::formats::manual::cause_page;
use crate::report::visible::visible;
use std::cmp::Reverse;

/// Lines of what a compiler said that are shown: its first errors, and how it ended.
const FIRST_LINES: usize = 40;
const LAST_LINES: usize = 10;

/// Characters of a line at most.
const LONGEST_LINE: usize = 300;

/// What a student may see of a grade, in the order in which it helps.
#[derive(Clone, Debug)]
pub struct Feedback<'a> {
    /// Title of the rubric.
    pub rubric: &'a str,
    /// What the submission is called.
    pub id: &'a str,
    /// Its language, if one was told.
    pub language: Option<&'a str>,
    /// Points.
    pub score: f64,
    /// Points that can be reached without a bonus.
    pub max: f64,
    /// Every item, in the rubric's order.
    pub items: Vec<ItemTold<'a>>,
    /// Why nothing could be measured, and what the compiler said of it.
    pub broken: Option<(&'a str, String)>,
    /// What it tried that no BRDF needs, in words.
    pub incidents: Vec<String>,
    /// What is wrong, each cause once.
    pub causes: Vec<CauseTold<'a>>,
    /// Items that cost points: what does not build first, then what costs most.
    pub lost: Vec<LostItem<'a>>,
    /// What to type to see the same.
    pub again: &'a str,
}

/// What is told of every item, hidden ones too.
#[derive(Clone, Copy, Debug)]
pub struct ItemTold<'a> {
    /// Its id.
    pub id: &'a str,
    /// Its title.
    pub title: &'a str,
    /// What counts how.
    pub kind: ItemKind,
    /// Whether nothing else is told.
    pub hidden: bool,
    /// Points at stake.
    pub points: f64,
    /// Points earned; negative where a penalty takes them.
    pub earned: f64,
    /// Whether something is missing, or was taken.
    pub is_lost: bool,
    /// The rubric's text on a loss, where there is one.
    pub text: Option<&'a str>,
}

impl<'a> ItemTold<'a> {
    /// Of an item.
    pub fn of(item: &'a ItemGrade) -> Self {
        let is_lost = item.is_lost();
        Self {
            id: &item.id,
            title: &item.title,
            kind: item.kind,
            hidden: item.hidden,
            points: item.points,
            earned: item.earned,
            is_lost,
            text: item.loss.as_deref().filter(|_| is_lost),
        }
    }
}

/// An item that cost points.
#[derive(Clone, Debug)]
pub struct LostItem<'a> {
    /// The item.
    pub item: ItemTold<'a>,
    /// How much of what was found is told; of hidden items nothing.
    pub hints: Hints,
    /// Whether it could be measured.
    pub is_measured: bool,
    /// The title of the item that had to earn something first.
    pub unmet: Option<&'a str>,
    /// `3 of 6 cases passed`.
    pub count: Option<String>,
    /// What was found, the clearest first.
    pub found: Vec<Found<'a>>,
    /// Numbers of its causes.
    pub causes: Vec<usize>,
}

/// A cause that a student is told.
#[derive(Clone, Debug)]
pub struct CauseTold<'a> {
    /// Its slug.
    pub slug: &'a str,
    /// What is wrong, and with which subjects; mostly one sentence for all.
    pub statements: Vec<(&'a str, Vec<&'a str>)>,
    /// Titles of the items that it costs.
    pub items: Vec<&'a str>,
    /// What mends it, where that is told.
    pub repair: Option<&'a str>,
    /// What speaks for it, where that is told.
    pub evidence: Vec<&'a str>,
}

impl CauseTold<'_> {
    /// The manual's page, of a cause that gonio knows.
    pub fn known(&self) -> Option<Cause> {
        Cause::ALL.into_iter().find(|cause| cause.slug() == self.slug)
    }

    /// Where the manual's page can be read.
    pub fn address(&self) -> Option<String> {
        cause_page(self.slug)
    }
}

impl<'a> Feedback<'a> {
    /// Of a grade; `again` is what a student types to see the same.
    pub fn of(grade: &'a Grade, again: &'a str) -> Self {
        let mut feedback = Self {
            rubric: &grade.rubric,
            id: &grade.id,
            language: grade.language.as_deref(),
            score: grade.score,
            max: grade.max,
            items: grade.items.iter().map(ItemTold::of).collect(),
            broken: grade.broken.as_ref().map(|Broken { why, said }| (why.as_str(), bounded(said))),
            incidents: grade.incidents.iter().map(incident).collect(),
            causes: Vec::new(),
            lost: Vec::new(),
            again,
        };
        let mut lost: Vec<&ItemGrade> = grade.items.iter().filter(|i| i.is_lost()).collect();
        lost.sort_by_key(|item| rank(item));
        for item in lost {
            let told = lost_item(grade, item);
            let causes = match told.hints >= Hints::Cause {
                true => feedback.add_causes(grade, item, told.hints),
                false => Vec::new(),
            };
            feedback.lost.push(LostItem { causes, ..told });
        }
        feedback
    }

    /// Titles of items that cost nothing.
    pub fn passed(&self) -> Vec<&'a str> {
        let passed = self.items.iter().filter(|i| !i.is_lost && i.kind != ItemKind::Penalty);
        passed.map(|i| i.title).collect()
    }

    /// Lost items that there is something to say of.
    pub fn told(&self) -> impl Iterator<Item = (usize, &LostItem<'a>)> {
        self.lost.iter().enumerate().filter(|(_, lost)| lost.is_measured)
    }

    /// Titles of items that could not be measured.
    pub fn unmeasured(&self) -> Vec<&'a str> {
        self.lost.iter().filter(|lost| !lost.is_measured).map(|lost| lost.item.title).collect()
    }

    /// Whether there are items that students cannot measure themselves.
    pub fn has_hidden(&self) -> bool {
        self.items.iter().any(|i| i.hidden)
    }

    /// Tells the causes of what a lost item found; their numbers.
    fn add_causes(&mut self, grade: &'a Grade, item: &'a ItemGrade, hints: Hints) -> Vec<usize> {
        let mut numbers = Vec::new();
        let (sure, unsure): (Vec<&Diagnosis>, Vec<&Diagnosis>) =
            grade.diagnoses.iter().partition(|d| d.confident);
        for diagnosis in sure.into_iter().chain(unsure) {
            let Some(slug) = diagnosis.cause.as_deref() else { continue };
            if !item.lost.iter().any(|l| l.subject == diagnosis.subject) {
                continue;
            }
            let at = self.causes.iter().position(|c| c.slug == slug).unwrap_or_else(|| {
                self.causes.push(CauseTold::new(slug));
                self.causes.len() - 1
            });
            let cause = &mut self.causes[at];
            cause.add(diagnosis, hints, is_in_hidden(grade, &diagnosis.subject));
            if !cause.items.contains(&item.title.as_str()) {
                cause.items.push(&item.title);
            }
            if !numbers.contains(&at) {
                numbers.push(at);
            }
        }
        numbers
    }
}

impl<'a> CauseTold<'a> {
    fn new(slug: &'a str) -> Self {
        Self { slug, statements: Vec::new(), items: Vec::new(), repair: None, evidence: Vec::new() }
    }

    fn add(&mut self, found: &'a Diagnosis, hints: Hints, in_hidden: bool) {
        match self.statements.iter_mut().find(|(statement, _)| *statement == found.statement) {
            Some((_, subjects)) if subjects.contains(&found.subject.as_str()) => {}
            Some((_, subjects)) => subjects.push(&found.subject),
            None => self.statements.push((&found.statement, vec![&found.subject])),
        }
        if hints < Hints::Full {
            return;
        }
        self.repair = self.repair.or(found.repair.as_deref());
        // What speaks for a cause names directions, and these may be of hidden items.
        if self.evidence.is_empty() && !in_hidden {
            self.evidence = found.evidence.iter().map(String::as_str).collect();
        }
    }
}

/// Whether a hidden item lost something on a subject.
fn is_in_hidden(grade: &Grade, subject: &str) -> bool {
    grade.items.iter().filter(|i| i.hidden).any(|i| i.lost.iter().any(|l| l.subject == subject))
}

fn lost_item<'a>(grade: &'a Grade, item: &'a ItemGrade) -> LostItem<'a> {
    let hints = if item.hidden { Hints::None } else { item.hints };
    let told = hints >= Hints::Region;
    let unmet = item.unmet.as_deref().map(|id| {
        let needed = grade.items.iter().find(|i| i.id == id);
        needed.map_or(id, |needed| needed.title.as_str())
    });
    let measured = grade.broken.is_none() || item.cases == 0;
    // What the text says of is not known to be wrong.
    let is_wrong = measured && (unmet.is_none() || item.passed < item.cases || item.hidden);
    let told_item = ItemTold::of(item);
    LostItem {
        item: ItemTold { text: told_item.text.filter(|_| is_wrong), ..told_item },
        hints,
        is_measured: measured,
        unmet,
        count: (told && measured && item.cases > 0).then(|| {
            format!("{} of {} case{} passed", item.passed, item.cases, if item.cases == 1 { "" } else { "s" })
        }),
        found: if told { found::by_check(&item.lost) } else { Vec::new() },
        causes: Vec::new(),
    }
}

/// What does not build first, then what costs most; what was not scored for want of
/// another item after what has to be mended before, and a bonus last.
fn rank(item: &ItemGrade) -> (bool, bool, bool, Reverse<u64>) {
    let measures = item.cases > 0 || !item.lost.is_empty() || item.hidden;
    // Thousandths are enough to tell points apart.
    let cost = (1e3 * missing(&ItemTold::of(item))).max(0.0) as u64;
    (item.kind == ItemKind::Bonus, item.unmet.is_some(), measures, Reverse(cost))
}

/// What was tried, soberly.
fn incident(incident: &Incident) -> String {
    let Incident { phase, what, times } = incident;
    let when = match phase {
        Phase::Build => "while it was built",
        Phase::Run => "while it was measured",
    };
    let often = if *times > 1 { format!(" ({times} times)") } else { String::new() };
    format!("{when}: {what}{often}")
}

/// The first and the last lines.
pub fn bounded(said: &str) -> String {
    let shown = visible(said.trim_end());
    let cut = |line: &str| match line.chars().count() > LONGEST_LINE {
        true => line.chars().take(LONGEST_LINE).chain(['…']).collect(),
        false => line.to_string(),
    };
    let lines: Vec<String> = shown.lines().map(cut).collect();
    match lines.len().checked_sub(FIRST_LINES + LAST_LINES) {
        None | Some(0) => lines.join("\n"),
        Some(left) => {
            let (first, last) = (&lines[..FIRST_LINES], &lines[lines.len() - LAST_LINES..]);
            format!("{}\n… {left} lines are left out …\n{}", first.join("\n"), last.join("\n"))
        }
    }
}

/// `a` and `b`, as a sentence has them.
pub fn titles(titles: &[&str]) -> String {
    let quoted: Vec<String> = titles.iter().map(|t| format!("“{t}”")).collect();
    listed(&quoted.iter().map(String::as_str).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::super::examples::{diagnosis, grade, hidden_item, item, lost};
    use super::*;

    fn ids<'a>(feedback: &Feedback<'a>) -> Vec<&'a str> {
        feedback.lost.iter().map(|l| l.item.id).collect()
    }

    #[test]
    fn what_matters_comes_first() {
        let all = [
            ("bonus", ItemKind::Bonus, 9.0, 1, false),
            ("small", ItemKind::Regular, 1.0, 4, false),
            ("needs", ItemKind::Regular, 5.0, 4, true),
            ("large", ItemKind::Regular, 3.0, 4, false),
            ("builds", ItemKind::Regular, 0.5, 0, false),
        ];
        let made = all.map(|(id, kind, points, cases, unmet)| ItemGrade {
            kind,
            cases,
            passed: 0,
            unmet: unmet.then(|| "builds".into()),
            ..item(id, points)
        });
        let grade = Grade { items: made.into(), ..grade() };
        let feedback = Feedback::of(&grade, "");
        assert_eq!(ids(&feedback), ["builds", "large", "small", "needs", "bonus"]);
        assert_eq!(feedback.lost[3].unmet, Some("Title of builds"));
    }

    #[test]
    fn hints_say_how_much_is_told() {
        for (hints, found, causes, repair) in [
            (Hints::None, 0, 0, false),
            (Hints::Region, 1, 0, false),
            (Hints::Cause, 1, 1, false),
            (Hints::Full, 1, 1, true),
        ] {
            let item =
                ItemGrade { hints, lost: vec![lost("metal", "normalization", 30.0)], ..item("a", 2.0) };
            let grade = Grade { items: vec![item], diagnoses: vec![diagnosis("metal")], ..grade() };
            let feedback = Feedback::of(&grade, "");
            assert_eq!((feedback.lost[0].found.len(), feedback.causes.len()), (found, causes), "{hints:?}");
            let told = feedback.causes.first().is_some_and(|c| c.repair.is_some() && !c.evidence.is_empty());
            assert_eq!(told, repair, "{hints:?}");
        }
    }

    #[test]
    fn causes_of_hidden_failures_stay_hidden() {
        let shown = ItemGrade {
            hints: Hints::Full,
            lost: vec![lost("metal", "normalization", 30.0)],
            ..item("a", 2.0)
        };
        let grade = Grade {
            items: vec![shown, hidden_item("b", "secret"), hidden_item("c", "metal")],
            diagnoses: vec![
                diagnosis("metal"),
                Diagnosis { cause: Some("masking".into()), ..diagnosis("secret") },
            ],
            ..grade()
        };
        let feedback = Feedback::of(&grade, "");
        let slugs: Vec<&str> = feedback.causes.iter().map(|c| c.slug).collect();
        assert_eq!(slugs, ["half-vector-jacobian"]);
        assert!(feedback.causes[0].repair.is_some() && feedback.causes[0].evidence.is_empty());
        assert!(
            feedback.lost.iter().filter(|l| l.item.hidden).all(|l| l.found.is_empty() && l.count.is_none())
        );
    }

    #[test]
    fn a_cause_is_told_once_for_all_it_costs() {
        let with = |id: &str, subject: &str| ItemGrade {
            lost: vec![lost(subject, "normalization", 30.0)],
            ..item(id, 2.0)
        };
        let grade = Grade {
            items: vec![with("a", "metal:alpha=0.1"), with("b", "metal:alpha=0.5")],
            diagnoses: vec![diagnosis("metal:alpha=0.1"), diagnosis("metal:alpha=0.5")],
            ..grade()
        };
        let feedback = Feedback::of(&grade, "");
        assert_eq!(feedback.causes.len(), 1);
        let cause = &feedback.causes[0];
        assert_eq!(cause.statements.len(), 1);
        assert_eq!(cause.statements[0].1, ["metal:alpha=0.1", "metal:alpha=0.5"]);
        assert_eq!(titles(&cause.items), "“Title of a” and “Title of b”");
        assert!(cause.known().is_some() && cause.address().unwrap().starts_with("https://"));
    }

    #[test]
    fn texts_on_a_loss_are_told_where_something_is_wrong() {
        let of = |item: ItemGrade, broken: bool| {
            let broken = broken.then(|| Broken { why: "w".into(), said: String::new() });
            let grade = Grade { items: vec![item], broken, ..grade() };
            let feedback = Feedback::of(&grade, "");
            (feedback.lost[0].item.text.is_some(), feedback.lost[0].count.is_some())
        };
        assert_eq!(of(item("a", 1.0), false), (true, true));
        assert_eq!(of(item("a", 1.0), true), (false, false), "nobody measured that it is wrong");
        assert_eq!(of(ItemGrade { cases: 0, passed: 0, ..item("builds", 1.0) }, true), (true, false));
        let unmet = ItemGrade { unmet: Some("b".into()), passed: 6, ..item("a", 1.0) };
        assert_eq!(of(unmet.clone(), false), (false, true), "all of its cases passed");
        assert_eq!(of(ItemGrade { passed: 5, ..unmet }, false), (true, true));
    }

    #[test]
    fn a_compiler_is_heard_first_and_last() {
        let long: Vec<String> = (0..1000).map(|k| format!("error {k}")).collect();
        let shown = bounded(&long.join("\n"));
        assert!(shown.starts_with("error 0\n") && shown.ends_with("error 999"));
        assert!(shown.contains("error 39\n… 950 lines are left out …\nerror 990\n"), "{shown}");
        assert_eq!(bounded(&"x".repeat(100_000)).chars().count(), LONGEST_LINE + 1);
        assert_eq!(bounded("\u{1b}[31mred\u{202e}"), "␛[31mred\u{fffd}");
    }
}
