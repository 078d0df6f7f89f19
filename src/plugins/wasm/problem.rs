//! Why a file is not a module that gonio can run, each with what to do about it.

use wasmi::{FuncType, ValType};

/// Why a file is not a module that gonio can run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{name}` {problem}")]
pub struct ModuleError {
    /// The file, as it was named.
    pub name: String,
    /// What is wrong with it.
    pub problem: Problem,
}

/// What is wrong with a module: the rest of a sentence that begins with its name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Not a file, or not readable.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// Too many bytes.
    #[error("has {bytes} bytes; a module may have {most}")]
    TooBig {
        /// How many.
        bytes: u64,
        /// How many it may have.
        most: u64,
    },
    /// Something else than WebAssembly.
    #[error("is not a WebAssembly module: {0}")]
    NotWasm(String),
    /// A component, which is another format with the same first bytes.
    #[error(
        "is a WebAssembly component, and gonio runs core modules: build for wasm32-unknown-unknown or \
         wasm32-wasip1 (not wasip2), or leave out `wasm-tools component new`"
    )]
    Component,
    /// Of another version.
    #[error("is of WebAssembly version {0}; gonio runs version 1")]
    Version(u32),
    /// A section reaches beyond the end of the file.
    #[error(
        "is cut off: its {section} section has {wants} bytes at byte {at}, where {has} are left; build or \
         copy it again"
    )]
    CutOff {
        /// Which section.
        section: &'static str,
        /// Where its content begins.
        at: usize,
        /// Bytes that it should have.
        wants: u64,
        /// Bytes that are there.
        has: usize,
    },
    /// The number of something is not a number.
    #[error("is damaged: there should be a number at byte {at}; build or copy it again")]
    NoNumber {
        /// Where.
        at: usize,
    },
    /// Too many of something.
    #[error("has {count} {what}; gonio takes modules of at most {most}")]
    TooMany {
        /// How many.
        count: u32,
        /// Of what.
        what: &'static str,
        /// How many there may be.
        most: u32,
    },
    /// Nothing is wrong with the module: gonio itself was built in a way that cannot run any.
    #[error(
        "cannot be run: this gonio was built so that WebAssembly would overflow its stack; build the package \
         wasmi with opt-level 3 and without debug-assertions, or with opt-level 0"
    )]
    Build,
    /// It does not validate.
    #[error("is not valid WebAssembly (2.0, without SIMD, threads and 64-bit memories): {0}")]
    Invalid(String),
    /// It wants more memory than it may have.
    #[error("begins with {wants} MiB of memory; it may have {most} MiB (--memory)")]
    Memory {
        /// MiB that it begins with.
        wants: u64,
        /// MiB that it may have.
        most: u64,
    },
    /// It lacks exports.
    #[error(
        "does not export {}; mark each with GONIO_EXPORT (C), `#[unsafe(no_mangle)] pub extern \"C\"` \
         (Rust) or `export` (AssemblyScript); `memory` is exported by the linker",
        quoted(.0)
    )]
    Missing(Vec<String>),
    /// An export is of another type.
    #[error("exports `{name}` as {found}; gonio calls it as {expected} (pointers, sizes and modes are i32)")]
    WrongExport {
        /// Which.
        name: String,
        /// Its type.
        found: String,
        /// The type that it should have.
        expected: String,
    },
    /// It imports what does not exist.
    #[error(
        "imports {}, which gonio does not have{}; it has the functions of C's math.h in `env`, \
         `abort`, `trace` and `seed` of AssemblyScript, and WASI preview 1 (which fails): link the \
         rest into the module",
        quoted(.names), meant(.nearest)
    )]
    UnknownImports {
        /// Which.
        names: Vec<String>,
        /// What exists and is called almost as the first.
        nearest: Option<String>,
    },
    /// It imports a function of another type.
    #[error("imports `{name}` as {found}; it is {expected}")]
    WrongImport {
        /// Which.
        name: String,
        /// Its type in the module.
        found: String,
        /// Its type.
        expected: String,
    },
    /// It imports a memory, a table or a global.
    #[error("imports the {what} `{name}`; gonio provides functions only: let the module have its own")]
    NotAFunction {
        /// A memory, a table or a global.
        what: &'static str,
        /// Which.
        name: String,
    },
}

impl Problem {
    /// With the name of the file.
    pub(super) fn of(self, name: &str) -> ModuleError {
        ModuleError { name: name.to_owned(), problem: self }
    }
}

/// The first of them, for a sentence.
fn quoted(names: &[String]) -> String {
    const SHOWN: usize = 5;
    let shown: Vec<_> = names.iter().take(SHOWN).map(|name| format!("`{name}`")).collect();
    match names.len().saturating_sub(SHOWN) {
        0 => shown.join(", "),
        rest => format!("{} and {rest} more", shown.join(", ")),
    }
}

fn meant(name: &Option<String>) -> String {
    name.as_ref().map_or_else(String::new, |name| format!(" (is `{name}` meant?)"))
}

/// A type as WebAssembly writes it: (i32, f64) → f64.
pub(super) fn signature(ty: &FuncType) -> String {
    let list = |types: &[ValType]| types.iter().map(|ty| word(*ty)).collect::<Vec<_>>().join(", ");
    match ty.results() {
        [] => format!("({}) → nothing", list(ty.params())),
        [one] => format!("({}) → {}", list(ty.params()), word(*one)),
        more => format!("({}) → ({})", list(ty.params()), list(more)),
    }
}

fn word(ty: ValType) -> &'static str {
    match ty {
        ValType::I32 => "i32",
        ValType::I64 => "i64",
        ValType::F32 => "f32",
        ValType::F64 => "f64",
        ValType::V128 => "v128",
        ValType::FuncRef => "funcref",
        ValType::ExternRef => "externref",
    }
}
