//! The process between gonio and a plugin: it sees to it that nothing that the
//! plugin starts outlives the run, even if gonio itself is killed.
//!
//! It hands its standard input and output to the plugin and lets go of them. The
//! plugin's orphans become its children, so it can end them. It learns that gonio
//! is gone, or wants the plugin gone, when nobody reads standard error any more.

use super::descendants::{end_as, end_descendants};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::process::{Pid, Resource, Rlimit, WaitOptions};
use rustix::process::{set_child_subreaper, setrlimit, setsid, waitpid};
use std::ffi::OsString;
use std::process::Command;

/// As shells tell that a command cannot be started.
const CANNOT_START: i32 = 127;

/// Runs `command` with at most `memory` bytes of address space and no core dump,
/// and ends as it does, once all that it started has ended too.
pub fn supervise(command: &[OsString], memory: u64) -> i32 {
    let limit = |most| Rlimit { current: Some(most), maximum: Some(most) };
    // A limit that cannot be set is an error: the plugin must not run without.
    let limited = setrlimit(Resource::Core, limit(0)).and_then(|()| setrlimit(Resource::As, limit(memory)));
    // In a session of its own it has no terminal: an interrupt there is for gonio, which
    // then ends its plugins. Nor is it hung up when gonio ends while it has stopped
    // processes, as a group would be that loses its parent.
    let session = setsid();
    let reaper = set_child_subreaper(Some(rustix::process::getpid()));
    if let Err(e) = limited.and(reaper).and(session.map(drop)) {
        eprintln!("gonio cannot limit the plugin: {e}");
        return CANNOT_START;
    }
    let Some((program, arguments)) = command.split_first() else { return CANNOT_START };
    // Before the plugin takes what the memory is limited to.
    let watching = std::thread::Builder::new().spawn(|| {
        let nobody_reads = || {
            let mut pipe = [PollFd::from_borrowed_fd(rustix::stdio::stderr(), PollFlags::empty())];
            poll(&mut pipe, None).is_ok() && pipe[0].revents().contains(PollFlags::ERR)
        };
        while !nobody_reads() {}
        end_descendants();
        std::process::exit(0);
    });
    if let Err(e) = watching {
        eprintln!("gonio cannot watch over the plugin: {e}");
        return CANNOT_START;
    }
    let child = match Command::new(program).args(arguments).spawn() {
        Ok(child) => Pid::from_child(&child),
        Err(e) => {
            eprintln!("cannot start `{}`: {e}", program.to_string_lossy());
            return CANNOT_START;
        }
    };
    // The plugin alone holds its pipes, so that their ends are its own.
    if let Ok(null) = std::fs::OpenOptions::new().read(true).write(true).open("/dev/null") {
        let _ = rustix::stdio::dup2_stdin(&null);
        let _ = rustix::stdio::dup2_stdout(&null);
    }
    let status = loop {
        match waitpid(None, WaitOptions::empty()) {
            Ok(Some((pid, status))) if pid == child => break status,
            // An orphan.
            Ok(_) | Err(rustix::io::Errno::INTR) => {}
            Err(_) => return 1,
        }
    };
    end_descendants();
    end_as(status)
}
