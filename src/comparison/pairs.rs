//! Which results of two reports belong together.

use super::change::Place;
use crate::report::{CheckResult, Report};
use std::collections::HashMap;

/// What names a result within a report: row, subject, check, and direction bit for bit.
type Key<'a> = (Option<&'a str>, &'a str, &'a str, Option<[u64; 2]>, bool);

/// The place of a result.
pub fn place(result: &CheckResult) -> Place {
    Place { wo: result.wo, transport: result.transport }
}

fn key(result: &CheckResult) -> Key<'_> {
    let wo = result.wo.map(|wo| [wo.theta_deg, wo.phi_deg].map(f64::to_bits));
    let radiance = result.transport == crate::bsdf::Transport::Radiance;
    (result.subject.label.as_deref(), &result.subject.name, &result.check, wo, radiance)
}

/// Each later result with the earlier one that it is to be compared with, and the
/// earlier ones that are left.
pub fn pairs<'a>(
    before: &'a Report,
    after: &'a Report,
) -> (Vec<(Option<&'a CheckResult>, &'a CheckResult)>, Vec<&'a CheckResult>) {
    let mut open: HashMap<Key, Vec<&CheckResult>> = HashMap::new();
    // Reversed, so that equal keys are taken in their order.
    for result in before.results.iter().rev() {
        open.entry(key(result)).or_default().push(result);
    }
    let paired = after.results.iter().map(|r| (open.get_mut(&key(r)).and_then(Vec::pop), r)).collect();
    let left: Vec<&CheckResult> = open.into_values().flatten().collect();
    (paired, left)
}
