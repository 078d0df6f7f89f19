//! What holds in one sandbox, as its processes hand it on.

use super::incident::Phase;
use serde::{Deserialize, Serialize};

/// What holds in one sandbox.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rules {
    /// What it is for.
    pub phase: Phase,
    /// Whether gonio itself answers for a shared library in it.
    pub library: bool,
    /// Whether its calls of the system are watched.
    pub watched: bool,
    /// Bytes of memory of all; half more of a process's address space.
    pub memory: u64,
    /// Seconds of processor time of all.
    pub processor: Option<u64>,
    /// Seconds of the clock.
    pub clock: Option<f64>,
    /// Processes at a time.
    pub processes: u64,
    /// Bytes of files.
    pub disk: u64,
    /// Where the folder is.
    pub work: String,
    /// Folders that it may read beside those that every sandbox has.
    pub open: Vec<String>,
    /// Folders that packages of those name, and that it looks for without being shown them.
    pub named: Vec<String>,
}
