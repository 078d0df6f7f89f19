//! What AssemblyScript imports by itself, and its `JSMath`.

use super::host::{Host, memory};
use super::math;
use wasmi::{Caller, Error, Func, FuncType, Store};

/// Bytes of a text that are read.
const MOST_TEXT: usize = 4096;

/// The function that AssemblyScript imports from `env` as `name`, of the type `ty`.
pub fn provide(store: &mut Store<Host>, name: &str, ty: &FuncType) -> Option<Func> {
    Some(match name {
        // C has another.
        "abort" if ty.params().is_empty() => {
            Func::wrap(store, || -> Result<(), Error> { Err(Error::new("called abort()")) })
        }
        "abort" => Func::wrap(store, abort),
        "trace" => Func::wrap(store, trace),
        "console.log" => Func::wrap(store, log),
        // Math.random() begins with it. It must not differ from run to run.
        "seed" => Func::wrap(store, || 0.5_f64),
        _ => return of_javascript(store, name.strip_prefix("Math.")?),
    })
}

/// Where JavaScript and C differ in more than the name.
fn of_javascript(store: &mut Store<Host>, name: &str) -> Option<Func> {
    match name {
        "abs" => math::provide(store, "fabs"),
        "max" => math::provide(store, "fmaximum"),
        "min" => math::provide(store, "fminimum"),
        "round" => Some(Func::wrap(store, |x: f64| libm::floor(x + 0.5))),
        "sign" => Some(Func::wrap(store, |x: f64| if x == 0.0 || x.is_nan() { x } else { x.signum() })),
        _ => math::provide(store, name),
    }
}

fn abort(caller: Caller<'_, Host>, message: i32, file: i32, line: i32, column: i32) -> Result<(), Error> {
    let (message, file) = (text(&caller, message), text(&caller, file));
    Err(Error::new(format!("called abort(\"{message}\") at {file}:{line}:{column}")))
}

#[expect(clippy::too_many_arguments, reason = "AssemblyScript's")]
fn trace(mut caller: Caller<'_, Host>, message: i32, n: i32, a: f64, b: f64, c: f64, d: f64, e: f64) {
    let mut line = text(&caller, message);
    for value in [a, b, c, d, e].iter().take(usize::try_from(n).unwrap_or(0)) {
        line += &format!(" {value}");
    }
    caller.data_mut().hear(format!("{line}\n").as_bytes());
}

fn log(mut caller: Caller<'_, Host>, message: i32) {
    let line = text(&caller, message) + "\n";
    caller.data_mut().hear(line.as_bytes());
}

/// A string of AssemblyScript: UTF-16, its bytes counted in front of it.
fn text(caller: &Caller<'_, Host>, address: i32) -> String {
    let read = || {
        let data = memory(caller)?.data(caller);
        let at = address as u32 as usize;
        let size = u32::from_le_bytes(*data.get(at.checked_sub(4)?..)?.first_chunk()?) as usize;
        let bytes = data.get(at..at.checked_add(size.min(MOST_TEXT))?)?;
        let units = bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
        Some(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
    };
    read().unwrap_or_default()
}
