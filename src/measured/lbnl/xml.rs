//! Elements of a document and their places.

use super::error::ReadError;
use roxmltree::{Document, Node, ParsingOptions};

/// More elements, attributes and texts than any file has: WINDOW's own have a few
/// thousand.
const MOST_NODES: u32 = 1 << 20;

/// Parses a document.
pub fn parse(bytes: &[u8]) -> Result<Document<'_>, ReadError> {
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let before = &bytes[..e.valid_up_to()];
        let line = 1 + before.iter().filter(|b| **b == b'\n').count();
        let column = 1 + before.iter().rev().take_while(|b| **b != b'\n').count();
        ReadError {
            line: line as u32,
            column: column as u32,
            message: format!("byte {} is not UTF-8 text", before.len()),
        }
    })?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| {
        let pos = e.pos();
        // The parser's sentence ends with the place.
        let message = e.to_string();
        let message = message.rsplit_once(" at ").map_or(&*message, |(sentence, _)| sentence);
        ReadError {
            line: pos.row,
            column: pos.col,
            message: format!("this is no well-formed XML: {message}"),
        }
    })
}

/// An error at a byte of the document.
pub fn wrong_at(document: &Document, byte: usize, message: impl Into<String>) -> ReadError {
    let pos = document.text_pos_at(byte.min(document.input_text().len()));
    ReadError { line: pos.row, column: pos.col, message: message.into() }
}

/// An error at an element.
pub fn wrong(node: Node, message: impl Into<String>) -> ReadError {
    wrong_at(node.document(), node.range().start, message)
}

/// The children called `name`, whatever their namespace.
pub fn children<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}

/// The only child called `name`.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &'static str) -> Result<Node<'a, 'i>, ReadError> {
    optional_child(node, name)?
        .ok_or_else(|| wrong(node, format!("<{}> has no <{name}>", node.tag_name().name())))
}

/// The child called `name`, if there is one; more than one is a mistake.
pub fn optional_child<'a, 'i>(
    node: Node<'a, 'i>,
    name: &'static str,
) -> Result<Option<Node<'a, 'i>>, ReadError> {
    let mut all = children(node, name);
    let first = all.next();
    match all.next() {
        Some(second) => {
            Err(wrong(second, format!("a second <{name}> in <{}>; one is read", node.tag_name().name())))
        }
        None => Ok(first),
    }
}

/// The text of an element without the blanks around it.
pub fn text<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or("").trim()
}

/// Whether two names are the same, as Radiance compares them.
pub fn same(a: &str, b: &str) -> bool {
    a.eq_ignore_ascii_case(b)
}
