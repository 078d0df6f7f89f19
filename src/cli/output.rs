//! Where words go: machine output to stdout, the rest to stderr.

use super::args::{Color, Voice};
use super::error::CliError;
use crate::report::Look;
use std::io::{ErrorKind, IsTerminal, Write, stderr, stdout};
use std::path::Path;

/// Writes to stdout. A reader that has seen enough is no error.
pub fn emit(text: &str) -> Result<(), CliError> {
    let mut out = stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(CliError::Stdout(e)),
        _ => Ok(()),
    }
}

/// Tells people something; not worth ending for if nobody can hear it.
pub fn tell(text: &str) {
    let _ = writeln!(stderr().lock(), "{text}");
}

/// Better to find out before an hour of measuring.
pub fn prove_writable(folder: &Path) -> Result<(), CliError> {
    let made = std::fs::create_dir_all(folder).and_then(|()| tempfile::tempfile_in(folder));
    made.map(drop).map_err(|why| CliError::Output { path: folder.into(), why })
}

fn from_environment(name: &str, usual: usize) -> usize {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

impl Voice {
    /// Whether messages are coloured.
    pub fn colored(&self) -> bool {
        match self.color {
            Color::Always => true,
            Color::Never => false,
            // https://no-color.org: set to anything but nothing.
            Color::Auto => {
                stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
            }
        }
    }

    /// How pages are laid out, all told.
    pub fn look(&self) -> Look {
        Look { width: from_environment("COLUMNS", 100), colour: self.colored(), lines: None }
    }

    /// How a page is laid out that is to fit a screen, unless all is asked for.
    pub fn screen(&self) -> Look {
        let lines = (!self.verbose).then(|| from_environment("LINES", 50));
        Look { lines, ..self.look() }
    }

    /// How errors are drawn.
    pub fn error_page(&self, error: &CliError) -> String {
        let plain = !self.colored();
        let theme = match (stderr().is_terminal(), plain) {
            (false, true) => miette::GraphicalTheme::none(),
            (_, true) => miette::GraphicalTheme::unicode_nocolor(),
            (_, false) => miette::GraphicalTheme::unicode(),
        };
        let mut page = String::new();
        match miette::GraphicalReportHandler::new_themed(theme).render_report(&mut page, error) {
            Ok(()) => page,
            Err(_) => format!("error: {error}\n"),
        }
    }
}
