//! An instance of a module: the calls of the contract, made of calls of its exports.

use super::budget::{self, Stopped};
use super::doing::Doing;
use super::exports::Exports;
use super::host::Host;
use crate::bsdf::Transport;
use crate::plugins::Limits;
use crate::plugins::instance::{Call, Created, Fault, Function, Instance};
use wasmi::{Store, TypedFunc, WasmParams, WasmResults};

/// Bytes that a text of a module may have.
const MOST_TEXT: usize = 1 << 20;
/// Bytes of a number.
const NUMBER: usize = 8;

/// An instance of a module.
pub struct Running {
    store: Store<Host>,
    exports: Exports,
    limits: Limits,
    /// What the module allocated for arguments and answers.
    buffer: Buffer,
    /// Why it can be called no more.
    ended: Option<String>,
}

#[derive(Clone, Copy, Default)]
struct Buffer {
    address: u32,
    size: u32,
}

impl Running {
    /// The instance whose exports are `exports`, after its start function.
    pub fn new(store: Store<Host>, exports: Exports, limits: Limits) -> Result<Self, Fault> {
        let mut running = Self { store, exports, limits, buffer: Buffer::default(), ended: None };
        for function in running.exports.first.into_iter().flatten() {
            running.run(&function, (), Doing::Starting)?;
        }
        Ok(running)
    }

    /// Calls one of its exports.
    fn run<P: WasmParams, R: WasmResults>(
        &mut self,
        function: &TypedFunc<P, R>,
        params: P,
        doing: Doing<'_>,
    ) -> Result<R, Fault> {
        if let Some(why) = &self.ended {
            return Err(Fault::Ended(format!("the module has ended before: {why}")));
        }
        self.store.data_mut().refused = false;
        budget::call(&mut self.store, function, params, self.limits.call, doing.rows()).map_err(|stopped| {
            let did = match stopped {
                Stopped::Trap(did) => format!("{did} in {doing}"),
                Stopped::Fuel(units) => format!(
                    "looped without end: used {units} units of fuel in {doing} (raise --call-limit if it \
                     only needs longer)"
                ),
                Stopped::Stretch(units) => format!(
                    "has a stretch without a branch in {doing}, which uses {units} units of fuel and cannot be \
                     interrupted; write it as a loop"
                ),
                Stopped::Clock => format!(
                    "took longer than {} s in {doing} (raise --call-limit if it only needs longer)",
                    self.limits.call.as_secs_f64()
                ),
            };
            match self.store.data().refused {
                true => self.end(format!("{} of memory, and then {did}", self.wanted())),
                false => self.end(did),
            }
        })
    }

    fn wanted(&self) -> String {
        format!("wanted more than {} MiB", self.limits.mebibytes())
    }

    /// It `did` what ends it.
    fn end(&mut self, did: String) -> Fault {
        let why = plain(&format!("the module {did}{}", self.store.data().said()));
        self.ended = Some(why.clone());
        Fault::Ended(why)
    }

    /// Memory of the module for `size` bytes, the same as before while that is enough.
    fn room(&mut self, size: usize) -> Result<u32, Fault> {
        let Ok(size) = u32::try_from(size) else {
            return Err(Fault::Refused(format!("{size} bytes are more than the memory of a module can be")));
        };
        if size <= self.buffer.size {
            return Ok(self.buffer.address);
        }
        let old = std::mem::take(&mut self.buffer);
        if old.size > 0 {
            let free = self.exports.free;
            self.run(&free, (old.address as i32, old.size as i32), Doing::Free)?;
        }
        let (alloc, doing) = (self.exports.alloc, Doing::Alloc(size));
        let address = self.run(&alloc, size as i32, doing)? as u32;
        let has = self.exports.memory.data(&self.store).len() as u64;
        if address == 0 {
            return Err(Fault::Refused(match self.store.data().refused {
                true => format!("the module {} of memory in {doing}", self.wanted()),
                false => format!("{doing} returned 0: the module found no memory in its {has} bytes"),
            }));
        }
        if u64::from(address) + u64::from(size) > has {
            return Err(self.end(format!("returned address {address} in {doing}: its memory ends at {has}")));
        }
        if !address.is_multiple_of(NUMBER as u32) {
            return Err(
                self.end(format!("returned address {address} in {doing}: not a multiple of {NUMBER}"))
            );
        }
        self.buffer = Buffer { address, size };
        Ok(address)
    }

    /// The text at `address`, which the module returned from `doing`.
    fn text(&mut self, address: i32, doing: Doing<'_>) -> Result<String, Fault> {
        let address = address as u32 as usize;
        let data = self.exports.memory.data(&self.store);
        let Some(rest) = data.get(address..) else {
            let has = data.len();
            return Err(self
                .end(format!("returned a text at address {address} in {doing}: its memory ends at {has}")));
        };
        let window = &rest[..rest.len().min(MOST_TEXT + 1)];
        match window.iter().position(|byte| *byte == 0) {
            Some(size) => Ok(String::from_utf8_lossy(&window[..size]).into_owned()),
            None => Err(self.end(format!(
                "returned a text in {doing} that does not end with 0 within {} bytes",
                window.len().min(MOST_TEXT)
            ))),
        }
    }

    /// Why the module says that `doing` failed.
    fn refusal(&mut self, doing: Doing<'_>) -> Fault {
        let error = self.exports.error;
        let said = self.run(&error, (), Doing::Error).and_then(|address| match address {
            0 => Ok(String::new()),
            _ => self.text(address, Doing::Error),
        });
        match said {
            Ok(text) if text.trim().is_empty() => {
                Fault::Refused(format!("{doing} failed, and gonio_error() does not say why"))
            }
            Ok(text) => Fault::Refused(plain(&text)),
            Err(fault) => fault,
        }
    }
}

impl Instance for Running {
    fn describe(&mut self) -> Result<String, Fault> {
        let (describe, doing) = (self.exports.describe, Doing::Describe);
        match self.run(&describe, 0, doing)? {
            0 => Err(self.refusal(doing)),
            address => self.text(address, doing),
        }
    }

    fn create(&mut self, model: &str, parameters: &str) -> Result<Created, Fault> {
        if model.contains('\0') || parameters.contains('\0') {
            return Err(Fault::Refused(format!("{model:?} or its parameters {parameters:?} contain a NUL")));
        }
        let text = [model.as_bytes(), b"\0", parameters.as_bytes(), b"\0"].concat();
        let address = self.room(text.len())?;
        let data = self.exports.memory.data_mut(&mut self.store);
        data[address as usize..][..text.len()].copy_from_slice(&text);
        let (create, describe) = (self.exports.create, self.exports.describe);
        let second = address + model.len() as u32 + 1;
        let handle = self.run(&create, (address as i32, second as i32), Doing::Create(model))?;
        if handle == 0 {
            return Err(self.refusal(Doing::Create(model)));
        }
        let describe = match self.run(&describe, handle, Doing::Describe)? {
            0 => None,
            address => Some(self.text(address, Doing::Describe)?),
        };
        Ok(Created { handle: u64::from(handle as u32), describe })
    }

    fn call(&mut self, call: &Call, answer: &mut [f64]) -> Result<(), Fault> {
        let doing = Doing::Rows(call.function, call.rows);
        let wi = 3 * NUMBER;
        let values = wi + call.input.len() * NUMBER;
        let size = values + answer.len() * NUMBER;
        let address = self.room(size)?;
        let place = &mut self.exports.memory.data_mut(&mut self.store)[address as usize..][..size];
        write(&mut place[..wi], &call.wo);
        write(&mut place[wi..values], call.input);
        place[values..].fill(0xff); // NaN: what is not written must not be an old answer

        let at = |offset: usize| (address + offset as u32) as i32;
        let mode = match call.transport {
            Transport::Radiance => 0,
            Transport::Importance => 1,
        };
        let (handle, rows) = (call.handle as u32 as i32, call.rows as i32);
        let code = match call.function {
            Function::Sample => {
                let Some(function) = self.exports.sample else { return Err(lacks(call.function)) };
                let weight = values + 3 * call.rows * NUMBER;
                let pdf = weight + call.channels * call.rows * NUMBER;
                let flags = pdf + call.rows * NUMBER;
                let arrays = (at(wi), at(values), at(weight), at(pdf), at(flags));
                let params = (handle, mode, at(0), rows, arrays.0, arrays.1, arrays.2, arrays.3, arrays.4);
                self.run(&function, params, doing)?
            }
            Function::Eval | Function::Pdf => {
                let function =
                    if call.function == Function::Eval { Some(self.exports.eval) } else { self.exports.pdf };
                let Some(function) = function else { return Err(lacks(call.function)) };
                self.run(&function, (handle, mode, at(0), rows, at(wi), at(values)), doing)?
            }
        };
        if code != 0 {
            return Err(self.refusal(doing));
        }
        let place = &self.exports.memory.data(&self.store)[address as usize..][..size];
        read(&place[values..], answer);
        Ok(())
    }

    fn destroy(&mut self, handle: u64) -> Result<(), Fault> {
        let destroy = self.exports.destroy;
        self.run(&destroy, handle as u32 as i32, Doing::Destroy).map(drop)
    }
}

fn lacks(function: Function) -> Fault {
    let word = function.word();
    Fault::Refused(format!(
        "the module does not export gonio_{word}; leave \"{word}\" out of \"has\" in its description"
    ))
}

/// `text` without what would move a terminal's cursor or change its colours.
fn plain(text: &str) -> String {
    let harmless =
        |c: char| if c.is_control() && c != '\n' && c != '\t' { char::REPLACEMENT_CHARACTER } else { c };
    text.chars().map(harmless).collect()
}

fn write(place: &mut [u8], numbers: &[f64]) {
    for (bytes, number) in place.chunks_exact_mut(NUMBER).zip(numbers) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
}

fn read(place: &[u8], numbers: &mut [f64]) {
    let (chunks, _) = place.as_chunks::<NUMBER>();
    for (number, bytes) in numbers.iter_mut().zip(chunks) {
        *number = f64::from_le_bytes(*bytes);
    }
}
