//! What a plugin may take.

use std::time::Duration;

/// What a plugin may take before it is stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// How long one call may last (`--call-limit`).
    pub call: Duration,
    /// Bytes of the address space of a process, or of the memory of a WebAssembly
    /// module (`--memory`).
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { call: Duration::from_secs(10), memory: 4096 << 20 }
    }
}

impl Limits {
    /// `memory` as it is given: in MiB.
    pub fn mebibytes(&self) -> u64 {
        self.memory >> 20
    }
}
