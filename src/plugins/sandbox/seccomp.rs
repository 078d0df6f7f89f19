//! The system calls of seccomp, for which there is no safe crate that tells of calls: a
//! filter with a listener, its notifications, and their answers. Nothing else is in here.
#![expect(unsafe_code, reason = "system calls on structures that outlive them, and only here")]

use libc::{c_int, seccomp_notif, seccomp_notif_resp, seccomp_notif_sizes, sock_filter, sock_fprog};
use std::io;
use std::os::fd::{AsRawFd, FromRawFd, OwnedFd};
use std::ptr::from_mut;

/// A call of the system that waits for an answer.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// What the answer is for.
    pub id: u64,
    /// The thread that calls, by its number out here.
    pub thread: u32,
    /// Which call.
    pub number: i64,
    /// With what.
    pub arguments: [u64; 6],
}

/// What a call gets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The kernel goes on with it, by its own rules.
    Continue,
    /// This error.
    Refuse(c_int),
}

/// Puts this thread and all that it will start under `filter`; calls that it tells of come
/// to the listener. This process must not be able to get new privileges.
pub fn install(filter: &[sock_filter]) -> io::Result<OwnedFd> {
    let mut sizes = seccomp_notif_sizes { seccomp_notif: 0, seccomp_notif_resp: 0, seccomp_data: 0 };
    // SAFETY: the kernel fills this structure.
    checked(unsafe {
        libc::syscall(libc::SYS_seccomp, libc::SECCOMP_GET_NOTIF_SIZES, 0, from_mut(&mut sizes))
    })?;
    let fits = usize::from(sizes.seccomp_notif) == size_of::<seccomp_notif>()
        && usize::from(sizes.seccomp_notif_resp) == size_of::<seccomp_notif_resp>();
    if !fits {
        return Err(io::Error::other("this kernel's notifications have another form"));
    }
    let len = filter.len().try_into().map_err(|_| io::Error::other("the filter is too long"))?;
    let program = sock_fprog { len, filter: filter.as_ptr().cast_mut() };
    let listening = |flags: libc::c_ulong| {
        // SAFETY: the kernel copies the program, which lives until then, and checks it.
        checked(unsafe {
            libc::syscall(libc::SYS_seccomp, libc::SECCOMP_SET_MODE_FILTER, flags, &raw const program)
        })
    };
    // Else a signal would repeat a call that is waiting; since Linux 5.19.
    let killable = libc::SECCOMP_FILTER_FLAG_WAIT_KILLABLE_RECV;
    let listener = listening(libc::SECCOMP_FILTER_FLAG_NEW_LISTENER | killable)
        .or_else(|_| listening(libc::SECCOMP_FILTER_FLAG_NEW_LISTENER))?;
    // SAFETY: the kernel has just opened it for this process.
    Ok(unsafe { OwnedFd::from_raw_fd(listener as c_int) })
}

/// The next call that waits.
pub fn next(listener: &OwnedFd) -> io::Result<Call> {
    // SAFETY: all of it is integers; the kernel wants it zeroed.
    let mut told: seccomp_notif = unsafe { std::mem::zeroed() };
    let fd = listener.as_raw_fd();
    // SAFETY: the kernel fills this structure, whose size `install` has compared.
    checked(i64::from(unsafe { libc::ioctl(fd, libc::SECCOMP_IOCTL_NOTIF_RECV, from_mut(&mut told)) }))?;
    Ok(Call { id: told.id, thread: told.pid, number: told.data.nr.into(), arguments: told.data.args })
}

/// Whether a call still waits: else its thread's number may be another's by now.
pub fn still_waits(listener: &OwnedFd, call: &Call) -> bool {
    let mut id = call.id;
    // SAFETY: the kernel reads this number.
    unsafe { libc::ioctl(listener.as_raw_fd(), libc::SECCOMP_IOCTL_NOTIF_ID_VALID, from_mut(&mut id)) == 0 }
}

/// Answers a call.
pub fn answer(listener: &OwnedFd, call: &Call, answer: Answer) -> io::Result<()> {
    let (error, flags) = match answer {
        Answer::Continue => (0, libc::SECCOMP_USER_NOTIF_FLAG_CONTINUE as u32),
        Answer::Refuse(error) => (-error, 0),
    };
    let mut response = seccomp_notif_resp { id: call.id, val: 0, error, flags };
    let fd = listener.as_raw_fd();
    // SAFETY: the kernel reads this structure, whose size `install` has compared.
    checked(i64::from(unsafe { libc::ioctl(fd, libc::SECCOMP_IOCTL_NOTIF_SEND, from_mut(&mut response)) }))?;
    Ok(())
}

/// Lets the programs that this process starts have none of the files that are open now,
/// but the standard ones.
pub fn keep_no_files() -> io::Result<()> {
    let (first, last, flag) = (3u32, u32::MAX, libc::CLOSE_RANGE_CLOEXEC);
    // SAFETY: it only marks files, those of Rust's owners too, as to be closed by exec.
    checked(unsafe { libc::syscall(libc::SYS_close_range, first, last, flag) })?;
    Ok(())
}

fn checked(result: i64) -> io::Result<i64> {
    if result < 0 { Err(io::Error::last_os_error()) } else { Ok(result) }
}
