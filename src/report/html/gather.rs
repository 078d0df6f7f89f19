//! Reads the evidence of a page, and decides what of it the page carries.

use super::super::saved::read_evidence;
use super::cells::{self, ALL, COARSE};
use super::pack::packed;
use super::pictures::{self, Picture};
use super::subject::{Subject, is_telling, is_wrong};
use crate::evidence::Evidence;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::path::Path;

/// Besides the first case of each subject at most so many are read, those that fail first:
/// each takes some milliseconds, and a page cannot carry them all.
const MOST_CASES: usize = 1500;

/// Where there are more subjects, those that pass have no pictures: some take as long to
/// draw as a case takes to read.
const MOST_DRAWN: usize = 400;

/// Bytes of a page's cells and pictures at most.
const MOST_BYTES: usize = 12 << 20;

/// Of these, for pictures at most.
const MOST_PICTURES: usize = 4 << 20;

/// Fine cells of the first case of each subject are carried up to so many bytes.
const MOST_FINE_FIRSTS: usize = 4 << 20;

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

/// How much a case is worth a place on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    /// It fails, or could not be measured.
    Wrong,
    /// It is the first of its subject.
    First,
    /// It is unclear, or waived.
    Unclear,
    /// Another.
    Rest,
}

const RANKS: [Rank; 4] = [Rank::Wrong, Rank::First, Rank::Unclear, Rank::Rest];

/// Cells of a case, in both finenesses.
struct Cells {
    evidence: String,
    rank: Rank,
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
    let wanted = wanted(subjects);
    let crowded = subjects.len() > MOST_DRAWN;
    let one = |(subject, wanted): (&Subject, &Vec<Option<Rank>>)| {
        read(folder, subject, wanted, is_telling(subject.verdict) || !crowded)
    };
    let read: Vec<Read> = subjects.par_iter().zip(&wanted).map(one).collect();
    choose(subjects, read, PAGE.saturating_sub(words).min(MOST_BYTES))
}

fn rank(subject: &Subject, number: usize) -> Rank {
    match subject.cases[number].verdict {
        verdict if is_wrong(verdict) => Rank::Wrong,
        _ if subject.first_case() == Some(number) => Rank::First,
        verdict if is_telling(verdict) => Rank::Unclear,
        _ => Rank::Rest,
    }
}

/// The ranks of the cases of each subject that are to be read; `None` of the others.
fn wanted(subjects: &[Subject]) -> Vec<Vec<Option<Rank>>> {
    let ranks: Vec<Vec<Rank>> =
        subjects.iter().map(|s| (0..s.cases.len()).map(|number| rank(s, number)).collect()).collect();
    let firsts: Vec<Option<usize>> = subjects.iter().map(Subject::first_case).collect();
    let mut left = MOST_CASES;
    let mut wanted: Vec<Vec<Option<Rank>>> = ranks.iter().map(|of| vec![None; of.len()]).collect();
    for rank in RANKS {
        for (subject, of) in ranks.iter().enumerate() {
            for (number, _) in of.iter().enumerate().filter(|(_, r)| **r == rank) {
                let first = firsts[subject] == Some(number);
                if first || left > 0 {
                    wanted[subject][number] = Some(rank);
                    left -= usize::from(!first);
                }
            }
        }
    }
    wanted
}

/// The path of evidence that a report names: never one outside of its folder.
fn is_ours(path: &str) -> bool {
    let name = path.strip_prefix("evidence/").and_then(|p| p.strip_suffix(".json.gz"));
    let tame = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    name.is_some_and(|name| !name.is_empty() && name.chars().all(tame))
}

fn read(folder: &Path, subject: &Subject, wanted: &[Option<Rank>], drawn: bool) -> Read {
    let mut unread = None;
    let mut of_cases: Vec<(usize, Evidence)> = Vec::new();
    let mut cells = Vec::new();
    let mut has_cells = false;
    for (number, case) in subject.cases.iter().enumerate() {
        let Some(path) = case.evidence else { continue };
        if !is_ours(path) {
            unread.get_or_insert_with(|| format!("{path}: evidence lies in evidence/, as NAME.json.gz"));
            continue;
        }
        let Some(rank) = wanted[number] else { continue };
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
        pictures: if drawn { pictures::of_cases(subject, &of_cases, all) } else { Vec::new() },
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
    pictures.sort_by_key(|(number, _)| Reverse(subjects[*number].verdict));
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
    for rank in RANKS {
        let of_rank = || cells.iter().filter(|(_, c)| c.rank == rank);
        let fine: usize = of_rank().map(|(_, c)| c.fine.len()).sum();
        // The first of each subject is to have cells, be they coarse; where there are many,
        // a page that opens at once is worth more than fine cells of what passes.
        let firsts = || cells.iter().filter(|(_, c)| c.rank == Rank::First);
        let reserved: usize = match rank {
            Rank::Wrong => firsts().map(|(_, c)| c.coarse.len()).sum(),
            _ => 0,
        };
        let room = match rank {
            Rank::First => left.min(MOST_FINE_FIRSTS),
            _ => left.saturating_sub(reserved),
        };
        let chosen: Vec<(usize, String, String)> = of_rank()
            .filter_map(|(number, c)| {
                let bytes = if fine > room { &c.coarse } else { &c.fine };
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
    fn failures_are_read_first_and_no_more_than_there_is_time_for() {
        use super::super::super::synthetic::report;
        use super::super::subject::subjects;
        let mut report = report();
        let one = report.results[0].clone();
        report.results.clear();
        for number in 0..2000 {
            let mut result = one.clone();
            result.subject.name = format!("m{}", number / 4);
            result.wo.as_mut().unwrap().theta_deg = f64::from(10 * (number % 4));
            result.verdict = if number == 1998 { crate::checks::Verdict::Fail } else { one.verdict };
            report.results.push(result);
        }
        let columns = report.checks();
        let subjects = subjects(&report, &columns);
        let wanted = wanted(&subjects);
        assert!(wanted.iter().zip(&subjects).all(|(w, s)| w[s.first_case().unwrap()].is_some()));
        assert_eq!(wanted.iter().flatten().flatten().count(), 500 + MOST_CASES);
        assert_eq!(wanted[499][2], Some(Rank::Wrong));
    }

    #[test]
    fn no_file_outside_of_the_evidence_is_read() {
        assert!(is_ours("evidence/case-0001.json.gz"));
        for path in ["/etc/passwd", "evidence/../../x.json.gz", "evidence/.json.gz", "x/case-1.json.gz", ""] {
            assert!(!is_ours(path), "{path}");
        }
    }
}
