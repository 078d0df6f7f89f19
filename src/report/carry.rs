//! Results of an earlier report, for subjects that are what they were.

use super::json::{CheckResult, Diagnosis, Report, SubjectEntry};
use super::saved::{FileError, evidence_path, write_whole};
use crate::bsdf::Transport;
use crate::checks::Verdict;
use crate::suite::{Case, Plan, digests};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

/// What is taken over from an earlier report.
#[derive(Clone, Debug, Default)]
pub struct Carried {
    /// Results by the number of their case in the plan.
    pub rows: BTreeMap<usize, Vec<CheckResult>>,
    /// Diagnoses of their subjects.
    pub diagnoses: Vec<Diagnosis>,
    /// Their subjects: group and spelling.
    subjects: BTreeSet<(String, String)>,
    /// Evidence by the number of the case: read before anything is written, since the
    /// later report may go into the same folder, where numbers have other meanings.
    evidence: Vec<(usize, Vec<u8>)>,
}

type Key<'a> = (Option<&'a str>, &'a str, Option<[u64; 2]>, Transport);

fn of_row(row: &CheckResult) -> Key<'_> {
    let wo = row.wo.map(|wo| [wo.theta_deg, wo.phi_deg].map(f64::to_bits));
    (row.subject.label.as_deref(), &row.subject.name, wo, row.transport)
}

impl Carried {
    /// What of `earlier`, which lies in `folder`, holds for the cases of a plan: of each
    /// subject with the same digest, if every case of it was measured.
    pub fn of(earlier: &Report, folder: &Path, plan: &Plan, samples: bool) -> Self {
        let known: BTreeMap<(Option<&str>, &str), &SubjectEntry> =
            earlier.subjects.iter().map(|s| ((s.label.as_deref(), s.name.as_str()), s)).collect();
        let mut rows: HashMap<Key, Vec<&CheckResult>> = HashMap::new();
        for row in &earlier.results {
            rows.entry(of_row(row)).or_default().push(row);
        }
        let find = |case: &Case| {
            let wo = [case.theta_deg, case.phi_deg].map(f64::to_bits);
            let key = |wo| (label(&case.group, &case.spelling), case.spelling.as_str(), wo, case.transport);
            let found = rows.get(&key(Some(wo))).or_else(|| rows.get(&key(None)))?;
            found
                .iter()
                .all(|row| is_measured(row))
                .then(|| found.iter().map(|r| (*r).clone()).collect::<Vec<_>>())
        };
        let mut same: BTreeSet<(String, String)> = digests(plan, samples)
            .into_iter()
            .filter(|((group, spelling), digest)| {
                known
                    .get(&(label(group, spelling), spelling.as_str()))
                    .is_some_and(|entry| entry.digest == *digest)
            })
            .map(|(key, _)| key)
            .collect();
        let mut carried = Self::default();
        for (index, case) in plan.cases.iter().enumerate() {
            let key = (case.group.clone(), case.spelling.clone());
            if !same.contains(&key) {
                continue;
            }
            match find(case) {
                Some(found) => drop(carried.rows.insert(index, found)),
                None => drop(same.remove(&key)),
            }
        }
        carried.rows.retain(|index, _| {
            let case = &plan.cases[*index];
            same.contains(&(case.group.clone(), case.spelling.clone()))
        });
        let named: BTreeSet<&str> = same.iter().map(|(_, spelling)| spelling.as_str()).collect();
        let of_them = |d: &&Diagnosis| named.contains(d.subject.as_str());
        carried.diagnoses = earlier.diagnoses.iter().filter(of_them).cloned().collect();
        for (index, rows) in &mut carried.rows {
            let path = rows.iter().find_map(|row| row.evidence.clone());
            let bytes = path.and_then(|path| std::fs::read(folder.join(path)).ok());
            let kept = bytes.as_ref().map(|_| evidence_path(*index));
            carried.evidence.extend(bytes.map(|bytes| (*index, bytes)));
            for row in rows {
                row.evidence.clone_from(&kept);
                row.plot = None;
            }
        }
        carried.subjects = same;
        carried
    }

    /// Numbers of the plan's cases that are to be measured.
    pub fn left(&self, plan: &Plan) -> Vec<usize> {
        (0..plan.cases.len()).filter(|index| !self.rows.contains_key(index)).collect()
    }

    /// Whether a subject's results are taken over.
    pub fn holds(&self, group: &str, spelling: &str) -> bool {
        self.subjects.contains(&(group.into(), spelling.into()))
    }

    /// Writes the evidence of what is taken over into the later report's folder.
    pub fn write_evidence(&self, folder: &Path) -> Result<(), FileError> {
        for (index, bytes) in &self.evidence {
            write_whole(&folder.join(evidence_path(*index)), bytes)?;
        }
        Ok(())
    }
}

/// What a row is called that is not named as its subject.
pub fn label<'a>(group: &'a str, spelling: &str) -> Option<&'a str> {
    (spelling.split(':').next() != Some(group)).then_some(group)
}

/// Not of a case that was never begun, nor of one that could not be measured.
fn is_measured(row: &CheckResult) -> bool {
    row.verdict != Verdict::Error && row.evaluations.total() > 0
}
