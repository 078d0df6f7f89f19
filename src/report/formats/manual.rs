//! Where the manual can be read.

use crate::cause::Cause;

/// The project's page.
pub const HOME: &str = env!("CARGO_PKG_REPOSITORY");

/// The page of a cause that gonio knows.
pub fn cause_page(slug: &str) -> Option<String> {
    let known = Cause::ALL.into_iter().find(|cause| cause.slug() == slug)?;
    Some(format!("{HOME}/blob/main/docs/causes/{known}.md"))
}

/// The table of checks.
pub fn checks_page() -> String {
    format!("{HOME}#what-is-checked")
}
