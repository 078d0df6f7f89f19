//! Subjects in any language: programs, shared libraries, WebAssembly modules.
//! `docs/plugins.md` is the contract.

mod conventions;
mod description;
mod instance;
mod library;
mod limits;
mod open;
mod plugin;
mod probe;
mod process;
mod route;
mod sandbox;
mod subject;
mod wasm;
mod wire;

pub use conventions::{Conventions, Failure, Frame, Given, Up, Weight};
pub use instance::{Call, Created, Fault, Function, Instance};
pub use library::work;
pub use limits::Limits;
pub use open::{Plugins, offered};
pub use process::{Launch, Program, in_path, set_gonio, supervise};
pub use route::{Named, Route};
pub use sandbox::{
    Allowance, BuildFailure, Incident, Isolation, Phase, Rules, Sandbox, confine, guard, incidents, isolation,
};
