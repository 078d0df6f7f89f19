//! Text within Markdown, as GitHub and GitLab render it.

use crate::report::visible::{one_line, visible};

/// Invisible, and the end of what looks like a name or an address.
const BREAK: char = '\u{200b}';

/// Text on one line that nothing in it can turn into HTML, emphasis, links, formulas or
/// cells; addresses stay addresses, and names names.
pub fn plain(content: &str) -> String {
    let mut escaped = String::new();
    for c in one_line(content).chars() {
        if r"\`*_[]<>&|~#$".contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// Text that nothing in it can turn into anything else: neither HTML nor emphasis, links,
/// mentions, references, formulas or cells.
pub fn text(content: &str) -> String {
    // Mentions are looked for after escapes are gone.
    let escaped = plain(content).replace('@', &format!("@{BREAK}"));
    let broken = |word: &str, at: usize| format!("{}{BREAK}{}", &word[..at], &word[at..]);
    escaped.replace("://", &broken("://", 1)).replace("www.", &broken("www.", 3))
}

/// The most backticks in a row.
fn backticks(content: &str) -> usize {
    content.split(|c| c != '`').map(str::len).max().unwrap_or(0)
}

/// As code within a line.
pub fn code(content: &str) -> String {
    let content = one_line(content);
    let fence = "`".repeat(backticks(&content) + 1);
    // A space is taken away at both ends where there is one at both.
    let space = if content.is_empty() || content.contains('`') { " " } else { "" };
    format!("{fence}{space}{content}{space}{fence}")
}

/// As code within a cell of a table, where `|` ends the cell even in code.
pub fn cell(content: &str) -> String {
    code(content).replace('|', "\\|")
}

/// As a block of code.
pub fn fenced(language: &str, content: &str) -> String {
    let fence = "`".repeat(backticks(content).max(2) + 1);
    format!("{fence}{language}\n{}\n{fence}", visible(content).trim_end_matches('\n'))
}

/// A part that stands or falls whole.
#[derive(Debug)]
pub struct Block {
    /// Without line ends around it.
    pub text: String,
    /// How many findings it tells.
    pub findings: usize,
}

impl Block {
    /// One that tells no finding.
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), findings: 0 }
    }

    /// One that tells a finding.
    pub fn finding(text: impl Into<String>) -> Self {
        Self { text: text.into(), findings: 1 }
    }
}

/// The whole.
pub fn joined(blocks: &[Block]) -> String {
    let mut text = blocks.iter().map(|b| b.text.as_str()).collect::<Vec<_>>().join("\n\n");
    text.push('\n');
    text
}

/// As many whole blocks as fit into so many bytes, and what was left out then. `all` is
/// where everything is.
pub fn cut(blocks: &[Block], bytes: usize, all: &str) -> String {
    let whole = joined(blocks);
    if whole.len() <= bytes {
        return whole;
    }
    let closing = |from: usize| {
        let findings: usize = blocks[from..].iter().map(|b| b.findings).sum();
        let what = if findings == 1 { "1 finding is".into() } else { format!("{findings} findings are") };
        format!("{what} left out here, for want of room: {} has all.\n", code(all))
    };
    let mut text = String::new();
    for (k, block) in blocks.iter().enumerate() {
        let longer = text.len() + block.text.len() + "\n\n".len();
        if longer + closing(k + 1).len() > bytes {
            text += &closing(k);
            break;
        }
        text += &block.text;
        text += "\n\n";
    }
    if text.len() <= bytes { text } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        assert_eq!(
            text("a|b <i>&amp; `c` *d* _e_ [f](g) #1 $h$ ~i~ \\"),
            r"a\|b \<i\>\&amp; \`c\` \*d\* \_e\_ \[f\](g) \#1 \$h\$ \~i\~ \\"
        );
        assert_eq!(text("@me at https://x or www.x"), "@\u{200b}me at https:\u{200b}//x or www\u{200b}.x");
        assert_eq!(text("# one\n- two"), r"\# one - two");
    }

    #[test]
    fn fences_are_longer_than_what_they_hold() {
        assert_eq!(code("a"), "`a`");
        assert_eq!(code("a`b``c"), "``` a`b``c ```");
        assert_eq!(code(""), "`  `");
        assert_eq!(cell("a|b"), r"`a\|b`");
        assert_eq!(fenced("sh", "x"), "```sh\nx\n```");
        assert_eq!(fenced("", "a\n````\nb"), "`````\na\n````\nb\n`````");
    }

    #[test]
    fn cuts_between_blocks_and_counts_what_is_left_out() {
        let blocks: Vec<Block> = (0..5).map(|k| Block::finding(format!("{k}").repeat(100))).collect();
        let all = joined(&blocks);
        assert_eq!(cut(&blocks, all.len(), "r"), all);
        let some = cut(&blocks, all.len() - 1, "r");
        assert!(some.ends_with("\n\n1 finding is left out here, for want of room: `r` has all.\n"), "{some}");
        let two = cut(&blocks, 300, "r");
        assert!(two.contains("3 findings are left out") && two.contains(&"1".repeat(100)), "{two}");
        for bytes in 0..all.len() {
            let some = cut(&blocks, bytes, "r");
            assert!(some.len() <= bytes && (bytes < 100 || some.contains("left out")), "{bytes}: {some}");
        }
    }
}
