//! What gonio keeps of a running module: the limits of its memory, and what it said.

use wasmi::errors::{MemoryError, TableError};
use wasmi::{Caller, Extern, Memory, ResourceLimiter};
use wasmi_core::LimiterError;

/// Elements that a table may have: functions that can be pointed at.
const MOST_ELEMENTS: usize = 100_000;
/// How much of what a module says is kept: its end, where a panic speaks.
const KEPT: usize = 4096;

/// What gonio keeps of a running module.
pub struct Host {
    memory: usize,
    started: bool,
    said: Vec<u8>,
    /// Whether memory was refused to it since this was last set to false.
    pub refused: bool,
}

impl Host {
    /// Of a module that may have so many bytes of memory.
    pub fn new(memory: u64) -> Self {
        Self {
            memory: usize::try_from(memory).unwrap_or(usize::MAX),
            started: false,
            said: Vec::new(),
            refused: false,
        }
    }

    /// From now on its tables stay as they are.
    pub fn started(&mut self) {
        self.started = true;
    }

    /// Keeps what the module says.
    pub fn hear(&mut self, text: &[u8]) {
        self.said.extend_from_slice(&text[text.len().saturating_sub(KEPT)..]);
        self.said.drain(..self.said.len().saturating_sub(KEPT));
    }

    /// What the module said, for the end of an error.
    pub fn said(&self) -> String {
        match String::from_utf8_lossy(&self.said).trim() {
            "" => String::new(),
            text => format!("; it said: {text}"),
        }
    }
}

/// The memory of the module that calls.
pub fn memory(caller: &Caller<'_, Host>) -> Option<Memory> {
    caller.get_export("memory").and_then(Extern::into_memory)
}

impl ResourceLimiter for Host {
    fn memory_growing(
        &mut self,
        _current: usize,
        desired: usize,
        _maximum: Option<usize>,
    ) -> Result<bool, LimiterError> {
        let fits = desired <= self.memory;
        self.refused |= !fits;
        Ok(fits)
    }

    fn memory_grow_failed(&mut self, error: &MemoryError) -> Result<(), LimiterError> {
        self.refused |= matches!(error, MemoryError::OutOfSystemMemory);
        Ok(())
    }

    /// A `table.grow` that runs out of fuel cannot be resumed (wasmi 2.0 loses its
    /// place), so none may begin. Compilers do not write it.
    fn table_growing(
        &mut self,
        _current: usize,
        desired: usize,
        _maximum: Option<usize>,
    ) -> Result<bool, LimiterError> {
        Ok(!self.started && desired <= MOST_ELEMENTS)
    }

    fn table_grow_failed(&mut self, _error: &TableError) -> Result<(), LimiterError> {
        Ok(())
    }

    fn instances(&self) -> usize {
        1
    }

    fn tables(&self) -> usize {
        usize::MAX // they are counted before
    }

    fn memories(&self) -> usize {
        1
    }
}
