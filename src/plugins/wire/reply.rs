//! What a program answers, besides numbers.

use crate::plugins::instance::{Created, Fault};
use serde::Deserialize;

/// The object of an answer.
#[derive(Debug, Default, Deserialize)]
pub struct Reply {
    /// Why there is none.
    pub error: Option<String>,
    handle: Option<u64>,
    describe: Option<serde_json::Value>,
    #[serde(default)]
    pub(super) bytes: u64,
}

impl Reply {
    /// Reads the object.
    pub fn read(text: &str) -> Result<Self, String> {
        serde_json::from_str(text).map_err(|e| format!("{e} in `{}`", shown(text.as_bytes())))
    }

    /// Itself, unless it tells an error.
    pub fn accepted(self) -> Result<Self, Fault> {
        match self.error {
            Some(error) => Err(Fault::Refused(error)),
            None => Ok(self),
        }
    }

    /// The subject that it tells of.
    pub fn created(self) -> Result<Created, String> {
        let handle = self.handle.ok_or("create() was answered without a `handle`")?;
        Ok(Created { handle, describe: self.describe.filter(|d| !d.is_null()).map(|d| d.to_string()) })
    }
}

/// Bytes as people can read them, the first of them.
pub(super) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    let mut few: String = text.chars().take(MOST).flat_map(char::escape_debug).collect();
    if text.chars().count() > MOST || bytes.len() > 4 * MOST {
        few.push('…');
    }
    few
}
