//! What ends a command early.

use super::exit::Exit;
use crate::registry::RegistryError;
use crate::report::FileError;
use crate::suite::SuiteError;
use miette::Diagnostic;
use std::path::PathBuf;

/// What ends a command early, with what to type next.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CliError {
    /// A suite, or a subject on the command line, has mistakes.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Suite(#[from] Box<SuiteError>),
    /// A name that does not exist.
    #[error("{0}")]
    #[diagnostic(help("`gonio list` shows what there is"))]
    Registry(RegistryError),
    /// No such suite.
    #[error("there is no suite `{name}`")]
    #[diagnostic(help("{help}"))]
    NoSuite {
        /// As asked for.
        name: String,
        /// What there is.
        help: String,
    },
    /// Something that was typed cannot be used.
    #[error("{message}")]
    #[diagnostic(help("{help}"))]
    Usage {
        /// What is wrong.
        message: String,
        /// What to type.
        help: String,
    },
    /// A folder that cannot be written into.
    #[error("cannot write into {path}: {why}")]
    #[diagnostic(help("name a folder that can be written into: --out DIR"))]
    Output {
        /// Which.
        path: PathBuf,
        /// Why.
        why: std::io::Error,
    },
    /// Standard output cannot be written to.
    #[error("cannot write to standard output: {0}")]
    Stdout(std::io::Error),
    /// A file of a report cannot be written or read.
    #[error(transparent)]
    #[diagnostic(help("the results above stand; name another folder: --out DIR"))]
    File(#[from] FileError),
    /// A bug of gonio.
    #[error("internal error: {0}")]
    #[diagnostic(help("this is a bug of gonio, not of the subject: please report it"))]
    Internal(String),
}

impl CliError {
    /// The exit code.
    pub fn exit(&self) -> Exit {
        match self {
            Self::Suite(_) | Self::Registry(_) | Self::NoSuite { .. } | Self::Usage { .. } => Exit::Usage,
            Self::Output { .. } | Self::File(_) | Self::Stdout(_) | Self::Internal(_) => Exit::Internal,
        }
    }
}

impl From<SuiteError> for CliError {
    fn from(error: SuiteError) -> Self {
        Self::Suite(Box::new(error))
    }
}

// By hand: a source would be printed below the message that it is.
impl From<RegistryError> for CliError {
    fn from(error: RegistryError) -> Self {
        Self::Registry(error)
    }
}
