//! Lines, colours and symbols.

use super::super::visible::visible;
use super::super::wording::wrapped;
use crate::checks::Verdict;

/// How a summary looks.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Characters a line, 80 to 120.
    pub width: usize,
    /// Whether the terminal takes colours.
    pub colour: bool,
    /// Lines that a page is to fit; everything is told in full where `None`.
    pub lines: Option<usize>,
}

impl Look {
    /// Characters a line.
    pub fn width(&self) -> usize {
        self.width.clamp(80, 120)
    }

    /// Text in a colour of the terminal's (an SGR code).
    pub fn paint(&self, code: &str, text: &str) -> String {
        if self.colour { format!("\u{1b}[{code}m{text}\u{1b}[0m") } else { text.to_string() }
    }
}

/// A shape for each verdict, so that nothing hangs on colour.
pub fn symbol(verdict: Verdict) -> char {
    match verdict {
        Verdict::Pass => '✓',
        Verdict::Fail => '✗',
        Verdict::Inconclusive => '?',
        Verdict::Warn => '!',
        Verdict::Skipped => '–',
        Verdict::Error => 'E',
        Verdict::Waived => 'w',
    }
}

/// Blue, and not green, against red.
pub fn code(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "34",
        Verdict::Fail | Verdict::Error => "1;31",
        Verdict::Inconclusive | Verdict::Warn => "33",
        Verdict::Skipped | Verdict::Waived => "2",
    }
}

pub fn line(text: &mut String, content: &str) {
    text.push_str(content.trim_end());
    text.push('\n');
}

/// What subjects say is shown, not obeyed: neither control characters by a terminal, nor
/// lines that begin with `::` by GitHub Actions, which takes them for commands wherever a
/// log has them.
fn shown(content: &str) -> String {
    let lines = visible(content);
    let shown = lines.split('\n').map(|line| match line.trim_start().starts_with("::") {
        true => format!("| {}", line.trim_start()),
        false => line.to_string(),
    });
    shown.collect::<Vec<_>>().join("\n")
}

pub fn indented(text: &mut String, content: &str, indent: usize, look: Look) {
    for part in wrapped(&shown(content), look.width() - indent) {
        line(text, &format!("{:indent$}{part}", ""));
    }
}

/// A word in bold and what it says, indented.
pub fn told(text: &mut String, word: &str, content: &str, look: Look) {
    let parts = wrapped(&shown(&format!("{word}: {content}")), look.width() - 4);
    for (k, part) in parts.iter().enumerate() {
        match part.strip_prefix(word).filter(|_| k == 0) {
            Some(rest) => line(text, &format!("    {}{rest}", look.paint("1", word))),
            None => line(text, &format!("    {part}")),
        }
    }
}
