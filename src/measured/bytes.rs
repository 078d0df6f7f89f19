//! Reading little-endian numbers, with errors that say where.

/// What is wrong with the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{format}, byte {offset}: {message}")]
pub struct FormatError {
    /// The format that the content was taken for.
    pub format: &'static str,
    /// Where, counted from 0.
    pub offset: u64,
    /// What is wrong, with the values.
    pub message: String,
}

impl FormatError {
    /// At `offset` of a file of `format`.
    pub fn new(format: &'static str, offset: usize, message: impl Into<String>) -> Self {
        Self { format, offset: offset as u64, message: message.into() }
    }
}

/// A place in the content of a file, which only moves forward.
pub(super) struct Cursor<'a> {
    format: &'static str,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub fn new(format: &'static str, bytes: &'a [u8]) -> Self {
        Self { format, bytes, at: 0 }
    }

    /// Where it is.
    pub fn offset(&self) -> usize {
        self.at
    }

    /// The next `count` bytes, which hold `what`.
    pub fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], FormatError> {
        let left = self.bytes.len() - self.at;
        if count > left {
            let message =
                format!("the file ends where {what} should be: {count} bytes are needed, {left} are left");
            return Err(FormatError::new(self.format, self.at, message));
        }
        let found = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(found)
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], FormatError> {
        Ok(self.take(N, what)?.try_into().expect("as many bytes as were taken"))
    }

    pub fn u8(&mut self, what: &str) -> Result<u8, FormatError> {
        self.array::<1>(what).map(|[byte]| byte)
    }

    pub fn u16(&mut self, what: &str) -> Result<u16, FormatError> {
        self.array(what).map(u16::from_le_bytes)
    }

    pub fn u32(&mut self, what: &str) -> Result<u32, FormatError> {
        self.array(what).map(u32::from_le_bytes)
    }

    pub fn i32(&mut self, what: &str) -> Result<i32, FormatError> {
        self.array(what).map(i32::from_le_bytes)
    }

    pub fn u64(&mut self, what: &str) -> Result<u64, FormatError> {
        self.array(what).map(u64::from_le_bytes)
    }
}
