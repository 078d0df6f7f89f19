//! What a check found within an item: where it fails, and how large the error is.

use super::super::Lost;
use crate::bsdf::Transport;
use crate::checks::{self, Verdict};
use crate::report::WoAngles;
use crate::report::wording::{self, tidy};

/// Places that are listed of a subject; of the others only their number.
const MOST_PLACES: usize = 8;

/// Subjects that are listed of a check.
const MOST_SUBJECTS: usize = 6;

/// A check that does not pass within an item, over all its cases.
#[derive(Clone, Debug)]
pub struct Found<'a> {
    /// Its id.
    pub check: &'a str,
    /// What must hold.
    pub hypothesis: Option<&'static str>,
    /// `fails`, `could not be measured`, …
    pub verb: &'static str,
    /// For each subject, the directions: `metal:alpha=0.1 at θo 30° and 60°, φo 17°`.
    pub places: Vec<String>,
    /// Where it is clearest.
    pub clearest: &'a Lost,
    /// Subject and direction of that.
    pub at: String,
    /// All of them, the clearest first.
    pub all: Vec<&'a Lost>,
}

impl Found<'_> {
    /// How large the error is, in words.
    pub fn effect(&self) -> Option<String> {
        self.clearest.effect.as_ref().map(wording::effect)
    }

    /// The worst place with its numbers.
    pub fn worst(&self) -> Option<String> {
        self.clearest.worst.as_ref().map(wording::worst)
    }
}

/// By check, the clearest first.
pub fn by_check(lost: &[Lost]) -> Vec<Found<'_>> {
    let mut groups: Vec<Vec<&Lost>> = Vec::new();
    for one in lost {
        match groups.iter_mut().find(|group| group[0].check == one.check) {
            Some(group) => group.push(one),
            None => groups.push(vec![one]),
        }
    }
    groups.iter_mut().for_each(|group| group.sort_by(|a, b| clearer(a, b)));
    groups.sort_by(|a, b| clearer(a[0], b[0]));
    groups.iter().map(|group| found(group)).collect()
}

/// The more serious first; of the same, the one farther beyond what is tolerated.
pub fn clearer(a: &Lost, b: &Lost) -> std::cmp::Ordering {
    let size = |l: &Lost| l.effect.as_ref().map_or(0.0, |e| (e.value.0 / e.tolerance.0).abs()).max(0.0);
    b.verdict.cmp(&a.verdict).then(size(b).total_cmp(&size(a)))
}

fn found<'a>(group: &[&'a Lost]) -> Found<'a> {
    let clearest = group[0];
    let mut subjects: Vec<&str> = Vec::new();
    for one in group {
        if !subjects.contains(&one.subject.as_str()) {
            subjects.push(&one.subject);
        }
    }
    let of = |subject: &&str| {
        let of_subject: Vec<&Lost> = group.iter().copied().filter(|l| l.subject == *subject).collect();
        place(subject, &of_subject)
    };
    let mut places: Vec<String> = subjects.iter().take(MOST_SUBJECTS).map(of).collect();
    if subjects.len() > MOST_SUBJECTS {
        places.push(format!("and {} more subjects", subjects.len() - MOST_SUBJECTS));
    }
    Found {
        check: &clearest.check,
        hypothesis: checks::find(&clearest.check).map(|check| check.hypothesis()),
        verb: verb(clearest.verdict),
        places,
        clearest,
        at: place(&clearest.subject, &[clearest]),
        all: group.to_vec(),
    }
}

/// What a check does that does not pass.
pub fn verb(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Fail => "fails",
        Verdict::Error => "could not be measured",
        Verdict::Skipped => "was not measured",
        Verdict::Inconclusive => "could not decide",
        Verdict::Warn => "finds another convention",
        Verdict::Pass | Verdict::Waived => "passes",
    }
}

fn place(subject: &str, lost: &[&Lost]) -> String {
    let importance = lost.iter().all(|l| l.transport == Transport::Importance);
    let mode = if importance { ", importance" } else { "" };
    let wos: Vec<WoAngles> = lost.iter().filter_map(|l| l.wo).collect();
    match wos.is_empty() {
        true => format!("{subject}{mode}"),
        false => format!("{subject} at {}{mode}", directions(wos)),
    }
}

/// `θo 30° and 60°, φo 17°`; where the azimuths differ each direction by itself.
fn directions(mut wos: Vec<WoAngles>) -> String {
    wos.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg).then(a.phi_deg.total_cmp(&b.phi_deg)));
    wos.dedup();
    let one_azimuth = wos.iter().all(|wo| wo.phi_deg == wos[0].phi_deg);
    let names: Vec<String> = match (one_azimuth, wos.len()) {
        (true, 1) | (false, _) => wos.iter().map(|wo| wording::direction(*wo)).collect(),
        (true, _) => wos.iter().map(|wo| format!("{}°", tidy(wo.theta_deg))).collect(),
    };
    let left = names.len().saturating_sub(MOST_PLACES);
    let mut shown: Vec<&str> = names.iter().take(MOST_PLACES).map(String::as_str).collect();
    let more = format!("{left} more");
    if left > 0 {
        shown.push(&more);
    }
    let list = listed(&shown);
    match one_azimuth && wos.len() > 1 {
        true => format!("θo {list}, φo {}°", tidy(wos[0].phi_deg)),
        false => list,
    }
}

/// `a, b and c`.
pub fn listed(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).into(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::examples::lost;
    use super::*;
    use crate::checks::Effect;

    #[test]
    fn directions_are_put_together() {
        let wo = |theta_deg, phi_deg| WoAngles { theta_deg, phi_deg };
        assert_eq!(directions(vec![wo(60.0, 17.0)]), "θo 60° φo 17°");
        assert_eq!(directions(vec![wo(60.0, 17.0), wo(30.0, 17.0)]), "θo 30° and 60°, φo 17°");
        assert_eq!(directions(vec![wo(60.0, 17.0), wo(60.0, 137.0)]), "θo 60° φo 17° and θo 60° φo 137°");
        let many: Vec<WoAngles> = (0..20).map(|k| wo(f64::from(k), 17.0)).collect();
        assert_eq!(directions(many), "θo 0°, 1°, 2°, 3°, 4°, 5°, 6°, 7° and 12 more, φo 17°");
    }

    #[test]
    fn checks_come_by_how_clear_they_are_and_subjects_stay_apart() {
        let sized = |subject: &str, check: &str, theta, size| Lost {
            effect: Some(Effect::exact("e", size, 0.01)),
            ..lost(subject, check, theta)
        };
        let crashed = Lost { verdict: Verdict::Error, ..lost("b", "energy", 30.0) };
        let all = [
            sized("a", "albedo", 30.0, 0.02),
            sized("a", "weight", 30.0, 0.5),
            sized("b", "weight", 60.0, 0.9),
            sized("a", "weight", 60.0, 0.7),
            crashed,
        ];
        let found = by_check(&all);
        let checks: Vec<_> = found.iter().map(|f| (f.check, f.verb)).collect();
        assert_eq!(checks, [("energy", "could not be measured"), ("weight", "fails"), ("albedo", "fails")]);
        assert_eq!(found[1].places, ["b at θo 60° φo 17°", "a at θo 30° and 60°, φo 17°"]);
        assert_eq!(found[1].at, "b at θo 60° φo 17°");
        assert_eq!(found[1].effect().unwrap(), "e = 90.00 %, tolerated 1.00 %");
        let many: Vec<Lost> = (0..9).map(|k| lost(&format!("s{k}"), "mis", 30.0)).collect();
        assert_eq!(by_check(&many)[0].places.last().unwrap(), "and 3 more subjects");
    }
}
