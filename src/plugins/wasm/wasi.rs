//! WASI preview 1, as far as programs want it that compute: they may say something
//! and end; there are no files, clocks, random numbers and arguments.

use super::host::{Host, memory};
use wasmi::{Caller, Error, Func, FuncType, Store, Val, ValType};

/// The module from which programs import it.
pub const MODULE: &str = "wasi_snapshot_preview1";

/// The names of all functions.
pub const NAMES: &[&str] = &[
    "args_get",
    "args_sizes_get",
    "clock_res_get",
    "clock_time_get",
    "environ_get",
    "environ_sizes_get",
    "fd_advise",
    "fd_allocate",
    "fd_close",
    "fd_datasync",
    "fd_fdstat_get",
    "fd_fdstat_set_flags",
    "fd_fdstat_set_rights",
    "fd_filestat_get",
    "fd_filestat_set_size",
    "fd_filestat_set_times",
    "fd_pread",
    "fd_prestat_dir_name",
    "fd_prestat_get",
    "fd_pwrite",
    "fd_read",
    "fd_readdir",
    "fd_renumber",
    "fd_seek",
    "fd_sync",
    "fd_tell",
    "fd_write",
    "path_create_directory",
    "path_filestat_get",
    "path_filestat_set_times",
    "path_link",
    "path_open",
    "path_readlink",
    "path_remove_directory",
    "path_rename",
    "path_symlink",
    "path_unlink_file",
    "poll_oneoff",
    "proc_exit",
    "proc_raise",
    "random_get",
    "sched_yield",
    "sock_accept",
    "sock_recv",
    "sock_send",
    "sock_shutdown",
];

// Numbers of errors.
const SUCCESS: i32 = 0;
const BADF: i32 = 8;
const FAULT: i32 = 21;
const NOSYS: i32 = 52;

/// How many pieces of a text are written at once; callers write the rest again.
const MOST_PIECES: usize = 16;

/// The function `name`, of the type `ty` where it does nothing.
pub fn provide(store: &mut Store<Host>, name: &str, ty: &FuncType) -> Option<Func> {
    if !NAMES.contains(&name) {
        return None;
    }
    Some(match name {
        "fd_write" => Func::wrap(store, fd_write),
        "proc_exit" => Func::wrap(store, |code: i32| -> Result<(), Error> { Err(Error::i32_exit(code)) }),
        // None of them. C libraries end the program if they cannot be told so.
        "args_sizes_get" | "environ_sizes_get" => Func::wrap(store, sizes_get),
        // No such folder: here C libraries stop looking for more.
        "fd_prestat_get" => refuse(store, ty, BADF),
        _ => refuse(store, ty, NOSYS),
    })
}

fn refuse(store: &mut Store<Host>, ty: &FuncType, error: i32) -> Func {
    Func::new(store, ty.clone(), move |_, _, results| {
        for result in results {
            *result =
                if result.ty() == ValType::I32 { Val::I32(error) } else { Val::default_for_ty(result.ty()) };
        }
        Ok(())
    })
}

fn sizes_get(mut caller: Caller<'_, Host>, count: i32, size: i32) -> i32 {
    let Some(memory) = memory(&caller) else { return FAULT };
    for address in [count, size] {
        if memory.write(&mut caller, address as u32 as usize, &[0; 4]).is_err() {
            return FAULT;
        }
    }
    SUCCESS
}

fn fd_write(mut caller: Caller<'_, Host>, fd: i32, pieces: i32, count: i32, written: i32) -> i32 {
    if !(1..=2).contains(&fd) {
        return BADF;
    }
    let Some(memory) = memory(&caller) else { return FAULT };
    let count = (count as u32 as usize).min(MOST_PIECES);
    let (data, host) = memory.data_and_store_mut(&mut caller);
    let Some(list) = data.get(pieces as u32 as usize..).and_then(|rest| rest.get(..8 * count)) else {
        return FAULT;
    };
    let mut total = 0_u32;
    for piece in list.chunks_exact(8) {
        let (start, size) = (word(&piece[..4]), word(&piece[4..]));
        let Some(text) = data.get(start as usize..).and_then(|rest| rest.get(..size as usize)) else {
            return FAULT;
        };
        host.hear(text);
        total = total.saturating_add(size);
    }
    match memory.write(&mut caller, written as u32 as usize, &total.to_le_bytes()) {
        Ok(()) => SUCCESS,
        Err(_) => FAULT,
    }
}

fn word(bytes: &[u8]) -> u32 {
    bytes.first_chunk().map_or(0, |four| u32::from_le_bytes(*four))
}
