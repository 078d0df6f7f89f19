//! What tells this program from any other build of it.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// More program headers or bytes of notes than this are no program's.
const MOST_HEADERS: u16 = 256;
const MOST_NOTES: u64 = 1 << 16;

/// Its linker's build id with its length, where it has one: a hash of what was linked,
/// which spares reading all of it (20 MB take longer than a short check). Else the
/// BLAKE3 hash of the file; empty where it cannot be read.
pub fn identity() -> Vec<u8> {
    let read = || -> io::Result<Vec<u8>> {
        let mut file = File::open(std::env::current_exe()?)?;
        if let Some(mut id) = build_id(&mut file) {
            id.extend(file.metadata()?.len().to_le_bytes());
            return Ok(id);
        }
        file.rewind()?;
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(file)?;
        Ok(hasher.finalize().as_bytes().to_vec())
    };
    read().unwrap_or_default()
}

/// The note of type 3 of `GNU` in a little-endian ELF file of 64 bits (System V ABI,
/// "ELF Header", "Program Header", "Note Section"; ld(1), `--build-id`).
fn build_id(file: &mut (impl Read + Seek)) -> Option<Vec<u8>> {
    let header: [u8; 64] = array(file, 0)?;
    if header[..6] != *b"\x7fELF\x02\x01" {
        return None;
    }
    let (table, size) = (u64_at(&header, 32)?, u16_at(&header, 54)?);
    for k in 0..u16_at(&header, 56)?.min(MOST_HEADERS) {
        let program: [u8; 56] = array(file, table.checked_add(u64::from(k) * u64::from(size))?)?;
        const NOTE: u32 = 4;
        if u32_at(&program, 0)? != NOTE {
            continue;
        }
        file.seek(SeekFrom::Start(u64_at(&program, 8)?)).ok()?;
        let mut notes = Vec::new();
        file.by_ref().take(u64_at(&program, 32)?.min(MOST_NOTES)).read_to_end(&mut notes).ok()?;
        if let Some(id) = id_among(&notes) {
            return Some(id.to_vec());
        }
    }
    None
}

/// Name and contents of each note fill whole words.
fn id_among(mut notes: &[u8]) -> Option<&[u8]> {
    const BUILD_ID: u32 = 3;
    while notes.len() >= 12 {
        let (name, length) = (u32_at(notes, 0)? as usize, u32_at(notes, 4)? as usize);
        let from = 12 + name.checked_next_multiple_of(4)?;
        let contents = notes.get(from..from.checked_add(length)?)?;
        if u32_at(notes, 8)? == BUILD_ID && notes[12..].starts_with(b"GNU\0") && name == 4 {
            return (!contents.is_empty()).then_some(contents);
        }
        notes = notes.get(from + length.checked_next_multiple_of(4)?..)?;
    }
    None
}

fn array<const N: usize>(file: &mut (impl Read + Seek), at: u64) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    file.seek(SeekFrom::Start(at)).ok()?;
    file.read_exact(&mut bytes).ok()?;
    Some(bytes)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// A file with one segment that is no note, and one of two notes.
    fn elf(notes: &[u8]) -> Vec<u8> {
        let mut file = vec![0; 64];
        file[..6].copy_from_slice(b"\x7fELF\x02\x01");
        file[32] = 64;
        file[54] = 56;
        file[56] = 2;
        let mut program = vec![0; 112];
        program[0] = 1;
        program[56] = 4;
        program[56 + 8] = 64 + 112;
        program[56 + 32] = notes.len() as u8;
        file.extend(program);
        file.extend(notes);
        file
    }

    fn note(kind: u8, name: &[u8; 4], contents: &[u8]) -> Vec<u8> {
        let mut note = vec![4, 0, 0, 0, contents.len() as u8, 0, 0, 0, kind, 0, 0, 0];
        note.extend(name);
        note.extend(contents);
        note.resize(note.len().next_multiple_of(4), 0);
        note
    }

    #[test]
    fn a_build_id_is_found_among_other_notes() {
        let id = |notes: &[Vec<u8>]| build_id(&mut Cursor::new(elf(&notes.concat())));
        let other = note(1, b"GNU\0", b"12345");
        let foreign = note(3, b"Go\0\0", b"abc");
        let own = note(3, b"GNU\0", b"the id");
        assert_eq!(id(&[other.clone(), foreign.clone(), own]).unwrap(), b"the id");
        assert_eq!(id(&[other, foreign]), None);
    }

    #[test]
    fn what_is_no_such_file_has_none() {
        let whole = elf(&note(3, b"GNU\0", b"of words"));
        for length in 0..whole.len() {
            assert_eq!(build_id(&mut Cursor::new(&whole[..length])), None, "{length}");
        }
        let mut other = whole.clone();
        other[0] = 0;
        assert_eq!(build_id(&mut Cursor::new(&other)), None);
        assert_eq!(build_id(&mut Cursor::new(vec![0xff; 4096])), None);
    }

    #[test]
    fn this_program_is_the_same_as_itself() {
        assert!(!identity().is_empty());
        assert_eq!(identity(), identity());
    }
}
