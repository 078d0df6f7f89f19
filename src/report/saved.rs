//! Evidence on disk: `evidence/case-NNNN.json.gz`.

use crate::evidence::Evidence;
use flate2::read::GzDecoder;
use flate2::{Compression, GzBuilder};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Evidence unpacks to at most so many bytes: a thousand times what a case has.
const MOST_BYTES: u64 = 1 << 30;

/// Why a file could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The folder or the file could not be made.
    #[error("failed to write {}: {source}", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It holds a number that JSON does not, and would not be read again.
    #[error("{} would not be read again: {source}", path.display())]
    NotKept {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
    /// It could not be opened.
    #[error("failed to read {}: {source}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is cut short, damaged, or not gzip at all.
    #[error("{} is not a whole gzip file: {source}", path.display())]
    Damaged {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// What it unpacks to is not evidence of this version of gonio.
    #[error("{} does not hold evidence: {source}", path.display())]
    NotEvidence {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: serde_json::Error,
    },
}

/// Writes a whole file or none; its folder is made where there is none.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let write = || {
        let folder = path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        let mut file = tempfile::Builder::new().prefix(".writing-").tempfile_in(folder)?;
        file.write_all(bytes)?;
        readable_by_others(file.as_file())?;
        file.persist(path).map_err(|e| e.error)?;
        Ok(())
    };
    write().map_err(|source| FileError::Write { path: path.into(), source })
}

/// Files of a report are as open as other files; temporary ones are private.
#[cfg(unix)]
fn readable_by_others(file: &File) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn readable_by_others(_: &File) -> io::Result<()> {
    Ok(())
}

/// The path of a case's evidence, from the report's folder.
pub fn evidence_path(index: usize) -> String {
    format!("evidence/case-{index:04}.json.gz")
}

/// Writes a case's evidence into the report's folder; returns its path from
/// there. Equal evidence gives equal bytes.
pub fn write_evidence(report_dir: &Path, index: usize, evidence: &Evidence) -> Result<String, FileError> {
    let relative = evidence_path(index);
    let path = report_dir.join(&relative);
    let not_kept = |source| FileError::NotKept { path: path.clone(), source };
    let json = serde_json::to_vec(evidence).map_err(not_kept)?;
    // An infinite number is written as null, and is none when it comes back.
    serde_json::from_slice::<Evidence>(&json).map_err(not_kept)?;
    // Packing is done beside the measurements; a tenth more bytes for a third of its time.
    let mut packer = GzBuilder::new().mtime(0).write(Vec::new(), Compression::fast());
    let packed = packer.write_all(&json).and_then(|()| packer.finish());
    let packed = packed.map_err(|source| FileError::Write { path: path.clone(), source })?;
    write_whole(&path, &packed)?;
    Ok(relative)
}

/// Reads evidence that [`write_evidence`] wrote.
pub fn read_evidence(path: &Path) -> Result<Evidence, FileError> {
    let file = File::open(path).map_err(|source| FileError::Read { path: path.into(), source })?;
    let mut json = Vec::new();
    let unpacked = GzDecoder::new(io::BufReader::new(file)).take(MOST_BYTES).read_to_end(&mut json);
    unpacked.map_err(|source| FileError::Damaged { path: path.into(), source })?;
    serde_json::from_slice(&json).map_err(|source| FileError::NotEvidence { path: path.into(), source })
}

#[cfg(test)]
mod tests {
    use super::super::plots::synthetic::gallery;
    use super::*;

    #[test]
    fn evidence_comes_back_and_draws_the_same() {
        use super::super::plots::{Caption, disc_picture as picture};
        let folder = tempfile::tempdir().unwrap();
        let (_, evidence) = gallery().remove(0);
        let path = write_evidence(folder.path(), 7, &evidence).unwrap();
        assert_eq!(path, "evidence/case-0007.json.gz");
        let again = read_evidence(&folder.path().join(&path)).unwrap();
        let caption = Caption::default();
        assert_eq!(picture(&evidence, caption), picture(&again, caption));
        assert_eq!(evidence.draws, again.draws);
        let bytes = std::fs::read(folder.path().join(&path)).unwrap();
        write_evidence(folder.path(), 8, &evidence).unwrap();
        let same = bytes == std::fs::read(folder.path().join(evidence_path(8))).unwrap();
        assert!(same, "equal evidence gives equal bytes");
        assert!(bytes.len() < 100_000, "{} bytes", bytes.len());
        let files = std::fs::read_dir(folder.path().join("evidence")).unwrap().count();
        assert_eq!(files, 2, "no temporary file stays");
    }

    #[test]
    fn damage_is_told_and_never_a_panic() {
        let folder = tempfile::tempdir().unwrap();
        let (_, evidence) = gallery().remove(1);
        let path = folder.path().join(write_evidence(folder.path(), 0, &evidence).unwrap());
        let whole = std::fs::read(&path).unwrap();
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read_evidence(&path).unwrap_err()
        };
        for end in [0, 5, 10, 100, whole.len() / 2, whole.len() - 1] {
            let error = read(&whole[..end]);
            assert!(matches!(error, FileError::Damaged { .. }), "{end}: {error}");
            assert!(error.to_string().contains("case-0000"), "{error}");
        }
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 0x10;
        assert!(matches!(read(&flipped), FileError::Damaged { .. } | FileError::NotEvidence { .. }));
        assert!(matches!(read(b"{\"subject\":1}"), FileError::Damaged { .. }));
        let mut packer = GzBuilder::new().write(Vec::new(), Compression::default());
        packer.write_all(b"{\"subject\":1}").unwrap();
        assert!(matches!(read(&packer.finish().unwrap()), FileError::NotEvidence { .. }));
        let missing = read_evidence(&folder.path().join("nowhere.json.gz")).unwrap_err();
        assert!(matches!(missing, FileError::Read { .. }));
    }

    #[test]
    fn what_json_cannot_hold_is_refused_when_written() {
        let folder = tempfile::tempdir().unwrap();
        let (_, mut evidence) = gallery().remove(1);
        evidence.integrals.as_mut().unwrap().second[0] = f64::INFINITY;
        let error = write_evidence(folder.path(), 0, &evidence).unwrap_err();
        assert!(matches!(error, FileError::NotKept { .. }), "{error}");
        assert!(!folder.path().join(evidence_path(0)).exists());
    }
}
