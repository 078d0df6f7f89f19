//! SARIF 2.1.0 (<https://docs.oasis-open.org/sarif/sarif/v2.1.0/>), the part of it that
//! GitHub's code scanning and editors show.

use super::findings::{Finding, findings};
use super::manual::HOME;
use super::sarif_rules::{Descriptor, rules};
use super::site::Site;
use super::visible::{one_line, visible};
use crate::checks::Verdict;
use crate::report::json::Report;
use serde::Serialize;
use std::collections::BTreeMap;

/// The schema that editors check it by.
const SCHEMA: &str =
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// What paths are relative to: the root of the repository.
const BASE: &str = "%SRCROOT%";

/// What may stand in a URI as it is (RFC 3986, §3.3), without `:`, which would make the
/// first part of a path a scheme.
const PLAIN: &str = "-._~!$&'()*+,;=@/";

#[derive(Serialize)]
struct Log {
    #[serde(rename = "$schema")]
    schema: &'static str,
    version: &'static str,
    runs: [Run; 1],
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Run {
    tool: Tool,
    automation_details: AutomationDetails,
    invocations: [Invocation; 1],
    original_uri_base_ids: BTreeMap<&'static str, Base>,
    column_kind: &'static str,
    results: Vec<Entry>,
}

#[derive(Serialize)]
struct Tool {
    driver: Driver,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Driver {
    name: &'static str,
    version: String,
    information_uri: &'static str,
    rules: Vec<Descriptor>,
}

#[derive(Serialize)]
struct AutomationDetails {
    id: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Invocation {
    execution_successful: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    start_time_utc: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tool_execution_notifications: Vec<Notification>,
}

#[derive(Serialize)]
struct Notification {
    level: &'static str,
    message: Message,
}

#[derive(Serialize)]
struct Base {
    description: Message,
}

/// Text (SARIF 2.1.0, §3.11).
#[derive(Debug, Serialize)]
pub struct Message {
    text: String,
}

/// The help of a rule.
#[derive(Debug, Serialize)]
pub struct Help {
    /// Plain.
    pub text: String,
    /// The same for those who show Markdown.
    pub markdown: String,
}

impl Message {
    /// `text` as plain text: braces stand for placeholders, and `[…](…)` for a link.
    pub fn new(text: &str) -> Self {
        let text = visible(text).replace('{', "{{").replace('}', "}}").replace("](", "] (");
        Self { text }
    }
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Entry {
    rule_id: String,
    rule_index: usize,
    level: &'static str,
    message: Message,
    locations: [Location; 1],
    partial_fingerprints: Fingerprints,
    #[serde(skip_serializing_if = "Option::is_none")]
    baseline_state: Option<&'static str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    suppressions: Vec<Suppression>,
    properties: Properties,
}

/// GitHub compares the first alone, and would make it from the line's text: of several
/// subjects on one line it would keep one.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Fingerprints {
    primary_location_line_hash: String,
    #[serde(rename = "gonio/v1")]
    gonio: String,
}

#[derive(Serialize)]
struct Suppression {
    kind: &'static str,
    justification: String,
}

#[derive(Serialize)]
struct Properties {
    subject: String,
    verdict: &'static str,
    checks: Vec<String>,
    command: String,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Location {
    physical_location: PhysicalLocation,
    logical_locations: [LogicalLocation; 1],
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct PhysicalLocation {
    artifact_location: ArtifactLocation,
    region: Region,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ArtifactLocation {
    uri: String,
    uri_base_id: &'static str,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct LogicalLocation {
    name: String,
    fully_qualified_name: String,
    kind: &'static str,
}

fn level(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Error | Verdict::Fail | Verdict::Waived => "error",
        Verdict::Warn => "warning",
        Verdict::Inconclusive | Verdict::Pass | Verdict::Skipped => "note",
    }
}

/// A path as a relative URI.
fn uri(path: &str) -> String {
    let mut text = String::new();
    for byte in path.bytes() {
        let c = char::from(byte);
        if c.is_ascii_alphanumeric() || PLAIN.contains(c) {
            text.push(c);
        } else {
            text += &format!("%{byte:02X}");
        }
    }
    text
}

fn result(finding: &Finding, index: &BTreeMap<String, usize>, site: &Site) -> Entry {
    let rule_id = finding.rule.id();
    let name = finding.name.clone();
    let details = finding.details().join("\n");
    let waived = finding.verdict == Verdict::Waived;
    let justification = || finding.because().unwrap_or_else(|| "the suite waives it".into());
    Entry {
        rule_index: index[&rule_id],
        rule_id,
        level: level(finding.verdict),
        // The first sentence is all that a list shows.
        message: Message::new(&format!("{name}: {}\n{details}", finding.headline())),
        locations: [Location {
            physical_location: PhysicalLocation {
                artifact_location: ArtifactLocation { uri: uri(&finding.spot.file), uri_base_id: BASE },
                region: Region { start_line: finding.spot.line },
            },
            logical_locations: [LogicalLocation {
                fully_qualified_name: one_line(&site.portable(&finding.subject.name)),
                name,
                kind: "object",
            }],
        }],
        partial_fingerprints: Fingerprints {
            primary_location_line_hash: finding.fingerprint(),
            gonio: finding.fingerprint(),
        },
        baseline_state: finding.known.map(|known| if known { "unchanged" } else { "new" }),
        suppressions: waived
            .then(|| Suppression { kind: "external", justification: justification() })
            .into_iter()
            .collect(),
        properties: Properties {
            subject: one_line(&site.portable(&finding.subject.name)),
            verdict: finding.verdict.word(),
            checks: finding.checks().into_iter().map(one_line).collect(),
            command: visible(&finding.lead().command),
        },
    }
}

fn invocation(report: &Report) -> Invocation {
    let started = report.started.parse::<jiff::Timestamp>().ok();
    let told = |partial: &String| Notification { level: "error", message: Message::new(partial) };
    Invocation {
        execution_successful: report.partial.is_none(),
        start_time_utc: started.map(|time| time.strftime("%Y-%m-%dT%H:%M:%SZ").to_string()),
        tool_execution_notifications: report.partial.iter().map(told).collect(),
    }
}

/// The whole file.
pub fn sarif(report: &Report, site: &Site) -> String {
    let found = findings(report, site);
    let rules = rules(&found);
    let index: BTreeMap<String, usize> = rules.iter().enumerate().map(|(k, r)| (r.id.clone(), k)).collect();
    let root = Base { description: Message::new("The root of the repository.") };
    let log = Log {
        schema: SCHEMA,
        version: "2.1.0",
        runs: [Run {
            tool: Tool {
                driver: Driver {
                    name: "gonio",
                    version: one_line(&report.gonio),
                    information_uri: HOME,
                    rules,
                },
            },
            // Up to the last `/` it is a category: analyses of one replace each other.
            automation_details: AutomationDetails { id: format!("gonio/{}/", one_line(&report.suite)) },
            invocations: [invocation(report)],
            original_uri_base_ids: BTreeMap::from([(BASE, root)]),
            column_kind: "unicodeCodePoints",
            results: found.iter().map(|finding| result(finding, &index, site)).collect(),
        }],
    };
    let mut text = serde_json::to_string_pretty(&log).unwrap_or_default();
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::super::examples::{hostile, report, site};
    use super::*;
    use crate::report::json::SubjectEntry;
    use crate::suite::Source;
    use serde_json::Value;

    fn run(report: &Report) -> Value {
        let log: Value = serde_json::from_str(&sarif(report, &site())).unwrap();
        log["runs"][0].clone()
    }

    #[test]
    fn a_failure_with_a_cause_is_one_result_at_the_line_that_asks_for_it() {
        let mut report = report();
        let source = Some(Source { file: "suites/a b.toml".into(), line: 12 });
        let entry = SubjectEntry {
            name: "ggx:alpha=0.5".into(),
            label: None,
            digest: String::new(),
            source,
            carried: false,
        };
        report.subjects = vec![entry];
        let run = run(&report);
        let results = run["results"].as_array().unwrap();
        assert_eq!(results.len(), 2);
        let failure = &results[0];
        assert_eq!(
            (failure["ruleId"].as_str(), failure["level"].as_str()),
            (Some("half-vector-jacobian"), Some("error"))
        );
        let place = &failure["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "suites/a%20b.toml");
        assert_eq!(place["region"]["startLine"], 12);
        assert_eq!(failure["locations"][0]["logicalLocations"][0]["fullyQualifiedName"], "ggx:alpha=0.5");
        let text = failure["message"]["text"].as_str().unwrap();
        assert!(
            text.starts_with("ggx:alpha=0.5: pdf() lacks the factor 1/(4 wo·h)\nrepair: divide"),
            "{text}"
        );
        let index = failure["ruleIndex"].as_u64().unwrap() as usize;
        assert_eq!(run["tool"]["driver"]["rules"][index]["id"], "half-vector-jacobian");
        assert_eq!(results[1]["level"], "note");
        assert_eq!(
            results[1]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"],
            "out/report.json"
        );
        assert_eq!(run["invocations"][0]["executionSuccessful"], true);
        assert_eq!(run["invocations"][0]["startTimeUtc"], "2026-01-01T00:00:00Z");
    }

    #[test]
    fn what_is_waived_is_suppressed_with_its_reason_and_a_stopped_run_says_so() {
        let mut report = report();
        report.results[0].verdict = Verdict::Waived;
        report.results[0].waived_because = Some("coat".into());
        report.results[1].verdict = Verdict::Warn;
        report.partial = Some("interrupted".into());
        let run = run(&report);
        let of = |verdict: &str| {
            let results = run["results"].as_array().unwrap();
            results.iter().find(|r| r["properties"]["verdict"] == verdict).unwrap().clone()
        };
        assert_eq!(of("waived")["suppressions"][0]["kind"], "external");
        assert_eq!(of("waived")["suppressions"][0]["justification"], "coat");
        assert!(of("fail").get("suppressions").is_none());
        assert_eq!(of("warn")["level"], "warning");
        let invocation = &run["invocations"][0];
        assert_eq!(invocation["executionSuccessful"], false);
        assert_eq!(invocation["toolExecutionNotifications"][0]["message"]["text"], "interrupted");
    }

    #[test]
    fn paths_are_uris() {
        assert_eq!(uri("a/b-c.toml"), "a/b-c.toml");
        assert_eq!(uri("c:/θ #1?%"), "c%3A/%CE%B8%20%231%3F%25");
    }

    #[test]
    fn hostile_text_is_neither_link_nor_placeholder() {
        let run = run(&hostile());
        let results = run["results"].as_array().unwrap();
        for result in results {
            let text = result["message"]["text"].as_str().unwrap();
            assert!(!text.contains("](") && text.contains("{{0}}") && !text.contains('\u{1b}'), "{text}");
            let rules = run["tool"]["driver"]["rules"].as_array().unwrap();
            assert_eq!(rules[result["ruleIndex"].as_u64().unwrap() as usize]["id"], result["ruleId"]);
        }
        assert_eq!(results.len(), 5);
        assert!(run["invocations"][0].get("startTimeUtc").is_none());
    }
}
