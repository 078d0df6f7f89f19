//! `gonio grade`.

use super::args::Voice;
use super::error::CliError;
use super::exit::Exit;
use super::interrupt::stop_on_interrupt;
use super::output::{prove_writable, tell};
use super::progress::Steps;
use crate::grading::{
    Failure, Fairness, Grade, Graded, Grader, Submission, Wishes, find, grade_all, kept, load,
};
use crate::registry::Registry;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;

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
    /// The folder of grades, which is gone on with.
    #[arg(short, long, value_name = "DIR", default_value = "grades")]
    pub out: PathBuf,
    /// As a student does: without the hidden seed and items, and nothing is kept.
    #[arg(long = "self", id = "own", conflicts_with_all = ["only", "again"])]
    pub own: bool,
    /// Only the submission of this id (may be repeated); the others stay as they are.
    #[arg(long, value_name = "ID")]
    pub only: Vec<String>,
    /// Measure again what is kept.
    #[arg(long)]
    pub again: bool,
    /// Submissions at a time; one for each processor if left out. Grades do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub workers: Option<u16>,
}

/// Grades what is asked for.
pub fn grade(args: &GradeArgs, registry: &Registry, voice: Voice) -> Result<Exit, CliError> {
    let rubric = load(&args.rubric, !args.own)?;
    let found = find(&args.submissions, &rubric).map_err(|message| CliError::Usage {
        message,
        help: "name submissions (a folder or zip each), or folders of them".into(),
    })?;
    if !voice.quiet {
        found.passed_over.iter().for_each(|why| tell(&format!("passed over: {why}")));
    }
    let chosen = chosen(args, &found.submissions)?;
    let stop = stop_on_interrupt("what is graded is kept, and the same command goes on")?;
    let (typed, places) = (args.rubric.display().to_string(), args.submissions.clone());
    let command = move |id: &str, item: &str| {
        let places: Vec<String> = places.iter().map(|p| p.display().to_string()).collect();
        format!("gonio grade {typed} {} --only {id} --item {item}", places.join(" "))
    };
    let wishes = Wishes {
        explanations: Arc::new(registry.explanations()),
        stop: stop.clone(),
        command: Arc::new(command),
        again: args.again,
    };
    let _scratch;
    let out = if args.own {
        _scratch = tempfile::tempdir().map_err(|e| CliError::Internal(e.to_string()))?;
        _scratch.path()
    } else {
        prove_writable(&args.out)?;
        &args.out
    };
    let _alone = alone(out)?;
    let grader = Grader::new(rubric, registry.clone(), wishes).map_err(failed)?;
    if !args.own {
        solution_is_right(&grader, out)?;
    }
    let steps = Steps::new(voice);
    let each = |submission: &Submission, graded: &Result<Graded, Failure>| {
        if let Err(e) = graded
            && !matches!(e, Failure::Stopped)
        {
            tell(&format!("{}: not graded: {e}", submission.id));
        }
    };
    let workers = args.workers.map_or_else(cores, usize::from);
    let results = grade_all(&grader, &chosen, out, workers, &each);
    steps.finish();
    let failures = results.iter().filter(|r| matches!(r, Err(Failure::File(_) | Failure::System(_)))).count();
    let grades: Vec<Grade> = kept(out, found.submissions.iter()).into_iter().flatten().collect();
    let fairness = Fairness { budget: grader.measurement.budget(), students: found.submissions.len() };
    for grade in &grades {
        tell(&format!(
            "{} {} {}/{}",
            grade.id,
            grade.language.as_deref().unwrap_or("-"),
            grade.score,
            grade.max
        ));
    }
    tell(&format!("{fairness:?} {}", fairness.chance()));
    Ok(if stop.load(Ordering::Relaxed) {
        Exit::Interrupted
    } else if failures > 0 {
        Exit::Internal
    } else {
        Exit::Passed
    })
}

/// The submissions that are graded now.
fn chosen(args: &GradeArgs, all: &[Submission]) -> Result<Vec<Submission>, CliError> {
    if let Some(id) = args.only.iter().find(|id| !all.iter().any(|s| s.id == **id)) {
        let help = match crate::registry::nearest(id, all.iter().map(|s| s.id.as_str())) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "the gradebook has the ids".into(),
        };
        return Err(CliError::Usage { message: format!("there is no submission `{id}`"), help });
    }
    let wanted = |s: &&Submission| args.only.is_empty() || args.only.contains(&s.id);
    Ok(all.iter().filter(wanted).cloned().collect())
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

/// The teacher's own submission must lose nothing, or a correct one would.
fn solution_is_right(grader: &Grader, out: &Path) -> Result<(), CliError> {
    let Some(solution) = grader.solution() else { return Ok(()) };
    let graded = grader.grade(&solution, &out.join("solution")).map_err(failed)?;
    let lost: Vec<String> =
        graded.grade.items.iter().filter(|item| item.is_lost()).map(|item| item.id.clone()).collect();
    if lost.is_empty() {
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
