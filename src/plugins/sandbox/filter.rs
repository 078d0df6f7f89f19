//! The filter of system calls, a program for the kernel.

use super::calls::{About, watched};
use super::incident::Phase;
use libc::{BPF_ABS, BPF_JEQ, BPF_JGE, BPF_JMP, BPF_JSET, BPF_K, BPF_LD, BPF_RET, BPF_W, sock_filter};
use libc::{SECCOMP_RET_ALLOW, SECCOMP_RET_ERRNO, SECCOMP_RET_KILL_PROCESS, SECCOMP_RET_USER_NOTIF};

/// AUDIT_ARCH_… of linux/audit.h.
const ARCHITECTURE: Option<u32> = if cfg!(target_arch = "x86_64") {
    Some(0xc000_003e)
} else if cfg!(target_arch = "aarch64") {
    Some(0xc000_00b7)
} else {
    None
};

/// Numbers of calls from here on are x32's, the same calls with other numbers.
const X32: u32 = 0x4000_0000;

/// Where `struct seccomp_data` has the number, the architecture and the arguments.
const NUMBER: u32 = 0;
const WHERE: u32 = 4;
const ARGUMENTS: u32 = 16;

/// The filter of a phase.
///
/// # Errors
/// On architectures whose numbers it does not know.
pub fn filter(phase: Phase) -> Result<Vec<sock_filter>, String> {
    let Some(architecture) = ARCHITECTURE else {
        return Err(format!("the system calls of {} are not known", std::env::consts::ARCH));
    };
    let mut all = vec![
        load(WHERE),
        skip_if(BPF_JEQ, architecture, 1, 0),
        end(SECCOMP_RET_KILL_PROCESS),
        load(NUMBER),
        skip_if(BPF_JGE, X32, 0, 1),
        end(SECCOMP_RET_KILL_PROCESS),
    ];
    for (number, about) in watched(phase) {
        let block = match about {
            About::Missing => vec![end(SECCOMP_RET_ERRNO | libc::ENOSYS as u32)],
            // What an open file is: frequent, and about no path.
            About::Look { flags: Some(flags), .. } => vec![
                load(ARGUMENTS + 8 * flags as u32),
                skip_if(BPF_JSET, libc::AT_EMPTY_PATH as u32, 0, 1),
                end(SECCOMP_RET_ALLOW),
                end(SECCOMP_RET_USER_NOTIF),
            ],
            _ => vec![end(SECCOMP_RET_USER_NOTIF)],
        };
        all.push(skip_if(BPF_JEQ, number as u32, 0, block.len() as u8));
        all.extend(block);
    }
    all.push(end(SECCOMP_RET_ALLOW));
    Ok(all)
}

/// Loads a word of what is known of the call: of an argument, its low half.
fn load(offset: u32) -> sock_filter {
    sock_filter { code: (BPF_LD | BPF_W | BPF_ABS) as u16, jt: 0, jf: 0, k: offset }
}

/// Skips so many instructions where the comparison holds, and where not.
fn skip_if(comparison: u32, k: u32, holds: u8, not: u8) -> sock_filter {
    sock_filter { code: (BPF_JMP | comparison | BPF_K) as u16, jt: holds, jf: not, k }
}

fn end(action: u32) -> sock_filter {
    sock_filter { code: (BPF_RET | BPF_K) as u16, jt: 0, jf: 0, k: action }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the kernel would do.
    fn run(filter: &[sock_filter], words: &[(u32, u32)]) -> u32 {
        let (mut at, mut a) = (0, 0);
        loop {
            let step = filter[at];
            let code = u32::from(step.code);
            at += 1;
            if code == BPF_RET | BPF_K {
                return step.k;
            } else if code == BPF_LD | BPF_W | BPF_ABS {
                a = words.iter().find(|(offset, _)| *offset == step.k).map_or(0, |(_, value)| *value);
            } else {
                let holds = match code & !(BPF_JMP | BPF_K) {
                    BPF_JEQ => a == step.k,
                    BPF_JGE => a >= step.k,
                    BPF_JSET => a & step.k != 0,
                    other => panic!("{other}"),
                };
                at += usize::from(if holds { step.jt } else { step.jf });
            }
        }
    }

    #[test]
    fn calls_are_told_apart() {
        let architecture = ARCHITECTURE.unwrap();
        for phase in [Phase::Build, Phase::Run] {
            let filter = filter(phase).unwrap();
            let with = |number: i64, arguments: &[(u32, u32)]| {
                let mut words = vec![(WHERE, architecture), (NUMBER, number as u32)];
                words.extend(arguments.iter().map(|(k, value)| (ARGUMENTS + 8 * k, *value)));
                run(&filter, &words)
            };
            assert_eq!(with(libc::SYS_read, &[]), SECCOMP_RET_ALLOW);
            assert_eq!(with(libc::SYS_openat, &[]), SECCOMP_RET_USER_NOTIF);
            assert_eq!(with(libc::SYS_ptrace, &[]), SECCOMP_RET_USER_NOTIF);
            assert_eq!(with(libc::SYS_newfstatat, &[]), SECCOMP_RET_USER_NOTIF);
            assert_eq!(with(libc::SYS_newfstatat, &[(3, 0x1100)]), SECCOMP_RET_ALLOW);
            assert_eq!(with(libc::SYS_statx, &[(2, 0x1000)]), SECCOMP_RET_ALLOW);
            assert_eq!(with(libc::SYS_memfd_create, &[]), SECCOMP_RET_ERRNO | libc::ENOSYS as u32);
            let signals = if phase == Phase::Run { SECCOMP_RET_USER_NOTIF } else { SECCOMP_RET_ALLOW };
            assert_eq!(with(libc::SYS_kill, &[]), signals);
            assert_eq!(with(libc::SYS_read | i64::from(X32), &[]), SECCOMP_RET_KILL_PROCESS);
            // The door of 32-bit programs.
            assert_eq!(run(&filter, &[(WHERE, 0x4000_0003), (NUMBER, 0)]), SECCOMP_RET_KILL_PROCESS);
        }
    }
}
