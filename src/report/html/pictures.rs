//! The pictures of a subject as parts of a page.

use super::super::plots::{Caption, albedo_curve, disc_picture, ratio_picture, reciprocity_picture};
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
    Some(inline(ratio_picture(&found.subject, found.profile.as_ref()?)))
}

/// What is drawn of the cases that were read, by their number; `all` if that is every one.
pub fn of_cases(subject: &Subject, read: &[(usize, Evidence)], all: bool) -> Vec<Picture> {
    let mut pictures = Vec::new();
    let mut add = |svg: Option<String>, stands_for_discs| {
        pictures.extend(svg.map(|svg| Picture { svg: inline(svg), stands_for_discs }));
    };
    let evidence = |number: usize| read.iter().find(|(k, _)| *k == number).map(|(_, e)| e);
    let shown = subject.first_case().filter(|_| is_telling(subject.verdict));
    if let Some((number, first)) = shown.and_then(|k| Some((k, evidence(k)?))) {
        add(disc_picture(first, Caption { root_d: subject.cases[number].root_d }), true);
    }
    // Of pairs the case in which they are worst.
    let asymmetric = subject.checks.iter().find(|c| c.id == "reciprocity" && is_telling(c.verdict));
    let path = asymmetric.and_then(|check| check.results[0].evidence.as_deref());
    let number = path.and_then(|path| subject.cases.iter().position(|c| c.evidence == Some(path)));
    if let Some(worst) = number.and_then(evidence) {
        add(reciprocity_picture(worst), false);
    }
    if all && read.len() > 1 {
        let every: Vec<&Evidence> = read.iter().map(|(_, e)| e).collect();
        add(albedo_curve(&subject.id.name, &every), false);
    }
    pictures
}

/// Without what a page's policy of styles forbids; the page's own style says it.
fn inline(svg: String) -> String {
    svg.replace(" style=\"image-rendering:pixelated\"", "")
}
