//! The pictures of a feedback: of each lost item the most telling one.

use super::super::{Hints, Lost};
use super::feedback::{Feedback, LostItem};
use super::found::Found;
use crate::bsdf::Direction;
use crate::diagnosis::Profile;
use crate::evidence::Evidence;
use crate::report::{
    Diagnosis, Kind, Picture, Pictured, Report, WoAngles, diagnosis_picture, pictures_of_case,
    pictures_of_subject, read_evidence,
};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Pictures of a page at most: those of what costs most.
const MOST: usize = 4;

/// Directions that a curve over θ is drawn of, and no fewer: one point is no curve.
const CURVE: std::ops::RangeInclusive<usize> = 3..=8;

/// A picture with what it shows.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What it is of.
    pub title: String,
    /// A whole SVG document.
    pub svg: String,
}

/// The pictures of a feedback.
#[derive(Clone, Debug, Default)]
pub struct Drawn {
    /// By the id of the item.
    pub items: BTreeMap<String, Shown>,
    /// By the slug of the cause.
    pub causes: BTreeMap<String, Shown>,
    /// Evidence that could not be read: the first, and why.
    pub unread: Option<String>,
}

/// The kinds that tell most of a check, the best first.
pub fn telling(check: &str) -> &'static [Kind] {
    use Kind::{Albedo, Azimuth, Discs, Furnace, Lobe, Plane, Reciprocity, Weights};
    match check {
        "normalization" | "jacobian" | "returned-pdf" => &[Plane, Discs, Lobe],
        "weight" | "mis" => &[Weights, Discs, Lobe],
        "albedo" => &[Albedo, Weights, Discs],
        "energy" | "white-furnace" => &[Furnace, Lobe],
        "reciprocity" => &[Reciprocity, Lobe],
        "isotropy" => &[Azimuth, Discs, Lobe],
        "reference" | "fresnel" | "sensitivity" => &[Lobe, Discs],
        _ => &[Discs, Plane, Lobe],
    }
}

/// Draws them from what was measured in the submission's folder.
pub fn drawn(desk: &mut Desk, report: Option<&Report>, feedback: &Feedback) -> Drawn {
    let mut drawn = Drawn::default();
    let mut left = MOST;
    let diagnoses = report.map_or(&[][..], |report| &report.diagnoses);
    for (number, cause) in feedback.causes.iter().enumerate() {
        let lost = feedback.lost.iter().filter(|lost| lost.causes.contains(&number));
        let counted =
            lost.flat_map(|l| &l.found).find_map(|found| counted(found, diagnoses, Some(cause.slug)));
        if let Some((subject, profile)) = counted.filter(|_| left > 0) {
            let title = format!("{subject}: samples over pdf, and what the cause predicts");
            let svg = diagnosis_picture(subject, profile);
            drawn.causes.insert(cause.slug.into(), Shown { title, svg });
            left -= 1;
        }
    }
    let mut seen = BTreeSet::new();
    for lost in feedback.lost.iter().filter(|l| !l.found.is_empty()) {
        if left == 0 {
            break;
        }
        if let Some((shown, key)) = desk.of_item(lost, diagnoses).filter(|(_, key)| !seen.contains(key)) {
            seen.insert(key);
            drawn.items.insert(lost.item.id.into(), shown);
            left -= 1;
        }
    }
    drawn.unread.clone_from(&desk.unread);
    drawn
}

/// The counts of a diagnosis of a subject that a check shows, at a direction that it shows.
fn counted<'a>(
    found: &Found,
    diagnoses: &'a [Diagnosis],
    slug: Option<&str>,
) -> Option<(&'a str, &'a Profile)> {
    let of_cause = diagnoses.iter().filter(|d| slug.is_none() || d.cause.as_deref() == slug);
    of_cause.filter_map(|d| Some((d.subject.as_str(), d.profile.as_ref()?))).find(|(subject, profile)| {
        let shown = found.all.iter().filter(|lost| lost.subject == *subject).filter_map(|lost| lost.wo);
        let angle = |wo: WoAngles| {
            Direction::from_angles(wo.theta_deg.to_radians(), wo.phi_deg.to_radians()).angle(profile.wo)
        };
        shown.into_iter().any(|wo| angle(wo) < 1e-6)
    })
}

/// Tells pictures apart: the file and what is drawn of it.
type Key = (String, Kind);

/// Evidence at hand, and what was drawn of it: what several items show is drawn once.
pub struct Desk<'a> {
    measured: &'a Path,
    cases: BTreeMap<(Key, bool, bool), Option<Picture>>,
    read: BTreeMap<String, Option<Evidence>>,
    unread: Option<String>,
}

impl<'a> Desk<'a> {
    /// Of the submission that was measured in this folder.
    pub fn new(measured: &'a Path) -> Self {
        Self { measured, cases: BTreeMap::new(), read: BTreeMap::new(), unread: None }
    }

    /// Reads evidence once; what cannot be read is remembered.
    fn read(&mut self, path: &str) -> Option<&Evidence> {
        if !self.read.contains_key(path) {
            let evidence = match is_below(path) {
                true => read_evidence(&self.measured.join(path)).map_err(|e| {
                    // The folder is another on the reader's machine.
                    e.to_string().replace(&format!("{}/", self.measured.display()), "")
                }),
                false => Err(format!("{path}: evidence lies in evidence/")),
            };
            let evidence = evidence.map_err(|why| self.unread.get_or_insert(why)).ok();
            self.read.insert(path.into(), evidence);
        }
        self.read.get(path)?.as_ref()
    }

    fn of_item(&mut self, lost: &LostItem, diagnoses: &[Diagnosis]) -> Option<(Shown, Key)> {
        // A prediction tells the cause.
        let told = if lost.hints >= Hints::Cause { diagnoses } else { &[] };
        lost.found.iter().find_map(|found| {
            let profile =
                counted(found, told, None).filter(|(subject, _)| *subject == found.clearest.subject);
            self.of_check(found, profile.map(|p| p.1))
        })
    }

    fn of_check(&mut self, found: &Found, profile: Option<&Profile>) -> Option<(Shown, Key)> {
        let path = found.clearest.evidence.as_deref()?;
        telling(found.check).iter().find_map(|kind| {
            let (picture, at) = match kind {
                Kind::Albedo | Kind::Furnace => (self.curve(found, *kind)?, found.clearest.subject.clone()),
                kind => (self.case(found.clearest, profile, *kind)?, found.at.clone()),
            };
            let shown = Shown { title: format!("{}: {at}", picture.title), svg: picture.svg };
            Some((shown, (path.to_string(), *kind)))
        })
    }

    /// A picture of a case.
    pub fn case(&mut self, lost: &Lost, profile: Option<&Profile>, kind: Kind) -> Option<Picture> {
        let path = lost.evidence.as_deref()?;
        let fit = lost.effect.as_ref().filter(|_| lost.check == "goodness-of-fit");
        let key = ((path.to_string(), kind), fit.is_some(), profile.is_some());
        if let Some(picture) = self.cases.get(&key) {
            return picture.clone();
        }
        let case = Pictured {
            index: 0,
            group: "",
            evidence: self.read(path)?,
            suspicious: true,
            root_d: fit.map(|e| e.value.0),
            diagnosed: profile,
        };
        let picture = pictures_of_case(&case, &[case], |k| k == kind).pop();
        self.cases.insert(key, picture.clone());
        picture
    }

    /// A curve over the directions at which a check fails for the subject where it is clearest.
    fn curve(&mut self, found: &Found, kind: Kind) -> Option<Picture> {
        let subject = &found.clearest.subject;
        let mut paths: Vec<&str> = Vec::new();
        for path in found.all.iter().filter(|l| l.subject == *subject).filter_map(|l| l.evidence.as_deref()) {
            if !paths.contains(&path) {
                paths.push(path);
            }
        }
        paths.truncate(*CURVE.end());
        for path in &paths {
            self.read(path)?;
        }
        let evidence: Vec<&Evidence> = paths.iter().filter_map(|p| self.read[*p].as_ref()).collect();
        if evidence.len() < *CURVE.start() {
            return None;
        }
        pictures_of_subject(subject, &evidence).into_iter().find(|p| p.kind == kind)
    }
}

/// The path of evidence that a grade names: never one outside of its folder.
pub fn is_below(path: &str) -> bool {
    let name = path.strip_prefix("evidence/").and_then(|p| p.strip_suffix(".json.gz"));
    name.is_some_and(|n| !n.is_empty() && n.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)))
}

#[cfg(test)]
mod tests {
    use super::super::super::{Grade, Hints, ItemGrade};
    use super::super::examples::{diagnosis, evidence_in, grade, hidden_item, item, lost, report};
    use super::*;

    fn with(id: &str, points: f64, check: &str, evidence: &str) -> ItemGrade {
        let found = Lost { evidence: Some(evidence.into()), ..lost("metal", check, 60.0) };
        ItemGrade { hints: Hints::Region, lost: vec![found], ..item(id, points) }
    }

    #[test]
    fn what_costs_most_is_shown_and_the_same_picture_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = evidence_in(folder.path());
        let mut hidden = hidden_item("hidden", "metal");
        hidden.lost[0].evidence = Some(path.clone());
        let items = vec![
            with("a", 1.0, "goodness-of-fit", &path),
            with("b", 3.0, "normalization", &path),
            with("c", 2.0, "support", &path),
            hidden,
        ];
        let grade = Grade { items, diagnoses: vec![diagnosis("metal")], ..grade() };
        let drawn =
            drawn(&mut Desk::new(folder.path()), Some(&report(&["metal"])), &Feedback::of(&grade, ""));
        let ids: Vec<&str> = drawn.items.keys().map(String::as_str).collect();
        assert_eq!(ids, ["b", "c"], "a has the picture of c, and hidden items have none");
        assert!(drawn.items["b"].title.starts_with(Kind::Plane.title()), "{}", drawn.items["b"].title);
        assert!(drawn.items["c"].title.starts_with(Kind::Discs.title()), "{}", drawn.items["c"].title);
        assert!(drawn.causes.is_empty() && drawn.unread.is_none(), "hints tell the region only");
    }

    #[test]
    fn hints_decide_whether_there_is_any() {
        let folder = tempfile::tempdir().unwrap();
        let path = evidence_in(folder.path());
        let of = |hints| {
            let item = ItemGrade { hints, ..with("a", 1.0, "goodness-of-fit", &path) };
            let grade = Grade { items: vec![item], diagnoses: vec![diagnosis("metal")], ..grade() };
            let drawn =
                drawn(&mut Desk::new(folder.path()), Some(&report(&["metal"])), &Feedback::of(&grade, ""));
            (drawn.items.len(), drawn.causes.len())
        };
        assert_eq!([Hints::None, Hints::Region, Hints::Cause].map(of), [(0, 0), (1, 0), (1, 1)]);
    }

    #[test]
    fn counts_of_a_cause_are_of_directions_that_are_shown() {
        let of = |theta| {
            let item = ItemGrade { lost: vec![lost("metal", "normalization", theta)], ..item("a", 2.0) };
            let grade = Grade { items: vec![item], diagnoses: vec![diagnosis("metal")], ..grade() };
            let drawn = drawn(
                &mut Desk::new(Path::new("nowhere")),
                Some(&report(&["metal"])),
                &Feedback::of(&grade, ""),
            );
            drawn.causes.len()
        };
        assert_eq!((of(60.0), of(30.0)), (1, 0), "the counts of the example are of 60°");
    }

    #[test]
    fn evidence_that_is_not_there_costs_a_picture_and_no_page() {
        let folder = tempfile::tempdir().unwrap();
        for (path, why) in
            [("evidence/case-0001.json.gz", "failed to read evidence/"), ("../x.json.gz", "lies in")]
        {
            let grade = Grade { items: vec![with("a", 1.0, "mis", path)], ..grade() };
            let drawn =
                drawn(&mut Desk::new(folder.path()), Some(&report(&["metal"])), &Feedback::of(&grade, ""));
            assert!(drawn.items.is_empty());
            let told = drawn.unread.unwrap();
            assert!(told.contains(why) && !told.contains(&folder.path().display().to_string()), "{told}");
        }
    }
}
