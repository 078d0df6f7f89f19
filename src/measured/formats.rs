//! What a file is, by its content.

use super::{merl_file, tensor_file};

/// A format that is read, or one that is known and is not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Format {
    /// A MERL table.
    Merl,
    /// A tensor file, as the RGL material database uses.
    Tensor,
    /// XML of LBNL's WINDOW.
    WindowXml,
    /// Another one, which gonio does not read, by its name.
    Other(&'static str),
    /// None that is known.
    Unknown,
}

/// What files of other formats begin with.
const BEGINNINGS: [(&[u8], &str); 27] = [
    (b"\x89PNG\r\n\x1a\n", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"\x76\x2f\x31\x01", "an OpenEXR picture"),
    (b"#?RADIANCE", "a Radiance HDR picture"),
    (b"#?RGBE", "a Radiance HDR picture"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive (unpack it first; NumPy's .npz is one too)"),
    (b"\x1f\x8b", "a gzip file (unpack it first)"),
    (b"BZh", "a bzip2 file (unpack it first)"),
    (b"\xfd7zXZ\0", "an xz file (unpack it first)"),
    (b"7z\xbc\xaf\x27\x1c", "a 7-Zip archive (unpack it first)"),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file (AxF and MATLAB 7.3 are of this kind)"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"version https://git-lfs", "a Git LFS pointer in place of the data (fetch them with `git lfs pull`)"),
    (b"IESNA", "IES photometric data (LM-63)"),
    (b"IES", "IES photometric data"),
    (b"ASTM", "ASTM E1392 scatter data"),
    (b"mdl ", "an MDL material"),
    (b"{\\rtf", "an RTF document"),
    (b"glTF", "a glTF scene"),
    (b"!ELF", "an ELF program"),
    (b"\x7fELF", "an ELF program"),
    (b"{", "JSON"),
];

/// Words on the first lines of text formats.
const WORDS: [(&str, &str); 6] = [
    ("TILT=", "IES photometric data"),
    ("E1392", "ASTM E1392 scatter data"),
    ("\nVARS", "ASTM E1392 scatter data"),
    ("ScatterType", "Zemax BSDF data"),
    ("SpectralContent", "Zemax BSDF data"),
    ("LightTools", "LightTools BSDF data"),
];

/// Bytes of the UTIA BRDF database's `.bin` files: 288 × 288 pairs of directions,
/// three channels of f64, no header.
const UTIA: usize = 288 * 288 * 3 * 8;

impl Format {
    /// Of this content.
    pub fn of(bytes: &[u8]) -> Self {
        if bytes.starts_with(tensor_file::MAGIC) || bytes.starts_with(b"tensor_file") {
            return Self::Tensor;
        }
        if merl_file::is_merl(bytes) {
            return Self::Merl;
        }
        if bytes.is_empty() {
            return Self::Other("an empty file");
        }
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]);
        let text = head.trim_start_matches('\u{feff}').trim_start();
        if text.starts_with('<') {
            return Self::of_markup(text);
        }
        if let Some((_, name)) = BEGINNINGS.iter().find(|(start, _)| bytes.starts_with(start)) {
            return Self::Other(name);
        }
        if let Some((_, name)) = WORDS.iter().find(|(word, _)| text.contains(word)) {
            return Self::Other(name);
        }
        if bytes.len() == UTIA {
            return Self::Other("a table of the UTIA BRDF database");
        }
        Self::Unknown
    }

    fn of_markup(text: &str) -> Self {
        let lower = text.to_ascii_lowercase();
        if text.contains("<WindowElement") {
            Self::WindowXml
        } else if lower.starts_with("<!doctype html") || lower.starts_with("<html") {
            Self::Other("an HTML page, such as a download that failed")
        } else if text.contains("<materialx") {
            Self::Other("a MaterialX document")
        } else if text.contains("<scene") {
            Self::Other("a Mitsuba scene")
        } else if text.contains("<svg") {
            Self::Other("an SVG picture")
        } else {
            Self::Other("XML without a WindowElement")
        }
    }
}

/// The formats that are read, for messages.
pub(super) const READ: &str = "MERL .binary, RGL tensor .bsdf and WINDOW XML (Klems, tensor tree)";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_tells_the_format() {
        for (bytes, format) in [
            (&b"tensor_file\0\x01\0"[..], Format::Tensor),
            (b"\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0", Format::Merl),
            (b"\0\0\0\x5a\0\0\0\x5a\0\0\0\xb4", Format::Merl),
            (b"\x89PNG\r\n\x1a\nxxxx", Format::Other("a PNG picture")),
            (b"IESNA:LM-63-2002\n", Format::Other("IES photometric data (LM-63)")),
            (b"Source  Measured\nSpectralContent XYZ\n", Format::Other("Zemax BSDF data")),
            (b"\xef\xbb\xbf <?xml version=\"1.0\"?>\n<WindowElement>", Format::WindowXml),
            (b"<?xml version=\"1.0\"?><a/>", Format::Other("XML without a WindowElement")),
            (b"<!DOCTYPE html><p>404", Format::Other("an HTML page, such as a download that failed")),
            (b"", Format::Other("an empty file")),
            (b"hello", Format::Unknown),
        ] {
            assert_eq!(Format::of(bytes), format, "{bytes:?}");
        }
        assert_eq!(Format::of(&vec![0; UTIA]), Format::Other("a table of the UTIA BRDF database"));
        // Three dimensions and as many values as they promise.
        let mut odd: Vec<u8> = [2i32, 3, 4].iter().flat_map(|n| n.to_le_bytes()).collect();
        odd.resize(12 + 24 * 24, 0);
        assert_eq!(Format::of(&odd), Format::Merl);
        odd.pop();
        assert_eq!(Format::of(&odd), Format::Unknown);
    }
}
