//! The same GGX in Rust, C, C++, Python and WebAssembly: for equal inputs the same
//! numbers, and from a suite the same verdicts.

mod common;

use common::languages::languages;
use gonio::bsdf::{Direction, Samples, Subject, Transport};
use gonio::registry::Registry;
use std::process::Command;
use std::sync::Arc;

/// Relative: a dozen operations and two transcendental functions, at a lobe whose
/// exponent multiplies rounding by 1/α² (at most 400 here).
const PRECISION: f64 = 1e-11;

fn subject(spelling: &str) -> Arc<dyn Subject> {
    Registry::builtin().resolve(&spelling.parse().unwrap()).unwrap_or_else(|e| panic!("{e}")).subject
}

/// eval, pdf and samples for fixed inputs.
fn numbers(subject: &dyn Subject, wo: Direction) -> (Vec<f64>, Vec<f64>, Samples) {
    const ROWS: usize = 1024;
    // Weyl's sequence: the same everywhere, without a generator. Not from ½, where GGX of α = 1
    // reflects light from the normal into the horizon, and rounding decides on which side.
    let u: Vec<f64> = (0..2 * ROWS).map(|k| (0.3 + k as f64 * 0.618_033_988_749_894_9).fract()).collect();
    let mut samples = Samples::default();
    samples.clear(subject.describe().channels.len());
    assert_eq!(subject.describe().dimensions, 2);
    subject.sample(wo, &u, Transport::Radiance, &mut samples).unwrap();
    let wi: Vec<Direction> = (0..ROWS)
        .map(|k| Direction::from_angles(1.6 * u[2 * k], std::f64::consts::TAU * u[2 * k + 1]))
        .collect();
    let (mut f, mut p) = (vec![0.0; ROWS], vec![0.0; ROWS]);
    subject.eval(wo, &wi, Transport::Radiance, &mut f).unwrap();
    subject.pdf(wo, &wi, Transport::Radiance, &mut p).unwrap();
    (f, p, samples)
}

fn assert_close(what: &str, found: &[f64], due: &[f64]) {
    assert_eq!(found.len(), due.len(), "{what}");
    for (k, (a, b)) in found.iter().zip(due).enumerate() {
        assert!((a - b).abs() <= PRECISION * b.abs().max(1e-3), "{what}, row {k}: {a} where Rust has {b}");
    }
}

#[test]
fn equal_inputs_give_equal_numbers() {
    for alpha in [0.05, 0.3, 1.0] {
        for (theta, phi) in [(0.0, 0.0), (40.0, 17.0), (85.0, 137.0), (120.0, 257.0)] {
            let wo = Direction::from_angles(f64::to_radians(theta), f64::to_radians(phi));
            let mut first: Option<(Vec<f64>, Vec<f64>, Samples)> = None;
            for (language, spelling) in languages().all(alpha) {
                let found = numbers(&*subject(&spelling), wo);
                let Some(rust) = &first else {
                    first = Some(found);
                    continue;
                };
                let what = |part: &str| format!("{language}, α = {alpha}, θ = {theta}°: {part}");
                assert_close(&what("eval"), &found.0, &rust.0);
                assert_close(&what("pdf"), &found.1, &rust.1);
                let flat = |s: &Samples| s.wi.iter().flat_map(|d| [d.x, d.y, d.z]).collect::<Vec<_>>();
                let valid = |s: &Samples| s.lobe.iter().map(|l| l.is_valid()).collect::<Vec<_>>();
                assert_eq!(valid(&found.2), valid(&rust.2), "{}", what("draws without a sample"));
                assert_close(&what("wi"), &flat(&found.2), &flat(&rust.2));
                assert_close(&what("weight"), &found.2.weight, &rust.2.weight);
                assert_close(&what("sample.pdf"), &found.2.pdf, &rust.2.pdf);
            }
        }
    }
}

#[test]
fn a_suite_gives_the_same_verdicts() {
    let folder = tempfile::tempdir().unwrap();
    let mut text =
        String::from("[suite]\nname = \"languages\"\ntheta = [0, 60, 85]\nphi = 17\nsamples = \"2^17\"\n");
    for alpha in [0.05, 0.5] {
        for (language, spelling) in languages().all(alpha) {
            let (name, _) = spelling.rsplit_once(":").unwrap();
            let more = if language == "Rust" {
                "distribution = \"ggx\"\nsampling = \"visible-normals\"\nfresnel = \"none\"\n"
            } else {
                ""
            };
            text += &format!(
                "[[subject]]\nuse = '{name}'\nlabel = \"{language} {alpha}\"\nalpha = {alpha}\n{more}"
            );
        }
    }
    let suite = folder.path().join("languages.toml");
    std::fs::write(&suite, &text).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_gonio"))
        .args(["run", suite.to_str().unwrap(), "--format", "json", "--plots", "none", "--out"])
        .arg(folder.path().join("report"))
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(0), "{told}");
    let report: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let results = report["results"].as_array().unwrap();
    // Cases come in the order of the suite: five languages, three directions each.
    let verdicts: Vec<&str> = results.iter().map(|r| r["verdict"].as_str().unwrap()).collect();
    let of_one = verdicts.len() / 10;
    assert!(of_one >= 3 * 15, "{}", verdicts.len());
    for alpha in verdicts.chunks(5 * of_one) {
        for language in alpha.chunks(of_one).skip(1) {
            assert_eq!(language, &alpha[..of_one], "{told}");
        }
    }
}
