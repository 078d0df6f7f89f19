//! What the results of a subject depend on, as one short text.

use super::plan::{Case, Plan};
use super::program;
use crate::evidence::Meter;
use crate::plugins::Named;
use crate::registry::{Spelling, Value};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, LazyLock};

/// Hexadecimal digits of a digest: 64 bits, so that two of a million differ.
const DIGITS: usize = 16;

/// This program, which is the code of every subject that is built in.
static PROGRAM: LazyLock<Vec<u8>> = LazyLock::new(program::identity);

/// The digest of each subject of a plan, by group and spelling: of what it says of
/// itself, the bytes of its file or program (the [identity](program::identity) of this
/// program for what is built in; what a script imports is not seen), and how it is measured. `samples` are left out where
/// a budget of time decides them.
pub fn digests(plan: &Plan, samples: bool) -> BTreeMap<(String, String), String> {
    let mut open: BTreeMap<(String, String), blake3::Hasher> = BTreeMap::new();
    for case in &plan.cases {
        let key = (case.group.clone(), case.spelling.clone());
        let hasher = open.entry(key).or_insert_with(|| subject(plan, case));
        let mut settings = case.settings.clone();
        settings.samples = if samples { settings.samples } else { 0 };
        let measured = (case.theta_deg, case.phi_deg, case.transport, &case.checks, &case.waivers, settings);
        add(hasher, format!("{measured:?}").as_bytes());
        if let Some(within) = case.company.within {
            add(hasher, &within.to_le_bytes());
        }
    }
    let hex = |hasher: blake3::Hasher| hasher.finalize().to_hex()[..DIGITS].to_string();
    open.into_iter().map(|(key, hasher)| (key, hex(hasher))).collect()
}

/// Each part with its length, so that none runs into the next.
fn add(hasher: &mut blake3::Hasher, bytes: &[u8]) {
    hasher.update(&(bytes.len() as u64).to_le_bytes());
    hasher.update(bytes);
}

fn subject(plan: &Plan, case: &Arc<Case>) -> blake3::Hasher {
    let mut hasher = blake3::Hasher::new();
    add(&mut hasher, env!("CARGO_PKG_VERSION").as_bytes());
    let terms = (plan.seed, plan.false_alarm, plan.share.map(f64::to_bits));
    add(&mut hasher, format!("{terms:?}").as_bytes());
    let description = Meter::describe(&*case.subject).map_err(|e| e.to_string());
    // What it says of itself may hold no number that JSON lacks; its debug text has all.
    add(&mut hasher, format!("{description:?} {:?}", case.claims).as_bytes());
    for spelling in std::iter::once(&case.spelling).chain(&case.reference) {
        add(&mut hasher, spelling.as_bytes());
        code(&mut hasher, spelling);
    }
    hasher
}

/// The bytes behind a spelling: of the plugin or this program, and of files that
/// parameters name.
fn code(hasher: &mut blake3::Hasher, spelling: &str) {
    let parsed = spelling.parse::<Spelling>().ok();
    let name = parsed.as_ref().map_or(spelling, |s| &s.name);
    let file = name.rsplit_once('#').map_or(name, |(file, _)| file);
    match Named::of(name).or_else(|| Named::of(file)) {
        Some(named) => named.files().iter().for_each(|path| content(hasher, path)),
        None => add(hasher, &PROGRAM),
    }
    for (_, value) in parsed.iter().flat_map(|s| &s.parameters) {
        let Value::Text(text) = value else { continue };
        if Path::new(text).is_file() {
            content(hasher, Path::new(text));
        } else if text.split([':', '#']).next().is_some_and(|file| Named::of(file).is_some()) {
            // A subject within another.
            code(hasher, text);
        }
    }
}

fn content(hasher: &mut blake3::Hasher, path: &Path) {
    match std::fs::read(path) {
        Ok(bytes) => add(hasher, blake3::hash(&bytes).as_bytes()),
        Err(_) => add(hasher, b"unreadable"),
    }
}
