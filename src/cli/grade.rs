//! `gonio grade`.

use super::args::Voice;
use super::error::CliError;
use super::exit::Exit;
use super::interrupt::stop_on_interrupt;
use super::output::{prove_writable, tell};
use super::progress::Steps;
use crate::calibration::Event;
use crate::grading::{
    Class, Failure, Fairness, Grade, Graded, Grader, Submission, System, Told, Wishes, class, find,
    folder_of, grade_all, kept, load, one, write_class, write_student,
};
use crate::plugins::{Isolation, isolation};
use crate::registry::{Registry, nearest};
use crate::report::summary;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use tempfile::TempDir;

/// Arguments of `gonio grade`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  gonio grade rubric.toml submissions/ --out grades
  gonio grade rubric.toml submissions/ --only ada         a late one; the others stay as they are
  gonio grade --self rubric.toml .                        a student, with the public part")]
pub struct GradeArgs {
    /// What earns points (docs/grading.md).
    pub rubric: PathBuf,
    /// Submissions, or folders of them: a folder or a zip each.
    #[arg(value_name = "SUBMISSIONS", required_unless_present = "own", default_value = ".")]
    pub submissions: Vec<PathBuf>,
    /// The folder of grades, which is gone on with; ./grades if left out. A student's own
    /// are kept only where one is named.
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// As a student does: without the hidden seed and items.
    #[arg(long = "self", id = "own", conflicts_with_all = ["only", "again"])]
    pub own: bool,
    /// Only the submission of this id (may be repeated); the others stay as they are.
    #[arg(long, value_name = "ID")]
    pub only: Vec<String>,
    /// Measure again what is kept.
    #[arg(long)]
    pub again: bool,
    /// Measure only this item of the one submission, and tell all that was found; nothing
    /// is written.
    #[arg(long, value_name = "ID")]
    pub item: Option<String>,
    /// Write results.json of these systems too.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "SYSTEM")]
    pub to: Vec<System>,
    /// Submissions at a time; one for each processor if left out. Grades do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub workers: Option<u16>,
}

/// Grades what is asked for.
pub fn grade(args: &GradeArgs, registry: &Registry, voice: Voice) -> Result<Exit, CliError> {
    let rubric = load(&args.rubric, !args.own)?;
    let found = find(&args.submissions, &rubric, args.own).map_err(|message| CliError::Usage {
        message,
        help: "name submissions (a folder or zip each), or folders of them".into(),
    })?;
    let chosen = chosen(args, &found.all)?;
    if !voice.quiet {
        found.passed_over.iter().for_each(|why| tell(&format!("passed over: {why}")));
        if let Isolation::Limits { why } = isolation() {
            tell(&format!("{}: {why}", UNPROTECTED));
        }
    }
    let stop = stop_on_interrupt("what is graded is kept, and the same command goes on")?;
    let places: Vec<String> = args.submissions.iter().map(|p| p.display().to_string()).collect();
    let (typed, places) = (args.rubric.display().to_string(), places.join(" "));
    let command = move |id: &str, item: &str| {
        shell_words::join(["gonio", "grade", &typed, &places, "--only", id, "--item", item])
    };
    let nowhere;
    let out = match &args.out {
        Some(out) if args.item.is_none() => out.as_path(),
        None if args.item.is_none() && !args.own => Path::new("grades"),
        // Nothing is kept.
        _ => {
            nowhere = tempfile::tempdir().map_err(|e| CliError::Internal(e.to_string()))?;
            nowhere.path()
        }
    };
    prove_writable(out)?;
    let _alone = alone(out)?;
    let scratch = scratch(out)?;
    let wishes = Wishes {
        explanations: Arc::new(registry.explanations()),
        stop: stop.clone(),
        command: Arc::new(command.clone()),
        scratch: scratch.path().to_path_buf(),
        again: args.again,
        own: args.own,
    };
    let grader = Grader::new(rubric, registry.clone(), wishes).map_err(failed)?;
    if let Some(item) = &args.item {
        return examine(&grader, &chosen[0], item, voice);
    }
    if !args.own {
        solution_is_right(&grader, out, voice)?;
    }
    let again = format!("gonio grade --self {} .", file_of(&args.rubric));
    let steps = Steps::new(voice);
    steps.observe(Event::Part { title: "grading", steps: chosen.len() as u64 });
    let each = |submission: &Submission, graded: &Result<Graded, Failure>| {
        let written = graded.as_ref().map_err(ToString::to_string).and_then(|graded| {
            let told = Told {
                measured: &folder_of(out, &submission.id),
                to: &args.to,
                again: &again,
                command: &|item| command(&submission.id, item),
            };
            write_student(out, &graded.grade, graded.report.as_ref(), &told).map_err(|e| e.to_string())
        });
        steps.observe(Event::Steps(1));
        if let (true, Ok(graded)) = (voice.verbose, graded) {
            tell(&one_line(&submission.id, graded));
        }
        match (graded, written) {
            (Err(Failure::Stopped), _) | (_, Ok(())) => Ok(()),
            (_, Err(why)) => {
                tell(&format!("{}: not graded: {why}", submission.id));
                Err(why)
            }
        }
    };
    let workers = args.workers.map_or_else(cores, usize::from);
    let done = grade_all(&grader, &chosen, out, workers, &each);
    steps.finish();
    let grades: Vec<Grade> = kept(out, found.all.iter()).into_iter().flatten().collect();
    let fairness = Fairness::new(grader.measurement.budget(), grades.len());
    let stopped = stop.load(Ordering::Relaxed);
    if args.own {
        grades.iter().for_each(|grade| tell(one(grade, &again, voice.screen()).trim_end()));
        return Ok(own_exit(&grades, done.iter().all(Result::is_ok) && !stopped));
    }
    let class_of = Class {
        title: &grader.rubric.title,
        grades: &grades,
        fairness,
        exports: &grader.rubric.exports,
        again: &again,
    };
    let files = write_class(out, &class_of)?;
    if !voice.quiet {
        tell(class(&grades, fairness, voice.screen()).trim_end());
        let missing = found.all.len() - grades.len();
        if missing > 0 {
            tell(&format!("{missing} of {} submissions have no grade yet", found.all.len()));
        }
        tell(&format!("for each student: {}", out.join("feedback").display()));
        files.iter().for_each(|file| tell(&format!("for the class: {}", file.display())));
    }
    Ok(match () {
        () if stopped => Exit::Interrupted,
        () if done.iter().any(Result::is_err) => Exit::Internal,
        () => Exit::Passed,
    })
}

/// What is said where nothing keeps a submission from the rest of the machine.
const UNPROTECTED: &str = "WARNING: submissions that are not WebAssembly run WITHOUT a sandbox, and can read and \
    write whatever you can";

/// A submission as it is done.
fn one_line(id: &str, Graded { grade, took, .. }: &Graded) -> String {
    let (score, max) = (grade.score, grade.max);
    format!("{id}: {score} of {max} (built in {:.1} s, measured in {:.1} s)", took.build_s, took.measure_s)
}

/// What a student's own grade means.
fn own_exit(grades: &[Grade], whole: bool) -> Exit {
    if !whole || grades.iter().any(|grade| grade.broken.is_some()) {
        Exit::Subject
    } else if grades.iter().flat_map(|grade| &grade.items).any(|item| item.is_lost()) {
        Exit::Failed
    } else {
        Exit::Passed
    }
}

/// An item measured again, alone, with everything that was found.
fn examine(grader: &Grader, submission: &Submission, item: &str, voice: Voice) -> Result<Exit, CliError> {
    if !grader.rubric.items.iter().any(|i| i.id == item) {
        let help = match nearest(item, grader.rubric.items.iter().map(|i| i.id.as_str())) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "the rubric has the ids".into(),
        };
        return Err(CliError::Usage { message: format!("the rubric has no item `{item}`"), help });
    }
    match grader.examine(submission, item).map_err(failed)? {
        Ok(report) => {
            tell(summary(&report, &[], voice.look()).trim_end());
            Ok(Exit::of(&report, false))
        }
        Err(broken) => {
            tell(&format!("{}: {}\n{}", submission.id, broken.why, broken.said));
            Ok(Exit::Subject)
        }
    }
}

fn file_of(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// The submissions that are graded now.
fn chosen(args: &GradeArgs, all: &[Submission]) -> Result<Vec<Submission>, CliError> {
    if let Some(id) = args.only.iter().find(|id| !all.iter().any(|s| s.id == **id)) {
        let help = match nearest(id, all.iter().map(|s| s.id.as_str())) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "the gradebook has the ids".into(),
        };
        return Err(CliError::Usage { message: format!("there is no submission `{id}`"), help });
    }
    let wanted = |s: &&Submission| args.only.is_empty() || args.only.contains(&s.id);
    let chosen: Vec<Submission> = all.iter().filter(wanted).cloned().collect();
    if args.item.is_some() && chosen.len() != 1 {
        return Err(CliError::Usage {
            message: "--item measures one submission".into(),
            help: "name it: --only ID".into(),
        });
    }
    Ok(chosen)
}

/// Two at once would write over each other's files.
fn alone(out: &Path) -> Result<File, CliError> {
    let path = out.join(".lock");
    let file = File::create(&path).map_err(|why| CliError::Output { path: path.clone(), why })?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(_) => Err(CliError::Usage {
            message: format!("another gonio grades into {}", out.display()),
            help: "wait for it, or name another folder: --out DIR".into(),
        }),
    }
}

/// A folder in `out`, which nobody else has, that is removed at the end. One that was
/// left by a gonio that was killed goes too.
fn scratch(out: &Path) -> Result<TempDir, CliError> {
    const PREFIX: &str = ".unpacked-";
    let wrong = |why| CliError::Output { path: out.into(), why };
    for entry in fs::read_dir(out).map_err(wrong)?.flatten() {
        if entry.file_name().to_string_lossy().starts_with(PREFIX) {
            fs::remove_dir_all(entry.path()).map_err(wrong)?;
        }
    }
    tempfile::Builder::new().prefix(PREFIX).tempdir_in(out).map_err(wrong)
}

/// The teacher's own submission must lose nothing, or a correct one would.
fn solution_is_right(grader: &Grader, out: &Path, voice: Voice) -> Result<(), CliError> {
    let Some(solution) = grader.solution() else { return Ok(()) };
    let graded = grader.grade(&solution, &out.join("solution")).map_err(failed)?;
    let lost: Vec<String> =
        graded.grade.items.iter().filter(|item| item.is_lost()).map(|item| item.id.clone()).collect();
    if lost.is_empty() {
        if !voice.quiet {
            graded.grade.review.iter().for_each(|what| tell(&format!("solution: {what}")));
        }
        return Ok(());
    }
    Err(CliError::Usage {
        message: format!("the solution itself loses points of {}", lost.join(", ")),
        help: format!("mend it or the rubric; {} has what was found", out.join("solution").display()),
    })
}

fn failed(failure: Failure) -> CliError {
    match failure {
        Failure::File(e) => e.into(),
        Failure::System(message) => CliError::Usage { message, help: "mend it, and run this again".into() },
        Failure::Stopped => CliError::Internal("stopped".into()),
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
