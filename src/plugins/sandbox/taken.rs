//! What all processes of a sandbox take together.

use super::rules::Rules;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Length of the kernel's tick for programs: USER_HZ, the same on all of today's machines.
const TICK: Duration = Duration::from_millis(10);

/// Threads for each process that is allowed.
const THREADS: u64 = 8;

/// An empty file takes about this much of the kernel's memory.
const FILE: u64 = 1024;

/// What processes take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Taken {
    /// How many processes.
    pub processes: u64,
    /// How many threads, the first of each process among them.
    pub threads: u64,
    /// Bytes of memory that is no file's.
    pub memory: u64,
    /// Processor time, ended processes included.
    pub processor: Duration,
}

/// Where processes are looked for.
pub enum Where {
    /// A sandbox with process numbers of its own: its /proc, seen from outside. Its first
    /// process is bubblewrap's.
    Sandbox {
        /// Its /.
        root: PathBuf,
    },
    /// All that descend from this process.
    Descendants(Vec<i32>),
}

impl Where {
    /// A sandbox whose first process has this number out here.
    pub fn sandbox(first: i32) -> Self {
        Self::Sandbox { root: format!("/proc/{first}/root").into() }
    }

    /// What is taken now.
    pub fn taken(&self) -> Taken {
        let mut sum = Taken::default();
        match self {
            Self::Sandbox { root } => {
                let proc = root.join("proc");
                for entry in std::fs::read_dir(&proc).into_iter().flatten().flatten() {
                    let Some(pid) = entry.file_name().to_str().and_then(|name| name.parse::<i32>().ok())
                    else {
                        continue;
                    };
                    sum.add(&entry.path(), pid == 1);
                }
            }
            Self::Descendants(pids) => {
                for pid in pids {
                    sum.add(Path::new(&format!("/proc/{pid}")), false);
                }
            }
        }
        sum
    }

    /// Bytes of its files.
    pub fn disk(&self, work: &str) -> u64 {
        let Self::Sandbox { root } = self else { return 0 };
        let used = |folder: &str| {
            let Ok(now) = rustix::fs::statvfs(root.join(folder)) else { return 0 };
            // Only its own file systems have their size.
            if now.f_flag.contains(rustix::fs::StatVfsMountFlags::RDONLY) {
                return 0;
            }
            now.f_blocks.saturating_sub(now.f_bfree) * now.f_frsize
                + now.f_files.saturating_sub(now.f_ffree) * FILE
        };
        used("tmp") + used(work.trim_start_matches('/'))
    }
}

impl Taken {
    /// What is too many of them, if something is.
    pub fn crowded(&self, rules: &Rules) -> Option<String> {
        let (processes, threads) = (rules.processes, rules.processes * THREADS);
        if self.processes > processes {
            return Some(format!("more than {processes} processes at a time"));
        }
        (self.threads > threads).then(|| format!("more than {threads} threads at a time"))
    }

    /// Adds a process, or of bubblewrap's own only what its children took.
    fn add(&mut self, process: &Path, only_children: bool) {
        let Ok(stat) = std::fs::read(process.join("stat")) else { return };
        let stat = String::from_utf8_lossy(&stat);
        // `pid (name) state parent …`, where the name may hold anything.
        let Some((_, rest)) = stat.rsplit_once(')') else { return };
        let words: Vec<&str> = rest.split_ascii_whitespace().collect();
        let number = |k: usize| words.get(k).and_then(|word| word.parse::<u64>().ok()).unwrap_or(0);
        let ticks = if only_children { 0 } else { number(11) + number(12) } + number(13) + number(14);
        self.processor += TICK.saturating_mul(ticks.min(u64::from(u32::MAX)) as u32);
        if only_children {
            return;
        }
        self.processes += 1;
        self.threads += number(17);
        let status = std::fs::read_to_string(process.join("status")).unwrap_or_default();
        for line in status.lines() {
            if let Some(("RssAnon" | "RssShmem", rest)) = line.split_once(':') {
                let kib = rest.split_ascii_whitespace().next().and_then(|word| word.parse::<u64>().ok());
                self.memory += kib.unwrap_or(0) << 10;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_process_takes_something() {
        let mut block = vec![1u8; 64 << 20];
        let me = || Where::Descendants(vec![std::process::id() as i32, -1]).taken();
        let before = me();
        assert_eq!(before.processes, 1);
        assert!(before.threads >= 1 && before.memory >= 64 << 20, "{before:?}");
        let until = std::time::Instant::now() + Duration::from_millis(200);
        while std::time::Instant::now() < until {
            block[0] = std::hint::black_box(block[1]);
        }
        assert!(me().processor > before.processor + Duration::from_millis(50), "{before:?} {:?}", me());
    }
}
