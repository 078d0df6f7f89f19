//! Ctrl-C.

use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first Ctrl-C, at which `news` says what becomes of the work; the second
/// ends the program at once.
pub fn stop_on_interrupt(news: &'static str) -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(Exit::Interrupted as i32);
        }
        tell(&format!("stopping; {news} (Ctrl-C again ends at once)"));
    })
    .map_err(|e| CliError::Internal(format!("cannot watch for Ctrl-C: {e}")))?;
    Ok(stop)
}
