//! A module that was compiled, from which every thread starts its own instance.

use super::host::Host;
use super::problem::{ModuleError, Problem};
use super::running::Running;
use super::{budget, exports, imports, probe, sections};
use crate::plugins::Limits;
use crate::plugins::instance::{Fault, Instance};
use std::fmt;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use wasmi::{CompilationMode, Config, Engine, Store};

/// How deep functions may call each other. A random walk that calls itself for each
/// of its steps is far below it.
const MOST_DEPTH: usize = 10_000;
/// Bytes of the values of all functions that are being called.
const MOST_STACK: usize = 16 << 20;

/// A module that was compiled and found to be one that gonio can run.
#[derive(Clone)]
pub struct Module {
    module: wasmi::Module,
    limits: Limits,
}

impl fmt::Debug for Module {
    /// Without its code.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Module").field("limits", &self.limits).finish_non_exhaustive()
    }
}

impl Module {
    /// The module in the file at `path`.
    pub fn open(path: &Path, limits: &Limits) -> Result<Self, ModuleError> {
        let name = path.display().to_string();
        let bytes = read(path).map_err(|problem| problem.of(&name))?;
        Self::compile(&name, &bytes, limits)
    }

    /// The module `bytes`, which errors call `name`.
    pub fn compile(name: &str, bytes: &[u8], limits: &Limits) -> Result<Self, ModuleError> {
        compiled(bytes, limits).map_err(|problem| problem.of(name))
    }

    /// An instance of it, for one thread.
    pub fn start(&self) -> Result<Box<dyn Instance>, Fault> {
        let mut store = self.store();
        let cannot = |why: &dyn fmt::Display| Fault::Ended(format!("the module cannot be started: {why}"));
        let imports = imports::link(&mut store, &self.module).map_err(|problem| cannot(&problem))?;
        let instance =
            wasmi::Instance::new(&mut store, &self.module, &imports).map_err(|error| cannot(&error))?;
        store.data_mut().started();
        let exports = exports::Exports::of(&instance, &store).map_err(|error| cannot(&error))?;
        Ok(Box::new(Running::new(store, exports, self.limits)?))
    }

    fn store(&self) -> Store<Host> {
        let mut store = Store::new(self.module.engine(), Host::new(self.limits.memory));
        store.limiter(|host| host);
        store
    }
}

fn read(path: &Path) -> Result<Vec<u8>, Problem> {
    let unreadable = |error: std::io::Error| Problem::Unreadable(error.to_string());
    let file = File::open(path).map_err(unreadable)?;
    let bytes = file.metadata().map_err(unreadable)?.len();
    if bytes > sections::MOST_BYTES {
        return Err(Problem::TooBig { bytes, most: sections::MOST_BYTES });
    }
    let mut content = Vec::new();
    // One byte more than a module may have, if the file has grown or never ends.
    file.take(sections::MOST_BYTES + 1).read_to_end(&mut content).map_err(unreadable)?;
    Ok(content)
}

fn compiled(bytes: &[u8], limits: &Limits) -> Result<Module, Problem> {
    let bytes = sections::checked(bytes)?;
    if !probe::stays_level() {
        return Err(Problem::Build);
    }
    let module = wasmi::Module::new(&Engine::new(&config()), &bytes)
        .map_err(|error| Problem::Invalid(error.to_string()))?;
    let module = Module { module, limits: *limits };
    imports::link(&mut module.store(), &module.module)?;
    exports::check(&module.module, limits.memory)?;
    Ok(module)
}

fn config() -> Config {
    let mut config = Config::default();
    budget::prices(&mut config);
    config
        // Not lazily: whoever called a function first would pay the fuel for it.
        .compilation_mode(CompilationMode::Eager)
        .ignore_custom_sections(true)
        .wasm_multi_memory(false)
        .set_max_recursion_depth(MOST_DEPTH)
        .set_max_stack_height(MOST_STACK);
    config
}
