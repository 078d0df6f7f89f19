//! The one place where a plan meets the engine and the report.

use super::args::{Format, Voice};
use super::earlier::read_if_any;
use super::error::CliError;
use super::exit::Exit;
use super::formats::Destination;
use super::interrupt::stop_on_interrupt;
use super::output::{emit, prove_writable, tell};
use super::progress::Progress;
use super::request::Request;
use crate::comparison::compare;
use crate::engine::{Draws, Options};
use crate::evidence::Meter;
use crate::report::{
    Carried, FileError, Look, REPORT, Recording, Report, record, redraw, summary, write_report,
};
use crate::suite::{Plan, reproduce};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs everything that is asked for.
pub fn execute(request: &Request, voice: Voice) -> Result<Exit, CliError> {
    for folder in request.plans.iter().filter_map(|p| request.folder(p)) {
        prove_writable(&folder)?;
    }
    if voice.verbose && request.refused > 0 {
        tell(&format!("left out: {} combinations that their model refuses", request.refused));
    }
    let stop = stop_on_interrupt("what was measured is still reported")?;
    let mut exit = None;
    for plan in &request.plans {
        let one = run(plan, request, voice, &stop)?;
        exit = Some(exit.map_or(one, |so_far: Exit| so_far.and(one)));
        if stop.load(Ordering::Relaxed) {
            break;
        }
    }
    Ok(exit.unwrap_or(Exit::Nothing))
}

/// What subjects do contrary to the conventions that they declare, each once.
fn contradictions(plan: &Plan<'static>) -> BTreeSet<String> {
    let mut told = BTreeSet::new();
    let mut last = None;
    // Cases of a subject stand together.
    for case in &plan.cases {
        if last.replace(&case.spelling) == Some(&case.spelling) {
            continue;
        }
        let found = Meter::describe(&*case.subject).map(|d| d.contradictions).unwrap_or_default();
        told.extend(
            found
                .into_iter()
                .map(|what| format!("warning: {}: {what}; it is measured as such", case.spelling)),
        );
    }
    told
}

/// Runs one plan, keeps what it gives, and tells it.
fn run(
    plan: &Plan<'static>,
    request: &Request,
    voice: Voice,
    stop: &Arc<AtomicBool>,
) -> Result<Exit, CliError> {
    if plan.cases.is_empty() {
        tell(&format!("suite `{}` has no case: nothing was run; add a [[subject]]", plan.suite));
        return Ok(Exit::Nothing);
    }
    if !voice.quiet {
        contradictions(plan).iter().for_each(|told| tell(told));
    }
    let folder = request.folder(plan);
    let baseline = read_baseline(request, plan, voice)?;
    let carried = read_carried(request, plan, voice)?;
    let takes_over = !carried.rows.is_empty();
    let (mut report, mut measured) = measure(plan, request, voice, stop, folder.as_deref(), carried);
    if let (true, Some(folder), Some(which)) = (takes_over, &folder, request.plots.which()) {
        // A picture that cannot be drawn must not lose the report.
        measured = measured.and(redraw(folder, &mut report, which).map(drop));
    }
    let comparison = baseline.as_ref().map(|before| compare(before, &report));
    let report = report.compared(comparison);
    let written = folder.as_ref().map(|folder| keep(&report, request, folder)).transpose();
    if !voice.quiet {
        let look = if request.full { voice.look() } else { voice.screen() };
        let files = written.as_ref().map_or(&[][..], |files| files.as_deref().unwrap_or_default());
        tell(&page(&report, folder.as_deref(), files, look));
    }
    if request.format == Format::Json {
        let mut text = serde_json::to_string(&report).map_err(|e| CliError::Internal(e.to_string()))?;
        text.push('\n');
        emit(&text)?;
    }
    measured?;
    written?;
    if stop.load(Ordering::Relaxed) { Ok(Exit::Interrupted) } else { Ok(Exit::of(&report, request.strict)) }
}

/// Runs a plan and hands its results to the report. With it the first file that could not
/// be written, which must not lose it.
fn measure(
    plan: &Plan<'static>,
    request: &Request,
    voice: Voice,
    stop: &Arc<AtomicBool>,
    folder: Option<&Path>,
    carried: Carried,
) -> (Report, Result<(), FileError>) {
    let progress = Progress::new(plan, voice);
    let program = program();
    let recording = Recording {
        options: Options {
            threads: request.threads,
            stop: stop.clone(),
            draws: request.draws.clone(),
            ..Options::default()
        },
        explanations: &request.explanations,
        folder,
        pictures: request.plots.which(),
        command: &|case, share, check| reproduce(&program, plan, &case.case, share, check),
        time_s: request.time_s,
    };
    let measured = record(plan, recording, carried, &mut |event| progress.observe(event));
    progress.finish();
    measured
}

/// Writes the report, and what else is asked for; the files beside it.
fn keep(report: &Report, request: &Request, folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    write_report(folder, report)?;
    let stdout_is_taken = request.format == Format::Json;
    request.outputs.write(report, Destination { report: folder, out: folder, stdout_is_taken })
}

/// The report to compare with, if there is one by now.
fn read_baseline(request: &Request, plan: &Plan, voice: Voice) -> Result<Option<Report>, CliError> {
    let Some(path) = &request.baseline else { return Ok(None) };
    let path = request.of_plan(path, plan);
    let found = read_if_any("--baseline", &path, "this run is judged by itself", voice.quiet)?;
    Ok(found.map(|(_, report)| report))
}

/// What need not be measured again.
fn read_carried(request: &Request, plan: &Plan, voice: Voice) -> Result<Carried, CliError> {
    let Some(path) = &request.changed_since else { return Ok(Carried::default()) };
    let path = request.of_plan(path, plan);
    let samples = matches!(request.draws, Draws::Planned);
    let found = read_if_any("--changed-since", &path, "everything is measured", voice.quiet)?;
    Ok(found.map_or_else(Carried::default, |(folder, report)| Carried::of(&report, &folder, plan, samples)))
}

/// The page for people; `written` are files beside the report.
fn page(report: &Report, folder: Option<&Path>, written: &[PathBuf], look: Look) -> String {
    let Some(folder) = folder else { return summary(report, &[], look) };
    let mut files: Vec<(&str, String)> =
        [("report", REPORT), ("evidence", "evidence"), ("pictures", "plots")]
            .map(|(what, name)| (what, folder.join(name).display().to_string()))
            .into();
    files.extend(written.iter().map(|path| {
        let what = if path.extension().is_some_and(|e| e == "html") { "page" } else { "also" };
        (what, path.display().to_string())
    }));
    let files: Vec<(&str, &str)> = files.iter().map(|(what, path)| (*what, path.as_str())).collect();
    summary(report, &files, look)
}

/// The name under which this program was called, for commands to type.
fn program() -> String {
    let path = std::env::args_os().next().map(PathBuf::from);
    path.and_then(|p| Some(p.file_stem()?.to_str()?.to_string())).unwrap_or_else(|| "gonio".into())
}
