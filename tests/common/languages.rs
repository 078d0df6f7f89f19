//! The same GGX in every language that a plugin can be written in.

use super::tools::tools;
use gonio::plugins::set_gonio;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// How each language is named on the command line, without its parameters.
pub struct Languages {
    c: PathBuf,
    cpp: PathBuf,
    wasm: PathBuf,
    python: String,
}

fn build(command: &mut Command) {
    let done = command.current_dir(env!("CARGO_MANIFEST_DIR")).output().expect("a compiler");
    assert!(done.status.success(), "{command:?}: {}", String::from_utf8_lossy(&done.stderr));
}

/// Builds them, the first time that it is asked.
pub fn languages() -> &'static Languages {
    static BUILT: OnceLock<Languages> = OnceLock::new();
    BUILT.get_or_init(|| {
        set_gonio(env!("CARGO_BIN_EXE_gonio").into());
        let tools = tools();
        let folder = tools.target.join("languages");
        std::fs::create_dir_all(&folder).unwrap();
        let [c, cpp, wasm] = ["ggx-c.so", "ggx-cpp.so", "ggx.wasm"].map(|name| folder.join(name));
        let shared = ["-O2", "-shared", "-fPIC", "-Iinclude", "-Isdk/cpp"];
        build(Command::new("cc").args(shared).args(["examples/plugins/ggx.c", "-lm", "-o"]).arg(&c));
        build(Command::new("c++").args(shared).args(["examples/plugins/ggx.cpp", "-o"]).arg(&cpp));
        build(
            Command::new("clang")
                .args(["--target=wasm32", "-nostdlib", "-O2", "-Wl,--no-entry", "-Iinclude"])
                .args(["examples/plugins/ggx.c", "-o"])
                .arg(&wasm),
        );
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/plugins/ggx.py");
        let python = format!("{} {}", tools.python.join("python").display(), script.display());
        Languages { c, cpp, wasm, python }
    })
}

impl Languages {
    /// Each with its name, the built-in model first.
    pub fn all(&self, alpha: f64) -> Vec<(&'static str, String)> {
        let path = |path: &Path| format!("{}:alpha={alpha}", path.display());
        vec![
            (
                "Rust",
                format!(
                    "torrance-sparrow:distribution=ggx,sampling=visible-normals,fresnel=none,alpha={alpha}"
                ),
            ),
            ("C", path(&self.c)),
            ("C++", path(&self.cpp)),
            ("WebAssembly", path(&self.wasm)),
            ("Python", format!("{}:alpha={alpha}", self.python)),
        ]
    }
}
