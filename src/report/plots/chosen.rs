//! Which pictures a report has, and where they are.

use super::super::saved::{FileError, write_whole};
use super::histogram;
use super::pictures::{of_case, of_subject};
use crate::diagnosis::Profile;
use crate::evidence::Evidence;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A case as pictures need it: everything is in its saved evidence, but for
/// what is said of it.
#[derive(Clone, Copy)]
pub struct Pictured<'a> {
    /// Number of the case in the plan.
    pub index: usize,
    /// The suite's entry that it belongs to.
    pub group: &'a str,
    /// What was measured.
    pub evidence: &'a Evidence,
    /// Whether a check failed, could not decide, or has a warning.
    pub suspicious: bool,
    /// √D of goodness-of-fit.
    pub root_d: Option<f64>,
    /// What was counted and predicted for the diagnosis of its subject, in this case or
    /// in another one.
    pub diagnosed: Option<&'a Profile>,
}

/// Which cases have pictures of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Which {
    /// Suspicious ones, and of each subject the one nearest to grazing.
    #[default]
    Telling,
    /// Every one.
    All,
}

/// Writes the pictures into the report's folder. Returns the path of each
/// pictured case from there, by the case's number.
pub fn draw(
    report_dir: &Path,
    cases: &[Pictured],
    p_values: &[f64],
    which: Which,
) -> Result<BTreeMap<usize, String>, FileError> {
    let draw_case = |case: &&Pictured| {
        let mut first = None;
        for picture in of_case(case, cases, |_| true) {
            let path = picture.kind.of_case(case.index);
            write_whole(&report_dir.join(&path), picture.svg.as_bytes())?;
            // The discs are a case's picture; where there are none, the next kind is.
            first.get_or_insert(path);
        }
        Ok(first.map(|path| (case.index, path)))
    };
    let drawn: Vec<Option<(usize, String)>> =
        chosen(cases, which).par_iter().map(draw_case).collect::<Result<_, FileError>>()?;
    let mut names = BTreeSet::new();
    for ((group, subject), of_group) in by_subject(cases) {
        let pictures = of_subject(subject, &of_group);
        if pictures.is_empty() {
            continue;
        }
        // A row is mostly named as its subjects' model is.
        let text = if subject.starts_with(group) { subject.into() } else { format!("{group} {subject}") };
        let name = file_name(&text, &mut names);
        for picture in pictures {
            let path = format!("plots/{}-{name}.svg", picture.kind.word());
            write_whole(&report_dir.join(path), picture.svg.as_bytes())?;
        }
    }
    if let Some(svg) = histogram::p_values(p_values) {
        write_whole(&report_dir.join("plots/p-values.svg"), svg.as_bytes())?;
    }
    Ok(drawn.into_iter().flatten().collect())
}

/// The cases that are drawn, in their order.
fn chosen<'a, 'b>(cases: &'b [Pictured<'a>], which: Which) -> Vec<&'b Pictured<'a>> {
    // θ from the normal of either side: 91° is as grazing as 89°.
    let grazing = |case: &Pictured| -case.evidence.wo.abs_cos_theta();
    let mut of_group: BTreeMap<&str, &Pictured> = BTreeMap::new();
    for case in cases {
        let best = of_group.entry(case.group).or_insert(case);
        if grazing(case) > grazing(best) {
            *best = case;
        }
    }
    let representative = |case: &Pictured| of_group.get(case.group).is_some_and(|c| c.index == case.index);
    cases.iter().filter(|c| which == Which::All || c.suspicious || representative(c)).collect()
}

/// The evidence of each subject within a group, as a curve against θ needs it.
fn by_subject<'a>(cases: &[Pictured<'a>]) -> BTreeMap<(&'a str, &'a str), Vec<&'a Evidence>> {
    let mut subjects: BTreeMap<(&str, &str), Vec<&Evidence>> = BTreeMap::new();
    for case in cases {
        subjects.entry((case.group, &case.evidence.subject)).or_default().push(case.evidence);
    }
    subjects
}

/// A name that any file system takes, and that no other has.
pub fn file_name(text: &str, taken: &mut BTreeSet<String>) -> String {
    let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.').collect();
    let kept: Vec<&str> = words.into_iter().filter(|w| !w.trim_matches('.').is_empty()).collect();
    let base: String = kept.join("-").to_ascii_lowercase().chars().take(80).collect();
    let mut name = base.clone();
    for k in 2.. {
        if taken.insert(name.clone()) {
            break;
        }
        name = format!("{base}-{k}");
    }
    name
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{Lobe, evidence};
    use super::*;

    fn cases() -> Vec<Evidence> {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let at = |theta| evidence("ggx:alpha=0.5", theta, 17.0, lobe, lobe);
        let mut all: Vec<Evidence> = [0.0, 85.0, 60.0].map(at).into();
        all[0].pairs = None;
        all[2].pairs = None;
        all
    }

    fn pictured(cases: &[Evidence]) -> Vec<Pictured<'_>> {
        cases
            .iter()
            .enumerate()
            .map(|(index, evidence)| Pictured {
                index,
                group: "ggx:alpha=0.5",
                evidence,
                suspicious: index == 2,
                root_d: None,
                diagnosed: None,
            })
            .collect()
    }

    fn files(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder.join("plots")).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn draws_suspicious_cases_and_the_most_grazing() {
        let folder = tempfile::tempdir().unwrap();
        let evidence = cases();
        let paths = draw(folder.path(), &pictured(&evidence), &[0.1, 0.7], Which::Telling).unwrap();
        assert_eq!(paths.keys().copied().collect::<Vec<_>>(), [1, 2]);
        assert_eq!(paths[&2], "plots/case-0002.svg");
        let expected = [
            "albedo-ggx-alpha-0.5.svg",
            "case-0001-azimuth.svg",
            "case-0001-lobe.svg",
            "case-0001-plane.svg",
            "case-0001-reciprocity.svg",
            "case-0001.svg",
            "case-0002-azimuth.svg",
            "case-0002-lobe.svg",
            "case-0002-plane.svg",
            "case-0002.svg",
            "furnace-ggx-alpha-0.5.svg",
            "p-values.svg",
        ];
        assert_eq!(files(folder.path()), expected);
    }

    #[test]
    fn draws_all_if_asked() {
        let folder = tempfile::tempdir().unwrap();
        let evidence = cases();
        let paths = draw(folder.path(), &pictured(&evidence), &[], Which::All).unwrap();
        assert_eq!(paths.len(), 3);
        assert!(!files(folder.path()).contains(&"p-values.svg".to_string()));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_an_error_with_its_path() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("plots"), "a file").unwrap();
        let error = draw(folder.path(), &[], &[0.5], Which::All).unwrap_err();
        assert!(error.to_string().contains("p-values.svg"), "{error}");
    }

    #[test]
    fn file_names_are_tame_and_distinct() {
        let mut taken = BTreeSet::new();
        let mut name = |text| file_name(text, &mut taken);
        assert_eq!(name("../ggx:alpha=0.5"), "ggx-alpha-0.5");
        assert_eq!(name("ggx:alpha=0.5"), "ggx-alpha-0.5-2");
        assert_eq!(name("/*"), "");
    }
}
