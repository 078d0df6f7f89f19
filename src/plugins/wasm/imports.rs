//! What a module may import: mathematics, and what does nothing.

use super::host::Host;
use super::problem::{Problem, signature};
use super::{assemblyscript, math, wasi};
use wasmi::{Extern, ExternType, Func, FuncType, Module, Store};

/// From where C and AssemblyScript import what they do not find.
const ENV: &str = "env";

/// How alike a name must be to be the one that is meant.
const ALIKE: f64 = 0.85;

/// What `module` imports, in its order.
pub fn link(store: &mut Store<Host>, module: &Module) -> Result<Vec<Extern>, Problem> {
    let mut found = Vec::new();
    let (mut unknown, mut nearest) = (Vec::new(), None);
    for import in module.imports() {
        let name = format!("{}.{}", import.module(), import.name());
        let ty = match import.ty() {
            ExternType::Func(ty) => ty,
            ExternType::Memory(_) => return Err(Problem::NotAFunction { what: "memory", name }),
            ExternType::Table(_) => return Err(Problem::NotAFunction { what: "table", name }),
            ExternType::Global(_) => return Err(Problem::NotAFunction { what: "global variable", name }),
        };
        let Some(function) = provide(store, import.module(), import.name(), ty) else {
            nearest = nearest.or_else(|| nearest_to(import.name()));
            unknown.push(name);
            continue;
        };
        let is = function.ty(&*store);
        if is != *ty {
            return Err(Problem::WrongImport { name, found: signature(ty), expected: signature(&is) });
        }
        found.push(Extern::Func(function));
    }
    if unknown.is_empty() { Ok(found) } else { Err(Problem::UnknownImports { names: unknown, nearest }) }
}

fn provide(store: &mut Store<Host>, module: &str, name: &str, ty: &FuncType) -> Option<Func> {
    match module {
        ENV if name == "emscripten_notify_memory_growth" => Some(Func::wrap(store, |_: i32| ())),
        ENV => math::provide(store, name).or_else(|| assemblyscript::provide(store, name, ty)),
        wasi::MODULE => wasi::provide(store, name, ty),
        _ => None,
    }
}

fn nearest_to(name: &str) -> Option<String> {
    let all = [(ENV, math::NAMES), (wasi::MODULE, wasi::NAMES)];
    all.iter()
        .flat_map(|(module, names)| names.iter().map(move |known| (module, known)))
        .map(|(module, known)| (strsim::jaro_winkler(name, known), module, known))
        .filter(|(alike, ..)| *alike > ALIKE)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, module, known)| format!("{module}.{known}"))
}
