//! How subjects are called on a page, and in its links.

use super::super::json::SubjectId;

/// Characters of an anchor's readable part at most.
const READABLE: usize = 60;

/// What a subject's section is called in links. It depends on nothing but how the
/// subject is named, so that a link holds in the next run.
pub fn anchor(subject: &SubjectId) -> String {
    let whole = match &subject.label {
        Some(label) => format!("{label} {}", subject.name),
        None => subject.name.clone(),
    };
    let tame = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || ".-_".contains(c);
    if whole.chars().all(tame) && !whole.contains("--") && whole.len() <= READABLE {
        return format!("s-{whole}");
    }
    let words = whole.split(|c: char| !c.is_ascii_alphanumeric() && c != '.');
    let words: Vec<&str> = words.filter(|w| !w.is_empty()).collect();
    let readable: String = words.join("-").to_ascii_lowercase().chars().take(READABLE).collect();
    // Names that differ in other characters only are told apart by their digest.
    let digest = blake3::hash(whole.as_bytes()).to_hex();
    format!("s-{}-{}", readable.trim_end_matches('-'), &digest[..8])
}

/// What a check's part of a section is called.
pub fn check_anchor(section: &str, check: &str) -> String {
    let tame: String = check.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    format!("{section}--{tame}")
}

/// A name before its parameters, and these one by one, with their commas.
pub fn parts(name: &str) -> (&str, Vec<&str>) {
    match name.split_once(':') {
        Some((base, rest)) => (base, rest.split_inclusive(',').collect()),
        None => (name, Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Claims;
    use crate::registry::Parameters;

    fn subject(name: &str, label: Option<&str>) -> SubjectId {
        SubjectId {
            name: name.into(),
            label: label.map(Into::into),
            parameters: Parameters::default(),
            claims: Claims::default(),
        }
    }

    #[test]
    fn anchors_are_readable_distinct_and_tame() {
        assert_eq!(anchor(&subject("lambert", None)), "s-lambert");
        let names = ["a:b=1", "a:b=2", "a b 1", "a-b-1", "A", "a", "a--b", "<script>", "\"><img>", ""];
        let labels = [None, Some("a"), Some("a b")];
        let mut anchors: Vec<String> =
            names.iter().flat_map(|name| labels.map(|label| anchor(&subject(name, label)))).collect();
        let tame = |a: &String| a.chars().all(|c| c.is_ascii_alphanumeric() || "-._".contains(c));
        assert!(anchors.iter().all(tame), "{anchors:?}");
        assert!(anchors.iter().all(|a| !a.contains("--")), "the mark between section and check: {anchors:?}");
        anchors.sort();
        let all = anchors.len();
        anchors.dedup();
        assert_eq!(anchors.len(), all, "{anchors:?}");
    }

    #[test]
    fn names_break_between_parameters() {
        assert_eq!(parts("a:b=1,c=2"), ("a", vec!["b=1,", "c=2"]));
        assert_eq!(parts("a"), ("a", vec![]));
    }
}
