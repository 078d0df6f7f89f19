//! The section of a subject.

use super::super::json::{CheckResult, Diagnosis};
use super::super::terminal::symbol;
use super::super::wording::{certainty, direction, effect, probability, range, ratio, worst};
use super::changes::{Changed, Changes};
use super::gather::Carried;
use super::head::{counted, thousands};
use super::names;
use super::pack::inert_json;
use super::subject::{Case, Check, Subject, is_telling};
use crate::bsdf::Transport;
use crate::cause::Cause;
use crate::checks::Verdict;
use askama::Template;
use serde::Serialize;

/// What was counted is hardly chance below this.
const UNLIKELY: f64 = 1e-6;

/// What a section shows below its heading.
#[derive(Template)]
#[template(path = "section.html")]
pub struct Section<'a> {
    pub cause: Option<CauseView<'a>>,
    pub ratio: Option<&'a str>,
    pub changes: Vec<&'a Changed<'a>>,
    pub telling: Vec<CheckView<'a>>,
    pub others: Vec<CheckView<'a>>,
    /// For the script: the cases whose cells can be drawn.
    pub discs: Option<String>,
    pub pictures: Vec<&'a str>,
    pub stand_in: Option<&'a str>,
    pub unread: Option<&'a str>,
    pub directions: Option<Directions<'a>>,
    pub parameters: Vec<(&'a str, String)>,
    pub claims: Vec<(String, String)>,
}

/// What is wrong with a subject.
pub struct CauseView<'a> {
    pub found: &'a Diagnosis,
    pub slug: Option<&'a str>,
    /// Whether the page holds the manual's page on it.
    pub in_manual: bool,
    /// The page elsewhere, where it is no page of gonio's own manual.
    pub elsewhere: Option<&'a str>,
    pub after_repair: Option<String>,
    pub explain: Option<String>,
}

/// A check of the subject.
pub struct CheckView<'a> {
    pub id: &'a str,
    pub anchor: String,
    pub verdict: Verdict,
    pub at: String,
    pub message: &'a str,
    /// How large the error is, at the clearest place.
    pub effect: String,
    pub certainty: String,
    pub limit: String,
    /// The rest, by name.
    pub facts: Vec<(&'static str, String)>,
    pub command: &'a str,
    /// Every direction, where there are several.
    pub rows: Vec<RowView>,
}

/// A check at a direction.
pub struct RowView {
    pub verdict: Verdict,
    pub wo: String,
    pub effect: String,
    pub certainty: String,
    pub limit: String,
    pub samples: String,
}

/// Directions × checks.
pub struct Directions<'a> {
    pub checks: Vec<&'a str>,
    pub rows: Vec<(String, Vec<Option<Verdict>>)>,
}

impl CheckView<'_> {
    pub fn symbol(&self) -> char {
        symbol(self.verdict)
    }
}

impl RowView {
    pub fn symbol(&self) -> char {
        symbol(self.verdict)
    }
}

/// The symbol of a verdict, or nothing.
pub fn shape(verdict: &Option<Verdict>) -> String {
    verdict.map(|v| symbol(v).to_string()).unwrap_or_default()
}

/// `fail at 3 of 6 directions`.
pub fn at(check: &Check) -> String {
    let all = check.results.len();
    let same = check.results.iter().filter(|r| r.verdict == check.verdict).count();
    let word = check.verdict.word();
    match (all, check.results[0].wo) {
        (1, Some(wo)) => format!("{word} at {}", direction(wo)),
        (1, None) => word.into(),
        _ if same == all => format!("{word} at all {}", counted(all, "direction")),
        _ => format!("{word} at {} of {}", thousands(same), counted(all, "direction")),
    }
}

/// A given direction with its mode.
fn given(result: &CheckResult) -> String {
    let wo = result.wo.map_or("–".into(), direction);
    match result.transport {
        Transport::Radiance => wo,
        Transport::Importance => format!("{wo}, importance"),
    }
}

/// The section of a subject below its heading.
pub fn section<'a>(
    subject: &'a Subject<'a>,
    carried: &'a Carried,
    changes: Option<&'a Changes<'a>>,
) -> Section<'a> {
    let views = subject.checks.iter().map(|check| view(subject, check));
    let (mut telling, others): (Vec<CheckView>, Vec<CheckView>) = views.partition(|v| is_telling(v.verdict));
    telling.sort_by_key(|check| std::cmp::Reverse(check.verdict));
    let of_subject = |c: &&Changed| c.is_of(subject.id);
    let claims = serde_json::to_value(subject.id.claims).ok();
    let claims = claims.as_ref().and_then(|c| c.as_object()).into_iter().flatten();
    Section {
        cause: subject.found.map(|found| cause(found, subject)),
        ratio: carried.ratio.as_deref(),
        changes: changes.map(|c| c.list.iter().filter(of_subject).collect()).unwrap_or_default(),
        telling,
        others,
        discs: carried.has_cells.then(|| discs(subject)).flatten(),
        pictures: carried.pictures.iter().filter(|p| !p.stands_for_discs).map(|p| p.svg.as_str()).collect(),
        stand_in: carried.pictures.iter().find(|p| p.stands_for_discs).map(|p| p.svg.as_str()),
        unread: carried.unread.as_deref(),
        directions: directions(subject),
        parameters: subject.id.parameters.0.iter().map(|(k, v)| (k.as_str(), v.to_string())).collect(),
        claims: claims.map(|(k, v)| (k.replace('_', " "), plain(v))).collect(),
    }
}

/// A claim's value without the quotes of JSON.
fn plain(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Bool(true) => "yes".into(),
        serde_json::Value::Bool(false) => "no".into(),
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

fn cause<'a>(found: &'a Diagnosis, subject: &Subject) -> CauseView<'a> {
    let slug = found.cause.as_deref();
    let in_manual = slug.is_some_and(|slug| Cause::ALL.iter().any(|c| c.slug() == slug));
    let page = found.page.as_deref().filter(|page| !in_manual && page.starts_with("https://"));
    let result = subject.checks.first().map(|c| c.results[0]);
    let program = result.and_then(|r| r.command.split(' ').next()).unwrap_or("gonio");
    let after = |p: f64| {
        let doubt = if p < UNLIKELY { ": something else may be wrong too" } else { "" };
        format!("p = {}{doubt}", probability(p.log10()))
    };
    CauseView {
        found,
        slug,
        in_manual,
        elsewhere: page,
        after_repair: found.p_after_repair.map(|p| after(p.0)),
        explain: slug.map(|slug| format!("{program} explain {slug}")),
    }
}

fn view<'a>(subject: &Subject, check: &Check<'a>) -> CheckView<'a> {
    let result = check.results[0];
    let mut facts = Vec::new();
    if let Some(place) = &result.worst {
        facts.push(("where", worst(place)));
        if !place.u.is_empty() {
            let u: Vec<String> = place.u.iter().map(f64::to_string).collect();
            facts.push(("drawn by u", u.join(", ")));
        }
    }
    if let Some(reason) = result.reason.as_ref().filter(|r| **r != result.message) {
        facts.push(("reason", reason.clone()));
    }
    if let Some(because) = &result.waived_because {
        facts.push(("waived, since", because.clone()));
    }
    let attempts: Vec<String> = result
        .attempts
        .iter()
        .map(|a| {
            format!(
                "{} draws of seed {}: p = {}",
                thousands(a.samples as usize),
                a.seed,
                probability(a.log10_p.0)
            )
        })
        .collect();
    if is_telling(check.verdict) && !attempts.is_empty() {
        facts.push(("looks", attempts.join("; ")));
    }
    let rows = match check.results.len() {
        0 | 1 => Vec::new(),
        _ if !is_telling(check.verdict) => Vec::new(),
        _ => check.results.iter().map(|r| row(r)).collect(),
    };
    let many = check.results.len() > 1 && result.wo.is_some();
    let place = if many && is_telling(check.verdict) {
        format!("{}, clearest at {}", at(check), given(result))
    } else {
        at(check)
    };
    CheckView {
        id: check.id,
        anchor: names::check_anchor(&subject.anchor, check.id),
        verdict: check.verdict,
        at: place,
        message: &result.message,
        effect: effect_of(result),
        certainty: certainty(result).unwrap_or_default(),
        limit: limits(&check.results),
        facts,
        command: &result.command,
        rows,
    }
}

fn effect_of(result: &CheckResult) -> String {
    let channel = result.channel.as_ref().map_or(String::new(), |c| format!(" (channel {c})"));
    result.effect.as_ref().map_or(String::new(), |e| effect(e) + &channel)
}

/// From the least to the most of all directions.
fn limits(results: &[&CheckResult]) -> String {
    let mut limits: Vec<f64> = results.iter().filter_map(|r| r.detection_limit).map(|l| l.0).collect();
    limits.sort_by(f64::total_cmp);
    match (limits.first(), limits.last()) {
        (Some(least), Some(most)) if ratio(*least) != ratio(*most) => range(*least, *most),
        (Some(least), _) => ratio(*least),
        _ => String::new(),
    }
}

fn row(result: &CheckResult) -> RowView {
    RowView {
        verdict: result.verdict,
        wo: given(result),
        effect: effect_of(result),
        certainty: certainty(result).unwrap_or_default(),
        limit: result.detection_limit.map_or(String::new(), |l| ratio(l.0)),
        samples: if result.samples > 0 { thousands(result.samples as usize) } else { String::new() },
    }
}

fn directions<'a>(subject: &Subject<'a>) -> Option<Directions<'a>> {
    if subject.cases.len() < 2 || subject.cases.iter().any(|c| c.wo.is_none()) {
        return None;
    }
    let checks: Vec<&str> = subject.checks.iter().map(|c| c.id).collect();
    let name = |case: &Case| {
        let mode = if case.transport == Transport::Importance { ", importance" } else { "" };
        case.wo.map_or(String::new(), |wo| direction(wo) + mode)
    };
    let row = |case: &Case| (name(case), checks.iter().map(|c| case.verdicts.get(c).copied()).collect());
    let rows = subject.cases.iter().map(row).collect();
    Some(Directions { checks, rows })
}

/// A case as the script knows it.
#[derive(Serialize)]
struct DiscCase<'a> {
    evidence: &'a str,
    plot: Option<&'a str>,
    theta: f64,
    phi: f64,
    transport: Transport,
    verdict: &'a str,
}

#[derive(Serialize)]
struct Discs<'a> {
    cases: Vec<DiscCase<'a>>,
    first: usize,
}

/// What the script needs to draw discs.
fn discs(subject: &Subject) -> Option<String> {
    let first = subject.first_case().and_then(|k| subject.cases[k].evidence);
    let cases: Vec<DiscCase> = subject
        .cases
        .iter()
        .filter_map(|case| {
            let wo = case.wo?;
            Some(DiscCase {
                evidence: case.evidence?,
                plot: case.plot.filter(|p| is_picture(p)),
                theta: wo.theta_deg,
                phi: wo.phi_deg,
                transport: case.transport,
                verdict: case.verdict.word(),
            })
        })
        .collect();
    let first = cases.iter().position(|c| Some(c.evidence) == first).unwrap_or(0);
    (!cases.is_empty()).then(|| inert_json(&Discs { cases, first }))
}

/// A link leads to a picture of the report and nowhere else.
fn is_picture(path: &str) -> bool {
    let name = path.strip_prefix("plots/").and_then(|p| p.strip_suffix(".svg"));
    name.is_some_and(|n| n.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)))
}
