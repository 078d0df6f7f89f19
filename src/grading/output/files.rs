//! Where files of grades lie, from the folder of all grades.

/// Characters of a name at most, its digest aside.
const LONGEST: usize = 80;

/// The name of the file or folder of a submission or an item: what it is called where any
/// file system takes that, else what is tame of it, told apart by a digest.
pub fn file_name(id: &str) -> String {
    let tame = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let plain = id.chars().all(tame) && !id.starts_with('.') && !id.is_empty() && id.len() <= LONGEST;
    if plain {
        return id.into();
    }
    let kept: String = id.chars().map(|c| if tame(c) { c } else { '_' }).take(LONGEST).collect();
    format!("{}~{}", kept.trim_start_matches('.'), &blake3::hash(id.as_bytes()).to_hex()[..8])
}

/// The student's page.
pub fn feedback_page(id: &str) -> String {
    format!("feedback/{}.html", file_name(id))
}

/// The same in Markdown.
pub fn feedback_text(id: &str) -> String {
    format!("feedback/{}.md", file_name(id))
}

/// Everything behind the lost points of a submission.
pub fn appeals(id: &str) -> String {
    format!("appeals/{}", file_name(id))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_tame_and_distinct() {
        assert_eq!(file_name("s-12_a.b"), "s-12_a.b");
        let ids = ["..", ".", "", "a/b", "a\\b", "a_b~1", "../../etc", "Zoë", "a b", "a\0b", "CON~"];
        let mut names: Vec<String> = ids.iter().map(|id| file_name(id)).collect();
        names.push(file_name(&"x".repeat(300)));
        for name in &names {
            assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.~".contains(c)), "{name}");
            assert!(!name.starts_with('.') && name.contains('~') && name.len() <= 89, "{name}");
        }
        names.sort();
        names.dedup();
        assert_eq!(names.len(), ids.len() + 1);
    }
}
