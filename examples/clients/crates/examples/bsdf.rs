//! What docs/field-notes-crates.md says of bsdf 0.1.1, without gonio: formulas,
//! midpoint sums and counted draws.
//!
//! ```text
//! cargo run --release --example bsdf             # all of it
//! cargo run --release --example bsdf -- horizon  # one finding
//! ```

mod common;

use bsdf::conductive::Conductive;
use bsdf::disney::Disney;
use bsdf::emissive::Emissive;
use bsdf::ggx::GGX;
use bsdf::lambert::Lambert;
use bsdf::mix::Mix;
use bsdf::rough_glass::RoughGlass;
use bsdf::{BSDF, RgbF, Vec3d};
use common::{Random, Vector, at, integral};
use std::f64::consts::PI;
use std::panic::{AssertUnwindSafe, catch_unwind};

fn v(w: Vector) -> Vec3d {
    Vec3d::from_array(w)
}

fn u(random: &mut Random) -> Vec3d {
    Vec3d::new(random.next(), random.next(), random.next())
}

const ROUGH: GGX = GGX { alpha_x: 0.25, alpha_y: 0.25 };

/// What is said instead of a value.
fn outcome(f: impl FnOnce() -> String) -> String {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let told = catch_unwind(AssertUnwindSafe(f));
    std::panic::set_hook(hook);
    told.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| s.to_string()));
        format!("panics: {}", text.unwrap_or_default().lines().next().unwrap_or_default())
    })
}

/// emissive.rs: what scatters nothing has the density 1 everywhere, and its
/// direction is the zero vector, which other materials refuse.
fn emissive() {
    let lamp = || Emissive { emission: RgbF::ONE };
    let wo = at(30.0, 17.0);
    let z = integral(0.0, 180.0, 400, |wi| lamp().sample_incoming_pdf(v(wo), v(wi)));
    println!(
        "Emissive: ∫pdf = {z:.4} = 4π, f = 0, sampled direction {}",
        lamp().sample_incoming(v(wo), u(&mut Random(1))).omega_i
    );
    let mixed = Mix { b1: lamp(), b2: Lambert { kd: RgbF::ONE }, factor: 0.5 };
    for z in [0.2, 0.8] {
        let told = outcome(|| {
            let s = mixed.sample_incoming(v(wo), Vec3d::new(0.3, 0.4, z));
            format!(
                "wi = {}, pdf = {:.4} (pdf of the half that draws: {:.4})",
                s.omega_i,
                s.pdf,
                0.5 * s.omega_i.z / PI
            )
        });
        println!("  mixed half and half with Lambert, u₂ = {z}: {told}");
    }
}

/// utils.rs:138 and ggx.rs:101: G1 = 0 over cos θ = 0 at the horizon.
fn horizon() {
    println!("pdf and value at wo ⟂ n");
    let (wo, wi) = (Vec3d::new(0.6, 0.8, 0.0), v(at(40.0, 60.0)));
    let (metal, glass) =
        (Conductive { color: RgbF::ONE, ggx: ROUGH, ior: 1.5 }, RoughGlass { ggx: ROUGH, ior: 1.5 });
    let plastic = Disney::default();
    let materials: [(&str, &dyn BSDF); 3] =
        [("Conductive", &metal), ("RoughGlass", &glass), ("Disney", &plastic)];
    for (name, material) in materials {
        for (side, wi) in [("same side", wi), ("other side", -wi)] {
            let pdf = outcome(|| format!("pdf = {}", material.sample_incoming_pdf(wo, wi)));
            let f = outcome(|| format!("f = {}", material.evaluate(wo, wi)));
            println!("  {name}, {side}: {pdf}, {f}");
        }
        let mut random = Random(7);
        let mut told = std::collections::BTreeMap::new();
        for _ in 0..1000 {
            let (u, below) = (u(&mut random), Vec3d::new(0.6, 0.8, -0.0));
            for wo in [wo, below] {
                let draw = outcome(|| format!("pdf = {}", material.sample_incoming(wo, u).pdf));
                *told.entry(draw).or_insert(0) += 1;
            }
        }
        println!("  {name}, 2000 draws: {told:?}");
    }
}

/// rough_glass.rs:129: `radiance_correction` takes (η_o/η_i)² out again.
fn eta() {
    println!("RoughGlass, α = 0.0025, η = 1.5: Σ f cos/pdf over transmitted draws, of radiance and as it is");
    let glass = RoughGlass { ggx: GGX { alpha_x: 0.0025, alpha_y: 0.0025 }, ior: 1.5 };
    for theta in [30.0, 150.0] {
        let wo = at(theta, 17.0);
        let mut random = Random(1);
        let (n, mut sum, mut count) = (200_000, 0.0, 0.0);
        for _ in 0..n {
            let s = glass.sample_incoming(v(wo), u(&mut random));
            if s.omega_i.z * wo[2] < 0.0 && s.pdf > 0.0 {
                sum += s.bsdf.x * s.omega_i.z.abs() / s.pdf / n as f64;
                count += 1.0 / n as f64;
            }
        }
        let scale: f64 = if theta < 90.0 { 1.0 / 1.5 } else { 1.5 };
        println!(
            "  θo = {theta}°: {sum:.4}; 1 − F = {count:.4}, (η_o/η_i)² (1 − F) = {:.4}",
            count * scale * scale
        );
    }
}

/// mix.rs:58: `draw / factor` at draw = factor = 0.
fn mix() {
    let lambert = Lambert { kd: RgbF::ONE };
    let mixed = Mix { b1: lambert, b2: RoughGlass { ggx: ROUGH, ior: 1.5 }, factor: 0.0 };
    println!("Mix of factor 0 at u₂ = 0, where its second part is drawn with u₂ = 0/0");
    for theta in [30.0, 120.0] {
        let told = outcome(|| {
            let s = mixed.sample_incoming(v(at(theta, 17.0)), Vec3d::new(0.3, 0.4, 0.0));
            format!("wi = {:.4}, pdf = {:.4}", s.omega_i, s.pdf)
        });
        println!("  θo = {theta}°: {told}");
    }
}

/// rough_glass.rs:105: wi = −wo at an index of 1, up to rounding, where half
/// vector and Jacobian are 0/0.
fn matched() {
    println!("RoughGlass of index 1, α = 1: outcomes of 10000 draws");
    let glass = RoughGlass { ggx: GGX { alpha_x: 1.0, alpha_y: 1.0 }, ior: 1.0 };
    for theta in [0.0, 30.0, 60.0] {
        let (mut random, mut panics, mut zero) = (Random(6), 0, 0);
        for _ in 0..10_000 {
            let u = u(&mut random);
            let told = outcome(|| (glass.sample_incoming(v(at(theta, 17.0)), u).pdf == 0.0).to_string());
            panics += i32::from(told.starts_with("panics"));
            zero += i32::from(told == "true");
        }
        println!("  θo = {theta}°: {panics} panics, {zero} with pdf 0");
    }
}

/// utils.rs:66: 0.2162 for 0.2126.
fn luminance() {
    println!("The weights of luminance() add up to {:.4}", 0.2162 + 0.7152 + 0.0722);
    println!("  so that sheen of a white base, all tinted, is {:.4} of what it is untinted", 1.0 / 1.0036);
    let (wo, wi) = (v(at(80.0, 17.0)), v(at(80.0, 190.0)));
    let of = |sheen, sheen_tint| {
        let material =
            Disney { base_color: RgbF::ONE, specular: 0.0, sheen, sheen_tint, ..Disney::default() };
        material.evaluate(wo, wi).x
    };
    println!("  found {:.4}", (of(1.0, 1.0) - of(0.0, 0.0)) / (of(1.0, 0.0) - of(0.0, 0.0)));
}

/// disney.rs:165: the base is not reduced by what lies over it.
fn energy() {
    println!("Disney, white: albedo by midpoint sums");
    let plain = Disney { base_color: RgbF::ONE, ..Disney::default() };
    let cases = [
        ("specular 0.5", plain),
        ("specular 1", Disney { specular: 1.0, ..plain }),
        ("specular 0", Disney { specular: 0.0, ..plain }),
        ("specular 0, roughness 1", Disney { specular: 0.0, roughness: 1.0, ..plain }),
        ("specular 0, sheen 1", Disney { specular: 0.0, sheen: 1.0, ..plain }),
        ("clearcoat 1, its roughness 0.5", Disney { clearcoat: 1.0, clearcoat_roughness: 0.5, ..plain }),
        ("metallic 1", Disney { metallic: 1.0, ..plain }),
        (
            "metallic 1, clearcoat 1",
            Disney { metallic: 1.0, clearcoat: 1.0, clearcoat_roughness: 0.5, ..plain },
        ),
    ];
    for (name, material) in cases {
        let of = |theta| {
            let wo = at(theta, 17.0);
            integral(0.0, 90.0, 600, |wi| material.evaluate(v(wo), v(wi)).x * wi[2])
        };
        println!("  {name}: {:.3} at 0°, {:.3} at 60°, {:.3} at 80°", of(0.01), of(60.0), of(80.0));
    }
}

type Finding = (&'static str, fn());

fn main() {
    let findings: [Finding; 7] = [
        ("emissive", emissive),
        ("horizon", horizon),
        ("eta", eta),
        ("mix", mix),
        ("matched", matched),
        ("luminance", luminance),
        ("energy", energy),
    ];
    let wanted = std::env::args().nth(1);
    for (name, show) in findings {
        if wanted.as_deref().is_none_or(|w| w == name) {
            println!("[{name}]");
            show();
        }
    }
}
