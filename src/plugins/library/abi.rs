//! The C functions of a shared library.
#![expect(unsafe_code, reason = "foreign functions are called here, and only here")]

use crate::bsdf::Transport;
use crate::plugins::instance::{Call, Created, Fault, Function, Instance};
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::Path;
use std::sync::Arc;

type Describe = unsafe extern "C" fn(*mut c_void) -> *const c_char;
type Create = unsafe extern "C" fn(*const c_char, *const c_char) -> *mut c_void;
type Rows = unsafe extern "C" fn(*mut c_void, c_int, *const f64, usize, *const f64, *mut f64) -> c_int;
type Sample = unsafe extern "C" fn(
    *mut c_void,
    c_int,
    *const f64,
    usize,
    *const f64,
    *mut f64,
    *mut f64,
    *mut f64,
    *mut f64,
) -> c_int;
type Destroy = unsafe extern "C" fn(*mut c_void);
type Error = unsafe extern "C" fn() -> *const c_char;

/// The functions of a library; those that a plugin may lack are optional.
struct Functions {
    describe: Describe,
    create: Create,
    eval: Option<Rows>,
    pdf: Option<Rows>,
    sample: Option<Sample>,
    destroy: Option<Destroy>,
    error: Option<Error>,
}

/// A shared library in this process. It is never unloaded: its threads and exit
/// handlers may outlive any use of it.
#[derive(Clone)]
pub struct Loaded(Arc<Functions>);

impl Loaded {
    /// Loads the library at `path`.
    pub fn open(path: &Path) -> Result<Self, Fault> {
        let shown = path.display();
        // A bare name would be looked for in the system's folders.
        let path = path.canonicalize().map_err(|e| Fault::Ended(format!("`{shown}` cannot be read: {e}")))?;
        // SAFETY: its initialisers run, as those of any library that is linked; who
        // names it here wants that, and by default it happens in a process of its own.
        let library = unsafe { Library::new(&path) }
            .map_err(|e| Fault::Ended(format!("`{shown}` cannot be loaded: {e}")))?;
        let library = Box::leak(Box::new(library));
        let missing = |name: &str| {
            Fault::Ended(format!(
                "`{shown}` has no function {name}(): include/gonio.h declares what it needs"
            ))
        };
        // SAFETY: the types are those that include/gonio.h declares for these names.
        let functions = unsafe {
            Functions {
                describe: get(library, "gonio_describe").ok_or_else(|| missing("gonio_describe"))?,
                create: get(library, "gonio_create").ok_or_else(|| missing("gonio_create"))?,
                eval: get(library, "gonio_eval"),
                pdf: get(library, "gonio_pdf"),
                sample: get(library, "gonio_sample"),
                destroy: get(library, "gonio_destroy"),
                error: get(library, "gonio_error"),
            }
        };
        Ok(Self(Arc::new(functions)))
    }

    /// Why the last call failed.
    fn error(&self) -> Option<String> {
        // SAFETY: it takes nothing and returns a string or null.
        self.0.error.and_then(|error| unsafe { text(error()) })
    }
}

/// The function `name`, if there is one.
///
/// # Safety
/// It must have the type `F`.
unsafe fn get<F: Copy>(library: &'static Library, name: &str) -> Option<F> {
    // SAFETY: as the caller promises.
    unsafe { library.get::<F>(name.as_bytes()) }.ok().map(|symbol| *symbol)
}

/// A C string.
///
/// # Safety
/// It must be null or point to a string that ends.
unsafe fn text(string: *const c_char) -> Option<String> {
    // SAFETY: as the caller promises.
    (!string.is_null()).then(|| unsafe { CStr::from_ptr(string) }.to_string_lossy().into_owned())
}

/// A handle as C has it.
fn pointer(handle: u64) -> *mut c_void {
    std::ptr::with_exposed_provenance_mut(handle as usize)
}

impl Instance for Loaded {
    fn describe(&mut self) -> Result<String, Fault> {
        // SAFETY: null stands for all models; the string lives until the next call.
        unsafe { text((self.0.describe)(std::ptr::null_mut())) }.ok_or_else(|| {
            let why = self.error().unwrap_or_else(|| "gonio_describe(NULL) returned NULL".into());
            Fault::Ended(why)
        })
    }

    fn create(&mut self, model: &str, parameters: &str) -> Result<Created, Fault> {
        let string = |text: &str| {
            CString::new(text).map_err(|_| Fault::Refused(format!("`{}` has a zero", text.escape_debug())))
        };
        let (model, parameters) = (string(model)?, string(parameters)?);
        // SAFETY: both strings end and live through the call.
        let handle = unsafe { (self.0.create)(model.as_ptr(), parameters.as_ptr()) };
        if handle.is_null() {
            let why = self.error().unwrap_or_else(|| "gonio_create() returned NULL and no error".into());
            return Err(Fault::Refused(why));
        }
        // SAFETY: the handle is one that it gave.
        let describe = unsafe { text((self.0.describe)(handle)) };
        Ok(Created { handle: handle.expose_provenance() as u64, describe })
    }

    fn call(&mut self, call: &Call, answer: &mut [f64]) -> Result<(), Fault> {
        let name = call.function.word();
        let lacks = || Fault::Refused(format!("it describes {name}() and has no function gonio_{name}()"));
        let mode = c_int::from(call.transport == Transport::Importance);
        let handle = pointer(call.handle);
        let (wo, n, input) = (call.wo.as_ptr(), call.rows, call.input.as_ptr());
        let status = match call.function {
            Function::Eval | Function::Pdf => {
                let rows = if call.function == Function::Eval { self.0.eval } else { self.0.pdf };
                let rows = rows.ok_or_else(lacks)?;
                // SAFETY: wo has 3 numbers, the input n rows, the answer what `Call::answer` says.
                unsafe { rows(handle, mode, wo, n, input, answer.as_mut_ptr()) }
            }
            Function::Sample => {
                let sample = self.0.sample.ok_or_else(lacks)?;
                let (wi, rest) = answer.split_at_mut(3 * n);
                let (weight, rest) = rest.split_at_mut(call.channels * n);
                let (pdf, flags) = rest.split_at_mut(n);
                let (wi, weight) = (wi.as_mut_ptr(), weight.as_mut_ptr());
                // SAFETY: as above; the four parts of the answer do not overlap.
                unsafe {
                    sample(handle, mode, wo, n, input, wi, weight, pdf.as_mut_ptr(), flags.as_mut_ptr())
                }
            }
        };
        match status {
            0 => Ok(()),
            status => {
                let why =
                    self.error().unwrap_or_else(|| format!("gonio_{name}() returned {status}, and no error"));
                Err(Fault::Refused(why))
            }
        }
    }

    fn destroy(&mut self, handle: u64) -> Result<(), Fault> {
        if let Some(destroy) = self.0.destroy {
            // SAFETY: the handle is one that it gave, and is not used again.
            unsafe { destroy(pointer(handle)) };
        }
        Ok(())
    }
}
