//! `gonio calibrate`.

use super::args::Voice;
use super::error::CliError;
use super::exit::Exit;
use super::interrupt::stop_on_interrupt;
use super::output::{prove_writable, tell};
use super::progress::Steps;
use crate::calibration::{
    CALIBRATION, Calibration, Effort, Identity, PartId, Progress, TRIALS, Unfinished, Work, write,
};
use crate::registry::nearest;
use std::path::PathBuf;

/// Arguments of `gonio calibrate`.
#[derive(Debug, clap::Args)]
#[command(after_help = after_help())]
pub struct CalibrateArgs {
    /// As much as two cores measure in two minutes, in place of an hour's work.
    #[arg(long)]
    pub quick: bool,
    /// Only this part, and a report of it alone (may be repeated).
    #[arg(long, value_name = "NAME", value_parser = part)]
    pub part: Vec<PartId>,
    /// Where to; reports/calibration, or reports/calibration-quick, if left out.
    #[arg(short, long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// The first seed of all random numbers.
    #[arg(long, value_name = "N", default_value_t = crate::suite::SEED)]
    pub seed: u64,
    /// Sets of random parameters at which each mutant is diagnosed.
    #[arg(long, value_name = "N", default_value_t = TRIALS, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub trials: u64,
    /// Threads; one for each processor if left out. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

fn after_help() -> String {
    let rows: Vec<_> = PartId::ALL.iter().map(|p| format!("  {:16}{}", p.name(), p.doc())).collect();
    format!(
        "Parts:\n{}\n\nWhat was interrupted goes on when the same command is typed again. \
         Ends with 0 if calibration holds, and with 1 if it does not.",
        rows.join("\n")
    )
}

fn part(text: &str) -> Result<PartId, String> {
    PartId::find(text).ok_or_else(|| {
        let names = PartId::ALL.map(PartId::name);
        match nearest(text, names.into_iter()) {
            Some(n) => format!("no part is called so; did you mean `{n}`?"),
            None => format!("no part is called so; there are {}", names.join(", ")),
        }
    })
}

/// Measures the instrument, goes on with what an interrupted process left, and writes
/// the report.
pub fn calibrate(args: &CalibrateArgs, voice: Voice) -> Result<Exit, CliError> {
    let (effort, name) = match args.quick {
        true => (Effort::Quick, "reports/calibration-quick"),
        false => (Effort::Full, "reports/calibration"),
    };
    let folder = args.out.clone().unwrap_or_else(|| name.into());
    prove_writable(&folder)?;
    let stop = stop_on_interrupt("the units of work that are done are kept")?;
    // Parts are no setting: what one process did of a part serves another.
    let identity = Identity::new(format!("{effort:?}, seed {}", args.seed));
    let progress = Progress::open(&folder, &identity, stop).map_err(unfinished)?;
    let say = |text: String| {
        if !voice.quiet {
            tell(&text);
        }
    };
    if let Some(path) = progress.set_aside() {
        say(format!("unfinished work of other settings, or of another gonio, is now {}", path.display()));
    }
    if progress.done() > 0 {
        say(format!("going on: {} units of work are done", progress.done()));
    }
    let steps = Steps::new(voice);
    let observe = |event: crate::calibration::Event| steps.observe(event);
    let mut work = Work::new(effort, args.seed, args.threads.map(usize::from), &progress, &observe)
        .map_err(|e| CliError::Internal(format!("cannot start threads: {e}")))?;
    work.trials = args.trials;
    let parts = if args.part.is_empty() { &PartId::ALL[..] } else { &args.part };
    let measured = Calibration::measure(parts, &work);
    steps.finish();
    let calibration = match measured {
        Ok(calibration) => calibration,
        Err(Unfinished::Interrupted) => {
            say(format!("interrupted: {} units of work are kept; the same command goes on", progress.done()));
            return Ok(Exit::Interrupted);
        }
        Err(other) => return Err(unfinished(other)),
    };
    write(&folder, &calibration)?;
    drop(work);
    progress.finish()?;
    for line in calibration.parts().iter().flat_map(|p| p.summary()) {
        say(line);
    }
    for error in &calibration.errors {
        tell(&format!("error: {error}"));
    }
    let holds = calibration.errors.is_empty();
    let word = if holds { "holds" } else { "does not hold" };
    say(format!("calibration {word} ({:.1} s)", calibration.duration_s));
    say(format!("report    {}", folder.join(CALIBRATION).display()));
    Ok(if holds { Exit::Passed } else { Exit::Failed })
}

fn unfinished(error: Unfinished) -> CliError {
    match error {
        Unfinished::File(error) => error.into(),
        Unfinished::Busy(_) => CliError::Usage {
            message: error.to_string(),
            help: "wait for its end, or name another folder: --out DIR".into(),
        },
        Unfinished::Interrupted => CliError::Internal("interrupted before the beginning".into()),
    }
}
