//! GitLab's code quality report: the part of the Code Climate format that GitLab reads
//! (<https://docs.gitlab.com/ci/testing/code_quality/#code-quality-report-format>).

use super::findings::{Finding, findings};
use super::site::{Site, Spot};
use super::visible::one_line;
use crate::checks::Verdict;
use crate::report::json::Report;
use serde::Serialize;

#[derive(Serialize)]
struct Issue {
    description: String,
    check_name: String,
    fingerprint: String,
    severity: &'static str,
    location: Location,
}

#[derive(Serialize)]
struct Location {
    path: String,
    lines: Lines,
}

#[derive(Serialize)]
struct Lines {
    begin: usize,
}

impl From<Spot> for Location {
    fn from(spot: Spot) -> Self {
        Self { path: spot.file, lines: Lines { begin: spot.line } }
    }
}

/// Of what blocker, critical, major, minor and info are; `None` of what is no issue: GitLab
/// has no word for what is accepted.
fn severity(verdict: Verdict) -> Option<&'static str> {
    match verdict {
        Verdict::Error => Some("blocker"),
        Verdict::Fail => Some("critical"),
        Verdict::Warn => Some("minor"),
        Verdict::Inconclusive => Some("info"),
        Verdict::Waived | Verdict::Pass | Verdict::Skipped => None,
    }
}

fn issue(finding: Finding) -> Option<Issue> {
    let severity = severity(finding.verdict)?;
    let description = format!("{}: {}", finding.name, finding.headline());
    let (check_name, fingerprint) = (finding.rule.id(), finding.fingerprint());
    Some(Issue { description, check_name, fingerprint, severity, location: finding.spot.into() })
}

/// The whole file.
pub fn gitlab(report: &Report, site: &Site) -> String {
    let mut issues: Vec<Issue> = findings(report, site).into_iter().filter_map(issue).collect();
    if let Some(partial) = &report.partial {
        let suite = blake3::hash(report.suite.as_bytes()).to_hex();
        issues.push(Issue {
            description: format!(
                "the run of suite {} is not complete: {}",
                one_line(&report.suite),
                one_line(partial)
            ),
            check_name: "partial".into(),
            fingerprint: format!("partial-{}", &suite[..24]),
            severity: "major",
            location: Spot { file: site.report().into(), line: 1 }.into(),
        });
    }
    let mut text = serde_json::to_string_pretty(&issues).unwrap_or_default();
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::super::examples::{hostile, report, site};
    use super::*;
    use serde_json::Value;
    use std::collections::BTreeSet;

    fn issues(report: &Report) -> Vec<Value> {
        serde_json::from_str(&gitlab(report, &site())).unwrap()
    }

    #[test]
    fn verdicts_have_severities_and_what_is_waived_is_no_issue() {
        let mut report = report();
        report.results[0].verdict = Verdict::Warn;
        report.results[1].verdict = Verdict::Error;
        report.results[5].verdict = Verdict::Waived;
        report.partial = Some("interrupted".into());
        let found = issues(&report);
        let severities: Vec<_> = found.iter().map(|i| i["severity"].as_str().unwrap()).collect();
        assert_eq!(severities, ["blocker", "critical", "minor", "info", "major"]);
        let failure = &found[1];
        assert_eq!(failure["check_name"], "half-vector-jacobian");
        assert_eq!(failure["description"], "ggx:alpha=0.5: pdf() lacks the factor 1/(4 wo·h)");
        assert_eq!(failure["location"]["path"], "out/report.json");
        assert_eq!(failure["location"]["lines"]["begin"], 1);
    }

    #[test]
    fn fingerprints_are_unique_and_nothing_is_no_issue() {
        let found = issues(&hostile());
        let distinct: BTreeSet<_> = found.iter().map(|i| i["fingerprint"].as_str().unwrap()).collect();
        assert_eq!(distinct.len(), found.len());
        assert!(found.len() > 3);
        let none = Report { results: Vec::new(), ..report() };
        assert_eq!(issues(&none), Vec::<Value>::new());
    }
}
