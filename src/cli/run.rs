//! `gonio run`, and the one place where a plan meets the engine and the report.

use super::args::{Format, Measuring, Plots, Voice};
use super::error::CliError;
use super::exit::Exit;
use super::interrupt::stop_on_interrupt;
use super::output::{emit, prove_writable, tell};
use super::progress::Progress;
use crate::diagnosis::{Explanation, diagnose_all};
use crate::engine::{self, Event, Options};
use crate::evidence::Meter;
use crate::registry::{Registry, nearest};
use crate::report::{
    Diagnosis, FileError, Files, REPORT, Report, draw_diagnoses, draw_results, evidence_of, summary,
    write_evidence, write_report,
};
use crate::suite::{EMBEDDED, Expanded, Plan, embedded, load, reproduce};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Arguments of `gonio run`.
#[derive(Debug, clap::Args)]
pub struct RunArgs {
    /// Suite files, or names of suites that come with gonio: seed, quick, deep.
    #[arg(value_name = "SUITE", default_value = EMBEDDED[0].name)]
    pub suites: Vec<String>,
    /// How to measure.
    #[command(flatten)]
    pub measuring: Measuring,
}

/// What to run and where it goes.
pub struct Request {
    /// One for each suite.
    pub plans: Vec<Plan<'static>>,
    /// The folder of the report.
    pub out: Option<PathBuf>,
    /// Whether a report is kept where no folder is named.
    pub keep: bool,
    /// Threads.
    pub threads: Option<usize>,
    /// What comes out.
    pub format: Format,
    /// Which cases get a picture.
    pub plots: Plots,
    /// Whether unclear results fail.
    pub strict: bool,
    /// Combinations of parameters that were left out since their model refuses them.
    pub refused: usize,
    /// Explanations of failures besides those that come with gonio.
    pub explanations: Arc<Vec<Box<dyn Explanation>>>,
}

impl Request {
    /// These plans, with what was typed.
    pub fn new(plans: Vec<Plan<'static>>, measuring: &Measuring, registry: &Registry) -> Self {
        Self {
            plans,
            out: measuring.out.clone(),
            keep: false,
            threads: measuring.threads.map(usize::from),
            format: measuring.format,
            plots: measuring.plots,
            strict: measuring.strict,
            refused: 0,
            explanations: Arc::new(registry.explanations()),
        }
    }

    /// The folder of a plan's report: its own where there are several.
    fn folder(&self, plan: &Plan) -> Option<PathBuf> {
        let Some(out) = &self.out else {
            return self.keep.then(|| Path::new("reports").join(file_name(&plan.suite)));
        };
        Some(if self.plans.len() == 1 { out.clone() } else { out.join(file_name(&plan.suite)) })
    }
}

/// A suite's name as one part of a path.
fn file_name(suite: &str) -> String {
    suite.chars().map(|c| if c.is_alphanumeric() || "-_".contains(c) { c } else { '-' }).collect()
}

impl RunArgs {
    /// Reads and expands all suites before anything is run.
    pub fn request(&self, registry: &Registry) -> Result<Request, CliError> {
        let overrides = self.measuring.overrides();
        let (mut plans, mut refused): (Vec<Plan<'static>>, _) = (Vec::new(), 0);
        for suite in &self.suites {
            let (name, text) = read(suite)?;
            let Expanded { plan, refused: left_out } = load(&name, &text, registry, &overrides)?;
            refused += left_out;
            if plans.iter().any(|p| file_name(&p.suite) == file_name(&plan.suite)) {
                return Err(CliError::Usage {
                    message: format!("two suites are called `{}`", plan.suite),
                    help: "run them one by one, or give one of them another name = \"…\" in [suite]".into(),
                });
            }
            plans.push(plan);
        }
        Ok(Request { refused, keep: true, ..Request::new(plans, &self.measuring, registry) })
    }
}

/// The text of a suite: a file, or one that comes with gonio.
fn read(suite: &str) -> Result<(String, String), CliError> {
    match (std::fs::read_to_string(suite), embedded(suite)) {
        (Ok(text), _) => Ok((suite.into(), text)),
        (Err(_), Some(found)) => Ok((found.name.into(), found.text.into())),
        (Err(e), None) => {
            let names = EMBEDDED.iter().map(|e| e.name);
            let help = match nearest(suite, names.clone()) {
                _ if Path::new(suite).exists() => format!("the file cannot be read: {e}"),
                Some(n) => format!("did you mean `{n}`?"),
                None => {
                    let names = names.collect::<Vec<_>>().join(", ");
                    format!("name a file that exists, or one of the suites that come with gonio: {names}")
                }
            };
            Err(CliError::NoSuite { name: suite.into(), help })
        }
    }
}

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

/// Runs one plan and hands its results to the report: where the command line
/// meets the engine. Evidence is written case by case, so that a run that is
/// killed leaves what it had.
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
    let progress = Progress::new(plan, voice);
    let started = jiff::Timestamp::now().to_string();
    let options = Options { threads: request.threads, stop: stop.clone(), deadline: None };
    let mut unwritten: Option<FileError> = None;
    let results = engine::run(plan, &options, &mut |event| {
        progress.observe(event);
        if let (Event::CaseDone(case), Some(folder)) = (event, &folder)
            && let Some(evidence) = &case.evidence
            && let Err(error) = write_evidence(folder, case.index, evidence)
        {
            unwritten.get_or_insert(error);
        }
    });
    progress.finish();
    let diagnosed = diagnose_all(&results, &request.explanations, &options);
    let mut diagnoses = Diagnosis::all(&results, diagnosed);
    let plots = match (&folder, request.plots.which()) {
        (Some(folder), Some(which)) => draw_results(folder, &results, &diagnoses, which),
        _ => Ok(BTreeMap::new()),
    };
    let (plots, unwritten) = match plots {
        Ok(plots) => (plots, unwritten),
        Err(error) => (BTreeMap::new(), unwritten.or(Some(error))),
    };
    let program = program();
    let files = Files {
        command: &|case, check| reproduce(&program, plan, &case.case, results.share, check),
        evidence: &|case| folder.as_ref().and_then(|_| evidence_of(case)),
        plot: &|case| plots.get(&case.index).cloned(),
    };
    let drawn = match (&folder, request.plots.which()) {
        (Some(folder), Some(_)) => draw_diagnoses(folder, &mut diagnoses),
        _ => Ok(()),
    };
    let unwritten = unwritten.or(drawn.err());
    let report = Report::new(plan, &results, started, &files).diagnosed(diagnoses);
    let written = folder.as_ref().map(|folder| write_report(folder, &report)).transpose();
    if !voice.quiet {
        tell(&page(&report, folder.as_deref(), voice));
    }
    if request.format == Format::Json {
        let mut text = serde_json::to_string(&report).map_err(|e| CliError::Internal(e.to_string()))?;
        text.push('\n');
        emit(&text)?;
    }
    if let Some(error) = unwritten {
        return Err(error.into());
    }
    written?;
    if stop.load(Ordering::Relaxed) { Ok(Exit::Interrupted) } else { Ok(Exit::of(&results, request.strict)) }
}

/// The page for people.
fn page(report: &Report, folder: Option<&Path>, voice: Voice) -> String {
    let path = |name: &str| folder.map(|f| f.join(name).display().to_string()).unwrap_or_default();
    let paths = [("report", path(REPORT)), ("evidence", path("evidence")), ("pictures", path("plots"))];
    let files: Vec<(&str, &str)> = match folder {
        Some(_) => paths.iter().map(|(what, path)| (*what, path.as_str())).collect(),
        None => Vec::new(),
    };
    summary(report, &files, voice.look())
}

/// The name under which this program was called, for commands to type.
fn program() -> String {
    let path = std::env::args_os().next().map(PathBuf::from);
    path.and_then(|p| Some(p.file_stem()?.to_str()?.to_string())).unwrap_or_else(|| "gonio".into())
}
