//! Reads the evidence of a page, and decides what of it the page carries.

use super::super::saved::read_evidence;
use super::cells::{self, ALL, COARSE};
use super::pack::packed;
use super::pictures::{self, Picture};
use super::subject::{Subject, is_telling};
use crate::evidence::Evidence;
use rayon::prelude::*;
use std::path::Path;

/// Where there are more cases than this, only suspicious ones and the first of each
/// subject are read: each takes some milliseconds, and a page cannot carry them all.
const MOST_CASES: usize = 1500;

/// Bytes of a page's cells and pictures at most.
const MOST_BYTES: usize = 12 << 20;

/// Of these, for pictures at most.
const MOST_PICTURES: usize = 4 << 20;

/// A whole page is to be smaller than this.
const PAGE: usize = 18 << 20;

/// What a page carries of a subject besides words.
#[derive(Default)]
pub struct Carried {
    /// The ratio of a diagnosis.
    pub ratio: Option<String>,
    /// Its pictures.
    pub pictures: Vec<Picture>,
    /// Cells of its cases: file of the evidence, and packed bytes.
    pub cells: Vec<(String, String)>,
    /// Whether any case has cells, here or in its evidence.
    pub has_cells: bool,
    /// Evidence that is named and could not be read: the first, and why.
    pub unread: Option<String>,
}

/// Cells of a case, in both finenesses.
struct Cells {
    evidence: String,
    /// 0 suspicious, 1 the first of its subject, 2 another.
    rank: usize,
    fine: String,
    coarse: String,
}

struct Read {
    ratio: Option<String>,
    pictures: Vec<Picture>,
    cells: Vec<Cells>,
    has_cells: bool,
    unread: Option<String>,
}

/// What the page carries of each subject. `words` are the bytes that it has besides.
pub fn gather(folder: &Path, subjects: &[Subject], words: usize) -> Vec<Carried> {
    let crowded = subjects.iter().map(|s| s.cases.len()).sum::<usize>() > MOST_CASES;
    let read: Vec<Read> = subjects.par_iter().map(|s| read(folder, s, crowded)).collect();
    choose(subjects, read, PAGE.saturating_sub(words).min(MOST_BYTES))
}

/// The path of evidence that a report names: never one outside of its folder.
fn is_ours(path: &str) -> bool {
    let name = path.strip_prefix("evidence/").and_then(|p| p.strip_suffix(".json.gz"));
    let tame = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    name.is_some_and(|name| !name.is_empty() && name.chars().all(tame))
}

fn read(folder: &Path, subject: &Subject, crowded: bool) -> Read {
    let first = subject.first_case();
    let mut unread = None;
    let mut of_cases: Vec<(usize, Evidence)> = Vec::new();
    let mut cells = Vec::new();
    let mut has_cells = false;
    for (number, case) in subject.cases.iter().enumerate() {
        let Some(path) = case.evidence else { continue };
        let rank = match () {
            () if is_telling(case.verdict) => 0,
            () if first == Some(number) => 1,
            () => 2,
        };
        if crowded && rank == 2 {
            has_cells |= is_ours(path);
            continue;
        }
        if !is_ours(path) {
            unread.get_or_insert_with(|| format!("{path}: evidence lies in evidence/, as NAME.json.gz"));
            continue;
        }
        let evidence = match read_evidence(&folder.join(path)) {
            Ok(evidence) => evidence,
            Err(error) => {
                unread.get_or_insert_with(|| told(folder, &error));
                continue;
            }
        };
        if let Some(fine) = cells::encode(&evidence, ALL) {
            has_cells = true;
            let coarse = cells::encode(&evidence, COARSE).map(|c| packed(&c)).unwrap_or_default();
            cells.push(Cells { evidence: path.into(), rank, fine: packed(&fine), coarse });
        }
        of_cases.push((number, evidence));
    }
    let all = of_cases.len() == subject.cases.len();
    Read {
        ratio: pictures::of_diagnosis(subject),
        pictures: pictures::of_cases(subject, &of_cases, all),
        cells,
        has_cells,
        unread,
    }
}

/// Without the folder, which is another on the reader's machine.
fn told(folder: &Path, error: &super::super::saved::FileError) -> String {
    error.to_string().replace(&format!("{}/", folder.display()), "")
}

/// Takes what fits into `most` bytes: pictures and cells of what is suspicious first.
fn choose(subjects: &[Subject], read: Vec<Read>, most: usize) -> Vec<Carried> {
    let mut left = most;
    let mut pictures_left = MOST_PICTURES.min(most);
    let mut carried: Vec<Carried> = Vec::new();
    let mut cells: Vec<(usize, Cells)> = Vec::new();
    let mut pictures: Vec<(usize, Vec<Picture>)> = Vec::new();
    for (number, read) in read.into_iter().enumerate() {
        left = left.saturating_sub(read.ratio.as_ref().map_or(0, String::len));
        let Read { ratio, has_cells, unread, .. } = read;
        carried.push(Carried { ratio, has_cells, unread, ..Carried::default() });
        cells.extend(read.cells.into_iter().map(|c| (number, c)));
        pictures.push((number, read.pictures));
    }
    let passes = |number: usize| !is_telling(subjects[number].verdict);
    pictures.sort_by_key(|(number, _)| passes(*number));
    for (number, of_subject) in pictures {
        for picture in of_subject {
            // Sections of subjects that pass are packed, and their pictures in them.
            let size = if passes(number) { packed(picture.svg.as_bytes()).len() } else { picture.svg.len() };
            if size <= pictures_left {
                pictures_left -= size;
                left = left.saturating_sub(size);
                carried[number].pictures.push(picture);
            }
        }
    }
    for rank in 0..3 {
        let of_rank = || cells.iter().filter(|(_, c)| c.rank == rank);
        let fine: usize = of_rank().map(|(_, c)| c.fine.len()).sum();
        // The first of each subject is to have cells, be they coarse.
        let reserved: usize = if rank == 0 {
            cells.iter().filter(|(_, c)| c.rank == 1).map(|(_, c)| c.coarse.len()).sum()
        } else {
            0
        };
        let coarse = fine > left.saturating_sub(reserved);
        let chosen: Vec<(usize, String, String)> = of_rank()
            .filter_map(|(number, c)| {
                let bytes = if coarse { &c.coarse } else { &c.fine };
                let fits = bytes.len() <= left;
                left -= if fits { bytes.len() } else { 0 };
                fits.then(|| (*number, c.evidence.clone(), bytes.clone()))
            })
            .collect();
        for (number, evidence, bytes) in chosen {
            carried[number].cells.push((evidence, bytes));
        }
    }
    carried
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_file_outside_of_the_evidence_is_read() {
        assert!(is_ours("evidence/case-0001.json.gz"));
        for path in ["/etc/passwd", "evidence/../../x.json.gz", "evidence/.json.gz", "x/case-1.json.gz", ""] {
            assert!(!is_ours(path), "{path}");
        }
    }
}
