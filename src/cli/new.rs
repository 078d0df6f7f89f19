//! `gonio new`.

use super::args::Voice;
use super::error::CliError;
use super::exit::Exit;
use super::output::tell;
use crate::report::write_whole;
use clap::ValueEnum;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Arguments of `gonio new`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  gonio new c paint && cat paint/README.md")]
pub struct NewArgs {
    /// In which language.
    #[arg(value_enum)]
    pub language: Language,
    /// Its name: small letters, digits, - and _.
    #[arg(value_parser = name)]
    pub name: String,
    /// Write into this folder; ./NAME if left out.
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// What there is a template of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// A crate with gonio's command line in it.
    Rust,
    /// A shared library.
    C,
    /// A shared library, from a class.
    Cpp,
    /// A program, with numpy.
    Python,
    /// C for a WebAssembly module.
    WasmC,
}

/// A file by its path in the new folder, and its text before substitution.
type Template = (&'static str, &'static str);

macro_rules! template {
    ($path:literal from $source:literal) => {
        ($path, include_str!(concat!("../../", $source)))
    };
}

const C: Template = template!("bsdf.c" from "templates/c/bsdf.c");
const HEADER: Template = template!("include/gonio.h" from "include/gonio.h");
const PARAMETERS: Template = template!("include/gonio_parameters.h" from "include/gonio_parameters.h");

impl Language {
    fn files(self) -> Vec<Template> {
        match self {
            Self::Rust => vec![
                template!("src/main.rs" from "templates/rust/main.rs"),
                template!("Cargo.toml" from "templates/rust/manifest.toml"),
                template!("README.md" from "templates/rust/README.md"),
            ],
            Self::C => vec![C, HEADER, PARAMETERS, template!("README.md" from "templates/c/README.md")],
            Self::Cpp => vec![
                template!("bsdf.cpp" from "templates/cpp/bsdf.cpp"),
                template!("include/gonio.hpp" from "sdk/cpp/gonio.hpp"),
                template!("include/gonio_model.hpp" from "sdk/cpp/gonio_model.hpp"),
                HEADER,
                PARAMETERS,
                template!("README.md" from "templates/cpp/README.md"),
            ],
            Self::Python => vec![
                template!("bsdf.py" from "templates/python/bsdf.py"),
                template!("README.md" from "templates/python/README.md"),
            ],
            Self::WasmC => vec![
                C,
                HEADER,
                PARAMETERS,
                template!("include/gonio_wasm.h" from "include/gonio_wasm.h"),
                template!("README.md" from "templates/wasm-c/README.md"),
            ],
        }
    }
}

/// Writes a plugin to start from.
pub fn new(args: &NewArgs, voice: Voice) -> Result<Exit, CliError> {
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from(&args.name));
    if args.language == Language::Rust {
        crate_name(&args.name)?;
    }
    must_be_free(&folder)?;
    for (path, text) in args.language.files() {
        let text = text.replace("@NAME@", &args.name).replace("@VERSION@", env!("CARGO_PKG_VERSION"));
        write_whole(&folder.join(path), text.as_bytes())?;
    }
    if !voice.quiet {
        let readme = args.language.files().into_iter().find(|(path, _)| *path == "README.md");
        tell(&next_steps(&folder, readme.map_or("", |(_, text)| text), &args.name));
    }
    Ok(Exit::Passed)
}

/// The commands of a README's first block, without what follows the first check.
fn next_steps(folder: &Path, readme: &str, name: &str) -> String {
    let block = readme.lines().skip_while(|l| !l.starts_with("```")).skip(1);
    let mut text = format!("wrote {0}; now\n\n    cd {0}\n", folder.display());
    for line in block.take_while(|l| !l.starts_with("```")) {
        text.push_str(&format!("    {}\n", line.replace("@NAME@", name)));
        if line.contains(" check ") {
            break;
        }
    }
    text.trim_end().into()
}

/// `Err` where there is anything: what somebody wrote is not written over.
fn must_be_free(folder: &Path) -> Result<(), CliError> {
    let why = match std::fs::read_dir(folder).map(|mut entries| entries.next().is_some()) {
        Ok(false) => return Ok(()),
        Ok(true) => "is there already, and is not empty",
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        Err(e) if e.kind() == ErrorKind::NotADirectory => "is a file",
        Err(why) => return Err(CliError::Output { path: folder.into(), why }),
    };
    Err(CliError::Usage {
        message: format!("{} {why}", folder.display()),
        help: "name another folder: --out DIR".into(),
    })
}

fn name(text: &str) -> Result<String, String> {
    let first = text.chars().next().is_some_and(|c| c.is_ascii_lowercase());
    let rest = text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_');
    if first && rest {
        Ok(text.into())
    } else {
        Err("a name is a small letter, and then small letters, digits, - and _, as `rough-paint`".into())
    }
}

/// Words that cargo takes for no crate, or that would hide one that is needed.
const NO_CRATES: [&str; 53] = [
    "abstract", "alloc", "as", "async", "await", "become", "box", "break", "const", "continue", "core",
    "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "gonio", "if",
    "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub", "ref",
    "return", "self", "static", "std", "struct", "super", "test", "trait", "true", "try", "type", "unsafe",
    "use", "where", "while", "yield",
];

fn crate_name(name: &str) -> Result<(), CliError> {
    if NO_CRATES.contains(&name) {
        return Err(CliError::Usage {
            message: format!("a crate cannot be called `{name}`"),
            help: format!("choose another name, as `{name}-bsdf`"),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_what_every_language_takes() {
        for good in ["a", "paint", "rough-paint_2"] {
            assert_eq!(name(good).as_deref(), Ok(good));
        }
        for bad in ["", "2a", "-a", "_a", "Paint", "a b", "a.b", "../a", "ä", "a\"b"] {
            assert!(name(bad).is_err(), "{bad}");
        }
        assert!(crate_name("fn").is_err() && crate_name("gonio").is_err() && crate_name("paint").is_ok());
    }

    #[test]
    fn every_template_is_whole_and_says_how_to_go_on() {
        for language in Language::value_variants() {
            let files = language.files();
            let (_, readme) = files.iter().find(|(path, _)| *path == "README.md").expect("a README");
            let steps = next_steps(Path::new("x"), readme, "paint");
            assert!(steps.contains(" check ") && !steps.contains('@'), "{steps}");
            for (path, text) in files {
                let marks = text.replace("@NAME@", "").replace("@VERSION@", "").matches('@').count();
                // The one of `@gonio.bsdf`.
                assert!(marks == usize::from(path.ends_with(".py")), "{path}");
            }
        }
    }
}
