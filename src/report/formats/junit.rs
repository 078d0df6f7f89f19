//! JUnit XML, as GitLab, Jenkins and the readers for GitHub take it.

use super::findings::{in_short, name, place};
use super::site::Site;
use super::visible::{one_line, visible};
use crate::checks::Verdict;
use crate::report::json::{CheckResult, Report, SubjectId};
use crate::report::wording::facts;
use quick_junit::{NonSuccessKind, Property, TestCase, TestCaseStatus, TestSuite};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// The whole file: one test suite a subject, one test case a result.
pub fn junit(report: &Report, site: &Site) -> String {
    let mut whole = quick_junit::Report::new(format!("gonio {}", one_line(&report.suite)));
    if let Ok(time) = Duration::try_from_secs_f64(report.duration_s) {
        whole.set_time(time);
    }
    let mut taken = BTreeSet::new();
    for (subject, results) in by_subject(report) {
        let mut suite = TestSuite::new(name(subject, site));
        suite.add_property(Property::new("gonio.version", one_line(&report.gonio)));
        suite.add_property(Property::new("gonio.seed", report.seed.to_string()));
        suite.add_property(Property::new("gonio.subject", one_line(&subject.name)));
        if let Some(partial) = &report.partial {
            suite.add_property(Property::new("gonio.partial", one_line(partial)));
        }
        if let Some(seconds) = report.started.get(..19).filter(|_| report.started.is_ascii()) {
            // ISO 8601 in UTC, to the second: what every reader takes.
            suite.extra.insert("timestamp".into(), one_line(seconds).into());
        }
        let class = class(report, subject, site);
        for result in results {
            suite.add_test_case(test_case(report, result, &class, &mut taken));
        }
        whole.add_test_suite(suite);
    }
    // Only a writer can fail, and a string takes everything.
    whole.to_string().unwrap_or_default()
}

/// Subjects in the report's order, each with its results.
fn by_subject(report: &Report) -> Vec<(&SubjectId, Vec<&CheckResult>)> {
    let mut found: Vec<(&SubjectId, Vec<&CheckResult>)> = Vec::new();
    let mut places = BTreeMap::new();
    for result in &report.results {
        let id = &result.subject;
        let at = *places.entry((&id.name, &id.label)).or_insert_with(|| {
            found.push((id, Vec::new()));
            found.len() - 1
        });
        found[at].1.push(result);
    }
    found
}

/// `gonio.SUITE.SUBJECT`. Readers take what follows the last dot for the class and the
/// rest for its package, so that a subject has no dots here: α = 0.5 would be torn apart.
fn class(report: &Report, subject: &SubjectId, site: &Site) -> String {
    let part = |text: &str| text.replace('.', "_");
    format!("gonio.{}.{}", part(&one_line(&report.suite)), part(&name(subject, site)))
}

fn test_case(
    report: &Report,
    result: &CheckResult,
    class: &str,
    taken: &mut BTreeSet<(String, String)>,
) -> TestCase {
    let full = format!("{} {}", one_line(&result.check), place(result));
    let base = full.trim_end().to_string();
    let mut title = base.clone();
    // Readers tell test cases apart by class and name.
    for k in 2.. {
        if taken.insert((class.to_string(), title.clone())) {
            break;
        }
        title = format!("{base} ({k})");
    }
    let mut case = TestCase::new(title, status(report, result));
    case.set_classname(class);
    case
}

fn status(report: &Report, result: &CheckResult) -> TestCaseStatus {
    let message = one_line(&result.message);
    let reason = in_short(result.reason.as_ref().unwrap_or(&result.message));
    let known = report.comparison.as_ref().is_some_and(|c| c.knows(result));
    let (mut status, told) = match result.verdict {
        _ if known => (TestCaseStatus::skipped(), format!("known: the baseline has it too: {message}")),
        Verdict::Pass => return TestCaseStatus::success(),
        Verdict::Fail => (TestCaseStatus::non_success(NonSuccessKind::Failure), message),
        Verdict::Error => (TestCaseStatus::non_success(NonSuccessKind::Error), reason),
        Verdict::Skipped => (TestCaseStatus::skipped(), reason),
        Verdict::Inconclusive => (TestCaseStatus::skipped(), format!("inconclusive: {reason}")),
        Verdict::Warn => (TestCaseStatus::skipped(), format!("warn: {message}")),
        Verdict::Waived => {
            let because = result.waived_because.as_deref().map(one_line).unwrap_or_default();
            (TestCaseStatus::skipped(), format!("waived: {because}"))
        }
    };
    status.set_message(told).set_type(result.verdict.word());
    if result.verdict != Verdict::Skipped {
        status.set_description(description(report, result));
    }
    status
}

/// Everything that is known of a result, for people.
fn description(report: &Report, result: &CheckResult) -> String {
    let mut lines: Vec<String> = vec![format!("{}  {}", one_line(&result.subject.name), place(result))];
    lines.extend(facts(result).iter().map(|fact| visible(fact)));
    if result.verdict == Verdict::Fail {
        let of = report.diagnoses.iter().find(|d| d.subject == result.subject.name);
        lines.extend(of.map(|found| visible(&found.to_string())));
    }
    lines.push(format!("$ {}", visible(&result.command)));
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::super::examples::{TEXT, hostile, report, site};
    use super::*;
    use crate::bsdf::Transport;

    /// Its elements of this name.
    fn all<'a>(xml: &'a roxmltree::Document, tag: &'a str) -> Vec<roxmltree::Node<'a, 'a>> {
        xml.descendants().filter(|n| n.has_tag_name(tag)).collect()
    }

    #[test]
    fn verdicts_become_what_readers_know() {
        let mut report = report();
        report.results[0].verdict = Verdict::Waived;
        report.results[0].waived_because = Some("as in the paper".into());
        report.results[1].verdict = Verdict::Error;
        report.results[1].reason = Some("the program ended".into());
        report.results[5].reason = Some("not claimed lossless".into());
        let text = junit(&report, &site());
        let xml = roxmltree::Document::parse(&text).unwrap();
        let suites: Vec<_> = all(&xml, "testsuite").iter().map(|s| s.attribute("name").unwrap()).collect();
        assert_eq!(suites, ["lambert", "ggx:alpha=0.5", "ggx:alpha=0.01"]);
        let told = |tag: &str| -> Vec<String> {
            all(&xml, tag).iter().map(|n| n.attribute("message").unwrap_or("").to_string()).collect()
        };
        assert_eq!(told("failure").len(), 2);
        assert_eq!(told("error"), ["the program ended"]);
        let skipped = told("skipped");
        assert_eq!(skipped[0], "waived: as in the paper");
        assert_eq!(skipped[1], "not claimed lossless");
        assert!(skipped[2].starts_with("inconclusive: would only have seen"), "{skipped:?}");
        let failure = all(&xml, "failure")[0].text().unwrap();
        for part in ["√D = 0.80 % (0.70 to 0.91 %)", "σ = 12.31", "worst at θi", "[half-vector-jacobian]"]
        {
            assert!(failure.contains(part), "{part}: {failure}");
        }
        assert!(failure.contains("repair: divide by 4 wo·h") && failure.contains("\n$ gonio check ggx"));
        let root = xml.root_element();
        assert_eq!((root.attribute("failures"), root.attribute("errors")), (Some("2"), Some("1")));
    }

    #[test]
    fn what_the_baseline_has_too_is_no_failure() {
        let mut after = report();
        after.comparison = Some(crate::comparison::compare(&report(), &after));
        let text = junit(&after, &site());
        let xml = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(all(&xml, "failure").len(), 0);
        let known = |n: &&roxmltree::Node| n.attribute("message").unwrap_or("").starts_with("known: ");
        assert_eq!(all(&xml, "skipped").iter().filter(known).count(), 2);
    }

    #[test]
    fn names_are_unique_and_classes_have_no_stray_dots() {
        let mut report = report();
        let again = report.results.clone();
        report.results.extend(again.into_iter().map(|mut r| {
            r.transport = Transport::Importance;
            r
        }));
        report.results.push(report.results[0].clone());
        let text = junit(&report, &site());
        let xml = roxmltree::Document::parse(&text).unwrap();
        let cases: Vec<_> = all(&xml, "testcase")
            .iter()
            .map(|c| (c.attribute("classname").unwrap(), c.attribute("name").unwrap()))
            .collect();
        let distinct: BTreeSet<_> = cases.iter().collect();
        assert_eq!((cases.len(), distinct.len()), (13, 13), "{cases:?}");
        assert!(cases.contains(&("gonio.default.ggx:alpha=0_5", "goodness-of-fit θo 30° φo 17° importance")));
        assert!(cases.contains(&("gonio.default.lambert", "goodness-of-fit θo 0° φo 17° (2)")));
    }

    #[test]
    fn hostile_text_is_read_again_as_it_can_be_seen() {
        let text = junit(&hostile(), &site());
        let xml = roxmltree::Document::parse(&text).unwrap();
        let suite = all(&xml, "testsuite")[0].attribute("name").unwrap().to_string();
        assert!(suite.contains(&one_line(TEXT)), "{suite}");
        assert!(text.chars().all(|c| c == '\n' || !c.is_control()));
        assert!(all(&xml, "failure")[0].text().unwrap().contains(&visible(TEXT)));
        assert!(all(&xml, "injected").is_empty());
    }
}
