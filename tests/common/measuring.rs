//! Cases measured as a suite would.

use gonio::bsdf::{ClaimsPatch, Subject, Transport};
use gonio::checks::Verdict;
use gonio::engine::{CaseResult, Options, run};
use gonio::evidence::Company;
use gonio::suite::{Case, Plan, Settings};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

/// One case at θo = `theta`, φo = 137°, in radiance mode.
pub fn case(name: &str, subject: Arc<dyn Subject>, theta: f64, samples: u64) -> Case<'static> {
    Case {
        group: name.into(),
        spelling: name.into(),
        source: None,
        subject,
        parameters: Default::default(),
        theta_deg: theta,
        phi_deg: 137.0,
        transport: Transport::Radiance,
        claims: ClaimsPatch::default(),
        waivers: Vec::new(),
        company: Company::default(),
        reference: None,
        checks: Vec::new(),
        settings: Settings { samples, time_limit: Duration::from_secs(20), ..Settings::default() },
    }
}

/// Measures cases at seed 1.
pub fn measure(cases: Vec<Case<'static>>) -> Vec<CaseResult<'static>> {
    let plan = Plan {
        suite: "test".into(),
        seed: 1,
        false_alarm: 1e-6,
        share: None,
        cases: cases.into_iter().map(Arc::new).collect(),
    };
    run(&plan, &Options::default(), &mut |_| {}).cases
}

/// The checks with each verdict over all cases.
pub fn verdicts(results: &[CaseResult]) -> BTreeMap<Verdict, BTreeSet<&'static str>> {
    let mut map: BTreeMap<Verdict, BTreeSet<&'static str>> = BTreeMap::new();
    for finding in results.iter().flat_map(|r| &r.findings) {
        map.entry(finding.outcome.verdict).or_default().insert(finding.check);
    }
    map
}

/// What is said where that is the verdict.
pub fn told(results: &[CaseResult], verdict: Verdict) -> Vec<String> {
    let findings = results.iter().flat_map(|r| r.findings.iter().map(move |f| (r, f)));
    findings
        .filter(|(_, f)| f.outcome.verdict == verdict)
        .map(|(r, f)| format!("{} {}: {}", r.case.label(), f.check, f.outcome.message))
        .collect()
}
