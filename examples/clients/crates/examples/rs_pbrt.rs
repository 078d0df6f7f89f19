//! What docs/field-notes-crates.md says of rs_pbrt 0.9.12, without gonio:
//! formulas, midpoint sums and counted draws.
//!
//! ```text
//! cargo run --release --example rs_pbrt            # all of it
//! cargo run --release --example rs_pbrt -- hair    # one finding
//! ```

mod common;

use common::{Random, Vector, at, integral};
use rs_pbrt::core::geometry::{Normal3f, Point2f, Vector3f};
use rs_pbrt::core::interpolation::integrate_catmull_rom;
use rs_pbrt::core::material::TransportMode;
use rs_pbrt::core::microfacet::{BeckmannDistribution, MicrofacetDistribution, TrowbridgeReitzDistribution};
use rs_pbrt::core::pbrt::Spectrum;
use rs_pbrt::core::reflection::{
    Bsdf, Bxdf, FourierBSDF, FourierBSDFTable, Fresnel, FresnelConductor, FresnelDielectric, FresnelNoOp,
    FresnelSpecular, LambertianReflection, MicrofacetReflection, MicrofacetTransmission, SpecularReflection,
    SpecularTransmission, fr_dielectric,
};
use rs_pbrt::materials::disney::{DisneyClearCoat, DisneyFakeSS};
use rs_pbrt::materials::hair::HairBSDF;
use std::f64::consts::PI;
use std::sync::Arc;

const ALL: u8 = 31;

fn v(w: Vector) -> Vector3f {
    Vector3f { x: w[0] as f32, y: w[1] as f32, z: w[2] as f32 }
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn white(x: f32) -> Spectrum {
    Spectrum::new(x)
}

fn u(random: &mut Random) -> Point2f {
    let mut below_one = || (random.next() as f32).min(0.999_999_94);
    Point2f { x: below_one(), y: below_one() }
}

/// The lobes in a frame that changes nothing.
fn sum(bxdfs: Vec<Bxdf>) -> Bsdf {
    let up = Normal3f { x: 0.0, y: 0.0, z: 1.0 };
    let (ss, ts) = (Vector3f { x: 1.0, y: 0.0, z: 0.0 }, Vector3f { x: 0.0, y: 1.0, z: 0.0 });
    Bsdf { eta: 1.0, ns: up, ng: up, ss, ts, bxdfs }
}

/// Direction, f, density and flags of a draw, if there is one.
fn draw(bsdf: &Bsdf, wo: Vector, random: &mut Random) -> Option<(Vector, f64, f64, u8)> {
    let (mut wi, mut pdf, mut flags) = (Vector3f::default(), 0.0, ALL);
    let f = bsdf.sample_f(&v(wo), &mut wi, &u(random), &mut pdf, ALL, &mut flags);
    (pdf != 0.0).then(|| ([wi.x.into(), wi.y.into(), wi.z.into()], f.c[0].into(), pdf.into(), flags))
}

fn pdf(bsdf: &Bsdf, wo: Vector, wi: Vector) -> f64 {
    bsdf.pdf(&v(wo), &v(wi), ALL).into()
}

const DRAWS: usize = 1_000_000;

/// The share of draws that `counts`.
fn share(bsdf: &Bsdf, wo: Vector, counts: impl Fn(Vector, u8) -> bool) -> f64 {
    let mut random = Random(1);
    let hits = (0..DRAWS).filter(|_| draw(bsdf, wo, &mut random).is_some_and(|(wi, .., k)| counts(wi, k)));
    hits.count() as f64 / DRAWS as f64
}

fn facets(alpha: f32, visible: bool) -> MicrofacetDistribution {
    MicrofacetDistribution::TrowbridgeReitz(TrowbridgeReitzDistribution::new(alpha, alpha, visible))
}

/// materials/disney.rs:628: gtr1 divides by log10(α²) where ln(α²) belongs.
fn clearcoat() {
    println!("The coat's ∫pdf over its share of valid draws; ln 10 = {:.4}", 10f64.ln());
    for gloss in [0.1, 0.03] {
        let bsdf = sum(vec![Bxdf::DisClearCoat(DisneyClearCoat::new(1.0, gloss, None))]);
        for theta in [0.0, 30.0, 60.0] {
            let wo = at(theta, 17.0);
            let z = integral(0.0, 90.0, 1500, |wi| pdf(&bsdf, wo, wi));
            let s = share(&bsdf, wo, |_, _| true);
            println!("  α = {gloss}, θo = {theta}°: ∫pdf = {z:.4}, drawn {s:.4}, ratio {:.4}", z / s);
        }
    }
}

/// The azimuth around the fibre in 36 bins, drawn and told by pdf().
fn around(bsdf: &Bsdf, wo: Vector) -> ([f64; 36], [f64; 36]) {
    let bin = |w: Vector| ((w[2].atan2(w[1]) / (2.0 * PI) + 0.5) * 36.0).min(35.0) as usize;
    let (mut drawn, mut told) = ([0.0; 36], [0.0; 36]);
    let mut random = Random(2);
    for _ in 0..DRAWS {
        if let Some((wi, ..)) = draw(bsdf, wo, &mut random) {
            drawn[bin(wi)] += 1.0 / DRAWS as f64;
        }
    }
    // Along the fibre t = sin θ and around it φ: dω = dt dφ.
    let (n, m) = (400, 360);
    for j in 0..n {
        let t = -1.0 + 2.0 * (j as f64 + 0.5) / n as f64;
        for k in 0..m {
            let phi = -PI + 2.0 * PI * (k as f64 + 0.5) / m as f64;
            let c = (1.0 - t * t).sqrt();
            let wi = [t, c * phi.cos(), c * phi.sin()];
            told[bin(wi)] += pdf(bsdf, wo, wi) * 2.0 / n as f64 * 2.0 * PI / m as f64;
        }
    }
    (drawn, told)
}

/// materials/hair.rs: the loop over lobes ends with p = 2 where pbrt's ends with
/// p = 3, so that the last lobe is never drawn.
fn hair() {
    println!("Azimuths around a white fibre, drawn against pdf(); A₃ is the last lobe's share");
    for h in [0.3, 0.8, 0.95] {
        for theta in [30.0, 60.0] {
            let hair = HairBSDF::new(h, 1.55, white(0.0), 0.3, 0.3, 2.0, None);
            let wo = at(theta, 17.0);
            let last = hair.compute_ap_pdf((1.0 - wo[0] * wo[0]).sqrt() as f32)[3];
            let (drawn, told) = around(&sum(vec![Bxdf::Hair(hair)]), wo);
            let distance: f64 = drawn.iter().zip(told).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0;
            let (worst, (d, t)) = drawn
                .iter()
                .zip(told)
                .enumerate()
                .min_by(|a, b| (a.1.0 / a.1.1).total_cmp(&(b.1.0 / b.1.1)))
                .expect("36 of them");
            println!(
                "  h = {h}, θo = {theta}°: A₃ = {last:.4}, total variation {distance:.4}; at {}° drawn {d:.5}, told {t:.5}",
                10 * worst as i32 - 175
            );
        }
    }
}

/// materials/hair.rs, i0(): ten terms of a series that is asked up to x = 12.
fn bessel() {
    let series = |x: f64, terms: u32| {
        let (mut sum, mut term) = (0.0, 1.0);
        for i in 0..terms {
            sum += term;
            term *= x * x / 4.0 / f64::from((i + 1) * (i + 1));
        }
        sum
    };
    println!("I₀ by ten terms over I₀");
    for x in [4.0, 8.0, 10.0, 12.0] {
        println!("  x = {x}: {:.4}", series(x, 10) / series(x, 60));
    }
    println!("∫pdf of black hair (its first lobe) at wo = (0, 0.6, 0.8); βm = 0.3 asks I₀ up to 1/v = 11.8");
    for beta in [0.2, 0.3, 0.35, 0.5] {
        let hair = HairBSDF::new(0.3, 1.55, white(20.0), beta, 0.3, 2.0, None);
        let told: f64 = around(&sum(vec![Bxdf::Hair(hair)]), [0.0, 0.6, 0.8]).1.iter().sum();
        println!("  βm = {beta}, 1/v = {:.1}: {told:.4}", 1.0 / hair.v[0]);
    }
}

/// core/reflection.rs:1162: F is asked with wi·wh, which is positive on both
/// sides, so that inside counts as outside.
fn inside() {
    let eta = 1.5;
    let fresnel = Fresnel::Dielectric(FresnelDielectric { eta_i: 1.0, eta_t: eta });
    println!("What rough glass (α = 0.1, η = 1.5) sends back inside, of light that arrives there");
    let lobe = MicrofacetReflection::new(white(1.0), facets(0.1, true), fresnel, None);
    let none = Fresnel::NoOp(FresnelNoOp {});
    let perfect = MicrofacetReflection::new(white(1.0), facets(0.1, true), none, None);
    for theta in [120.0, 130.0, 150.0] {
        let wo = at(theta, 17.0);
        let of = |lobe: &MicrofacetReflection| {
            integral(90.0, 180.0, 1000, |wi| f64::from(lobe.f(&v(wo), &v(wi)).c[0]) * wi[2].abs())
        };
        let f = |cos: f64| fr_dielectric(cos as f32, 1.0, eta);
        println!(
            "  θo = {theta}°: {:.4} (F = 1: {:.4}); F from inside {:.4}, from outside {:.4}",
            of(&lobe),
            of(&perfect),
            f(wo[2]),
            f(-wo[2])
        );
    }
}

/// core/reflection.rs, MicrofacetTransmission: pdf() and f() are positive for
/// facets that face away from wo, at which nothing is refracted.
fn transmission() {
    let eta = 1.5;
    println!("MicrofacetTransmission, η = 1.5: ∫pdf, share of draws, and ∫pdf where wo·wh < 0 (wh up)");
    for (alpha, visible) in [(0.1, true), (0.5, true), (1.0, true), (0.1, false), (0.5, false)] {
        let lobe = MicrofacetTransmission::new(
            white(1.0),
            facets(alpha, visible),
            1.0,
            eta,
            TransportMode::Radiance,
            None,
        );
        let bsdf = sum(vec![Bxdf::MicrofacetTrans(lobe)]);
        for theta in [30.0, 80.0, 100.0, 150.0] {
            let wo = at(theta, 17.0);
            let (from, to) = if theta < 90.0 { (90.0, 180.0) } else { (0.0, 90.0) };
            let ratio = f64::from(if theta < 90.0 { eta } else { 1.0 / eta });
            let away = |wi: Vector| {
                let wh = [0, 1, 2].map(|k| wo[k] + ratio * wi[k]);
                dot(wo, wh) * wh[2] * wo[2] < 0.0
            };
            let z = integral(from, to, 1000, |wi| pdf(&bsdf, wo, wi));
            let phantom = integral(from, to, 1000, |wi| if away(wi) { pdf(&bsdf, wo, wi) } else { 0.0 });
            let s = share(&bsdf, wo, |_, _| true);
            let astray = share(&bsdf, wo, |wi, _| away(wi));
            let kind = if visible { "visible" } else { "all" };
            println!(
                "  α = {alpha} ({kind}), θo = {theta}°: ∫pdf {z:.4}, drawn {s:.4}; facing away: ∫pdf {phantom:.4}, drawn {astray:.4}"
            );
        }
    }
}

/// core/reflection.rs:828 and 938: a specular lobe has the density cos θ/π.
fn specular() {
    println!("pdf() at a direction that a specular lobe does not go to; pbrt returns 0");
    let (wo, wi) = (at(30.0, 17.0), at(50.0, 200.0));
    let glass = FresnelSpecular::new(white(1.0), white(1.0), 1.0, 1.5, TransportMode::Radiance, None);
    let through = SpecularTransmission::new(white(1.0), 1.0, 1.5, TransportMode::Radiance, None);
    let mirror = SpecularReflection::new(white(1.0), Fresnel::NoOp(FresnelNoOp {}), None);
    for (name, lobe) in [
        ("FresnelSpecular", Bxdf::FresnelSpec(glass)),
        ("SpecularTransmission", Bxdf::SpecTrans(through)),
        ("SpecularReflection", Bxdf::SpecRefl(mirror)),
    ] {
        println!("  {name}: {:.4} (cos θi/π = {:.4})", pdf(&sum(vec![lobe]), wo, wi), wi[2] / PI);
    }
    let matte = Bxdf::LambertianRefl(LambertianReflection::new(white(0.5), None));
    let bsdf = sum(vec![Bxdf::SpecTrans(through), matte]);
    let z = integral(0.0, 90.0, 400, |wi| pdf(&bsdf, wo, wi));
    let diffuse = share(&bsdf, wo, |_, flags| flags & 16 == 0);
    // What a renderer makes of it: the mean of f cos/pdf over diffuse draws.
    let mut random = Random(3);
    let draws = (0..DRAWS).filter_map(|_| draw(&bsdf, wo, &mut random));
    let weights: f64 = draws.filter(|d| d.3 & 16 == 0).map(|(wi, f, p, _)| f * wi[2] / p).sum();
    println!("Beside a matte lobe of albedo 0.5, as UberMaterial with opacity puts it:");
    println!(
        "  ∫pdf = {z:.4}, drawn {diffuse:.4}, mean weight of the matte lobe {:.4}",
        weights / DRAWS as f64
    );
}

/// core/reflection.rs: sample_f() of a lobe multiplies by the scale of f() again.
fn scale() {
    println!("A LambertianReflection scaled by 0.3: f() against the value of sample_f()");
    let lobe = LambertianReflection::new(white(0.8), Some(white(0.3)));
    let (wo, mut wi, mut pdf, mut kind) = (v(at(30.0, 17.0)), Vector3f::default(), 0.0, 0);
    let sampled = lobe.sample_f(&wo, &mut wi, &Point2f { x: 0.3, y: 0.4 }, &mut pdf, &mut kind);
    println!("  f = {:.5}, sample_f = {:.5}", lobe.f(&wo, &wi).c[0], sampled.c[0]);
}

/// core/reflection.rs:685: FresnelConductor does not take |cos θ|.
fn conductor() {
    println!("FresnelConductor (about copper, red) at cos θ and −cos θ");
    let metal = FresnelConductor { eta_i: white(1.0), eta_t: white(0.2), k: white(3.91) };
    for theta in [0f32, 45.0, 80.0] {
        let cos = theta.to_radians().cos();
        println!("  {theta}°: {:.4}, {:.4}", metal.evaluate(cos).c[0], metal.evaluate(-cos).c[0]);
    }
}

/// core/reflection.rs: sin²θ = 1 − cos²θ, in f32.
fn precision() {
    println!("D of Trowbridge-Reitz in f32 over D in f64, the largest error of 1000 normals at tan θ = α");
    for alpha in [0.001, 0.01, 0.1] {
        let d = TrowbridgeReitzDistribution::new(alpha, alpha, true);
        let error = |phi: f64| {
            let a = f64::from(alpha);
            let w = at(a.atan().to_degrees(), phi);
            let exact = 1.0 / (PI * a * a * w[2].powi(4) * 4.0);
            (f64::from(d.d(&v(w))) / exact - 1.0).abs()
        };
        let by_azimuth = (0..1000).map(|k| error(0.36 * f64::from(k))).fold(0.0, f64::max);
        let tilted = |k: i32| {
            let a = f64::from(alpha) * (0.5 + f64::from(k) / 1000.0);
            let w = at(a.atan().to_degrees(), 17.0);
            let alpha = f64::from(alpha);
            let exact = 1.0 / (PI * alpha * alpha * w[2].powi(4) * (1.0 + (a / alpha).powi(2)).powi(2));
            (f64::from(d.d(&v(w))) / exact - 1.0).abs()
        };
        let by_tilt = (0..1000).map(tilted).fold(0.0, f64::max);
        println!(
            "  α = {alpha}: {:.2} % at tan θ = α, {:.2} % from α/2 to 3α/2",
            100.0 * by_azimuth,
            100.0 * by_tilt
        );
    }
}

/// core/microfacet.rs: cos θ in f32 lies on a grid of 6e-8 below 1, so that the
/// normals drawn lie on rings.
fn rings() {
    println!(
        "Normals drawn by Trowbridge-Reitz (all of them): distinct angles, and share along the normal exactly"
    );
    for alpha in [0.001, 0.01, 0.1] {
        let d = TrowbridgeReitzDistribution::new(alpha, alpha, false);
        let (mut random, mut angles, mut along) = (Random(5), std::collections::BTreeSet::new(), 0);
        let n = 100_000;
        for _ in 0..n {
            let m = d.sample_wh(&v([0.0, 0.0, 1.0]), &u(&mut random));
            if f64::from(m.x).hypot(m.y.into()) < f64::from(alpha) {
                angles.insert(m.z.to_bits());
            }
            along += i32::from(m.x == 0.0 && m.y == 0.0);
        }
        println!(
            "  α = {alpha}: {} angles with sin θ < α, {:.2} % along the normal",
            angles.len(),
            100.0 * f64::from(along) / f64::from(n)
        );
    }
}

/// core/reflection.rs:1203: wo·wh is rounded below 0 where both directions graze.
fn grazing() {
    let wo = Vector3f { x: 0.956_218_8, y: 0.292_652_87, z: 1e-7 };
    let wi = Vector3f { x: -0.956_218_8, y: -0.292_652_93, z: 1.524_982_5e-8 };
    let wh = (wo + wi).normalize();
    let lobe = MicrofacetReflection::new(white(1.0), facets(0.3, true), Fresnel::NoOp(FresnelNoOp {}), None);
    println!("MicrofacetReflection near wi = −wo at the horizon");
    println!("  wo·wh = {:e}, pdf = {:e}", wo.x * wh.x + wo.y * wh.y + wo.z * wh.z, lobe.pdf(&wo, &wi));
    let d = TrowbridgeReitzDistribution::new(0.01, 0.01, true);
    println!("D(α = 0.01) of a normal at cos θ = 1e-12: {}", d.d(&Vector3f { x: 1.0, y: 0.0, z: 1e-12 }));
}

/// materials/plastic.rs:99: the indices of the coat are 1.5 outside, 1 inside.
fn plastic() {
    println!("F of FresnelDielectric(1.5, 1), as PlasticMaterial makes it, and the other way round");
    for theta in [0f32, 30.0, 42.0, 60.0] {
        let cos = theta.to_radians().cos();
        println!("  {theta}°: {:.4}, {:.4}", fr_dielectric(cos, 1.5, 1.0), fr_dielectric(cos, 1.0, 1.5));
    }
}

/// materials/disney.rs: DisneyFakeSS by its formula, midpoint sums.
fn fake_ss() {
    println!("Albedo of DisneyFakeSS, colour 1");
    for roughness in [0.0, 0.5, 1.0] {
        let lobe = DisneyFakeSS::new(white(1.0), roughness, None);
        let of = |theta: f64| {
            let wo = at(theta, 17.0);
            integral(0.0, 90.0, 400, |wi| f64::from(lobe.f(&v(wo), &v(wi)).c[0]) * wi[2])
        };
        println!(
            "  roughness {roughness}: {:.3} at 0°, {:.3} at 60°, {:.3} at 85°",
            of(0.0),
            of(60.0),
            of(85.0)
        );
    }
}

/// core/reflection.rs, fr_dielectric(): 1 − F near the critical angle, in f32.
fn critical() {
    println!("1 − F from inside η = 1.5, this far below the critical angle: f32 over f64");
    let critical = (1.0f64 / 1.5).asin();
    for below in [1e-6, 1e-5, 1e-4, 1e-3] {
        let cos = (critical - below).cos();
        let sin_t = 1.5 * (1.0 - cos * cos).sqrt();
        let cos_t = (1.0 - sin_t * sin_t).max(0.0).sqrt();
        let p = (cos - 1.5 * cos_t) / (cos + 1.5 * cos_t);
        let s = (1.5 * cos - cos_t) / (1.5 * cos + cos_t);
        let exact = 1.0 - (p * p + s * s) / 2.0;
        let found = 1.0 - f64::from(fr_dielectric(-cos as f32, 1.0, 1.5));
        println!("  {below:e} rad: {:.4}", found / exact);
    }
}

/// core/reflection.rs: an index of 1 makes a half vector of length 0, and
/// normalize() refuses it.
fn matched() {
    println!("MicrofacetTransmission of η = 1 straight through");
    let lobe =
        MicrofacetTransmission::new(white(1.0), facets(0.3, true), 1.0, 1.0, TransportMode::Radiance, None);
    let wo = at(30.0, 17.0);
    std::panic::set_hook(Box::new(|_| {}));
    let told = std::panic::catch_unwind(|| lobe.pdf(&v(wo), &v(wo.map(|x| -x))));
    let _ = std::panic::take_hook();
    println!("  pdf(wo, −wo): {}", told.map_or("panics".into(), |p| p.to_string()));
}

/// core/reflection.rs, FourierBSDF::sample_f(): the azimuth is turned from that
/// of wo, and a wo along the normal has none.
fn fourier() {
    const NODES: usize = 81;
    let node = |k: usize| -1.0 + 2.0 * k as f32 / (NODES - 1) as f32;
    let mut table = FourierBSDFTable {
        eta: 1.0,
        m_max: 1,
        n_channels: 1,
        n_mu: NODES as i32,
        mu: (0..NODES).map(node).collect(),
        recip: vec![f32::INFINITY],
        cdf: vec![0.0; NODES * NODES],
        ..Default::default()
    };
    for o in 0..NODES {
        for i in 0..NODES {
            // f cos θi = cos²θi |cos θo|/π, reflected: mu_i is that of −wi.
            let a = if node(o) * node(i) < 0.0 { node(i).powi(2) * node(o).abs() / PI as f32 } else { 0.0 };
            table.a_offset.push(table.a.len() as i32);
            table.m.push(1);
            table.a.push(a);
            table.a0.push(a);
        }
        integrate_catmull_rom(NODES as i32, &table.mu, o * NODES, &table.a0, &mut table.cdf);
    }
    let bsdf = sum(vec![Bxdf::Fourier(FourierBSDF::new(Arc::new(table), TransportMode::Radiance, None))]);
    println!(
        "FourierBSDF of cos²θi: mean cos θi and sin θi of draws; 0.750 and 0.589 of the density 3 cos²θi/2π"
    );
    for theta in [0.0, 0.01, 0.1, 30.0] {
        let wo = at(theta, 17.0);
        let (mut random, n) = (Random(4), 100_000);
        let (mut cos, mut sin, mut nan) = (0.0, 0.0, 0);
        for _ in 0..n {
            if let Some((wi, ..)) = draw(&bsdf, wo, &mut random) {
                if wi[2].is_nan() {
                    nan += 1;
                } else {
                    cos += wi[2] / f64::from(n);
                    sin += wi[0].hypot(wi[1]) / f64::from(n);
                }
            }
        }
        println!("  θo = {theta}°: {cos:.3}, {sin:.3}; {nan} not a number");
    }
}

/// core/microfacet.rs:138: Λ of Beckmann is the rational fit of Walter et al.
fn beckmann() {
    println!("Beckmann, all visible normals: ∫ G1 max(0, wo·m) D/cos θo dm, 1 if G1 were exact");
    for alpha in [0.1, 0.5, 1.0] {
        for theta in [30.0, 60.0, 80.0, 89.0] {
            let d = BeckmannDistribution::new(alpha, alpha, true);
            let wo = at(theta, 17.0);
            let z = integral(0.0, 90.0, 1500, |m| {
                if dot(wo, m) > 0.0 { f64::from(d.pdf(&v(wo), &v(m))) } else { 0.0 }
            });
            println!("  α = {alpha}, θo = {theta}°: {z:.5}");
        }
    }
}

type Finding = (&'static str, fn());

fn main() {
    let findings: [Finding; 17] = [
        ("clearcoat", clearcoat),
        ("hair", hair),
        ("bessel", bessel),
        ("fourier", fourier),
        ("precision", precision),
        ("rings", rings),
        ("matched", matched),
        ("grazing", grazing),
        ("plastic", plastic),
        ("fake-ss", fake_ss),
        ("critical", critical),
        ("inside", inside),
        ("transmission", transmission),
        ("specular", specular),
        ("scale", scale),
        ("conductor", conductor),
        ("beckmann", beckmann),
    ];
    let wanted = std::env::args().nth(1);
    for (name, show) in findings {
        if wanted.as_deref().is_none_or(|w| w == name) {
            println!("[{name}]");
            show();
        }
    }
}
