//! The summary of a report that a person wants to read first.

use super::json::{CheckResult, Diagnosis, Report};
use super::wording::{certainty, direction, effect, probability, range, worst, wrapped};
use crate::checks::{self, Verdict};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// Kinds of failure that are told in full; of the others only the number.
const BLOCKS: usize = 10;

/// What was counted is hardly chance below this, which has two reasons.
const UNLIKELY: f64 = 1e-6;
const DOUBT: &str = ": something else may be wrong too, or cells were integrated too coarsely";

/// Characters of a column of the matrix.
const COLUMN: usize = 4;

/// How a summary looks.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Characters a line, 80 to 120.
    pub width: usize,
    /// Whether the terminal takes colours.
    pub colour: bool,
}

impl Look {
    fn width(&self) -> usize {
        self.width.clamp(80, 120)
    }

    fn paint(&self, code: &str, text: &str) -> String {
        if self.colour { format!("\u{1b}[{code}m{text}\u{1b}[0m") } else { text.to_string() }
    }
}

/// A shape for each verdict, so that nothing hangs on colour.
pub fn symbol(verdict: Verdict) -> char {
    match verdict {
        Verdict::Pass => '✓',
        Verdict::Fail => '✗',
        Verdict::Inconclusive => '?',
        Verdict::Warn => '!',
        Verdict::Skipped => '–',
        Verdict::Error => 'E',
        Verdict::Waived => 'w',
    }
}

/// Blue, and not green, against red.
fn code(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "34",
        Verdict::Fail | Verdict::Error => "1;31",
        Verdict::Inconclusive | Verdict::Warn => "33",
        Verdict::Skipped | Verdict::Waived => "2",
    }
}

/// Three letters for a check's column.
pub(super) fn short(check: &str) -> String {
    let known = match check {
        "sanity" => "san",
        "determinism" => "det",
        "goodness-of-fit" => "fit",
        "normalization" => "nrm",
        "support" => "sup",
        "weight" => "wgt",
        "returned-pdf" => "pdf",
        "albedo" => "alb",
        "mis" => "mis",
        "energy" => "nrg",
        "white-furnace" => "fur",
        "reciprocity" => "rec",
        "isotropy" => "iso",
        "discrete-lobes" => "dis",
        "sensitivity" => "sen",
        "reference" => "ref",
        "distribution" => "ndf",
        "fresnel" => "fre",
        "jacobian" => "jac",
        "efficiency" => "eff",
        other => return other.chars().take(3).collect(),
    };
    known.to_string()
}

/// A case is a subject at a direction, with evidence of its own.
fn case_of(result: &CheckResult) -> (String, String, String) {
    let wo = result.wo.map_or(String::new(), direction);
    (result.subject.name.clone(), wo, result.evidence.clone().unwrap_or_default())
}

/// The whole summary. `files` are what was written, by name.
pub fn summary(report: &Report, files: &[(&str, &str)], look: Look) -> String {
    let mut text = String::new();
    matrix(&mut text, report, look);
    blocks(&mut text, report, look);
    footer(&mut text, report, files, look);
    text
}

fn line(text: &mut String, content: &str) {
    text.push_str(content.trim_end());
    text.push('\n');
}

fn indented(text: &mut String, content: &str, indent: usize, look: Look) {
    for part in wrapped(content, look.width() - indent) {
        line(text, &format!("{:indent$}{part}", ""));
    }
}

/// Checks in the order of reports, unknown ones last.
pub(super) fn columns(report: &Report) -> Vec<&str> {
    let met: BTreeSet<&str> = report.results.iter().map(|r| r.check.as_str()).collect();
    let known = checks::all().iter().map(|c| c.id()).filter(|id| met.contains(id));
    let unknown = met.iter().copied().filter(|id| checks::find(id).is_none());
    known.chain(unknown).collect()
}

fn matrix(text: &mut String, report: &Report, look: Look) {
    let columns = columns(report);
    let mut rows: Vec<&str> = Vec::new();
    let mut worst: BTreeMap<(&str, &str), Verdict> = BTreeMap::new();
    let mut cases: BTreeMap<&str, BTreeSet<(String, String, String)>> = BTreeMap::new();
    for result in &report.results {
        let row = result.subject.group();
        if !rows.contains(&row) {
            rows.push(row);
        }
        cases.entry(row).or_default().insert(case_of(result));
        let cell = worst.entry((row, &result.check)).or_insert(Verdict::Skipped);
        *cell = (*cell).max(result.verdict);
    }
    if rows.is_empty() {
        return line(text, "nothing was checked");
    }
    let name = |row: &str| format!("{row} ({})", cases[row].len());
    let longest = rows.iter().map(|row| name(row).chars().count()).max().unwrap_or(0).min(30);
    let fitting = ((look.width() - longest) / COLUMN).max(1);
    for band in columns.chunks(fitting) {
        let heads: String = band.iter().map(|check| format!("{:>COLUMN$}", short(check))).collect();
        line(text, &format!("{:longest$}{heads}", ""));
        for row in &rows {
            let mut content = format!("{:longest$}", super::plots::shortened(&name(row), longest));
            for check in band {
                let cell = match worst.get(&(*row, *check)) {
                    Some(verdict) => look.paint(code(*verdict), &symbol(*verdict).to_string()),
                    None => " ".into(),
                };
                // Under the middle of three letters.
                write!(content, "  {cell} ").expect("a string takes every text");
            }
            line(text, &content);
        }
        line(text, "");
    }
    let names: Vec<String> = columns.iter().map(|c| format!("{}\u{a0}{c}", short(c))).collect();
    let shapes =
        "✓\u{a0}pass ✗\u{a0}fail ?\u{a0}inconclusive !\u{a0}warn –\u{a0}skipped E\u{a0}error w\u{a0}waived";
    for legend in [shapes.to_string(), names.join(" ")] {
        for part in legend_lines(&legend, look.width()) {
            line(text, &look.paint("2", &part));
        }
    }
}

/// Wraps entries whose words are tied by no-break spaces, and unties them.
fn legend_lines(legend: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for entry in legend.split(' ') {
        let entry = entry.replace('\u{a0}', " ");
        let last = lines.last_mut().expect("there is one from the start");
        if last.is_empty() {
            last.push_str(&entry);
        } else if last.chars().count() + 2 + entry.chars().count() <= width {
            last.push_str("  ");
            last.push_str(&entry);
        } else {
            lines.push(entry);
        }
    }
    lines
}

/// Results that a person should look at, those of one subject, check and
/// verdict together, the clearest of each first.
fn kinds(report: &Report) -> Vec<Vec<&CheckResult>> {
    let told = [Verdict::Error, Verdict::Fail, Verdict::Inconclusive, Verdict::Warn];
    let mut kinds: Vec<Vec<&CheckResult>> = Vec::new();
    for verdict in told {
        for result in report.results.iter().filter(|r| r.verdict == verdict) {
            let same = |kind: &&mut Vec<&CheckResult>| {
                let first = kind[0];
                first.verdict == verdict
                    && first.check == result.check
                    && first.subject.name == result.subject.name
            };
            match kinds.iter_mut().find(same) {
                Some(kind) => kind.push(result),
                None => kinds.push(vec![result]),
            }
        }
    }
    // A largest effect names the clearest; where there is none the first stays.
    let size = |r: &CheckResult| r.effect.as_ref().map_or(0.0, |e| (e.value.0 / e.tolerance.0).abs());
    for kind in &mut kinds {
        kind.sort_by(|a, b| size(b).total_cmp(&size(a)));
    }
    kinds
}

fn blocks(text: &mut String, report: &Report, look: Look) {
    let kinds = kinds(report);
    let mut told = BTreeSet::new();
    for kind in kinds.iter().take(BLOCKS) {
        line(text, "");
        let subject = &kind[0].subject.name;
        let first = matches!(kind[0].verdict, Verdict::Error | Verdict::Fail) && told.insert(subject);
        let found = report.diagnoses.iter().find(|d| first && d.subject == *subject);
        block(text, kind, found, look);
    }
    if kinds.len() > BLOCKS {
        let mut counts: BTreeMap<(Verdict, &str), usize> = BTreeMap::new();
        for kind in &kinds[BLOCKS..] {
            *counts.entry((kind[0].verdict, &kind[0].check)).or_default() += kind.len();
        }
        line(text, "");
        let parts: Vec<String> = counts
            .iter()
            .rev()
            .map(|((verdict, check), n)| format!("{n} {check} ({})", verdict.word()))
            .collect();
        indented(text, &format!("and more: {}; all are in the report", parts.join(", ")), 0, look);
    }
    for found in report.diagnoses.iter().filter(|d| !told.contains(&d.subject)).take(BLOCKS) {
        indented(text, &format!("{}: {}", found.subject, named(found)), 0, look);
    }
}

/// What is wrong with each failing subject, by itself.
pub fn diagnoses(report: &Report, look: Look) -> String {
    let mut text = String::new();
    for found in &report.diagnoses {
        line(&mut text, &look.paint("1", &found.subject));
        let of = |r: &&CheckResult| r.subject.name == found.subject;
        diagnosis(&mut text, found, report.results.iter().find(of), look);
    }
    text
}

/// The statement with the slug, unless it has that already.
fn named(found: &Diagnosis) -> String {
    match found.cause.as_ref().map(|slug| format!("[{slug}]")) {
        Some(slug) if !found.statement.contains(&slug) => format!("{} {slug}", found.statement),
        _ => found.statement.clone(),
    }
}

/// A word in bold and what it says, indented.
fn told(text: &mut String, word: &str, content: &str, look: Look) {
    let parts = wrapped(&format!("{word}: {content}"), look.width() - 4);
    for (k, part) in parts.iter().enumerate() {
        match part.strip_prefix(word).filter(|_| k == 0) {
            Some(rest) => line(text, &format!("    {}{rest}", look.paint("1", word))),
            None => line(text, &format!("    {part}")),
        }
    }
}

impl std::fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = String::new();
        diagnosis(&mut text, self, None, Look { width: 100, colour: false });
        f.write_str(text.trim_end())
    }
}

/// `result` is one of the subject's: its command begins with the program.
fn diagnosis(text: &mut String, found: &Diagnosis, result: Option<&CheckResult>, look: Look) {
    told(text, "cause", &named(found), look);
    if let Some(repair) = &found.repair {
        told(text, "repair", repair, look);
    }
    for evidence in &found.evidence {
        told(text, "since", evidence, look);
    }
    if let Some(model) = &found.textbook {
        told(text, "taken for", model, look);
    }
    if let Some(p) = found.p_after_repair {
        let more = if p.0 < UNLIKELY { DOUBT } else { "" };
        told(text, "after the repair", &format!("p = {}{more}", probability(p.0.log10())), look);
    }
    // What is not certain names its rival.
    if let Some(other) = found.runner_up.as_ref().filter(|_| found.confident) {
        told(text, "next", other, look);
    }
    if let Some(slug) = &found.cause {
        let program = result.and_then(|r| r.command.split(' ').next()).unwrap_or("gonio");
        told(text, "more", &format!("{program} explain {slug}"), look);
    }
}

fn block(text: &mut String, kind: &[&CheckResult], found: Option<&Diagnosis>, look: Look) {
    let result = kind[0];
    let verdict =
        look.paint(code(result.verdict), &format!("{} {}", symbol(result.verdict), result.verdict.word()));
    let wo = result.wo.map_or(String::new(), |wo| format!("  {}", direction(wo)));
    let more = match kind.len() {
        1 => String::new(),
        2 => "  (and 1 more direction)".into(),
        n => format!("  (and {} more directions)", n - 1),
    };
    line(text, &format!("{verdict}  {}  {}{wo}{more}", result.subject.name, look.paint("1", &result.check)));
    if let Some(found) = &result.effect {
        let channel = result.channel.as_ref().map_or(String::new(), |c| format!(" (channel {c})"));
        indented(text, &(effect(found) + &channel), 4, look);
    }
    if let Some(certain) = certainty(result) {
        indented(text, &certain, 4, look);
    }
    if let Some(place) = &result.worst {
        indented(text, &worst(place), 4, look);
    }
    indented(text, &result.message, 4, look);
    if let Some(reason) = result.reason.as_ref().filter(|r| **r != result.message) {
        indented(text, reason, 4, look);
    }
    if let Some(found) = found {
        diagnosis(text, found, Some(result), look);
    }
    // Whole, so that it can be copied.
    line(text, &format!("    $ {}", result.command));
}

fn footer(text: &mut String, report: &Report, files: &[(&str, &str)], look: Look) {
    line(text, "");
    let s = &report.summary;
    let counts: Vec<String> = [
        (s.passed, "passed", "34"),
        (s.failed, "failed", "1;31"),
        (s.errors, "errors", "1;31"),
        (s.inconclusive, "inconclusive", "33"),
        (s.warned, "warned", "33"),
        (s.waived, "waived", "2"),
        (s.skipped, "skipped", "2"),
    ]
    .iter()
    .filter(|(n, word, _)| *n > 0 || *word == "failed")
    .map(|(n, word, code)| look.paint(code, &format!("{n} {word}")))
    .collect();
    line(text, &counts.join(", "));
    if let Some(partial) = &report.partial {
        indented(text, &format!("NOT COMPLETE: {partial}"), 0, look);
    }
    let cases: BTreeSet<_> = report.results.iter().map(case_of).collect();
    let run = format!(
        "{} {} of suite {}, seed {}, {:.1} s; correct subjects fail a run with probability {:e}",
        cases.len(),
        if cases.len() == 1 { "case" } else { "cases" },
        report.suite,
        report.seed,
        report.duration_s,
        report.false_alarm
    );
    indented(text, &run, 0, look);
    // Where chance is involved a limit is an error; elsewhere it is a share.
    let limits = report.results.iter().filter(|r| r.verdict == Verdict::Pass && r.log10_p.is_some());
    let mut limits: Vec<f64> = limits.filter_map(|r| r.detection_limit).map(|l| l.0).collect();
    limits.sort_by(f64::total_cmp);
    if let (Some(least), Some(most)) = (limits.first(), limits.last()) {
        let told = format!("statistical passes had detection limits of {}", range(*least, *most));
        indented(text, &told, 0, look);
    }
    let longest = files.iter().map(|f| f.0.chars().count()).max().unwrap_or(0);
    for (name, path) in files {
        line(text, &format!("{name:longest$}  {path}"));
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::json::{AttemptRow, Machine, SCHEMA_VERSION, SubjectId, Summary, WoAngles};
    use super::*;
    use crate::bsdf::{Claims, Direction};
    use crate::checks::Effect;
    use crate::evidence::{Evaluations, Figure, Place};
    use crate::registry::Parameters;

    fn result(name: &str, check: &str, theta_deg: f64, verdict: Verdict) -> CheckResult {
        CheckResult {
            subject: SubjectId {
                name: name.into(),
                label: None,
                parameters: Parameters::default(),
                claims: Claims::default(),
            },
            check: check.into(),
            wo: Some(WoAngles { theta_deg, phi_deg: 17.0 }),
            transport: Default::default(),
            verdict,
            effect: None,
            p_value: None,
            log10_p: None,
            threshold: None,
            attempts: Vec::new(),
            channel: None,
            samples: 262_144,
            evaluations: Evaluations::default(),
            detection_limit: None,
            message: "all is well".into(),
            reason: None,
            worst: None,
            command: format!("gonio check {name} --theta {theta_deg} --phi 17 --seed 1"),
            evidence: None,
            plot: None,
            waived_because: None,
        }
    }

    /// A report with one of everything.
    pub fn report() -> Report {
        let attempt = |seed: &str, log10_p: f64| AttemptRow {
            seed: seed.into(),
            samples: 1 << 18,
            log10_p: log10_p.into(),
        };
        let wo = Direction::from_angles(1.0, 0.3);
        let wi = Direction::from_angles(0.5, 3.4);
        let fit = |theta, value: f64| CheckResult {
            effect: Some(Effect::interval("√D", (value, value - 0.001, value + 0.0011), 0.003)),
            log10_p: Some(Figure(-60.5)),
            p_value: Some(Figure(0.0)),
            threshold: Some(Figure(1e-5)),
            attempts: vec![attempt("1", -34.2), attempt("1/confirmation", -60.5)],
            message: "samples are off pdf by 1.20 % RMS on 64 cells; shape passes: a factor of wo alone"
                .into(),
            worst: Some(Place::pair(wo, wi).value("σ", 12.31)),
            ..result("ggx:alpha=0.5", "goodness-of-fit", theta, Verdict::Fail)
        };
        let passed = |theta, limit: f64| CheckResult {
            log10_p: Some(Figure(-0.2)),
            detection_limit: Some(Figure(limit)),
            ..result("lambert", "goodness-of-fit", theta, Verdict::Pass)
        };
        let unsure = CheckResult {
            reason: Some("would only have seen an error of 5 %".into()),
            message: "found 0.5 ± 0.1, cubature 0.55".into(),
            ..result("ggx:alpha=0.01", "albedo", 85.0, Verdict::Inconclusive)
        };
        Report {
            schema_version: SCHEMA_VERSION,
            gonio: "0.1.0".into(),
            suite: "default".into(),
            seed: 1,
            false_alarm: 0.01,
            started: "2026-01-01T00:00:00Z".into(),
            duration_s: 12.34,
            machine: Machine { os: "linux".into(), arch: "x86_64".into(), cores: 2 },
            partial: None,
            summary: Summary { passed: 2, failed: 2, inconclusive: 1, skipped: 1, ..Summary::default() },
            results: vec![
                passed(0.0, 0.0031),
                passed(60.0, 0.028),
                fit(30.0, 0.008),
                fit(60.0, 0.012),
                unsure,
                result("lambert", "white-furnace", 0.0, Verdict::Skipped),
            ],
            subjects: Vec::new(),
            waivers: Vec::new(),
            allocation: None,
            diagnoses: vec![Diagnosis {
                profile: None,
                subject: "ggx:alpha=0.5".into(),
                cause: Some("half-vector-jacobian".into()),
                confident: true,
                statement: "pdf() lacks the factor 1/(4 wo·h)".into(),
                repair: Some("divide by 4 wo·h".into()),
                p_after_repair: Some(Figure(0.43)),
                runner_up: Some("pdf() is 4 times too large [constant-factor], 812.0 nats behind".into()),
                evidence: vec!["this fits 12 cells of 64".into()],
                textbook: Some("torrance-sparrow".into()),
                plot: None,
                page: Some("docs/causes/half-vector-jacobian.md".into()),
            }],
        }
    }

    const EXPECTED: &str = include_str!("terminal_expected.txt");

    #[test]
    fn reads_as_expected() {
        let files = [("report", "reports/default/report.json"), ("html", "reports/default/index.html")];
        let text = summary(&report(), &files, Look { width: 90, colour: false });
        assert_eq!(text, EXPECTED, "\n{text}");
    }

    #[test]
    fn colour_adds_nothing_but_colour() {
        let look = Look { width: 90, colour: true };
        let text = summary(&report(), &[], look);
        let mut plain = String::new();
        let mut rest = text.as_str();
        while let Some(start) = rest.find('\u{1b}') {
            plain.push_str(&rest[..start]);
            let end = start + rest[start..].find('m').unwrap();
            rest = &rest[end + 1..];
        }
        plain.push_str(rest);
        assert_eq!(plain, summary(&report(), &[], Look { colour: false, ..look }));
    }

    #[test]
    fn fifty_failures_stay_readable_and_in_width() {
        let mut report = report();
        for k in 0..50 {
            let name = format!("model-{k}:alpha=0.5");
            for check in checks::all() {
                report.results.push(result(&name, check.id(), 30.0, Verdict::Fail));
            }
        }
        for width in [80, 100, 120] {
            let text = summary(&report, &[], Look { width, colour: false });
            let longest = text.lines().filter(|l| !l.contains("$ ")).map(|l| l.chars().count()).max();
            assert!(longest.unwrap() <= width, "{longest:?} of {width}");
            assert_eq!(text.lines().filter(|l| l.contains("$ ")).count(), BLOCKS);
            assert!(text.contains("and more: ") && text.contains("(fail)"));
        }
    }

    #[test]
    fn a_doubtful_cause_has_no_next_and_none_has_no_slug() {
        let found = report().diagnoses.remove(0);
        let doubtful = Diagnosis { confident: false, p_after_repair: Some(Figure(0.0)), ..found };
        let text = doubtful.to_string();
        assert!(text.contains("p = 0: something else may be wrong too") && !text.contains("next"), "{text}");
        let none = Diagnosis {
            cause: None,
            repair: None,
            p_after_repair: None,
            runner_up: None,
            evidence: Vec::new(),
            textbook: None,
            plot: None,
            page: None,
            statement: "none of the explanations fits: energy fails".into(),
            ..doubtful
        };
        assert_eq!(none.to_string(), "    cause: none of the explanations fits: energy fails");
    }

    #[test]
    fn subjects_beyond_the_blocks_have_a_line_each() {
        let mut report = report();
        let found = report.diagnoses[0].clone();
        for k in 0..20 {
            let name = format!("model-{k}");
            report.results.push(result(&name, "energy", 30.0, Verdict::Fail));
            report.diagnoses.push(Diagnosis { subject: name, ..found.clone() });
        }
        let text = summary(&report, &[], Look { width: 90, colour: false });
        assert!(text.contains("\nmodel-18: pdf() lacks the factor 1/(4 wo·h) [half-vector-jacobian]\n"));
        assert_eq!(text.matches("half-vector-jacobian]").count(), 2 * BLOCKS);
        let all = diagnoses(&report, Look { width: 90, colour: false });
        assert_eq!(all.matches("half-vector-jacobian]").count(), 21);
    }

    #[test]
    fn an_empty_report_says_so() {
        let empty = Report { results: Vec::new(), summary: Summary::default(), ..report() };
        let text = summary(&empty, &[], Look { width: 80, colour: false });
        assert!(text.starts_with("nothing was checked\n") && text.contains("0 cases"));
    }
}
