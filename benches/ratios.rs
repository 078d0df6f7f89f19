//! Ratios that say what gonio costs: `cargo bench --bench ratios`. Machines are
//! noisy, so each figure is a median of ratios measured in turn in one run, or
//! a count of operations.

use gonio::bsdf::{Bsdf, Direction, Samples, Subject, Transport};
use gonio::engine::{Options, run, run_here};
use gonio::evidence::Evaluations;
use gonio::models::microfacet::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use gonio::statistics::streams::StreamKey;
use gonio::suite::{Case, Plan, Settings};
use std::sync::Arc;
use std::time::Instant;

fn ggx(alpha: f64) -> TorranceSparrow {
    let distribution = Distribution::ggx(Roughness::isotropic(alpha));
    TorranceSparrow::new(distribution, Masking::Smith, Fresnel::None, NormalSampling::Visible)
        .expect("GGX has visible normals")
}

fn plan(cases: impl IntoIterator<Item = (f64, f64)>, samples: u64, checks: &[&str]) -> Plan<'static> {
    let cases = cases.into_iter().map(|(alpha, theta)| {
        Arc::new(Case {
            group: "ggx".into(),
            spelling: format!("ggx-{alpha}"),
            source: None,
            subject: Arc::new(ggx(alpha)),
            parameters: Default::default(),
            theta_deg: theta,
            phi_deg: 17.0,
            transport: Transport::Radiance,
            claims: Default::default(),
            waivers: Vec::new(),
            company: Default::default(),
            reference: None,
            checks: checks.iter().map(|c| (*c).to_string()).collect(),
            settings: Settings { samples, ..Settings::default() },
        })
    });
    Plan { suite: "bench".into(), seed: 1, false_alarm: 1e-6, share: None, cases: cases.collect() }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Blocks of random numbers that raw calls go through in turn: with a single
/// one the processor would learn its branches by heart.
const BLOCKS: u64 = 64;

/// The same functions as often as the harness called them, and nothing else.
fn raw(subject: &dyn Subject, wo: Direction, calls: Evaluations, blocks: &[Vec<f64>]) -> f64 {
    let start = Instant::now();
    let mut sum = 0.0;
    let mut samples = Samples::default();
    let mut value = vec![0.0; 4096];
    let mut drawn = 0;
    for u in blocks.iter().cycle() {
        samples.clear(1);
        subject.sample(wo, u, Transport::Radiance, &mut samples).expect("it samples");
        drawn += samples.len() as u64;
        if drawn >= calls.sample {
            break;
        }
    }
    let wi = samples.wi.clone();
    for _ in 0..calls.eval / wi.len() as u64 {
        subject.eval(wo, &wi, Transport::Radiance, &mut value[..wi.len()]).expect("it evaluates");
        sum += value[0];
    }
    for _ in 0..calls.pdf / wi.len() as u64 {
        subject.pdf(wo, &wi, Transport::Radiance, &mut value[..wi.len()]).expect("it evaluates");
        sum += value[0];
    }
    std::hint::black_box(sum);
    start.elapsed().as_secs_f64()
}

/// As [`raw`], a direction a call, as an author writes them: GGX draws many at once faster
/// than that, which the harness uses.
fn one_by_one(bsdf: &TorranceSparrow, wo: Direction, calls: Evaluations, blocks: &[Vec<f64>]) -> f64 {
    let start = Instant::now();
    let dimensions = Bsdf::describe(bsdf).dimensions;
    let mut wi = Vec::new();
    let mut sum = 0.0;
    let rows = blocks.iter().cycle().flat_map(|u| u.chunks_exact(dimensions));
    for (k, u) in rows.take(calls.sample as usize).enumerate() {
        let Some(sample) = Bsdf::sample(bsdf, wo, u, Transport::Radiance) else { continue };
        sum += sample.weight[0];
        if k < 4096 {
            wi.push(sample.wi);
        }
    }
    for wi in wi.iter().cycle().take(calls.eval as usize) {
        sum += Bsdf::eval(bsdf, wo, *wi, Transport::Radiance)[0];
    }
    for wi in wi.iter().cycle().take(calls.pdf as usize) {
        sum += Bsdf::pdf(bsdf, wo, *wi, Transport::Radiance);
    }
    std::hint::black_box(sum);
    start.elapsed().as_secs_f64()
}

fn overhead() {
    for alpha in [0.5, 0.1, 0.01] {
        let plan = plan([(alpha, 60.0)], 1 << 20, &[]);
        let subject = ggx(alpha);
        let wo = plan.cases[0].wo();
        let dimensions = Bsdf::describe(&subject).dimensions;
        let block = |k| {
            let mut u = vec![0.0; 4096 * dimensions];
            StreamKey::new(1).block(k).fill(false, &mut u);
            u
        };
        let blocks: Vec<Vec<f64>> = (0..BLOCKS).map(block).collect();
        let (mut ratios, mut singly) = (Vec::new(), Vec::new());
        let mut calls = Evaluations::default();
        for _ in 0..9 {
            let start = Instant::now();
            let results = run_here(&plan, &Options::default());
            let harness = start.elapsed().as_secs_f64();
            calls = results.cases[0].evidence.as_ref().expect("it ran").evaluations;
            ratios.push(harness / raw(&subject, wo, calls, &blocks));
            singly.push(harness / one_by_one(&subject, wo, calls, &blocks));
        }
        println!(
            "harness / raw calls, GGX alpha {alpha}, 2^20 draws, all checks ({} sample, {} eval, {} pdf): {:.2} in batches, {:.2} one by one",
            calls.sample,
            calls.eval,
            calls.pdf,
            median(ratios),
            median(singly)
        );
    }
}

fn parallel() {
    let plan = plan((0..24).map(|k| (0.1, f64::from(k) * 3.0)), 1 << 19, &[]);
    let time = |threads| {
        let start = Instant::now();
        run(&plan, &Options { threads: Some(threads), ..Options::default() }, &mut |_| {});
        start.elapsed().as_secs_f64()
    };
    let ratios = (0..5).map(|_| time(1) / (2.0 * time(2))).collect();
    println!("parallel efficiency on 2 threads, 24 cases: {:.2}", median(ratios));
}

fn integration() {
    println!("evaluations of pdf, and error of its mass, to integrate a GGX pdf:");
    for alpha in [1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001] {
        let results = run_here(
            &plan([0.0, 30.0, 60.0, 75.0, 85.0, 89.0].map(|t| (alpha, t)), 1 << 18, &["normalization"]),
            &Options::default(),
        );
        let cells: Vec<String> = results
            .cases
            .iter()
            .filter_map(|c| c.evidence.as_ref()?.integrals.as_ref())
            .map(|i| format!("{:>7} {:.0e}", i.evaluations, i.mass().1))
            .collect();
        println!("  alpha {alpha:<6} {}", cells.join("  "));
    }
}

fn main() {
    overhead();
    parallel();
    integration();
}
