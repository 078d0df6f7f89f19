//! What a module is doing, as errors say it.

use crate::plugins::instance::Function;
use std::fmt;

/// What a module is doing.
#[derive(Clone, Copy, Debug)]
pub enum Doing<'a> {
    /// Its start function, or `_initialize`.
    Starting,
    /// The description of all models, or of one subject.
    Describe,
    /// A subject of this model.
    Create(&'a str),
    /// A function, of so many rows.
    Rows(Function, usize),
    /// The end of a subject.
    Destroy,
    /// The text of an error.
    Error,
    /// So many bytes.
    Alloc(u32),
    /// Bytes given back.
    Free,
}

impl Doing<'_> {
    /// How many rows it has.
    pub fn rows(self) -> usize {
        if let Self::Rows(_, rows) = self { rows } else { 0 }
    }
}

impl fmt::Display for Doing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Starting => f.write_str("its start function"),
            Self::Describe => f.write_str("describe()"),
            Self::Create(model) => write!(f, "create(\"{model}\")"),
            Self::Rows(function, rows) => write!(f, "{}() of {rows} rows", function.word()),
            Self::Destroy => f.write_str("destroy()"),
            Self::Error => f.write_str("gonio_error()"),
            Self::Alloc(bytes) => write!(f, "gonio_alloc({bytes})"),
            Self::Free => f.write_str("gonio_free()"),
        }
    }
}
