//! The process between gonio and a plugin: it sees to it that nothing that the
//! plugin starts outlives the run, even if gonio itself is killed.
//!
//! It hands its standard input and output to the plugin and lets go of them. The
//! plugin's orphans become its children, so it can end them. It learns that gonio
//! is gone, or wants the plugin gone, when nobody reads standard error any more.

use rustix::event::{PollFd, PollFlags, poll};
use rustix::process::{Pid, Resource, Rlimit, Signal, WaitOptions, WaitStatus};
use rustix::process::{kill_process, set_child_subreaper, setrlimit, setsid, wait, waitpid};
use std::collections::{BTreeSet, HashMap};
use std::ffi::OsString;
use std::process::Command;
use std::time::Duration;

/// As shells tell that a command cannot be started.
const CANNOT_START: i32 = 127;

/// How often processes are looked for and ended, at most.
const ROUNDS: usize = 1000;

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

/// Ends this process as that one ended.
fn end_as(status: WaitStatus) -> i32 {
    if let Some(signal) = status.terminating_signal().and_then(Signal::from_named_raw) {
        // The first may only take Rust's own handler away.
        for _ in 0..2 {
            let _ = kill_process(rustix::process::getpid(), signal);
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    status.exit_status().unwrap_or(1)
}

/// Ends every process that descends from this one. They are stopped first: what
/// forks without end would outrun a killer.
fn end_descendants() {
    let mut stopped = BTreeSet::new();
    // What forks faster than this is stopped in the end by what it may start.
    for _ in 0..ROUNDS {
        let new: Vec<i32> = descendants().into_iter().filter(|pid| stopped.insert(*pid)).collect();
        if new.is_empty() {
            break;
        }
        signal_all(&new, Signal::STOP);
    }
    for _ in 0..ROUNDS {
        let left = descendants();
        if left.is_empty() {
            return;
        }
        signal_all(&left, Signal::KILL);
        while let Ok(Some(_)) = wait(WaitOptions::NOHANG) {}
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn signal_all(pids: &[i32], signal: Signal) {
    for pid in pids.iter().filter_map(|pid| Pid::from_raw(*pid)) {
        let _ = kill_process(pid, signal);
    }
}

/// All processes that descend from this one and are not zombies.
fn descendants() -> Vec<i32> {
    let mut children: HashMap<i32, Vec<i32>> = HashMap::new();
    for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
        let Some(pid) = entry.file_name().to_str().and_then(|name| name.parse().ok()) else { continue };
        let Ok(stat) = std::fs::read(entry.path().join("stat")) else { continue };
        let stat = String::from_utf8_lossy(&stat);
        // `pid (name) state parent …`, where the name may hold anything.
        let Some((_, rest)) = stat.rsplit_once(')') else { continue };
        let words: Vec<&str> = rest.split_ascii_whitespace().collect();
        // A zombie with threads has only ended its first.
        let dead = words.first() == Some(&"Z") && words.get(17).is_none_or(|threads| *threads <= "1");
        if let (false, Some(Ok(parent))) = (dead, words.get(1).map(|word| word.parse())) {
            children.entry(parent).or_default().push(pid);
        }
    }
    let mut found = vec![rustix::process::getpid().as_raw_pid()];
    let mut next = 0;
    while let Some(parent) = found.get(next).copied() {
        found.extend(children.remove(&parent).unwrap_or_default());
        next += 1;
    }
    found.split_off(1)
}
