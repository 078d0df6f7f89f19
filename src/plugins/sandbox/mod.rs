//! Untrusted programs: built and run where they see nothing but their own folder, within
//! limits, and what they try is told.
//!
//! gonio → `gonio worker guard` → bubblewrap → `gonio worker confine` → the program. The
//! guard counts what all of it takes, answers for system calls that no BRDF needs, and ends
//! everything at once; confining sets what a process can only set for itself.

mod build;
mod calls;
mod confine;
mod filter;
mod fold;
mod guard;
mod incident;
mod isolation;
mod mounts;
mod places;
mod programs;
mod rules;
mod seccomp;
mod settings;
mod streams;
mod taken;
mod watch;

pub use build::BuildFailure;
pub use confine::confine;
pub use guard::{ENDED, VOICE, guard};
pub use incident::{Incident, Phase, incidents};
pub use isolation::{Isolation, isolation};
pub use rules::Rules;
pub use settings::{Allowance, Sandbox};
