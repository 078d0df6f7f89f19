//! `gonio figures`.

use super::args::Voice;
use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use crate::lecture;
use crate::registry::nearest;
use crate::report::write_whole;
use std::path::PathBuf;

/// Arguments of `gonio figures`.
#[derive(Debug, clap::Args)]
#[command(after_help = after_help())]
pub struct FiguresArgs {
    /// Only these; all where none is named.
    #[arg(value_name = "NAME", value_parser = name)]
    pub names: Vec<String>,
    /// Where to.
    #[arg(short, long, value_name = "DIR", default_value = "figures")]
    pub out: PathBuf,
}

/// Name and line of each figure and table.
fn rows() -> Vec<(&'static str, &'static str)> {
    let figures = lecture::all().into_iter().map(|f| (f.name, f.doc));
    figures.chain(lecture::tables().into_iter().map(|t| (t.name, t.doc))).collect()
}

fn after_help() -> String {
    let rows: Vec<_> = rows().iter().map(|(name, doc)| format!("  {name:30}{doc}")).collect();
    format!("Figures and tables:\n{}", rows.join("\n"))
}

fn name(text: &str) -> Result<String, String> {
    let names: Vec<_> = rows().iter().map(|(name, _)| *name).collect();
    if names.contains(&text) {
        return Ok(text.into());
    }
    Err(match nearest(text, names.iter().copied()) {
        Some(n) => format!("no figure is called so; did you mean `{n}`?"),
        None => format!("no figure is called so; there are {}", names.join(", ")),
    })
}

/// Draws the lecture's figures and writes its tables.
pub fn figures(args: &FiguresArgs, voice: Voice) -> Result<Exit, CliError> {
    let wanted = |name: &str| args.names.is_empty() || args.names.iter().any(|n| n == name);
    let write = |file: String, text: String, doc: &str| -> Result<(), CliError> {
        let path = args.out.join(file);
        write_whole(&path, text.as_bytes())?;
        if !voice.quiet {
            tell(&format!("{}  {doc}", path.display()));
        }
        Ok(())
    };
    for figure in lecture::all().iter().filter(|f| wanted(f.name)) {
        write(format!("{}.svg", figure.name), (figure.plot)().svg(), figure.doc)?;
    }
    for table in lecture::tables().iter().filter(|t| wanted(t.name)) {
        write(format!("{}.txt", table.name), (table.text)(), table.doc)?;
    }
    Ok(Exit::Passed)
}
