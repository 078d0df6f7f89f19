//! Reports that were made before.

use super::error::CliError;
use super::output::tell;
use crate::report::{REPORT, Report, SCHEMA_VERSION};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Reads a report, or that of a folder; with it the folder it lies in.
pub fn read(path: &Path) -> Result<(PathBuf, Report), CliError> {
    let file = file_of(path);
    let folder = file.parent().unwrap_or(Path::new(".")).to_path_buf();
    let wrong = |message: String| CliError::Usage {
        message: format!("{}: {message}", file.display()),
        help: "name the folder that `gonio run --out DIR` wrote".into(),
    };
    let text = std::fs::read_to_string(&file).map_err(|e| wrong(e.to_string()))?;
    let json: serde_json::Value =
        serde_json::from_str(&text).map_err(|e| wrong(format!("not a report: {e}")))?;
    // Told before the fields, since a later version may have others.
    let version = json.get("schema_version").and_then(serde_json::Value::as_u64);
    if version.is_some_and(|v| v > u64::from(SCHEMA_VERSION)) {
        return Err(wrong("was written by a later version of gonio".into()));
    }
    let report = Report::deserialize(json).map_err(|e| wrong(format!("not a report: {e}")))?;
    Ok((folder, report))
}

fn file_of(path: &Path) -> PathBuf {
    if path.is_dir() { path.join(REPORT) } else { path.to_path_buf() }
}

/// Reads the report that `option` names. A first run has none: `None`, and what becomes of
/// the run is told.
pub fn read_if_any(
    option: &str,
    path: &Path,
    without: &str,
    quiet: bool,
) -> Result<Option<(PathBuf, Report)>, CliError> {
    if file_of(path).exists() {
        return read(path).map(Some);
    }
    if !quiet {
        tell(&format!(
            "{option}: there is no report at {} yet: {without}. Keep this run\u{2019}s report there to have one next time.",
            path.display()
        ));
    }
    Ok(None)
}
