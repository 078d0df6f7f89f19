//! How often the fixed-grid χ² tests of renderers reject correct models.
//!
//! `cargo run --release --example fixed_grids -- 20` prints, for 20 seeds with an
//! azimuth of wo each, the rejections at 0.01 by each recipe, the range of its
//! ∫pdf, and what a test costs (milliseconds by the clock).

use gonio::bsdf::{Direction, Transport};
use gonio::calibration::fixed_grid::{FixedGrid, RECIPES};
use gonio::registry::Registry;
use gonio::statistics::binomial::proportion_interval;
use gonio::statistics::streams::StreamKey;
use std::f64::consts::TAU;
use std::time::Instant;

const THETAS: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 89.0];
const ALPHAS: [f64; 7] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seeds: u64 = std::env::args().nth(1).map_or(Ok(20), |a| a.parse())?;
    let mut models = vec!["lambert".to_string()];
    models.extend(ALPHAS.map(|alpha| format!("torrance-sparrow:alpha={alpha}")));
    for grid in RECIPES {
        println!("{} ({} × {} cells, {} samples)", grid.name, grid.theta, grid.phi, grid.samples);
        println!("{:28}  θ  rejected    pdf evaluations    ∫pdf from to     ms pdf  ms draws", "");
        let (mut rejected, mut tests) = (0, 0);
        for name in &models {
            for theta in THETAS {
                rejected += sweep(&grid, name, theta, seeds)?;
                tests += seeds;
            }
        }
        let (low, high) = proportion_interval(rejected, tests, 0.025);
        println!("{}: {rejected} of {tests} rejected ({low:.4} to {high:.4}, 95 %)\n", grid.name);
    }
    Ok(())
}

/// The number of rejections at one angle in degrees.
fn sweep(grid: &FixedGrid, name: &str, theta: f64, seeds: u64) -> Result<u64, Box<dyn std::error::Error>> {
    let subject = Registry::builtin().resolve(&name.parse()?)?.subject;
    let key = StreamKey::new(1).with("subject", name).with("theta", &theta.to_string());
    let (mut rejected, mut evaluations) = (0, 0);
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    let mut times = [0.0; 2];
    for seed in 0..seeds {
        let key = key.with("seed", &seed.to_string());
        let wo = Direction::from_angles(theta.to_radians(), TAU * key.block(0).next_f64());
        let start = Instant::now();
        let expected = grid.expect(&*subject, wo, Transport::Radiance)?;
        times[0] += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let observed = grid.observe(&*subject, wo, Transport::Radiance, grid.samples, &key)?;
        times[1] += start.elapsed().as_secs_f64();
        rejected += u64::from(grid.compare(&expected, &observed).rejected);
        let mass: f64 = expected.probability.iter().sum();
        (low, high) = (low.min(mass), high.max(mass));
        evaluations += expected.evaluations;
    }
    let [pdf, draws] = times.map(|t| 1e3 * t / seeds as f64);
    println!(
        "{name:28} {theta:2} {rejected:>6}/{seeds} {:>18} {low:9.5} {high:8.5} {pdf:9.1} {draws:9.1}",
        evaluations / seeds
    );
    Ok(rejected)
}
