//! What a program wrote to standard error, the end of it.

/// Bytes that are kept: a traceback is shorter.
const KEPT: usize = 8192;

/// Lines that are shown.
const SHOWN: usize = 12;

/// The end of what a program wrote to standard error.
#[derive(Default)]
pub struct LastWords {
    bytes: Vec<u8>,
    cut: bool,
}

impl LastWords {
    /// More of it.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() > 2 * KEPT {
            self.bytes.drain(..self.bytes.len() - KEPT);
            self.cut = true;
        }
    }

    /// Takes the last line that begins with `voice` out of it, without that.
    pub fn take_line(&mut self, voice: &str) -> Option<String> {
        let text = String::from_utf8_lossy(&self.bytes).into_owned();
        let lines: Vec<&str> = text.lines().collect();
        let at = lines.iter().rposition(|line| line.starts_with(voice))?;
        self.bytes = lines[..at].join("\n").into_bytes();
        Some(lines[at][voice.len()..].to_string())
    }

    /// As a message ends with it; empty if there is nothing.
    pub fn told(&self) -> String {
        let text = String::from_utf8_lossy(&self.bytes);
        let lines: Vec<&str> = text.lines().map(str::trim_end).filter(|l| !l.is_empty()).collect();
        if lines.is_empty() {
            return "; it said nothing".into();
        }
        let few = &lines[lines.len().saturating_sub(SHOWN)..];
        let more = if few.len() < lines.len() || self.cut { "…\n" } else { "" };
        let printable = |l: &&str| -> String {
            l.chars().map(|c| if c.is_control() && c != '\t' { '\u{fffd}' } else { c }).collect()
        };
        let few: Vec<String> = few.iter().map(printable).collect();
        format!("; it last said:\n{more}{}", few.join("\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_kept() {
        let mut words = LastWords::default();
        assert_eq!(words.told(), "; it said nothing");
        for k in 0..10_000 {
            words.push(format!("line {k}\n\n").as_bytes());
        }
        let told = words.told();
        assert!(told.ends_with("line 9998\nline 9999") && told.contains("…\nline 9988"), "{told}");
        assert!(words.bytes.len() <= 2 * KEPT + 100);
        words.push(b"\x1b[31mred\xff");
        assert!(words.told().ends_with("\u{fffd}[31mred\u{fffd}"));
    }
}
