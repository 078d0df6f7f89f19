//! Untrusted programs in the sandbox. Each hostile one gets nothing, is told of, and leaves
//! no process, file or mount; of honest ones nothing is told.

#[path = "sandbox/building.rs"]
mod building;
#[path = "sandbox/desk.rs"]
mod desk;
#[path = "sandbox/running.rs"]
mod running;
#[path = "common/tools.rs"]
#[allow(dead_code)]
mod tools;
