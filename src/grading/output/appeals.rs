//! Everything behind a lost point, for an appeal: a folder for each item. It is for the
//! teacher: it holds the seed, and hidden items.

use super::super::{Grade, ItemGrade, Lost};
use super::feedback::ItemTold;
use super::files::{appeals, file_name};
use super::found::{clearer, verb};
use super::pictures::{Desk, is_below, telling};
use super::points::{earned, loss, points};
use super::write::Told;
use crate::report::formats::markdown_text::{cell, code, fenced, plain, text};
use crate::report::wording::{certainty, direction, effect, worst};
use crate::report::{CheckResult, Diagnosis, FileError, Kind, Report, write_whole};
use std::path::Path;

/// Rows of the table of cases.
const MOST_ROWS: usize = 200;

/// The file to read first.
const README: &str = "README.md";

/// Writes the folders of all lost items; what was there of others before is gone.
pub fn write(
    folder: &Path,
    grade: &Grade,
    report: Option<&Report>,
    told: &Told,
    desk: &mut Desk,
) -> Result<(), FileError> {
    let all = folder.join(appeals(&grade.id));
    match std::fs::remove_dir_all(&all) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            return Err(FileError::Write { path: all, source });
        }
        _ => {}
    }
    for item in grade.items.iter().filter(|item| item.is_lost()) {
        let at = all.join(file_name(&item.id));
        let mut lost: Vec<&Lost> = item.lost.iter().collect();
        lost.sort_by(|a, b| clearer(a, b));
        let files = match lost.first() {
            Some(clearest) => write_files(&at, clearest, told, desk)?,
            None => Vec::new(),
        };
        let page = page(grade, item, &lost, &files, report, told);
        write_whole(&at.join(README), page.as_bytes())?;
    }
    Ok(())
}

/// The pictures and the evidence of the clearest case; their names.
fn write_files(at: &Path, clearest: &Lost, told: &Told, desk: &mut Desk) -> Result<Vec<String>, FileError> {
    let mut files = Vec::new();
    let Some(evidence) = clearest.evidence.as_deref().filter(|path| is_below(path)) else { return Ok(files) };
    let mut kinds: Vec<Kind> = telling(&clearest.check).iter().take(1).copied().collect();
    if !kinds.contains(&Kind::Discs) {
        kinds.push(Kind::Discs);
    }
    for kind in kinds {
        if let Some(picture) = desk.case(clearest, None, kind) {
            let name = format!("{}.svg", if kind == Kind::Discs { "discs" } else { kind.word() });
            write_whole(&at.join(&name), picture.svg.as_bytes())?;
            files.push(name);
        }
    }
    let name = evidence.trim_start_matches("evidence/").to_string();
    // A picture cannot be drawn of what is gone; the words remain.
    if std::fs::copy(told.measured.join(evidence), at.join(&name)).is_ok() {
        files.push(name);
    }
    Ok(files)
}

fn page(
    grade: &Grade,
    item: &ItemGrade,
    lost: &[&Lost],
    files: &[String],
    report: Option<&Report>,
    told: &Told,
) -> String {
    let of = ItemTold::of(item);
    let hidden = if item.hidden { " This item is hidden from students." } else { "" };
    let mut parts = vec![
        format!("# {}: {}", plain(&item.title), loss(&of)),
        format!(
            "Submission {} of {}, item {}: {}. {} of {} cases passed. The submission has {} of {}.{hidden}",
            code(&grade.id),
            plain(&grade.rubric),
            code(&item.id),
            earned(&of),
            item.passed,
            item.cases,
            points(grade.score),
            points(grade.max)
        ),
        format!(
            "Seed {}, gonio {}, kept apart by {}.",
            grade.seed,
            text(&grade.gonio),
            text(&grade.isolation)
        ),
        format!("To measure it again:\n\n{}", fenced("sh", &(told.command)(&item.id))),
    ];
    parts.extend(item.loss.as_ref().map(|loss| format!("The rubric says: {}", plain(loss))));
    parts.extend(item.unmet.as_ref().map(|id| format!("Not scored, as {} earned nothing.", code(id))));
    if let Some(broken) = &grade.broken {
        parts.push(format!("It could not be measured: {}", text(&broken.why)));
        parts.extend((!broken.said.is_empty()).then(|| fenced("text", &broken.said)));
    }
    if let Some(clearest) = lost.first() {
        let result = report.and_then(|report| result_of(report, clearest));
        parts.push(format!("## Where it is clearest\n\n{}", facts(clearest, result)));
        let of_subject = grade.diagnoses.iter().filter(|d| d.subject == clearest.subject);
        parts.extend(of_subject.map(diagnosis));
    }
    if !files.is_empty() {
        parts.push(format!("## Files\n\n{}", listed(files)));
    }
    if lost.len() > 1 {
        parts.push(format!("## Every case that did not pass\n\n{}", table(lost)));
    }
    parts.join("\n\n") + "\n"
}

/// The result of the report that a loss is of: that of its evidence.
fn result_of<'a>(report: &'a Report, lost: &Lost) -> Option<&'a CheckResult> {
    let wo = |wo: Option<crate::report::WoAngles>| wo.map(|wo| [wo.theta_deg, wo.phi_deg]);
    report.results.iter().find(|r| {
        r.check == lost.check
            && r.evidence == lost.evidence
            && r.transport == lost.transport
            && wo(r.wo) == wo(lost.wo)
            && (r.evidence.is_some() || r.subject.name == lost.subject)
    })
}

fn facts(lost: &Lost, result: Option<&CheckResult>) -> String {
    let mut lines = vec![
        format!("- subject: {}", code(&lost.subject)),
        format!("- check: {} {}", code(&lost.check), verb(lost.verdict)),
    ];
    lines.extend(lost.wo.map(|wo| format!("- direction: {}, {:?}", direction(wo), lost.transport)));
    lines.push(format!("- found: {}", text(&lost.message)));
    lines.extend(lost.effect.as_ref().map(|found| format!("- error: {}", text(&effect(found)))));
    lines.extend(result.and_then(certainty).map(|certainty| format!("- certainty: {}", text(&certainty))));
    if let Some(place) = &lost.worst {
        lines.push(format!("- {}", text(&worst(place))));
        let u: Vec<String> = place.u.iter().map(f64::to_string).collect();
        lines.extend((!u.is_empty()).then(|| format!("- drawn by u: {}", u.join(", "))));
    }
    if let Some(result) = result {
        lines.extend(result.channel.as_ref().map(|channel| format!("- channel: {}", text(channel))));
        lines.extend(result.reason.as_ref().map(|reason| format!("- reason: {}", text(reason))));
        for look in &result.attempts {
            let p = crate::report::wording::probability(look.log10_p.0);
            lines.push(format!("- {} draws of seed {}: p = {p}", look.samples, code(&look.seed)));
        }
        lines.extend((result.samples > 0).then(|| format!("- draws: {}", result.samples)));
    }
    lines.join("\n")
}

fn diagnosis(found: &Diagnosis) -> String {
    let slug = found.cause.as_deref().map_or(String::new(), |slug| format!(" ({})", code(slug)));
    let mut lines = vec![format!("- {}{slug}", text(&found.statement))];
    lines.extend(found.repair.as_ref().map(|repair| format!("- repair: {}", text(repair))));
    lines.extend(found.evidence.iter().map(|since| format!("- since: {}", text(since))));
    lines.extend(found.runner_up.as_ref().map(|next| format!("- next: {}", text(next))));
    format!("## The diagnosis of its subject\n\n{}", lines.join("\n"))
}

fn listed(files: &[String]) -> String {
    let what = |name: &String| match name.as_str() {
        "discs.svg" => Kind::Discs.title(),
        _ if name.ends_with(".json.gz") => "what was measured of this case: counts, integrals, and places",
        _ => "the picture that tells most of this check",
    };
    files.iter().map(|name| format!("- [{name}]({name}): {}", what(name))).collect::<Vec<_>>().join("\n")
}

fn table(lost: &[&Lost]) -> String {
    let mut lines = vec![
        "| subject | check | direction | verdict | error | evidence |".to_string(),
        "|---|---|---|---|---|---|".into(),
    ];
    lines.extend(lost.iter().take(MOST_ROWS).map(|l| {
        format!(
            "| {} | {} | {} | {} | {} | {} |",
            cell(&l.subject),
            cell(&l.check),
            l.wo.map_or("–".into(), direction),
            l.verdict.word(),
            l.effect.as_ref().map_or(String::new(), |found| text(&effect(found))),
            l.evidence.as_ref().map_or(String::new(), |path| cell(path)),
        )
    }));
    if lost.len() > MOST_ROWS {
        lines.push(format!("\nand {} more, in grade.json.", lost.len() - MOST_ROWS));
    }
    lines.join("\n")
}
