//! What the sandbox costs: `cargo bench --bench sandbox` prints how long a C library and a
//! Python program take to start, with limits only, in bubblewrap, and watched, and how many
//! million directions a second they evaluate in batches of 4096.

#[path = "../tests/common/languages.rs"]
mod languages;
#[path = "../tests/common/tools.rs"]
mod tools;

use gonio::bsdf::Transport;
use gonio::plugins::{Call, Function, Instance, Isolation, Limits, Named, Sandbox, isolation};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

const BATCH: usize = 4096;

/// Starts that are timed, of which the middle one is told.
const STARTS: usize = 15;

/// Batches that are timed.
const BATCHES: usize = 400;

fn main() {
    // They build the library, and say which program is gonio.
    let spelling = languages::languages().all(0.3).into_iter().find(|(name, _)| *name == "C").expect("C").1;
    let library = PathBuf::from(spelling.split(':').next().expect("a file"));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let python = tools::tools().python.join("python3");
    let script = root.join("examples/plugins/ggx.py");
    println!("{:24} {:>10} {:>16}", isolation().to_string(), "start, ms", "million rows/s");
    for (name, folder, named) in [
        ("C", library.parent().expect("a folder").to_path_buf(), Named::Library(library.clone())),
        (
            "Python",
            script.parent().expect("a folder").to_path_buf(),
            Named::Command(vec![python.into(), "ggx.py".into()]),
        ),
    ] {
        for how in ["as it is", "limits", "bubblewrap", "watched"] {
            let mut sandbox = Sandbox::new(&folder);
            sandbox.read = vec![root.join("sdk/python/src")];
            match (how, &mut sandbox.isolation) {
                ("bubblewrap", Isolation::Bubblewrap { unwatched, .. }) => *unwatched = Some(how.into()),
                ("limits", isolation) => *isolation = Isolation::Limits { why: how.into() },
                _ => {}
            }
            let sandbox = (how != "as it is").then(|| Arc::new(sandbox));
            let named = match (&named, &sandbox) {
                (Named::Command(words), None) => {
                    Named::Command(vec![words[0].clone(), script.clone().into()])
                }
                _ => named.clone(),
            };
            let limits = Limits::default();
            let start = || {
                let route = named.route(&limits, sandbox.as_ref()).expect("a route");
                route.start(&limits).expect("an instance")
            };
            let mut times: Vec<f64> = (0..STARTS)
                .map(|_| {
                    let since = Instant::now();
                    let instance = start();
                    let took = since.elapsed().as_secs_f64();
                    drop(instance);
                    took
                })
                .collect();
            times.sort_by(f64::total_cmp);
            let rate = rate(&mut *start());
            println!("{:24} {:10.1} {rate:16.2}", format!("{name}, {how}"), 1e3 * times[STARTS / 2]);
        }
    }
}

/// Million rows a second.
fn rate(instance: &mut dyn Instance) -> f64 {
    let description: serde_json::Value =
        serde_json::from_str(&instance.describe().expect("a description")).expect("JSON");
    let model = description["models"][0]["name"].as_str().expect("a name").to_string();
    let handle = instance.create(&model, "{\"alpha\":0.3}").expect("a subject").handle;
    let input: Vec<f64> = (0..BATCH)
        .flat_map(|k| {
            let z = (0.5 + k as f64) / BATCH as f64;
            [(1.0 - z * z).sqrt(), 0.0, z]
        })
        .collect();
    let call = Call {
        function: Function::Pdf,
        handle,
        transport: Transport::Radiance,
        wo: [0.6, 0.0, 0.8],
        rows: BATCH,
        channels: 1,
        input: &input,
    };
    let mut answer = vec![0.0; call.answer()];
    let since = Instant::now();
    for _ in 0..BATCHES {
        instance.call(&call, &mut answer).expect("values");
    }
    (BATCHES * BATCH) as f64 / since.elapsed().as_secs_f64() / 1e6
}
