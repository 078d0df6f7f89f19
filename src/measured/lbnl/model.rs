//! The registered model.

use super::{Measured, read_wavelength};
use crate::registry::Model;

/// The registered model `lbnl`.
pub fn model() -> Model {
    Model::new("lbnl", "a table in the XML of LBNL's WINDOW and Radiance (Klems or tensor tree)", |p| {
        let path = p.text("file");
        let bytes = std::fs::read(path).map_err(|e| format!("`{path}` cannot be read: {e}"))?;
        let table = read_wavelength(&bytes, p.text("wavelength")).map_err(|e| format!("`{path}`, {e}"))?;
        Ok(Measured::new(table))
    })
    .file("file", "the path of the XML")
    .choice("wavelength", &["visible", "solar", "nir"], "the band, as the file names it")
}
