//! The sections of a module, counted before anything is made of them: a million
//! exports cost nothing here, and have a name.

use super::problem::Problem;
use std::borrow::Cow;
use std::ops::Range;

/// Bytes that a module may have. The largest of plugins, Rust with debug
/// information, are of a few MiB.
pub const MOST_BYTES: u64 = 64 << 20;

/// The name under which the start function is exported. wasmi cannot interrupt a
/// start section, but it can interrupt a call.
pub const START: &str = "gonio: start";

/// Sections by their number: their name, what they have many of, and how many
/// there may be, about ten times what compilers make of large programs.
const SECTIONS: [(&str, &str, u32); 13] = [
    ("custom", "", u32::MAX),
    ("type", "types", 10_000),
    ("import", "imports", 1_000),
    ("function", "functions", 50_000),
    ("table", "tables", 16),
    ("memory", "memories", 1),
    ("global", "global variables", 10_000),
    ("export", "exports", 10_000),
    ("start", "", u32::MAX),
    ("element", "element segments", 10_000),
    ("code", "function bodies", 50_000),
    ("data", "data segments", 10_000),
    ("data count", "data segments", 10_000),
];

const EXPORT: u8 = 7;
const START_SECTION: u8 = 8;
const CODE: u8 = 10;

/// Local variables that all functions may have together. A few bytes declare
/// thousands, and compiling takes time for each.
const MOST_LOCALS: u32 = 2_000_000;

/// Checks the sections of `bytes`, and gives the module with its start section,
/// if it has one, made an export that is called [`START`].
pub fn checked(bytes: &[u8]) -> Result<Cow<'_, [u8]>, Problem> {
    if bytes.len() as u64 > MOST_BYTES {
        return Err(Problem::TooBig { bytes: bytes.len() as u64, most: MOST_BYTES });
    }
    check_head(bytes)?;
    let (mut start, mut exports) = (None, None);
    let mut at = 8;
    while at < bytes.len() {
        let section = section(bytes, at)?;
        at = section.content.end;
        match section.id {
            EXPORT => exports = Some(section),
            CODE => check_locals(&bytes[..at], section.content.start)?,
            START_SECTION if start.is_some() => return Ok(Cow::Borrowed(bytes)), // not valid
            START_SECTION => start = Some(section),
            _ => (),
        }
    }
    match (start, exports) {
        (Some(start), Some(exports)) => Ok(Cow::Owned(with_start_exported(bytes, &start, &exports)?)),
        _ => Ok(Cow::Borrowed(bytes)),
    }
}

/// One section: from its number to the end of its content.
struct Section {
    id: u8,
    begin: usize,
    content: Range<usize>,
}

fn check_head(bytes: &[u8]) -> Result<(), Problem> {
    let Some(magic) = bytes.strip_prefix(b"\0asm") else {
        return Err(Problem::NotWasm(beginning(bytes)));
    };
    match magic.first_chunk().map(|version| u32::from_le_bytes(*version)) {
        None => Err(Problem::CutOff { section: "head", at: 4, wants: 4, has: magic.len() }),
        Some(1) => Ok(()),
        Some(version) if version >> 16 == 1 => Err(Problem::Component),
        Some(version) => Err(Problem::Version(version)),
    }
}

/// What the file is instead.
fn beginning(bytes: &[u8]) -> String {
    let text = bytes.trim_ascii_start();
    if bytes.is_empty() {
        "it is empty".to_owned()
    } else if text.starts_with(b"(module") || text.starts_with(b";;") || text.starts_with(b"(;") {
        "it is its text form; translate it with wat2wasm or `wasm-tools parse`".to_owned()
    } else if bytes.starts_with(b"\x7fELF") {
        "it is a program or library of Linux; build it with --target=wasm32".to_owned()
    } else {
        let shown = &bytes[..bytes.len().min(8)];
        format!("it begins with \"{}\", not with \"\\0asm\"", shown.escape_ascii())
    }
}

fn section(bytes: &[u8], begin: usize) -> Result<Section, Problem> {
    let id = bytes[begin];
    let Some(&(name, what, most)) = SECTIONS.get(usize::from(id)) else {
        return Err(Problem::Invalid(format!("there is no section {id} (at byte {begin})")));
    };
    let (size, at) = number(bytes, begin + 1)?;
    let has = bytes.len() - at;
    if size as usize > has {
        return Err(Problem::CutOff { section: name, at, wants: u64::from(size), has });
    }
    let content = at..at + size as usize;
    if most < u32::MAX && size > 0 {
        let (count, _) = number(&bytes[..content.end], at)?;
        if count > most {
            return Err(Problem::TooMany { count, what, most });
        }
    }
    Ok(Section { id, begin, content })
}

/// Counts the local variables of the bodies in the code section at `at`.
fn check_locals(bytes: &[u8], at: usize) -> Result<(), Problem> {
    let (bodies, mut next) = number(bytes, at)?;
    let mut locals = 0_u32;
    for _ in 0..bodies {
        let (size, body) = number(bytes, next)?;
        next = body + size as usize;
        let (groups, mut at) = number(bytes, body)?;
        // Each is a number and a type of one byte; longer types are not valid here.
        for _ in 0..groups {
            let (count, ty) = number(bytes, at)?;
            locals = locals.saturating_add(count);
            at = ty + 1;
        }
        if locals > MOST_LOCALS {
            return Err(Problem::TooMany { count: locals, what: "local variables", most: MOST_LOCALS });
        }
    }
    Ok(())
}

/// The LEB128 number at `at`, and where it ends.
fn number(bytes: &[u8], at: usize) -> Result<(u32, usize), Problem> {
    let mut value = 0;
    for (i, byte) in bytes.iter().skip(at).take(5).enumerate() {
        value |= u64::from(byte & 0x7f) << (7 * i);
        if byte & 0x80 == 0 {
            return u32::try_from(value).map(|v| (v, at + i + 1)).map_err(|_| Problem::NoNumber { at });
        }
    }
    Err(Problem::NoNumber { at })
}

fn push_number(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn with_start_exported(bytes: &[u8], start: &Section, exports: &Section) -> Result<Vec<u8>, Problem> {
    let (function, _) = number(&bytes[..start.content.end], start.content.start)?;
    let (count, first) = number(&bytes[..exports.content.end], exports.content.start)?;
    let mut content = Vec::with_capacity(exports.content.len() + START.len() + 16);
    push_number(&mut content, count + 1);
    content.extend_from_slice(&bytes[first..exports.content.end]);
    push_number(&mut content, START.len() as u32);
    content.extend_from_slice(START.as_bytes());
    content.push(0);
    push_number(&mut content, function);
    let mut out = Vec::with_capacity(bytes.len() + START.len() + 16);
    let mut kept = 0;
    let mut sections = [start, exports];
    sections.sort_by_key(|section| section.begin);
    for section in sections {
        out.extend_from_slice(&bytes[kept..section.begin]);
        kept = section.content.end;
        if section.id == EXPORT {
            out.push(EXPORT);
            push_number(&mut out, content.len() as u32);
            out.extend_from_slice(&content);
        }
    }
    out.extend_from_slice(&bytes[kept..]);
    Ok(out)
}
