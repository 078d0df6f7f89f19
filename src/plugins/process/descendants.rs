//! The processes that descend from this one: found, and ended.

use rustix::process::{Pid, Signal, WaitOptions, WaitStatus, kill_process, wait};
use std::collections::{BTreeSet, HashMap};
use std::time::Duration;

/// How often processes are looked for and ended, at most.
const ROUNDS: usize = 1000;

/// Ends this process as that one ended.
pub fn end_as(status: WaitStatus) -> i32 {
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
pub fn end_descendants() {
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
pub fn descendants() -> Vec<i32> {
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
