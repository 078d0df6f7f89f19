//! The numbers and braces of a block of scattering data, with their places.

use super::error::ReadError;
use super::xml::{wrong, wrong_at};
use roxmltree::Node;

/// What stands in a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Token {
    /// `{`
    Open,
    /// `}`
    Close,
    /// A BSDF value in sr⁻¹: finite and not negative.
    Value(f64),
    /// The end of the block.
    End,
}

/// Reads tokens one by one.
pub struct Tokens<'a, 'i> {
    node: Node<'a, 'i>,
    /// Text between comments, as it stands in the file, and where it starts.
    pieces: Vec<(usize, &'a str)>,
    piece: usize,
    at: usize,
    /// Whether a value came and no comma since.
    may_part: bool,
}

impl<'a, 'i> Tokens<'a, 'i> {
    /// The tokens of an element.
    pub fn new(node: Node<'a, 'i>) -> Result<Self, ReadError> {
        let mut pieces = Vec::new();
        for child in node.children() {
            if child.is_element() {
                return Err(wrong(child, "an element among numbers"));
            }
            if child.is_text() {
                let range = child.range();
                // The text itself, not the parser's copy, so that places are right
                // whatever ends its lines.
                let text = &node.document().input_text()[range.clone()];
                pieces.push((range.start, text));
            }
        }
        Ok(Self { node, pieces, piece: 0, at: 0, may_part: false })
    }

    /// Where the next token starts, as a byte of the file.
    pub fn place(&self) -> usize {
        match self.pieces.get(self.piece) {
            Some((start, text)) => {
                let rest = &text[self.at..];
                start + self.at + (rest.len() - rest.trim_start().len())
            }
            None => self.node.range().end,
        }
    }

    /// An error at the next token.
    pub fn wrong(&self, message: impl Into<String>) -> ReadError {
        wrong_at(self.node.document(), self.place(), message)
    }

    /// An error at a byte that [`place`](Self::place) told before.
    pub fn wrong_from(&self, place: usize, message: impl Into<String>) -> ReadError {
        wrong_at(self.node.document(), place, message)
    }

    /// The next token, which stays.
    pub fn peek(&mut self) -> Result<Token, ReadError> {
        let here = (self.piece, self.at, self.may_part);
        let token = self.next();
        (self.piece, self.at, self.may_part) = here;
        token
    }

    /// The next token.
    pub fn next(&mut self) -> Result<Token, ReadError> {
        loop {
            let Some((_, text)) = self.pieces.get(self.piece) else { return Ok(Token::End) };
            let rest = &text[self.at..];
            let trimmed = rest.trim_start();
            self.at += rest.len() - trimmed.len();
            let Some(first) = trimmed.chars().next() else {
                (self.piece, self.at) = (self.piece + 1, 0);
                continue;
            };
            match first {
                ',' if self.may_part => {
                    self.may_part = false;
                    self.at += 1;
                }
                ',' => return Err(self.wrong("a comma where a value is expected")),
                '{' | '}' => {
                    self.at += 1;
                    // Radiance lets a comma follow a closed brace.
                    self.may_part = first == '}';
                    return Ok(if first == '{' { Token::Open } else { Token::Close });
                }
                _ => {
                    let is_end = |c: char| c.is_whitespace() || matches!(c, ',' | '{' | '}');
                    let word = &trimmed[..trimmed.find(is_end).unwrap_or(trimmed.len())];
                    let value = self.value(word)?;
                    self.at += word.len();
                    self.may_part = true;
                    return Ok(Token::Value(value));
                }
            }
        }
    }

    fn value(&self, word: &str) -> Result<f64, ReadError> {
        let shown: String = word.chars().take(24).collect();
        let value: f64 = word.parse().map_err(|_| self.wrong(format!("`{shown}` is not a number")))?;
        if !value.is_finite() {
            return Err(self.wrong(format!("`{shown}` is not finite; a BSDF value is needed")));
        }
        if value < 0.0 {
            return Err(self.wrong(format!("`{shown}` is negative, which no BSDF value is")));
        }
        // Not −0.
        Ok(value.abs())
    }
}
