//! The pictures of a subject as parts of a page.

use super::super::plots::{Kind, Pictured, diagnosis_picture, pictures_of_case, pictures_of_subject};
use super::subject::{Subject, is_telling};
use crate::evidence::Evidence;

/// A picture within a page.
pub struct Picture {
    /// SVG.
    pub svg: String,
    /// Whether it stands for the discs where no script draws them.
    pub stands_for_discs: bool,
}

/// The counts over pdf() of a diagnosis.
pub fn of_diagnosis(subject: &Subject) -> Option<String> {
    let found = subject.found?;
    Some(inline(diagnosis_picture(&found.subject, found.profile.as_ref()?)))
}

/// What is drawn of the cases that were read, by their number: of the first what its
/// section has no better picture of, of pairs the case in which they are worst if they
/// are wrong, and curves over all if `all` were read.
pub fn of_cases(subject: &Subject, read: &[(usize, Evidence)], all: bool) -> Vec<Picture> {
    let profile = subject.found.and_then(|found| found.profile.as_ref());
    let cases: Vec<Pictured> = read
        .iter()
        .map(|(number, evidence)| Pictured {
            index: *number,
            group: "",
            evidence,
            suspicious: is_telling(subject.cases[*number].verdict),
            root_d: subject.cases[*number].root_d,
            diagnosed: profile,
        })
        .collect();
    let of = |number: Option<usize>, wanted: &dyn Fn(Kind) -> bool| {
        let case = cases.iter().find(|case| Some(case.index) == number);
        case.map_or(Vec::new(), |case| pictures_of_case(case, &cases, wanted))
    };
    let asymmetric = subject.checks.iter().find(|c| c.id == "reciprocity" && is_telling(c.verdict));
    let path = asymmetric.and_then(|check| check.results[0].evidence.as_deref());
    let worst_pairs = path.and_then(|path| subject.cases.iter().position(|c| c.evidence == Some(path)));
    let mut drawn = of(subject.first_case(), &|kind| match kind {
        // What passes is unpacked by the script that draws them.
        Kind::Discs => is_telling(subject.verdict),
        // The picture of the diagnosis has it already.
        Kind::Plane => profile.is_none(),
        Kind::Reciprocity => false,
        _ => true,
    });
    drawn.extend(of(worst_pairs, &|kind| kind == Kind::Reciprocity));
    if all && read.len() > 1 {
        let every: Vec<&Evidence> = read.iter().map(|(_, e)| e).collect();
        drawn.extend(pictures_of_subject(&subject.id.name, &every));
    }
    drawn
        .into_iter()
        .map(|picture| Picture { stands_for_discs: picture.kind == Kind::Discs, svg: inline(picture.svg) })
        .collect()
}

/// Without what a page's policy of styles forbids; the page's own style says it.
pub fn inline(svg: String) -> String {
    svg.replace(" style=\"image-rendering:pixelated\"", "")
}
