//! Any measured file as a subject.

use super::bytes::FormatError;
use super::formats::{Format, READ};
use super::lbnl;
use super::merl::{Interpolation, Merl, MerlTable};
use super::per_wo::PerWo;
use super::rgl::Rgl;
use crate::bsdf::Subject;
use crate::registry::Model;
use std::path::Path;
use std::sync::Arc;

/// Why a file could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// It is not there.
    #[error("there is no file `{0}`")]
    Missing(String),
    /// It cannot be read.
    #[error("`{path}` cannot be read: {why}")]
    Unreadable {
        /// Which.
        path: String,
        /// Why.
        why: std::io::Error,
    },
    /// Its content is wrong.
    #[error("`{path}`: {error}")]
    Content {
        /// Which.
        path: String,
        /// What is wrong with it.
        error: ContentError,
    },
}

/// What is wrong with the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContentError {
    /// A known format that is not read.
    #[error("this is {0}; gonio reads {READ}")]
    Unread(&'static str),
    /// No known format.
    #[error("not a format that gonio knows (it begins with {0}); gonio reads {READ}")]
    Unknown(String),
    /// A mistake at a place.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A mistake in XML, at its line and column.
    #[error(transparent)]
    Xml(#[from] lbnl::ReadError),
    /// How to read it was asked for, and it can only be read in one way.
    #[error("only MERL tables can be read with interpolation = nearest")]
    Interpolation,
}

/// How a file is read where it can be read in several ways.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Of a MERL table.
    pub interpolation: Interpolation,
    /// The band of a WINDOW file, as it names it (upper or lower case).
    pub wavelength: String,
}

impl Default for Reading {
    fn default() -> Self {
        Self { interpolation: Interpolation::Linear, wavelength: "visible".into() }
    }
}

/// Opens a measured file of any format that gonio reads, which its content tells.
pub fn open(path: &Path, reading: &Reading) -> Result<Arc<dyn Subject>, OpenError> {
    let shown = || path.display().to_string();
    let bytes = std::fs::read(path).map_err(|why| match why.kind() {
        std::io::ErrorKind::NotFound => OpenError::Missing(shown()),
        _ => OpenError::Unreadable { path: shown(), why },
    })?;
    read(&bytes, reading).map_err(|error| OpenError::Content { path: shown(), error })
}

/// As [`open`], of the content of a file.
pub fn read(bytes: &[u8], reading: &Reading) -> Result<Arc<dyn Subject>, ContentError> {
    let format = Format::of(bytes);
    let nearest = reading.interpolation == Interpolation::Nearest;
    if nearest && matches!(format, Format::Tensor | Format::WindowXml) {
        return Err(ContentError::Interpolation);
    }
    Ok(match format {
        Format::Merl => Arc::new(PerWo(Merl::new(MerlTable::read(bytes)?, reading.interpolation))),
        Format::Tensor => Arc::new(PerWo(Rgl::read(bytes)?)),
        Format::WindowXml => {
            Arc::new(lbnl::Measured::new(lbnl::read_wavelength(bytes, &reading.wavelength)?))
        }
        Format::Other(name) => return Err(ContentError::Unread(name)),
        Format::Unknown => return Err(ContentError::Unknown(beginning(bytes))),
    })
}

/// The first bytes, as people can read them.
fn beginning(bytes: &[u8]) -> String {
    let few = &bytes[..bytes.len().min(12)];
    if few.iter().all(|b| (0x20..0x7f).contains(b)) {
        format!("`{}`", String::from_utf8_lossy(few))
    } else {
        let hex: Vec<String> = few.iter().map(|b| format!("{b:02x}")).collect();
        format!("bytes {}", hex.join(" "))
    }
}

/// The registered model `measured`.
pub(crate) fn model() -> Model {
    Model::dynamic(
        "measured",
        "a measured file: MERL .binary, RGL tensor .bsdf or WINDOW XML, told by its content",
        |p| {
            let interpolation = match p.text("interpolation") {
                "nearest" => Interpolation::Nearest,
                _ => Interpolation::Linear,
            };
            let reading = Reading { interpolation, wavelength: p.text("wavelength").into() };
            open(Path::new(p.text("file")), &reading).map_err(|e| e.to_string())
        },
    )
    .file("file", "the path of the measured file")
    .choice("interpolation", &["linear", "nearest"], "how a MERL table is read between its nodes")
    .idle()
    .choice("wavelength", &["visible", "solar", "nir"], "which band of a WINDOW file")
    .idle()
}
