//! Suites that come with gonio.

/// A suite that comes with gonio.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Embedded {
    /// As it is asked for.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// All of them; the first is run where none is asked for.
pub const EMBEDDED: [Embedded; 3] = [
    Embedded { name: "seed", text: include_str!("../../suites/seed.toml") },
    Embedded { name: "quick", text: include_str!("../../suites/quick.toml") },
    Embedded { name: "deep", text: include_str!("../../suites/deep.toml") },
];

/// The suite called `name`.
pub fn embedded(name: &str) -> Option<Embedded> {
    EMBEDDED.into_iter().find(|e| e.name == name)
}
