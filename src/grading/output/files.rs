//! Where files of grades lie, from the folder of all grades.

use std::fmt::Write;

/// Characters of a name at most, its digest aside.
const LONGEST: usize = 100;

/// The name of the file or folder of a submission or an item: what it is called where any
/// file system takes that, else what is tame of it, told apart by a digest.
pub fn file_name(id: &str) -> String {
    let tame = |c: char| c.is_alphanumeric() || "-_.@ ".contains(c);
    let is_plain = id.chars().all(tame) && id.chars().count() <= LONGEST && id.trim() == id;
    if is_plain && !id.starts_with('.') && !id.is_empty() {
        return id.into();
    }
    let kept: String = id.chars().map(|c| if tame(c) { c } else { '_' }).take(LONGEST).collect();
    format!("{}~{}", kept.trim().trim_start_matches('.'), &blake3::hash(id.as_bytes()).to_hex()[..8])
}

/// A path as a link has it.
pub fn link(path: &str) -> String {
    let mut link = String::new();
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => {
                link.push(byte.into())
            }
            _ => write!(link, "%{byte:02X}").expect("a string takes every text"),
        }
    }
    link
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
        for id in ["s-12_a.b", "Zoë Müller", "a@b.org"] {
            assert_eq!(file_name(id), id);
        }
        let ids = ["..", ".", "", "a/b", "a\\b", "a_b~1", "../../etc", "a\0b", "CON~", " a", "a\nb"];
        let mut names: Vec<String> = ids.iter().map(|id| file_name(id)).collect();
        names.push(file_name(&"x".repeat(300)));
        for name in &names {
            assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.~".contains(c)), "{name}");
            assert!(!name.starts_with('.') && name.contains('~') && name.len() <= 109, "{name}");
        }
        names.sort();
        names.dedup();
        assert_eq!(names.len(), ids.len() + 1);
    }

    #[test]
    fn links_have_no_spaces() {
        assert_eq!(link("feedback/a b@ë~1.html"), "feedback/a%20b%40%C3%AB~1.html");
    }
}
