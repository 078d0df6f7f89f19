//! What a program tried that no BRDF needs, and where that is kept.

use crate::report::visible::one_line;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Kinds of incidents that one process writes down: who tries a thousand paths has been
/// seen after some dozens.
const KINDS: usize = 40;

/// Characters of one of them.
const LENGTH: usize = 200;

/// Bytes of a log: many processes write to it.
const LOG: u64 = 1 << 20;

/// What stands for all further kinds.
const MORE: &str = "more of the kind";

/// Something that a submission tried and that no BRDF needs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub struct Incident {
    /// While it was built, or measured.
    pub phase: Phase,
    /// In a few words, with the path, address or program.
    pub what: String,
    /// How often.
    pub times: u64,
}

/// When something happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phase {
    /// While it was unpacked and built.
    Build,
    /// While it was measured.
    Run,
}

/// Incidents on their way into a file of JSON lines, each with how often since the last.
pub struct Log {
    path: Option<PathBuf>,
    phase: Phase,
    /// All kinds, and how often each since they were written.
    seen: BTreeMap<String, u64>,
}

impl Log {
    /// Appends to `path`, if there is one.
    pub fn new(path: Option<&Path>, phase: Phase) -> Self {
        Self { path: path.map(Path::to_path_buf), phase, seen: BTreeMap::new() }
    }

    /// Once more.
    pub fn note(&mut self, what: &str) {
        let mut what: String = one_line(what).chars().take(LENGTH + 1).collect();
        if what.chars().count() > LENGTH {
            what = what.chars().take(LENGTH - 1).collect();
            what.push('…');
        }
        if self.seen.len() >= KINDS && !self.seen.contains_key(&what) {
            what = MORE.into();
        }
        *self.seen.entry(what).or_default() += 1;
    }

    /// Writes what is new.
    pub fn flush(&mut self) {
        let mut lines = String::new();
        for (what, times) in self.seen.iter_mut().filter(|(_, times)| **times > 0) {
            let incident = Incident { phase: self.phase, what: what.clone(), times: *times };
            *times = 0;
            if let Ok(line) = serde_json::to_string(&incident) {
                lines += &line;
                lines.push('\n');
            }
        }
        let Some(path) = self.path.as_ref().filter(|_| !lines.is_empty()) else { return };
        // In one piece, since others append to it too.
        if let Ok(mut file) = OpenOptions::new().create(true).append(true).open(path)
            && file.metadata().is_ok_and(|m| m.len() < LOG)
        {
            let _ = file.write_all(lines.as_bytes());
        }
    }
}

/// The incidents of a log, equal ones in one; none if there is no log.
pub fn incidents(log: &Path) -> Vec<Incident> {
    let text = std::fs::read_to_string(log).unwrap_or_default();
    let mut all: BTreeMap<(Phase, String), u64> = BTreeMap::new();
    for incident in text.lines().filter_map(|line| serde_json::from_str::<Incident>(line).ok()) {
        *all.entry((incident.phase, incident.what)).or_default() += incident.times;
    }
    all.into_iter().map(|((phase, what), times)| Incident { phase, what, times }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_is_bounded_and_adds_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        assert_eq!(incidents(&path), []);
        for _ in 0..2 {
            let mut log = Log::new(Some(&path), Phase::Run);
            log.note("opened /x\n\u{1b}[31m\u{202e}");
            log.flush();
            log.note("opened /x\n\u{1b}[31m\u{202e}");
            log.note(&"a".repeat(1000));
            for k in 0..1000 {
                log.note(&format!("opened /{k:04}"));
            }
            log.flush();
            log.flush();
        }
        let all = incidents(&path);
        assert_eq!(all.len(), KINDS + 1);
        let times = |part: &str| all.iter().filter(|i| i.what.contains(part)).map(|i| i.times).sum::<u64>();
        assert_eq!(times("opened /x ␛[31m\u{fffd}"), 4);
        assert_eq!(times("more of"), 2 * (1002 - KINDS as u64));
        assert!(all.iter().all(|i| i.what.chars().count() <= LENGTH && !i.what.contains('\n')));
        for k in 0..100 {
            let mut log = Log::new(Some(&path), Phase::Build);
            (0..KINDS).for_each(|n| log.note(&format!("{k} {n} {}", "b".repeat(LENGTH))));
            log.flush();
        }
        assert!(path.metadata().unwrap().len() < LOG + 100_000);
    }
}
