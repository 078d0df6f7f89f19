//! Runs one case: gathers evidence, lets the checks judge it, draws more where
//! they ask for it, and confirms what they suspect.

use super::results::{Attempt, CaseResult, Finding};
use crate::bsdf::{Description, Precision, SubjectError};
use crate::checks::{self, Check, Judgement, Outcome, Terms, Verdict};
use crate::evidence::{BLOCK, Company, Evidence, Gatherer, Halt, Measurement, Meter, Setup, Watch};
use crate::statistics::budget;
use crate::statistics::streams::StreamKey;
use crate::suite::{Case, Waiver};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Instant;

/// Draws of the first look. Looks are four times apart, so that gross bugs stop
/// early and no more than log₄ of the cap share the budget.
const FIRST_LOOK: u64 = 1 << 14;
const LOOK_FACTOR: u64 = 4;

/// Looks of a confirmation, the last with half of its budget.
const CONFIRMATION: usize = 4;

/// A confirmation looks at N, 2N, 4N and 8N draws, N being where the suspicion arose
/// (METHOD §3); the last at the `cap` of the case, where that is more: an early look
/// may have been lucky with an error that only all draws show.
fn confirmation(suspected_at: u64, cap: u64) -> [u64; CONFIRMATION] {
    let n = suspected_at;
    [n, 2 * n, 4 * n, (8 * n).max(cap)]
}

/// RMS relative cell error that counts as wrong where the suite does not say
/// (METHOD §3): what a textbook implementation in this precision reaches. A table
/// that is drawn from exactly has no more of it.
fn default_tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F64 => 3e-3,
        Precision::F32 => 1e-2,
    }
}

/// Relative error of masses and means that counts as wrong (METHOD §3).
const MEAN_TOLERANCE: f64 = 1e-3;

/// Numbers of draws at which checks look, up to `cap`, in whole blocks.
fn looks(cap: u64) -> Vec<u64> {
    let cap = cap.div_ceil(BLOCK).max(1) * BLOCK;
    let mut looks: Vec<u64> =
        std::iter::successors(Some(FIRST_LOOK), |n| Some(n * LOOK_FACTOR)).take_while(|n| *n < cap).collect();
    looks.push(cap);
    looks
}

/// The case's description under the suite's claims.
fn description(case: &Case) -> Result<Description, SubjectError> {
    let mut description = Meter::describe(&*case.subject)?;
    description.claims = case.claims.over(description.claims);
    Ok(description)
}

/// The checks that a case runs.
fn selected(case: &Case) -> Vec<&'static dyn Check> {
    let wanted = |check: &&dyn Check| case.checks.is_empty() || case.checks.iter().any(|id| id == check.id());
    checks::all().iter().copied().filter(wanted).collect()
}

/// `Err` with the reason where a check is not run on a case.
fn applies(check: &dyn Check, case: &Case, description: &Description) -> Result<(), String> {
    checks::needs_kind(check, description.kind)?;
    if check.id() == "reference" && case.company.reference.is_none() {
        return Err("the suite names no reference".into());
    }
    if let Some(sure) = description.by_construction.iter().find(|sure| sure.check == check.id()) {
        return Err(format!("cannot fail by construction: {}", sure.because));
    }
    check.applies(description)
}

/// Number of tests of a case that share the false-alarm budget.
pub fn statistical_tests(case: &Case) -> usize {
    let Ok(description) = description(case) else { return 0 };
    let statistical = |c: &&&dyn Check| c.is_statistical() && applies(**c, case, &description).is_ok();
    selected(case).iter().filter(statistical).count()
}

/// A check that has not said its last word.
struct Open {
    check: &'static dyn Check,
    /// The first attempt, once it led to a suspicion.
    suspicion: Option<(Outcome, Attempt)>,
}

impl Open {
    /// Draws at which the suspicion arose.
    fn suspected_at(&self) -> Option<u64> {
        Some(self.suspicion.as_ref()?.1.samples)
    }
}

/// Runs a case. `share` is what each of its statistical tests may spend.
pub fn run_case<'a>(
    index: usize,
    case: &Arc<Case<'a>>,
    seed: u64,
    share: f64,
    watch: &Arc<Watch>,
) -> CaseResult<'a> {
    let start = Instant::now();
    let mut findings = Vec::new();
    let evidence = match description(case) {
        Ok(description) => Some(Run::new(case, seed, share, description, watch).finish(&mut findings)),
        Err(error) => {
            for check in selected(case) {
                findings.push(finding(check, Outcome::error(error.to_string()), Vec::new()));
            }
            None
        }
    };
    findings.sort_by_key(|f| checks::all().iter().position(|c| c.id() == f.check));
    for f in &mut findings {
        let effect = f.outcome.effect.as_ref().map(|e| e.value.0);
        let about = |w: &&Waiver| w.is_about(&case.spelling, f.check) && w.covers(effect);
        if let (Verdict::Fail, Some(waiver)) = (f.outcome.verdict, case.waivers.iter().find(about)) {
            f.outcome.verdict = Verdict::Waived;
            f.waived_because = Some(waiver.because.clone());
        }
    }
    CaseResult { index, case: case.clone(), findings, evidence, seconds: start.elapsed().as_secs_f64() }
}

/// Findings for a case that was not run.
pub fn not_run<'a>(index: usize, case: &Arc<Case<'a>>, outcome: &Outcome) -> CaseResult<'a> {
    let findings = selected(case).into_iter().map(|c| finding(c, outcome.clone(), Vec::new())).collect();
    CaseResult { index, case: case.clone(), findings, evidence: None, seconds: 0.0 }
}

fn finding(check: &'static dyn Check, outcome: Outcome, attempts: Vec<Attempt>) -> Finding {
    Finding { check: check.id(), outcome, attempts, waived_because: None }
}

/// A case under way.
struct Run<'r, 'a> {
    gatherer: Gatherer<'r>,
    open: Vec<Open>,
    skipped: Vec<Finding>,
    company: &'r Company<'a>,
    seed: u64,
    /// What each attempt of a test may spend.
    attempt: f64,
    looks: Vec<u64>,
    terms: Terms,
}

impl<'r, 'a> Run<'r, 'a> {
    fn new(case: &'r Case<'a>, seed: u64, share: f64, description: Description, watch: &Arc<Watch>) -> Self {
        let mut open = Vec::new();
        let mut skipped = Vec::new();
        for check in selected(case) {
            match applies(check, case, &description) {
                Ok(()) => open.push(Open { check, suspicion: None }),
                Err(reason) => skipped.push(finding(check, Outcome::skipped(reason), Vec::new())),
            }
        }
        let tolerance = case.settings.tolerance.unwrap_or(default_tolerance(description.precision));
        let terms = Terms {
            attempt: 0,
            ln_tail: f64::NEG_INFINITY,
            next: None,
            tolerance,
            mean_tolerance: MEAN_TOLERANCE,
            detect: case.settings.detect,
        };
        let wo = case.wo();
        let looks = looks(case.settings.samples);
        let setup = Setup {
            wo,
            transport: case.transport,
            precision: description.precision,
            claims: description.claims,
            key: StreamKey::new(seed)
                .with("subject", description.key(&case.spelling))
                .with("wo", &format!("{:x} {:x} {:x}", wo.x.to_bits(), wo.y.to_bits(), wo.z.to_bits()))
                .with("transport", &case.transport.to_string()),
            draws: looks.last().copied().unwrap_or(0),
            eval: open.iter().flat_map(|o| o.check.needs()).any(|m| m.reads_eval()),
            mis: description.has.eval
                && description.has.pdf
                && open.iter().any(|o| o.check.needs().contains(&Measurement::Mis)),
        };
        let meter = Meter::new(&*case.subject, description, watch.clone());
        Self {
            gatherer: Gatherer::new(meter, setup, watch.clone(), &case.spelling),
            open,
            skipped,
            company: &case.company,
            seed,
            attempt: budget::attempt(share),
            looks,
            terms,
        }
    }

    fn finish(mut self, findings: &mut Vec<Finding>) -> Evidence {
        findings.append(&mut self.skipped);
        let asked: Vec<Measurement> = self.open.iter().flat_map(|o| o.check.needs()).copied().collect();
        self.gatherer.prepare(&asked, self.company);
        if self.gatherer.evidence().looks_unimplemented() {
            let skip = |o: &Open| o.check.id() != "sanity";
            for open in self.open.extract_if(.., |o| skip(o)) {
                findings.push(finding(open.check, Outcome::skipped("not implemented"), Vec::new()));
            }
        }
        self.judge(0, None, findings, |open| !open.check.needs().contains(&Measurement::Draws));
        // Sanity speaks of every number, so it waits for the last draw.
        let sanity = |open: &Open| open.check.id() == "sanity";
        let looks = self.looks.clone();
        for (k, n) in looks.iter().enumerate() {
            if self.open.iter().all(|o| o.suspicion.is_some()) {
                break;
            }
            self.gatherer.draw(0, *n);
            self.terms.ln_tail = budget::look_share(self.attempt, looks.len(), k).ln();
            self.terms.next = looks.get(k + 1).copied();
            self.judge(0, Some(*n), findings, |open| !sanity(open));
        }
        self.judge(0, None, findings, sanity);
        self.confirm(findings);
        if findings.iter().any(|f| f.outcome.verdict == Verdict::Fail) {
            self.gatherer.complete(self.company);
        }
        self.gatherer.into_evidence()
    }

    /// Follows suspicions with other random numbers. Each check looks where its own
    /// suspicion leads it, whatever the others do: it decides as it would alone.
    fn confirm(&mut self, findings: &mut Vec<Finding>) {
        let cap = self.looks.last().copied().unwrap_or(0);
        let suspected: BTreeSet<u64> = self.open.iter().filter_map(Open::suspected_at).collect();
        // By draws, of which no fewer can be looked at again.
        let mut looks: Vec<(u64, usize, u64)> = Vec::new();
        for first in suspected {
            looks.extend(confirmation(first, cap).into_iter().enumerate().map(|(k, n)| (n, k, first)));
        }
        looks.sort_unstable();
        self.terms.attempt = 1;
        for (n, k, first) in looks {
            let due = |open: &Open| open.suspected_at() == Some(first);
            if !self.open.iter().any(due) {
                continue;
            }
            self.gatherer.draw(1, n);
            self.terms.ln_tail = budget::look_share(self.attempt, CONFIRMATION, k).ln();
            self.terms.next = confirmation(first, cap).get(k + 1).copied();
            self.judge(1, Some(n), findings, due);
        }
    }

    /// Lets the open checks that `now` admits judge the evidence.
    fn judge(
        &mut self,
        attempt: usize,
        drawn: Option<u64>,
        findings: &mut Vec<Finding>,
        now: impl Fn(&Open) -> bool,
    ) {
        let evidence = self.gatherer.evidence();
        let over = self.gatherer.is_over();
        let mut still_open = Vec::new();
        for mut open in std::mem::take(&mut self.open) {
            let suspected = open.suspicion.is_some();
            if !now(&open) || suspected != (attempt == 1) {
                still_open.push(open);
                continue;
            }
            let judgement = match halt_of(evidence, open.check) {
                // Draws that ended early are no look.
                Some(halt) => Judgement::from(halted(halt)),
                None => open.check.judge(evidence, &self.terms),
            };
            let outcome = match judgement {
                Judgement::More(_) if !over => {
                    still_open.push(open);
                    continue;
                }
                Judgement::More(_) | Judgement::Missing => {
                    let none = || Outcome::error("this could not be measured of the subject");
                    evidence.halts.first().map_or_else(none, |(_, halt)| halted(halt))
                }
                Judgement::Outcome(outcome) => *outcome,
            };
            let this = outcome.ln_p.map(|ln_p| Attempt {
                seed: format!("{}/{}", self.seed, ["draws", "confirmation"][attempt]),
                samples: drawn.unwrap_or(outcome.samples),
                ln_p,
            });
            let suspicious = outcome.verdict == Verdict::Fail && !outcome.certain;
            match (suspicious, this, open.suspicion.take()) {
                (true, Some(this), None) => {
                    open.suspicion = Some((outcome, this));
                    still_open.push(open);
                }
                (_, this, Some((first, before))) => {
                    let attempts: Vec<_> = std::iter::once(before).chain(this).collect();
                    findings.push(finding(open.check, settled(first, outcome), attempts));
                }
                (_, this, None) => {
                    findings.push(finding(open.check, outcome, this.into_iter().collect()));
                }
            }
        }
        self.open = still_open;
    }
}

/// The last word after a confirmation.
fn settled(first: Outcome, second: Outcome) -> Outcome {
    match second.verdict {
        Verdict::Fail | Verdict::Error => second,
        _ => {
            let reason = format!(
                "a suspicion was not confirmed by other random numbers: first {}; then {}",
                first.message, second.message
            );
            Outcome {
                verdict: Verdict::Inconclusive,
                reason: Some(reason.clone()),
                message: reason,
                ..second
            }
        }
    }
}

/// What kept a check's measurements from being made.
fn halt_of<'a>(evidence: &'a Evidence, check: &dyn Check) -> Option<&'a Halt> {
    evidence.halts.iter().find(|(step, _)| check.needs().contains(step)).map(|(_, halt)| halt)
}

fn halted(halt: &Halt) -> Outcome {
    match halt {
        Halt::Stopped => Outcome::inconclusive(halt.to_string()),
        Halt::Subject(error) => Outcome::error(error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_confirmation_ends_no_earlier_than_the_first_attempt() {
        assert_eq!(confirmation(1 << 14, 1 << 20), [1 << 14, 1 << 15, 1 << 16, 1 << 20]);
        assert_eq!(confirmation(1 << 18, 1 << 20), [1 << 18, 1 << 19, 1 << 20, 1 << 21]);
        for cap in [1, 1 << 14, 300_000, 1 << 20, 1 << 25] {
            let all = looks(cap);
            for first in &all {
                let looks = confirmation(*first, *all.last().unwrap());
                assert!(looks.is_sorted_by(|a, b| a < b) && looks[3] >= cap && looks[0] == *first);
            }
        }
    }
}
