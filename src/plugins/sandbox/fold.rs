//! Long messages, shortened.

use crate::report::visible::visible;

/// `text` with at most about `most` bytes: its beginning, where compilers tell the first
/// mistake, and its end.
pub fn folded(text: &[u8], most: usize) -> String {
    let text = visible(&String::from_utf8_lossy(text));
    let text = text.trim();
    if text.len() <= most {
        return text.to_string();
    }
    let half = most / 2;
    let head = text.char_indices().take_while(|(k, _)| *k < half).last().map_or(0, |(k, c)| k + c.len_utf8());
    let tail = text.char_indices().rev().take_while(|(k, _)| *k > text.len() - half).last();
    format!("{}\n…\n{}", &text[..head], &text[tail.map_or(text.len(), |(k, _)| k)..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_kept() {
        assert_eq!(folded(b" short\n", 100), "short");
        let long: String = (0..1000).map(|k| format!("θ {k}\n")).collect();
        let folded = folded(long.as_bytes(), 100);
        assert!(folded.starts_with("θ 0\nθ 1\n") && folded.ends_with("θ 998\nθ 999"), "{folded}");
        assert!(folded.contains("\n…\n") && folded.len() < 120, "{folded}");
        assert_eq!(super::folded(&[0xff; 3], 100), "\u{fffd}".repeat(3));
    }
}
