//! A plugin's process, seen from gonio: calls with a time limit, and how it ended.

use super::last_words::LastWords;
use super::launch::Launch;
use crate::plugins::instance::{Call, Created, Fault, Instance};
use crate::plugins::limits::{Limits, START};
use crate::plugins::sandbox::{ENDED, VOICE};
use crate::plugins::wire::{Reply, Request, Wire};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use std::fs::File;
use std::os::fd::OwnedFd;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::time::{Duration, Instant};

/// A pipe holds a batch then; the default is 64 KiB.
const PIPE: usize = 1 << 20;

/// How long an ended program may take to be gone: its supervisor ends what it left.
const LAST: Duration = Duration::from_secs(1);

/// How long its supervisor is waited for.
const PATIENCE: Duration = Duration::from_secs(20);

/// The process of a plugin.
pub struct Child {
    process: std::process::Child,
    input: Option<File>,
    output: File,
    errors: Option<File>,
    /// Read from `output`, not yet taken.
    read: Vec<u8>,
    said: LastWords,
    wire: Wire,
    hello: String,
    limits: Limits,
}

impl Child {
    /// Starts it and reads its description.
    pub fn start(launch: &Launch, limits: &Limits) -> Result<Self, Fault> {
        let mut process = launch.start(limits).map_err(Fault::Ended)?;
        let (Some(input), Some(output), Some(errors)) =
            (process.stdin.take(), process.stdout.take(), process.stderr.take())
        else {
            return Err(Fault::Ended("its pipes cannot be made".into()));
        };
        let mut child = Self {
            process,
            input: Some(ready(input.into())?),
            output: ready(output.into())?,
            errors: Some(ready(errors.into())?),
            read: Vec::new(),
            said: LastWords::default(),
            wire: Wire::Frames,
            hello: String::new(),
            limits: *limits,
        };
        let mut wire = None;
        child.hello = child.exchange(&[], "its description", START, |read| {
            wire = wire.or_else(|| Wire::of(read));
            wire.map_or(Ok(None), |wire| wire.take_text(read))
        })?;
        child.wire = wire.unwrap_or(Wire::Frames);
        Ok(child)
    }

    fn request(&mut self, request: &Request, answer: &mut [f64]) -> Result<Reply, Fault> {
        // An answer too many would be taken for that of this call.
        if self.read() == Some(0) {
            return Err(self.gone(&request.name()));
        }
        if self.read.iter().any(|b| !b.is_ascii_whitespace()) {
            return Err(self.ended(&format!("wrote more than was asked for, before {}", request.name())));
        }
        self.read.clear();
        let (head, payload) = self.wire.ask(request);
        let wire = self.wire;
        let limit = self.limits.call;
        self.exchange(&[&head, payload], &request.name(), limit, |read| wire.take(read, request, answer))?
            .accepted()
    }

    /// Writes `parts` and reads until `take` has all of the answer, for at most `limit`.
    fn exchange<T>(
        &mut self,
        parts: &[&[u8]],
        what: &str,
        limit: Duration,
        mut take: impl FnMut(&mut Vec<u8>) -> Result<Option<T>, String>,
    ) -> Result<T, Fault> {
        let mut deadline = Instant::now() + limit;
        let mut deaf: Option<Instant> = None;
        let mut unsent: Vec<&[u8]> = parts.iter().rev().copied().filter(|part| !part.is_empty()).collect();
        loop {
            self.send(&mut unsent);
            match take(&mut self.read) {
                Ok(Some(answer)) if unsent.is_empty() => return Ok(answer),
                Ok(Some(_)) => {
                    return Err(self.ended(&format!("answered {what} before it had read all of it")));
                }
                Ok(None) => {}
                Err(why) => return Err(self.ended(&format!("broke the protocol in {what}: {why}"))),
            }
            if self.input.is_none() && !unsent.is_empty() {
                // An end that comes with it says more.
                deadline = deadline.min(*deaf.get_or_insert_with(|| Instant::now() + LAST));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let option = if limit == START { "" } else { " (--call-limit)" };
                let limit = limit.as_secs_f64();
                return Err(self.ended(&match self.input {
                    Some(_) => format!("did not answer {what} within {limit} s{option}"),
                    None => format!("closed its standard input and did not answer {what}"),
                }));
            }
            if !self.wait(left, !unsent.is_empty()) {
                return Err(self.gone(what));
            }
        }
    }

    /// Writes what the pipe takes.
    fn send(&mut self, unsent: &mut Vec<&[u8]>) {
        while let (Some(part), Some(pipe)) = (unsent.last_mut(), &self.input) {
            match rustix::io::write(pipe, part) {
                Ok(n) => {
                    *part = &part[n..];
                    if part.is_empty() {
                        unsent.pop();
                    }
                }
                Err(Errno::INTR) => {}
                Err(Errno::AGAIN) => return,
                // It does not read any more: it may still answer, or end.
                Err(_) => self.input = None,
            }
        }
    }

    /// Waits for something to read or write, and reads; `false` at the end of its
    /// output.
    fn wait(&mut self, left: Duration, unsent: bool) -> bool {
        let mut fds = vec![PollFd::new(&self.output, PollFlags::IN)];
        fds.extend(self.errors.as_ref().map(|pipe| PollFd::new(pipe, PollFlags::IN)));
        fds.extend(self.input.as_ref().filter(|_| unsent).map(|pipe| PollFd::new(pipe, PollFlags::OUT)));
        let left = Timespec { tv_sec: left.as_secs() as i64, tv_nsec: i64::from(left.subsec_nanos()) };
        let _ = poll(&mut fds, Some(&left));
        let readable = |fd: &PollFd| fd.revents().intersects(PollFlags::IN | PollFlags::HUP | PollFlags::ERR);
        let (output, errors) = (readable(&fds[0]), self.errors.is_some() && readable(&fds[1]));
        if errors {
            self.listen();
        }
        if !output {
            return true;
        }
        self.read() != Some(0)
    }

    /// Reads what there is of its output: how much, 0 at its end, `None` if nothing is
    /// there yet.
    fn read(&mut self) -> Option<usize> {
        self.read.reserve(PIPE);
        match rustix::io::read(&self.output, rustix::buffer::spare_capacity(&mut self.read)) {
            Ok(n) => Some(n),
            Err(Errno::INTR | Errno::AGAIN) => None,
            Err(_) => Some(0),
        }
    }

    /// Reads what there is on standard error.
    fn listen(&mut self) {
        let mut bytes = [0; 4096];
        // No more than the pipe holds: who writes without end must not keep gonio here.
        for _ in 0..PIPE / bytes.len() {
            let Some(pipe) = &self.errors else { return };
            match rustix::io::read(pipe, &mut bytes[..]) {
                Ok(0) => self.errors = None,
                Ok(n) => self.said.push(&bytes[..n]),
                Err(Errno::INTR) => {}
                Err(_) => return,
            }
        }
    }

    /// Ends it, since it did `what`.
    fn ended(&mut self, what: &str) -> Fault {
        self.listen();
        Fault::Ended(format!("it {what}{}", self.said.told()))
    }

    /// Says how it went after its output ended.
    fn gone(&mut self, what: &str) -> Fault {
        self.input = None;
        let deadline = Instant::now() + LAST;
        // The supervisor ends as it did, and its errors end with that.
        let status = loop {
            self.listen();
            match self.process.try_wait() {
                Ok(Some(status)) => break Some(status),
                Ok(None) if Instant::now() < deadline => std::thread::sleep(Duration::from_millis(2)),
                _ => break None,
            }
        };
        self.listen();
        if status.is_some_and(|s| s.code() == Some(ENDED))
            && let Some(why) = self.said.take_line(VOICE)
        {
            return Fault::Ended(format!("it was ended for {why} in {what}{}", self.said.told()));
        }
        let how = match status {
            Some(status) => manner(status),
            None => "closed its standard output and went on running".into(),
        };
        let memory = self.limits.mebibytes();
        let memory = match status.and_then(|s| s.signal()) {
            Some(_) => format!(" (its memory is limited to {memory} MiB: --memory)"),
            None => String::new(),
        };
        Fault::Ended(format!("it {how} in {what}{memory}{}", self.said.told()))
    }
}

/// How a process ended.
fn manner(status: ExitStatus) -> String {
    let name = match status.signal() {
        None => return format!("ended with exit code {}", status.code().unwrap_or(0)),
        Some(4) => "SIGILL, an illegal instruction",
        Some(6) => "SIGABRT, abort() or a failed assertion",
        Some(7) => "SIGBUS, a bad address",
        Some(8) => "SIGFPE, a division by zero of integers",
        Some(9) => "SIGKILL, perhaps for want of memory",
        Some(11) => "SIGSEGV, a bad address",
        Some(25) => "SIGXFSZ, a file too large",
        Some(31) => "SIGSYS, a call of the system that does not exist here",
        Some(signal) => return format!("was killed by signal {signal}"),
    };
    format!("crashed ({name})")
}

/// A pipe that does not block and holds a batch.
fn ready(pipe: OwnedFd) -> Result<File, Fault> {
    // What is not allowed more has the default.
    let _ = rustix::pipe::fcntl_setpipe_size(&pipe, PIPE);
    rustix::io::ioctl_fionbio(&pipe, true).map_err(|e| Fault::Ended(format!("its pipe is broken: {e}")))?;
    Ok(pipe.into())
}

impl Instance for Child {
    fn describe(&mut self) -> Result<String, Fault> {
        Ok(self.hello.clone())
    }

    fn create(&mut self, model: &str, parameters: &str) -> Result<Created, Fault> {
        let reply = self.request(&Request::Create(model, parameters), &mut [])?;
        reply.created().map_err(|why| self.ended(&format!("broke the protocol: {why}")))
    }

    fn call(&mut self, call: &Call, answer: &mut [f64]) -> Result<(), Fault> {
        self.request(&Request::Call(call), answer).map(drop)
    }

    fn destroy(&mut self, handle: u64) -> Result<(), Fault> {
        self.request(&Request::Destroy(handle), &mut []).map(drop)
    }
}

impl Drop for Child {
    /// Without readers of standard error the supervisor ends the plugin and all that
    /// it started, and then itself.
    fn drop(&mut self) {
        self.input = None;
        self.errors = None;
        // It is not killed: only it can end what the plugin has started, thousands of
        // processes perhaps, and it goes on with that when gonio has ended.
        let deadline = Instant::now() + PATIENCE;
        while matches!(self.process.try_wait(), Ok(None)) && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
