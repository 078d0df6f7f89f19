//! GitHub: workflow commands that become annotations, and the summary of a step.

use super::findings::{Finding, findings};
use super::markdown::blocks;
use super::markdown_text::cut;
use super::site::{Site, Spot};
use super::visible::{one_line, visible};
use crate::checks::Verdict;
use crate::report::json::Report;

/// Annotations of each kind that GitHub keeps of one step.
const ANNOTATIONS: usize = 10;

/// Bytes of a step's summary: over 1024 KiB GitHub drops it whole.
pub const SUMMARY_BYTES: usize = 1 << 20;

/// The command of a finding; `None` of what needs nobody's attention.
fn command(finding: &Finding) -> Option<&'static str> {
    match finding.verdict {
        // It fails no gate.
        _ if finding.is_known() => Some("notice"),
        Verdict::Error | Verdict::Fail => Some("error"),
        Verdict::Warn => Some("warning"),
        Verdict::Inconclusive => Some("notice"),
        Verdict::Waived | Verdict::Pass | Verdict::Skipped => None,
    }
}

/// What ends a command's data.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// And what ends a property.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

fn line(kind: &str, spot: Option<&Spot>, title: &str, message: &str) -> String {
    let place =
        spot.map_or(String::new(), |spot| format!("file={},line={},", property(&spot.file), spot.line));
    format!("::{kind} {place}title={}::{}\n", property(title), data(message))
}

fn annotation(kind: &str, finding: &Finding) -> String {
    let known = if finding.is_known() { "as in the baseline: " } else { "" };
    let mut message = vec![format!("{}: {known}{}", finding.name, finding.headline())];
    message.extend(finding.details());
    line(kind, Some(&finding.spot), &format!("gonio {}", finding.rule.id()), &visible(&message.join("\n")))
}

/// Workflow commands, one a line: ten errors and ten warnings at most. Where that is not
/// all the last line, a notice, tells how many more there are, and where.
pub fn annotations(report: &Report, site: &Site) -> String {
    let mut text = String::new();
    let mut warnings = ANNOTATIONS;
    if let Some(partial) = &report.partial {
        let message = format!("the run of suite {} is not complete: {partial}", one_line(&report.suite));
        text += &line("warning", None, "gonio", &one_line(&message));
        warnings -= 1;
    }
    let found = findings(report, site);
    let mut left_out = Vec::new();
    // One notice is for what is left out.
    for (kind, plural, most) in [
        ("error", "errors", ANNOTATIONS),
        ("warning", "warnings", warnings),
        ("notice", "notices", ANNOTATIONS - 1),
    ] {
        let of: Vec<&Finding> = found.iter().filter(|f| command(f) == Some(kind)).collect();
        of.iter().take(most).for_each(|finding| text += &annotation(kind, finding));
        match of.len().saturating_sub(most) {
            0 => {}
            1 => left_out.push(format!("1 more {kind}")),
            n => left_out.push(format!("{n} more {plural}")),
        }
    }
    if !left_out.is_empty() {
        let message = format!(
            "{} of suite {}: the summary of this step and {} have all",
            left_out.join(", "),
            one_line(&report.suite),
            site.report()
        );
        text += &line("notice", None, "gonio", &message);
    }
    text
}

/// The summary of a step, in at most so many bytes.
pub fn summary_within(report: &Report, site: &Site, bytes: usize) -> String {
    cut(&blocks(report, site, false), bytes, site.report())
}

#[cfg(test)]
mod tests {
    use super::super::examples::{hostile, report, site};
    use super::*;

    #[test]
    fn what_ends_a_message_or_a_property_is_escaped() {
        let spot = Spot { file: "a,b:c%.toml".into(), line: 3 };
        assert_eq!(
            line("error", Some(&spot), "x: 5 %", "50 %\r\nof a, b: c"),
            "::error file=a%2Cb%3Ac%25.toml,line=3,title=x%3A 5 %25::50 %25%0D%0Aof a, b: c\n"
        );
    }

    #[test]
    fn each_kind_is_limited_and_the_last_line_counts_the_rest() {
        let mut report = report();
        let (fail, unsure) = (report.results[2].clone(), report.results[4].clone());
        report.results.clear();
        for (n, verdict) in [(10, Verdict::Fail), (10, Verdict::Warn), (9, Verdict::Inconclusive)] {
            for k in 0..n {
                let mut result = if verdict == Verdict::Fail { fail.clone() } else { unsure.clone() };
                result.verdict = verdict;
                result.subject.name = format!("model-{k}");
                report.results.push(result);
            }
        }
        let count =
            |text: &str, kind: &str| text.lines().filter(|l| l.starts_with(&format!("::{kind} "))).count();
        let all = annotations(&report, &site());
        assert_eq!(["error", "warning", "notice"].map(|kind| count(&all, kind)), [10, 10, 9], "{all}");
        assert!(!all.contains("more"), "{all}");
        for verdict in [Verdict::Fail, Verdict::Fail, Verdict::Inconclusive] {
            let mut result = fail.clone();
            result.verdict = verdict;
            result.subject.name = format!("another-{}", report.results.len());
            report.results.push(result);
        }
        report.partial = Some("interrupted".into());
        let cut = annotations(&report, &site());
        assert_eq!(["error", "warning", "notice"].map(|kind| count(&cut, kind)), [10, 10, 10], "{cut}");
        let last = cut.lines().last().unwrap();
        assert_eq!(
            last,
            "::notice title=gonio::2 more errors, 1 more warning, 1 more notice of suite default: the summary \
             of this step and out/report.json have all"
        );
    }

    #[test]
    fn hostile_text_begins_no_command_of_its_own() {
        let text = annotations(&hostile(), &site());
        for line in text.lines() {
            let properties = line.strip_prefix("::").and_then(|l| l.split_once("::")).unwrap().0;
            let (kind, properties) = properties.split_once(' ').unwrap();
            assert!(["error", "warning", "notice"].contains(&kind), "{line}");
            for part in properties.split(',') {
                assert!(["file", "line", "title"].contains(&part.split_once('=').unwrap().0), "{line}");
            }
        }
        // Two errors, a warning and what is not complete, and a notice.
        assert_eq!(text.lines().count(), 5, "{text}");
    }

    #[test]
    fn the_summary_keeps_within_its_bytes() {
        let mut report = report();
        for k in 0..8000 {
            let mut result = report.results[2].clone();
            result.subject.name = format!("ggx-{k}:alpha=0.5");
            report.results.push(result);
        }
        let whole = super::super::markdown::markdown(&report, &site(), false);
        assert!(whole.len() > SUMMARY_BYTES, "{}", whole.len());
        let text = summary_within(&report, &site(), SUMMARY_BYTES);
        assert!(text.len() <= SUMMARY_BYTES && text.len() > SUMMARY_BYTES - 4096, "{}", text.len());
        assert!(whole.starts_with(text.rsplit_once("\n\n").unwrap().0));
        assert!(
            text.trim_end().lines().last().unwrap().contains("left out"),
            "{}",
            &text[text.len() - 200..]
        );
        for bytes in [0, 10, 100, 1000, 5000] {
            assert!(summary_within(&report, &site(), bytes).len() <= bytes, "{bytes}");
        }
    }
}
