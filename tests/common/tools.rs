//! What tests need beside Rust: compilers, and Python with its packages.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Where things are.
pub struct Tools {
    /// The build folder.
    pub target: PathBuf,
    /// The `bin` of a Python with numpy, pytest and sdk/python.
    pub python: PathBuf,
}

/// Installs what is missing (tests/setup.sh), the first time that a test asks.
pub fn tools() -> &'static Tools {
    static TOOLS: OnceLock<Tools> = OnceLock::new();
    TOOLS.get_or_init(|| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("it is in the target folder");
        let done = Command::new(root.join("tests/setup.sh")).arg(target).output().expect("a shell");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        Tools { target: target.into(), python: target.join("venv/bin") }
    })
}
