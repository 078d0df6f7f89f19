//! What a plugin may take.

use std::time::Duration;

/// What a plugin may take, and where it runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Limits {
    /// What one call may take. A batch of 4096 directions takes a scalar function
    /// in Python a tenth of a second.
    pub call: Duration,
    /// Bytes: address space of a process, memory of a WebAssembly module. numpy
    /// with its threads asks for some hundreds of MiB that it never touches.
    pub memory: u64,
    /// Whether shared libraries are loaded into this process, where nothing
    /// protects it from them.
    pub in_process: bool,
}

impl Default for Limits {
    fn default() -> Self {
        Self { call: Duration::from_secs(10), memory: 4096 << 20, in_process: false }
    }
}

impl Limits {
    /// `memory` as it is given: in MiB.
    pub fn mebibytes(&self) -> u64 {
        self.memory >> 20
    }
}

/// The longest that a plugin may take to begin: Python imports a renderer in some
/// seconds.
pub const START: Duration = Duration::from_secs(60);
