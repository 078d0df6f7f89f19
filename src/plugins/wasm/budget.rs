//! How long a module may run: fuel, which is counted and therefore the same on all
//! machines, decides; a clock is behind it, for machines that are too slow.

use super::host::Host;
use super::trap;
use std::time::{Duration, Instant};
use wasmi::{
    Config, CustomFuelCosts, OperatorCost, Store, TypedFunc, TypedResumableCall, WasmParams, WasmResults,
};

/// Units of fuel (an instruction of wasm is one, about) for each second of the
/// limit, whatever is called.
const FUEL: f64 = 1e8;
/// The same for each row of a call.
const FUEL_OF_A_ROW: f64 = 1e4;
/// What any call may use, however short its limit.
const LEAST: u64 = 1_000_000;
/// How much is run between two looks at the clock: about a millisecond. It is also
/// the most that can be run in one go, see [`prices`].
const SLICE: u64 = 1 << 19;
/// Bytes that are copied or filled for a unit: the 4 GiB of a memory are half a slice.
const BYTES: u32 = 1 << 14;

/// What makes fuel the measure of everything.
///
/// Each `memory.grow` and `table.grow` takes 176 bytes of gonio's own stack until the
/// slice is over: all other instructions of wasmi end with a jump to the next, these
/// two with a call (wasmi 2.0, rustc 1.95). At the highest price a slice has 2056 of
/// them, and a stack of 2 MiB is safe.
pub fn prices(config: &mut Config) {
    let instructions = OperatorCost { memory_grow: u8::MAX, table_grow: u8::MAX, ..Default::default() };
    let bytes = CustomFuelCosts {
        bytes_copied_per_fuel: BYTES,
        // Nothing is compiled while it runs.
        fuel_per_bytes_translated: 0,
        fuel_per_bytes_validated: 0,
    };
    config.consume_fuel(true).operator_cost(instructions).fuel_cost(bytes);
}

/// Why a call did not return.
#[derive(Debug)]
pub enum Stopped {
    /// What the module did.
    Trap(String),
    /// It used all its fuel: so many units.
    Fuel(u64),
    /// It ran for too long.
    Clock,
    /// It cannot be interrupted for so many units: more than a slice.
    Stretch(u64),
}

/// Units of fuel for a call of `rows` rows.
pub fn fuel(limit: Duration, rows: usize) -> u64 {
    let units = (FUEL + FUEL_OF_A_ROW * rows as f64) * limit.as_secs_f64();
    (units as u64).max(LEAST)
}

/// Calls `function`, within the fuel of `rows` rows and within `limit`.
pub fn call<P: WasmParams, R: WasmResults>(
    store: &mut Store<Host>,
    function: &TypedFunc<P, R>,
    params: P,
    limit: Duration,
    rows: usize,
) -> Result<R, Stopped> {
    let whole = fuel(limit, rows);
    let begun = Instant::now();
    let mut given = SLICE.min(whole);
    let mut rest = whole - given;
    give(store, given)?;
    let mut state = function.call_resumable(&mut *store, params).map_err(trapped)?;
    loop {
        match state {
            TypedResumableCall::Finished(results) => return Ok(results),
            TypedResumableCall::HostTrap(trap) => return Err(trapped_by(trap.host_error())),
            TypedResumableCall::OutOfFuel(paused) => {
                rest += store.get_fuel().map_err(trapped)?;
                given = SLICE.min(rest);
                if paused.required_fuel() > SLICE {
                    return Err(Stopped::Stretch(paused.required_fuel()));
                }
                if paused.required_fuel() > given {
                    return Err(Stopped::Fuel(whole));
                }
                if begun.elapsed() > limit {
                    return Err(Stopped::Clock);
                }
                rest -= given;
                give(store, given)?;
                state = paused.resume(&mut *store).map_err(trapped)?;
            }
        }
    }
}

fn give(store: &mut Store<Host>, units: u64) -> Result<(), Stopped> {
    store.set_fuel(units).map_err(trapped)
}

fn trapped(error: wasmi::Error) -> Stopped {
    trapped_by(&error)
}

fn trapped_by(error: &wasmi::Error) -> Stopped {
    Stopped::Trap(trap::told(error))
}
