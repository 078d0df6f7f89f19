//! Whether this build of gonio can run modules at all.
//!
//! An instruction of wasmi ends with a call of the next one, which an optimising
//! compiler makes a jump. Where it does not (with debug assertions, say), each
//! instruction takes some of gonio's own stack, and a loop all of it: the process
//! ends. So it is measured, once, on a module that is known to end.

use super::budget;
use std::hint::black_box;
use std::sync::OnceLock;
use wasmi::{Caller, Config, Engine, Func, Instance, Module, Store};

/// The module of `probe.wat`: a hundred rounds of what plugins are made of, each of
/// which begins with a call of its import.
pub const MODULE: &[u8] = include_bytes!("probe.wasm");

/// Bytes by which the stack may differ from the first round to the last: less than
/// a call in each of them takes.
const LEVEL: usize = 1024;

/// Whether the stack stays where it is.
pub fn stays_level() -> bool {
    static STAYS: OnceLock<bool> = OnceLock::new();
    *STAYS.get_or_init(|| {
        let places = places().unwrap_or_default();
        match (places.first(), places.last()) {
            (Some(first), Some(last)) => first.abs_diff(*last) < LEVEL,
            _ => false,
        }
    })
}

/// Where the stack is, in each round.
pub fn places() -> Result<Vec<usize>, wasmi::Error> {
    let mut config = Config::default();
    budget::prices(&mut config);
    let engine = Engine::new(&config);
    let module = Module::new(&engine, MODULE)?;
    let mut store = Store::new(&engine, Vec::new());
    let here = Func::wrap(&mut store, |mut caller: Caller<'_, Vec<usize>>| {
        let local = 0_u8;
        caller.data_mut().push(std::ptr::from_ref(black_box(&local)).addr());
    });
    let instance = Instance::new(&mut store, &module, &[here.into()])?;
    store.set_fuel(1_000_000)?;
    instance.get_typed_func::<(), ()>(&store, "rounds")?.call(&mut store, ())?;
    Ok(store.into_data())
}
