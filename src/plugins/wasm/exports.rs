//! What a module exports: the functions of gonio.h, and its memory.

use super::host::Host;
use super::problem::{Problem, signature};
use super::sections::START;
use wasmi::{ExternType, FuncType, Instance, Memory, Module, Store, TypedFunc, ValType};

/// handle, mode, wo, rows, wi, values → 0 if it went well.
pub type Evaluate = TypedFunc<(i32, i32, i32, i32, i32, i32), i32>;
/// handle, mode, wo, rows, u, wi, weight, pdf, flags → 0 if it went well.
pub type Sample = TypedFunc<(i32, i32, i32, i32, i32, i32, i32, i32, i32), i32>;

/// The exports of a running module.
pub struct Exports {
    pub memory: Memory,
    pub describe: TypedFunc<i32, i32>,
    pub create: TypedFunc<(i32, i32), i32>,
    pub eval: Evaluate,
    pub pdf: Option<Evaluate>,
    pub sample: Option<Sample>,
    pub destroy: TypedFunc<i32, ()>,
    pub error: TypedFunc<(), i32>,
    pub alloc: TypedFunc<i32, i32>,
    pub free: TypedFunc<(i32, i32), ()>,
    /// What must be called first: the start function, then `_initialize`.
    pub first: [Option<TypedFunc<(), ()>>; 2],
}

/// The function `_initialize` of a WASI reactor.
pub const INITIALIZE: &str = "_initialize";

/// A function that is called: how many i32 it takes and gives, and whether it
/// must be there.
struct Called(&'static str, usize, usize, bool);

const CALLED: [Called; 11] = [
    Called("gonio_describe", 1, 1, true),
    Called("gonio_create", 2, 1, true),
    Called("gonio_eval", 6, 1, true),
    Called("gonio_pdf", 6, 1, false),
    Called("gonio_sample", 9, 1, false),
    Called("gonio_destroy", 1, 0, true),
    Called("gonio_error", 0, 1, true),
    Called("gonio_alloc", 1, 1, true),
    Called("gonio_free", 2, 0, true),
    Called(START, 0, 0, false),
    Called(INITIALIZE, 0, 0, false),
];

/// Whether `module` exports what it must, with the right types, and begins with no
/// more than `memory` bytes.
pub fn check(module: &Module, memory: u64) -> Result<(), Problem> {
    let mut missing = Vec::new();
    for Called(name, takes, gives, must) in CALLED {
        let expected = FuncType::new(vec![ValType::I32; takes], vec![ValType::I32; gives]);
        match module.get_export(name) {
            None if must => missing.push(name.to_owned()),
            None => (),
            Some(ExternType::Func(ty)) if ty == expected => (),
            Some(other) => {
                return Err(Problem::WrongExport {
                    name: name.to_owned(),
                    found: kind(&other),
                    expected: signature(&expected),
                });
            }
        }
    }
    match module.get_export("memory") {
        Some(ExternType::Memory(ty)) => {
            // A page is 64 KiB, so a MiB is 16 pages.
            let (wants, most) = (ty.minimum().div_ceil(16), memory >> 20);
            if ty.minimum() << 16 > memory {
                return Err(Problem::Memory { wants, most });
            }
        }
        Some(other) => {
            return Err(Problem::WrongExport {
                name: "memory".to_owned(),
                found: kind(&other),
                expected: "a memory".to_owned(),
            });
        }
        None => missing.push("memory".to_owned()),
    }
    if missing.is_empty() { Ok(()) } else { Err(Problem::Missing(missing)) }
}

fn kind(ty: &ExternType) -> String {
    match ty {
        ExternType::Func(ty) => signature(ty),
        ExternType::Memory(_) => "a memory".to_owned(),
        ExternType::Table(_) => "a table".to_owned(),
        ExternType::Global(_) => "a global variable".to_owned(),
    }
}

impl Exports {
    /// Those of `instance`, whose module was checked.
    pub fn of(instance: &Instance, store: &Store<Host>) -> Result<Self, wasmi::Error> {
        let memory = instance
            .get_memory(store, "memory")
            .ok_or_else(|| wasmi::Error::new("there is no export `memory`"))?;
        Ok(Self {
            memory,
            describe: instance.get_typed_func(store, "gonio_describe")?,
            create: instance.get_typed_func(store, "gonio_create")?,
            eval: instance.get_typed_func(store, "gonio_eval")?,
            pdf: instance.get_typed_func(store, "gonio_pdf").ok(),
            sample: instance.get_typed_func(store, "gonio_sample").ok(),
            destroy: instance.get_typed_func(store, "gonio_destroy")?,
            error: instance.get_typed_func(store, "gonio_error")?,
            alloc: instance.get_typed_func(store, "gonio_alloc")?,
            free: instance.get_typed_func(store, "gonio_free")?,
            first: [START, INITIALIZE].map(|name| instance.get_typed_func(store, name).ok()),
        })
    }
}
