//! The process that a shared library is loaded into.

use super::abi::Loaded;
use crate::plugins::wire;
use std::fs::File;
use std::io::{self, BufReader, BufWriter};
use std::path::Path;

/// An answer in a buffer makes one call of the system.
const BUFFER: usize = 1 << 20;

/// Loads the library at `path` and answers for it on standard input and output.
///
/// # Errors
/// Where it cannot be loaded or the pipe is broken.
pub fn work(path: &Path) -> io::Result<()> {
    // What the library prints goes to standard error, where it does no harm.
    let output = File::from(rustix::io::dup(rustix::stdio::stdout())?);
    rustix::stdio::dup2_stdout(rustix::stdio::stderr())?;
    let input = File::from(rustix::io::dup(rustix::stdio::stdin())?);
    let mut loaded = Loaded::open(path).map_err(|fault| io::Error::other(fault.to_string()))?;
    wire::serve(
        &mut loaded,
        // What is longer than its buffer goes by it.
        BufReader::new(input),
        BufWriter::with_capacity(BUFFER, output),
    )
}
