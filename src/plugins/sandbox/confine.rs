//! The first step inside: what a process can only do to itself, before it becomes the
//! program.

use super::filter::filter;
use super::rules::Rules;
use super::seccomp;
use super::streams::{receive, send};
use crate::plugins::library;
use rustix::io::{FdFlags, fcntl_setfd};
use rustix::process::{Resource, Rlimit, setrlimit};
use rustix::thread::set_no_new_privs;
use std::ffi::OsString;
use std::io;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::Command;

/// As shells tell that a command cannot be started.
const CANNOT_START: i32 = 127;

/// As gonio tells that a subject is broken.
const SUBJECT: i32 = 3;

/// What it tells the guard; anything else is why it is not watched.
pub const BEGINS: &str = "begins";

/// Open files of a process.
const FILES: u64 = 256;

/// Bytes of a file beyond what files may take.
const ROOM: u64 = 1 << 20;

/// Seconds after which the kernel ends a process that the guard has not ended.
const GRACE: u64 = 2;

/// Limits this process, tells the guard that it begins, and becomes `words`, or answers for
/// a library.
pub fn confine(rules: &Rules, words: &[OsString]) -> i32 {
    if let Err(e) = begin(rules) {
        eprintln!("gonio cannot confine the program: {e}");
        return CANNOT_START;
    }
    let Some((first, rest)) = words.split_first() else { return CANNOT_START };
    if rules.library {
        return match library::work(Path::new(first)) {
            Ok(()) => 0,
            Err(e) => {
                eprintln!("{e}");
                SUBJECT
            }
        };
    }
    let e = Command::new(first).args(rest).exec();
    eprintln!("cannot start `{}`: {e}", first.to_string_lossy());
    CANNOT_START
}

fn begin(rules: &Rules) -> io::Result<()> {
    // Standard input is the guard for now.
    let (_, streams) = receive(rustix::stdio::stdin())?;
    let [input, output] = &streams[..] else { return Err(io::Error::other("the guard sends no streams")) };
    let limit = |resource, most| setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) });
    limit(Resource::Core, 0)?;
    limit(Resource::Nofile, FILES)?;
    // A little more than there is room for in a sandbox's own file systems, where the guard
    // tells of it.
    limit(Resource::Fsize, rules.disk + ROOM)?;
    if let Some(seconds) = rules.processor {
        limit(Resource::Cpu, seconds + GRACE)?;
    }
    set_no_new_privs(true)?;
    // Last, since this program needs memory too. More than the guard allows of what is used,
    // so that it is the guard that tells.
    limit(Resource::As, rules.memory + rules.memory / 2)?;
    match watched(rules) {
        Ok(None) => send(rustix::stdio::stdin(), BEGINS, &[])?,
        Ok(Some(listener)) => send(rustix::stdio::stdin(), BEGINS, &[listener.as_fd()])?,
        Err(why) => send(rustix::stdio::stdin(), &why, &[])?,
    }
    rustix::stdio::dup2_stdout(output)?;
    rustix::stdio::dup2_stdin(input)?;
    fcntl_setfd(rustix::stdio::stdin(), FdFlags::empty())?;
    fcntl_setfd(rustix::stdio::stdout(), FdFlags::empty())?;
    Ok(())
}

/// The listener of the filter, if one is wanted. The guard has the only one: who holds it
/// can answer for everyone.
fn watched(rules: &Rules) -> Result<Option<OwnedFd>, String> {
    if !rules.watched {
        return Ok(None);
    }
    let listener = seccomp::install(&filter(rules.phase)?);
    listener.map(Some).map_err(|e| format!("the filter of system calls cannot be installed: {e}"))
}
