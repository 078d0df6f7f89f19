//! What is wrong with a file, and where.

/// A mistake in a file: its place, counted from 1 (columns in characters), and
/// what was expected there.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}")]
pub struct ReadError {
    /// Line.
    pub line: u32,
    /// Column.
    pub column: u32,
    /// What is wrong, with the values.
    pub message: String,
}
