//! Text that every output can hold and every reader can see.

/// The first picture of a control character (Unicode, Control Pictures).
const PICTURES: u32 = 0x2400;

/// `text` with its line ends, and with what cannot be seen in it made visible: control
/// characters, which XML 1.0 forbids and terminals obey; what turns the direction of
/// writing; what is no character.
pub fn visible(text: &str) -> String {
    text.replace("\r\n", "\n")
        .chars()
        .map(|c| match c {
            '\n' => c,
            '\t' => ' ',
            '\u{0}'..='\u{1f}' => char::from_u32(PICTURES + c as u32).unwrap_or(char::REPLACEMENT_CHARACTER),
            '\u{7f}' => '\u{2421}',
            '\u{80}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' => char::REPLACEMENT_CHARACTER,
            '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
                char::REPLACEMENT_CHARACTER
            }
            // Line ends to some readers only.
            '\u{2028}' | '\u{2029}' => char::REPLACEMENT_CHARACTER,
            _ => c,
        })
        .collect()
}

/// The same on one line, single spaces between its words.
pub fn one_line(text: &str) -> String {
    visible(text).split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_invisible_is_left() {
        assert_eq!(visible("a\0b\u{1b}[31m\tc\r\nd\re"), "a␀b␛[31m c\nd␍e");
        assert_eq!(visible("\u{7f}\u{9b}\u{ffff}\u{202e}ok θ"), "␡���ok θ");
        assert_eq!(one_line(" two\n\n  lines "), "two lines");
        for c in '\0'..='\u{ffff}' {
            let shown = visible(&c.to_string());
            assert!(c == '\n' || !shown.chars().any(char::is_control), "{c:?}");
        }
    }
}
