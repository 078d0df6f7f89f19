//! The process between gonio and a sandbox: it counts what the sandbox takes, and ends all
//! of it at once where that is too much, or where nobody reads its standard error any more.

use super::confine::BEGINS;
use super::incident::Log;
use super::mounts::ENVIRONMENT;
use super::rules::Rules;
use super::seccomp;
use super::streams;
use super::taken::Where;
use super::watch::Watch;
use crate::plugins::process::{descendants, end_as, end_descendants};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{MemfdFlags, memfd_create};
use rustix::io::{FdFlags, fcntl_setfd};
use rustix::process::{
    Pid, PidfdFlags, Signal, WaitOptions, WaitStatus, getpid, kill_process, pidfd_open, set_child_subreaper,
    setsid, waitpid,
};
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::{AsRawFd, OwnedFd};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// As shells tell that a command cannot be started.
const CANNOT_START: i32 = 127;

/// How it ends where it has ended the sandbox, having told why.
pub const ENDED: i32 = 125;

/// How what it says of itself begins.
pub const VOICE: &str = "gonio: ";

/// How often it counts. What forks without end starts some hundred processes meanwhile.
const ROUND: Duration = Duration::from_millis(25);

/// How often incidents are written.
const WRITE: Duration = Duration::from_secs(1);

/// Runs the command after the first `--` of `words`, in bubblewrap with what stands before
/// as its arguments, if there is a `bubblewrap`. Ends as the command does, once all that it
/// started has ended too.
pub fn guard(rules: &Rules, log: Option<&Path>, bubblewrap: Option<&Path>, words: &[OsString]) -> i32 {
    let mut parts = words.splitn(2, |word| word == "--");
    let (options, command) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    // A session of its own, and its orphans, as supervise.rs says.
    let alone = setsid().map(drop).and(set_child_subreaper(Some(getpid())));
    let started = alone
        .map_err(io::Error::from)
        .and_then(|()| seccomp::keep_no_files())
        .and_then(|()| start(bubblewrap, options, command));
    let mut guard = match started {
        Ok((child, hello, first)) => Guard {
            rules,
            log: Log::new(log, rules.phase),
            child,
            first,
            hello: Some(hello),
            places: None,
            watch: None,
            since: Instant::now(),
            written: Instant::now(),
        },
        Err(e) => {
            eprintln!("{VOICE}the sandbox cannot be started: {e}");
            return CANNOT_START;
        }
    };
    let status = guard.run();
    // Bubblewrap tells of a signal as shells do.
    let code = status.and_then(|status| status.exit_status()).filter(|_| bubblewrap.is_some());
    let signal = match code {
        Some(code @ 129..=192) => Some(code - 128),
        _ => status.and_then(|status| status.terminating_signal()),
    };
    if let Some(what) = signal.and_then(by_signal) {
        guard.log.note(what);
    }
    guard.log.flush();
    end_descendants();
    match (status, signal) {
        (None, _) => ENDED,
        (_, Some(signal)) => end_by(signal),
        (Some(status), None) => end_as(status),
    }
}

/// What the kernel ends a process for by this signal.
fn by_signal(signal: i32) -> Option<&'static str> {
    match signal {
        libc::SIGSYS => Some("called the system by another architecture's door"),
        libc::SIGXCPU => Some("was ended for its processor time"),
        libc::SIGXFSZ => Some("was ended for a file that is too large"),
        _ => None,
    }
}

/// Ends this process by a signal.
fn end_by(signal: i32) -> i32 {
    if let Some(signal) = Signal::from_named_raw(signal) {
        for _ in 0..2 {
            let _ = kill_process(getpid(), signal);
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    128 + signal
}

/// Starts it; where it says that it begins; and the pipe on which bubblewrap tells its
/// first process.
fn start(
    bubblewrap: Option<&Path>,
    options: &[OsString],
    command: &[OsString],
) -> io::Result<(Pid, OwnedFd, Option<File>)> {
    let (ours, theirs) = streams::pair()?;
    streams::send(&ours, "streams", &[rustix::stdio::stdin(), rustix::stdio::stdout()])?;
    let (first, tell) = rustix::pipe::pipe_with(rustix::pipe::PipeFlags::CLOEXEC)?;
    // Not as words: a program can read those of the first process of its sandbox.
    let arguments = memfd_create("arguments", MemfdFlags::CLOEXEC)?;
    let mut started = match (bubblewrap, command) {
        (Some(bubblewrap), _) => {
            let mut file = File::from(arguments.try_clone()?);
            for option in options {
                file.write_all(option.as_bytes())?;
                file.write_all(&[0])?;
            }
            rustix::fs::seek(&arguments, rustix::fs::SeekFrom::Start(0))?;
            fcntl_setfd(&arguments, FdFlags::empty())?;
            fcntl_setfd(&tell, FdFlags::empty())?;
            let mut started = Command::new(bubblewrap);
            started.arg("--args").arg(arguments.as_raw_fd().to_string());
            started.arg("--info-fd").arg(tell.as_raw_fd().to_string()).arg("--").args(command);
            started
        }
        (None, [program, rest @ ..]) => {
            let mut started = Command::new(program);
            started.args(rest);
            started
        }
        (None, []) => return Err(io::Error::other("a command without a program")),
    };
    // Nor its environment: bubblewrap sets what the program gets.
    started.env_clear();
    if bubblewrap.is_none() {
        started.envs(ENVIRONMENT);
        started.env("PATH", std::env::var_os("PATH").unwrap_or_default());
    }
    let child = started.stdin(Stdio::from(theirs)).stdout(Stdio::null()).spawn().map_err(|e| {
        let program = started.get_program().to_string_lossy().into_owned();
        io::Error::new(e.kind(), format!("`{program}`: {e}"))
    })?;
    // The program alone holds its pipes, so that their ends are its own.
    let null = std::fs::OpenOptions::new().read(true).write(true).open("/dev/null")?;
    rustix::stdio::dup2_stdin(&null)?;
    rustix::stdio::dup2_stdout(&null)?;
    Ok((Pid::from_child(&child), ours, bubblewrap.map(|_| File::from(first))))
}

struct Guard<'a> {
    rules: &'a Rules,
    log: Log,
    child: Pid,
    /// Where bubblewrap tells its first process.
    first: Option<File>,
    /// Where the confining step tells that it begins; `None` once it has.
    hello: Option<OwnedFd>,
    /// Where to look for what it takes, once it has begun.
    places: Option<Where>,
    watch: Option<Watch>,
    since: Instant,
    written: Instant,
}

impl Guard<'_> {
    /// How the command ended; `None` if it was ended.
    fn run(&mut self) -> Option<WaitStatus> {
        let ended = pidfd_open(self.child, PidfdFlags::empty()).ok();
        let mut counted = Instant::now();
        loop {
            loop {
                match waitpid(None, WaitOptions::NOHANG) {
                    Ok(Some((pid, status))) if pid == self.child => return Some(status),
                    // An orphan.
                    Ok(Some(_)) | Err(rustix::io::Errno::INTR) => {}
                    Ok(None) => break,
                    Err(_) => return None,
                }
            }
            let mut waits = vec![PollFd::from_borrowed_fd(rustix::stdio::stderr(), PollFlags::empty())];
            waits.extend(ended.as_ref().map(|fd| PollFd::new(fd, PollFlags::IN)));
            waits.extend(self.hello.as_ref().map(|fd| PollFd::new(fd, PollFlags::IN)));
            let left = ROUND.saturating_sub(counted.elapsed());
            let left = Timespec { tv_sec: 0, tv_nsec: i64::from(left.subsec_nanos()) };
            waits.extend(
                self.watch.as_ref().map(|watch| PollFd::from_borrowed_fd(watch.file(), PollFlags::IN)),
            );
            let _ = poll(&mut waits, Some(&left));
            if waits[0].revents().contains(PollFlags::ERR) {
                self.end();
                return None;
            }
            if self.hello.is_some() && waits.last().is_some_and(|wait| !wait.revents().is_empty()) {
                self.begins();
            }
            let answered = self.watch.as_ref().zip(self.places.as_ref());
            let mut why =
                answered.and_then(|(watch, places)| watch.answer(self.rules, places, &mut self.log));
            let count = counted.elapsed() >= ROUND;
            if count {
                counted = Instant::now();
                why = why.or_else(|| self.too_much());
            }
            if let Some(why) = why {
                self.end();
                self.log.note(&format!("was ended for {why}"));
                // Whoever should read it may be waiting for this process to end.
                let _ = rustix::io::ioctl_fionbio(rustix::stdio::stderr(), true);
                let _ = writeln!(io::stderr(), "\n{VOICE}{why}");
                return None;
            }
            if self.written.elapsed() >= WRITE {
                self.log.flush();
                self.written = Instant::now();
            }
        }
    }

    /// The confining step is inside.
    fn begins(&mut self) {
        let Some(hello) = self.hello.take() else { return };
        let (message, mut files) = streams::receive(&hello).unwrap_or_default();
        if message.is_empty() {
            // It has ended before.
            return;
        }
        if message != BEGINS {
            let _ = writeln!(io::stderr(), "{VOICE}{message}");
        }
        self.watch = files.pop().map(|listener| Watch::new(listener, self.rules));
        self.since = Instant::now();
        self.places = Some(match &mut self.first {
            Some(pipe) => Where::sandbox(first_process(pipe).unwrap_or(0)),
            None => Where::Descendants(Vec::new()),
        });
    }

    /// What of it is too much.
    fn too_much(&mut self) -> Option<String> {
        let rules = self.rules;
        if let Some(clock) = rules.clock.filter(|clock| self.since.elapsed().as_secs_f64() > *clock) {
            return Some(format!("more than {clock} s"));
        }
        let places = self.places.as_mut()?;
        if let Where::Descendants(pids) = places {
            *pids = descendants();
        }
        let taken = places.taken();
        let mebibytes = |bytes: u64| format!("{} MiB", bytes >> 20);
        if let Some(why) = taken.crowded(rules) {
            return Some(why);
        }
        if taken.memory > rules.memory {
            return Some(format!("more than {} of memory", mebibytes(rules.memory)));
        }
        if let Some(most) = rules.processor.filter(|most| taken.processor > Duration::from_secs(*most)) {
            return Some(format!("more than {most} s of processor time"));
        }
        if places.disk(&rules.work) >= rules.disk {
            return Some(format!("more than {} of files", mebibytes(rules.disk)));
        }
        None
    }

    /// Ends all of it: with the first process of a sandbox goes every other, at once.
    fn end(&mut self) {
        let first = match &self.places {
            Some(Where::Sandbox { root }) => {
                let number =
                    root.components().nth(2).and_then(|part| part.as_os_str().to_str()?.parse().ok());
                number.and_then(Pid::from_raw)
            }
            _ => None,
        };
        let _ = kill_process(first.unwrap_or(self.child), Signal::KILL);
        end_descendants();
    }
}

/// The number of bubblewrap's first process inside, out here.
fn first_process(pipe: &mut File) -> Option<i32> {
    #[derive(serde::Deserialize)]
    struct Info {
        #[serde(rename = "child-pid")]
        child: i32,
    }
    let mut bytes = [0; 1024];
    let mut read = 0;
    while read < bytes.len() {
        match pipe.read(&mut bytes[read..]) {
            Ok(0) | Err(_) => break,
            Ok(n) => read += n,
        }
        if bytes[..read].contains(&b'}') {
            break;
        }
    }
    serde_json::from_slice::<Info>(&bytes[..read]).ok().map(|info| info.child)
}
