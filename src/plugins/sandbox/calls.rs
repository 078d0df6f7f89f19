//! The calls of the system that are watched, and what each is about.

use super::incident::Phase;
use libc::c_long;

/// What a call is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// open(path, flags): which arguments these are.
    Open { path: Path, flags: usize },
    /// openat2(folder, path, how).
    OpenHow,
    /// Something is asked of a path, or of what an open file is if these flags say so.
    Look { path: Path, flags: Option<usize> },
    /// A path is made, changed or removed.
    Write(Path),
    /// A process, without a word.
    Fork,
    /// A process or thread, by these flags.
    Clone,
    /// The same, with the flags in memory.
    CloneBehind,
    /// Another program, by the path at this argument.
    Exec(Path),
    /// A socket of this family.
    Socket,
    /// Away through a socket.
    Connect,
    /// A signal to the process of the first argument.
    Signal(usize),
    /// What no program in a sandbox has to do.
    Never(&'static str),
    /// What would be memory that nobody counts; programs do without.
    Missing,
}

/// Where a call has a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path {
    /// The argument that is the open folder it starts from; that of the process if `None`.
    pub folder: Option<usize>,
    /// The argument that is its text.
    pub text: usize,
}

/// From the folder of the process.
const fn here(text: usize) -> Path {
    Path { folder: None, text }
}

/// From the folder of the argument before it.
const fn at(text: usize) -> Path {
    Path { folder: Some(text - 1), text }
}

const fn look(path: Path) -> About {
    About::Look { path, flags: None }
}

/// What all architectures have.
const ALL: &[(c_long, About)] = &[
    (libc::SYS_openat, About::Open { path: at(1), flags: 2 }),
    (libc::SYS_openat2, About::OpenHow),
    (libc::SYS_newfstatat, About::Look { path: at(1), flags: Some(3) }),
    (libc::SYS_statx, About::Look { path: at(1), flags: Some(2) }),
    (libc::SYS_faccessat, look(at(1))),
    (libc::SYS_faccessat2, look(at(1))),
    (libc::SYS_mkdirat, About::Write(at(1))),
    (libc::SYS_mknodat, About::Write(at(1))),
    (libc::SYS_unlinkat, About::Write(at(1))),
    (libc::SYS_renameat, About::Write(at(3))),
    (libc::SYS_renameat2, About::Write(at(3))),
    (libc::SYS_linkat, About::Write(at(3))),
    (libc::SYS_symlinkat, About::Write(at(2))),
    (libc::SYS_fchmodat, About::Write(at(1))),
    (libc::SYS_truncate, About::Write(here(0))),
    (libc::SYS_clone, About::Clone),
    (libc::SYS_clone3, About::CloneBehind),
    (libc::SYS_execve, About::Exec(here(0))),
    (libc::SYS_execveat, About::Exec(at(1))),
    (libc::SYS_socket, About::Socket),
    (libc::SYS_connect, About::Connect),
    (libc::SYS_ptrace, About::Never("ptrace")),
    (libc::SYS_process_vm_readv, About::Never("process_vm_readv")),
    (libc::SYS_process_vm_writev, About::Never("process_vm_writev")),
    (libc::SYS_pidfd_getfd, About::Never("pidfd_getfd")),
    // A filter of its own could answer in place of this one.
    (libc::SYS_seccomp, About::Never("seccomp")),
    (libc::SYS_mount, About::Never("mount")),
    (libc::SYS_umount2, About::Never("umount")),
    (libc::SYS_pivot_root, About::Never("pivot_root")),
    (libc::SYS_chroot, About::Never("chroot")),
    (libc::SYS_open_tree, About::Never("open_tree")),
    (libc::SYS_move_mount, About::Never("move_mount")),
    (libc::SYS_fsopen, About::Never("fsopen")),
    (libc::SYS_unshare, About::Never("unshare")),
    (libc::SYS_setns, About::Never("setns")),
    (libc::SYS_bpf, About::Never("bpf")),
    (libc::SYS_keyctl, About::Never("keyctl")),
    (libc::SYS_add_key, About::Never("add_key")),
    (libc::SYS_request_key, About::Never("request_key")),
    (libc::SYS_io_uring_setup, About::Never("io_uring_setup")),
    (libc::SYS_perf_event_open, About::Never("perf_event_open")),
    (libc::SYS_userfaultfd, About::Never("userfaultfd")),
    (libc::SYS_open_by_handle_at, About::Never("open_by_handle_at")),
    (libc::SYS_init_module, About::Never("init_module")),
    (libc::SYS_finit_module, About::Never("finit_module")),
    (libc::SYS_kexec_load, About::Never("kexec_load")),
    (libc::SYS_reboot, About::Never("reboot")),
    (libc::SYS_memfd_create, About::Missing),
    (libc::SYS_shmget, About::Missing),
];

/// What x86-64 has of old.
#[cfg(target_arch = "x86_64")]
const OLD: &[(c_long, About)] = &[
    (libc::SYS_open, About::Open { path: here(0), flags: 1 }),
    (libc::SYS_creat, About::Write(here(0))),
    (libc::SYS_stat, look(here(0))),
    (libc::SYS_lstat, look(here(0))),
    (libc::SYS_access, look(here(0))),
    (libc::SYS_mkdir, About::Write(here(0))),
    (libc::SYS_mknod, About::Write(here(0))),
    (libc::SYS_rmdir, About::Write(here(0))),
    (libc::SYS_unlink, About::Write(here(0))),
    (libc::SYS_rename, About::Write(here(1))),
    (libc::SYS_link, About::Write(here(1))),
    (libc::SYS_symlink, About::Write(here(1))),
    (libc::SYS_chmod, About::Write(here(0))),
    (libc::SYS_fork, About::Fork),
    (libc::SYS_vfork, About::Fork),
];

#[cfg(not(target_arch = "x86_64"))]
const OLD: &[(c_long, About)] = &[];

/// Signals: what is built may end its own processes, what runs has none.
const RUN: &[(c_long, About)] = &[
    (libc::SYS_kill, About::Signal(1)),
    (libc::SYS_tkill, About::Signal(1)),
    (libc::SYS_tgkill, About::Signal(2)),
    (libc::SYS_rt_sigqueueinfo, About::Signal(1)),
    (libc::SYS_rt_tgsigqueueinfo, About::Signal(2)),
];

/// The calls that are watched.
pub fn watched(phase: Phase) -> impl Iterator<Item = (c_long, About)> {
    let more = if phase == Phase::Run { RUN } else { &[] };
    ALL.iter().chain(OLD).chain(more).copied()
}
