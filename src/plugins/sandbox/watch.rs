//! Answers to the calls that a filter tells of, and what of them is an incident.
//!
//! What stands in memory, as paths do, can be changed after it was read: by that is told,
//! never decided. Calls that must not happen are refused by what stands in registers.

use super::calls::{About, Path as At, watched};
use super::incident::{Log, Phase};
use super::places::{absolute, may_read, may_write};
use super::rules::Rules;
use super::seccomp::{self, Answer, Call};
use super::taken::Where;
use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::net::SocketAddr;
use std::os::fd::{AsFd, BorrowedFd, OwnedFd};
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::{FileExt, MetadataExt};
use std::path::{Path, PathBuf};

/// Longest path of the kernel.
const PATH_MAX: usize = 4096;

/// Pages are at least this long, and what ends before the next can be read.
const PAGE: u64 = 4096;

/// Calls that are answered before something else is looked at.
const TURN: usize = 200;

/// Programs that hand over to another one: a script may begin with `#!/usr/bin/env`, or be
/// one of a shell.
const HANDING_OVER: &[&str] =
    &["/usr/bin/env", "/usr/bin/sh", "/usr/bin/dash", "/usr/bin/bash", "/bin/sh", "/bin/bash"];

/// What makes namespaces (linux/sched.h, CLONE_NEW…).
const NAMESPACES: u64 = (libc::CLONE_NEWNS
    | libc::CLONE_NEWCGROUP
    | libc::CLONE_NEWUTS
    | libc::CLONE_NEWIPC
    | libc::CLONE_NEWUSER
    | libc::CLONE_NEWPID
    | libc::CLONE_NEWNET) as u64;

/// The listener of a filter, and what it must know to answer.
pub struct Watch {
    listener: OwnedFd,
    calls: HashMap<i64, About>,
    /// The files of programs that may become another one: device and number.
    handing_over: Vec<(u64, u64)>,
}

impl Watch {
    /// For this listener.
    pub fn new(listener: OwnedFd, rules: &Rules) -> Self {
        let file = |path: &Path| path.metadata().ok().map(|m| (m.dev(), m.ino()));
        let mut handing_over: Vec<_> = HANDING_OVER.iter().filter_map(|path| file(Path::new(path))).collect();
        // gonio itself becomes the program; with a library in it, it stays.
        if !rules.library {
            handing_over.extend(file(Path::new("/proc/self/exe")));
        }
        Self { listener, calls: watched(rules.phase).collect(), handing_over }
    }

    /// What is to be waited for.
    pub fn file(&self) -> BorrowedFd<'_> {
        self.listener.as_fd()
    }

    /// Answers the calls that wait. What of them is too much, if something is.
    pub fn answer(&self, rules: &Rules, places: &Where, log: &mut Log) -> Option<String> {
        for _ in 0..TURN {
            use rustix::event::{PollFd, PollFlags, Timespec, poll};
            let mut waits = [PollFd::new(&self.listener, PollFlags::IN)];
            let now = Timespec { tv_sec: 0, tv_nsec: 0 };
            if !poll(&mut waits, Some(&now)).is_ok_and(|_| waits[0].revents().contains(PollFlags::IN)) {
                break;
            }
            // It may have been killed meanwhile.
            let Ok(call) = seccomp::next(&self.listener) else { continue };
            let caller = Caller { call, rules, listener: &self.listener };
            let about = self.calls.get(&call.number).copied().unwrap_or(About::Never("an unknown call"));
            let decision = self.decide(&caller, about, places);
            if let Some(what) = decision.incident {
                log.note(&what);
            }
            if let Some(why) = decision.too_much {
                return Some(why);
            }
            let _ = seccomp::answer(&self.listener, &call, decision.answer);
        }
        None
    }

    fn decide(&self, caller: &Caller, about: About, places: &Where) -> Decision {
        let arguments = caller.call.arguments;
        let run = caller.rules.phase == Phase::Run;
        match about {
            About::Open { path, flags } => caller.opens(path, arguments[flags]),
            About::OpenHow => {
                let flags = caller.number(arguments[2]).unwrap_or(0);
                caller.opens(At { folder: Some(0), text: 1 }, flags)
            }
            About::Look { path, .. } => {
                let path = caller.path(path).filter(|path| !caller.may_read(path));
                go_on(path.map(|path| format!("looked for {}", path.display())))
            }
            About::Write(path) => {
                let path = caller.path(path).filter(|path| !may_write(path, caller.rules));
                go_on(path.map(|path| format!("wrote {}", path.display())))
            }
            About::Fork if run => refuse(libc::EPERM, "started a process"),
            About::Clone if arguments[0] & NAMESPACES != 0 => refuse(libc::EPERM, "made a namespace"),
            About::Clone if run && arguments[0] & libc::CLONE_THREAD as u64 == 0 => {
                refuse(libc::EPERM, "started a process")
            }
            About::Fork | About::Clone => {
                let thread = about == About::Clone && arguments[0] & libc::CLONE_THREAD as u64 != 0;
                let mut then = places.taken();
                then.processes += u64::from(!thread);
                then.threads += 1;
                Decision { too_much: then.crowded(caller.rules), ..go_on(None) }
            }
            About::CloneBehind => {
                let flags = caller.number(arguments[0]).unwrap_or(0);
                if run && flags & libc::CLONE_THREAD as u64 == 0 {
                    return refuse(libc::EPERM, "started a process");
                }
                // Everyone then takes the older call, whose flags cannot change.
                Decision { answer: Answer::Refuse(libc::ENOSYS), ..go_on(None) }
            }
            About::Exec(path) => {
                if !run || self.hands_over(caller) {
                    return go_on(None);
                }
                let path = caller.path(path).unwrap_or_else(|| "a program".into());
                refuse(libc::EPERM, format!("started {}", path.display()))
            }
            // Libraries ask local services for names of users; here are none.
            About::Socket if arguments[0] as i32 == libc::AF_UNIX => go_on(None),
            About::Socket => {
                let family = match arguments[0] as i32 {
                    libc::AF_INET => "IPv4",
                    libc::AF_INET6 => "IPv6",
                    libc::AF_NETLINK => "netlink",
                    libc::AF_PACKET => "packet",
                    _ => "of some family",
                };
                refuse(libc::EPERM, format!("opened a socket ({family})"))
            }
            About::Connect => {
                let to = caller.address(arguments[1], arguments[2]).filter(|to| !to.contains("nscd"));
                go_on(to.map(|to| format!("connected to {to}")))
            }
            About::Signal(words) => {
                let (to, signal) = (arguments[0] as i32, arguments[words] as i32);
                if signal == 0 || caller.own().is_some_and(|own| own.contains(&(to as u32))) {
                    return go_on(None);
                }
                refuse(libc::EPERM, format!("sent signal {signal} to process {to}"))
            }
            About::Never(name) => refuse(libc::EPERM, format!("called {name}()")),
            About::Missing => Decision { answer: Answer::Refuse(libc::ENOSYS), ..go_on(None) },
        }
    }

    /// Whether the caller is a program that only starts another.
    fn hands_over(&self, caller: &Caller) -> bool {
        let exe = caller.proc("exe").metadata();
        exe.is_ok_and(|m| self.handing_over.contains(&(m.dev(), m.ino())))
    }
}

/// What becomes of a call.
struct Decision {
    answer: Answer,
    incident: Option<String>,
    too_much: Option<String>,
}

fn go_on(incident: Option<String>) -> Decision {
    Decision { answer: Answer::Continue, incident, too_much: None }
}

fn refuse(error: i32, incident: impl Into<String>) -> Decision {
    Decision { answer: Answer::Refuse(error), incident: Some(incident.into()), too_much: None }
}

/// A call and who calls.
struct Caller<'a> {
    call: Call,
    rules: &'a Rules,
    listener: &'a OwnedFd,
}

impl Caller<'_> {
    fn opens(&self, path: At, flags: u64) -> Decision {
        let Some(path) = self.path(path) else { return go_on(None) };
        let writes = libc::O_WRONLY | libc::O_RDWR | libc::O_CREAT | libc::O_TRUNC;
        let incident = if flags as i32 & writes != 0 && !may_write(&path, self.rules) {
            Some(format!("wrote {}", path.display()))
        } else if !self.may_read(&path) {
            Some(format!("opened {}", path.display()))
        } else {
            None
        };
        go_on(incident)
    }

    fn may_read(&self, path: &Path) -> bool {
        let own = if path.starts_with("/proc") { self.own() } else { None };
        may_read(path, self.rules, own.map(|[process, _]| process))
    }

    /// A path of the call, from the root of the sandbox.
    fn path(&self, at: At) -> Option<PathBuf> {
        let arguments = self.call.arguments;
        let text = self.bytes(arguments[at.text])?;
        let path = PathBuf::from(std::ffi::OsString::from_vec(text));
        if path.as_os_str().is_empty() {
            return None;
        }
        if path.is_absolute() {
            return Some(absolute(Path::new("/"), &path));
        }
        let folder = match at.folder.map(|k| arguments[k] as i32) {
            None | Some(libc::AT_FDCWD) => self.proc("cwd"),
            Some(open) => self.proc(&format!("fd/{open}")),
        };
        Some(absolute(&std::fs::read_link(folder).ok()?, &path))
    }

    fn proc(&self, name: &str) -> PathBuf {
        format!("/proc/{}/{name}", self.call.thread).into()
    }

    /// The process and the thread, by their numbers in the sandbox.
    fn own(&self) -> Option<[u32; 2]> {
        let status = std::fs::read_to_string(self.proc("status")).ok()?;
        let last = |key: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(key))?;
            line.split_ascii_whitespace().last()?.parse().ok()
        };
        Some([last("NStgid:")?, last("NSpid:")?])
    }

    /// The address of a socket (struct sockaddr_…) in the caller's memory.
    fn address(&self, at: u64, length: u64) -> Option<String> {
        let mut all = [0; 110];
        let all = &mut all[..(length as usize).min(110)];
        self.memory().ok()?.read_exact_at(all, at).ok()?;
        let family = u16::from_ne_bytes(all.get(..2)?.try_into().ok()?);
        let port = || Some(u16::from_be_bytes(all.get(2..4)?.try_into().ok()?));
        match i32::from(family) {
            libc::AF_UNIX => {
                // An abstract name begins with a zero.
                let name = all[2..].split(|byte| *byte == 0).find(|part| !part.is_empty())?;
                Some(String::from_utf8_lossy(name).into_owned())
            }
            libc::AF_INET => {
                let ip = <[u8; 4]>::try_from(all.get(4..8)?).ok()?;
                Some(SocketAddr::from((ip, port()?)).to_string())
            }
            libc::AF_INET6 => {
                let ip = <[u8; 16]>::try_from(all.get(8..24)?).ok()?;
                Some(SocketAddr::from((ip, port()?)).to_string())
            }
            _ => None,
        }
    }

    /// A string in the caller's memory.
    fn bytes(&self, mut address: u64) -> Option<Vec<u8>> {
        let memory = self.memory().ok()?;
        let mut all = Vec::new();
        while all.len() < PATH_MAX {
            let mut page = [0; PAGE as usize];
            let here = &mut page[..(PAGE - address % PAGE) as usize];
            let read = memory.read_at(here, address).ok().filter(|n| *n > 0)?;
            match here[..read].iter().position(|byte| *byte == 0) {
                Some(end) => {
                    all.extend_from_slice(&here[..end]);
                    return seccomp::still_waits(self.listener, &self.call).then_some(all);
                }
                None => all.extend_from_slice(&here[..read]),
            }
            address = address.checked_add(read as u64)?;
        }
        None
    }

    /// A number of 64 bits in the caller's memory.
    fn number(&self, address: u64) -> Option<u64> {
        let mut bytes = [0; 8];
        self.memory().ok()?.read_exact_at(&mut bytes, address).ok()?;
        Some(u64::from_ne_bytes(bytes))
    }

    fn memory(&self) -> io::Result<File> {
        File::open(self.proc("mem"))
    }
}
