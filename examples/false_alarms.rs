//! How often correct subjects fail: the quick suite over many seeds.
//!
//! `cargo run --release --example false_alarms -- 1000` prints the failures, the
//! rate that their number excludes, the suspicions that a second look
//! dismissed, and whether the ε = 0 p-values of independent levels are uniform.

use gonio::checks::{Verdict, level_p_values};
use gonio::engine::{Options, run};
use gonio::registry::Registry;
use gonio::statistics::binomial::proportion_interval;
use gonio::statistics::uniformity::kolmogorov_smirnov;
use gonio::suite::{Overrides, embedded, load};

fn main() {
    let arguments: Vec<u64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let seeds = arguments.first().copied().unwrap_or(100);
    let first = arguments.get(1).copied().unwrap_or(1);
    let quick = embedded("quick").expect("the quick suite comes with gonio");
    let registry = Registry::builtin();
    let (mut failed, mut suspicions, mut attempts, mut undecided) = (0u64, 0u64, 0u64, 0u64);
    let mut p_values = Vec::new();
    let mut share = 0.0;
    for seed in first..first + seeds {
        let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
        let plan = load(quick.name, quick.text, &registry, &overrides).expect("the suite is right").plan;
        let results = run(&plan, &Options::default(), &mut |_| {});
        share = results.share;
        let findings = results.cases.iter().flat_map(|c| c.findings.iter().map(move |f| (c, f)));
        for (case, finding) in findings {
            attempts += u64::from(!finding.attempts.is_empty());
            let suspected = finding.attempts.len() > 1;
            suspicions += u64::from(suspected);
            match finding.outcome.verdict {
                Verdict::Fail | Verdict::Error | Verdict::Warn => {
                    failed += 1;
                    let message = &finding.outcome.message;
                    println!("seed {seed}: {} {}: {message}", case.case.label(), finding.check);
                }
                Verdict::Inconclusive if !suspected => undecided += 1,
                _ => {}
            }
        }
        p_values.extend(results.cases.iter().filter_map(|c| c.evidence.as_ref()).flat_map(level_p_values));
    }
    let (_, high) = proportion_interval(failed, seeds, 0.05);
    println!("{seeds} runs of the quick suite (seeds {first} to {}): {failed} failures", first + seeds - 1);
    println!("  excludes a rate of failing runs above {high:.1e} (95 %); the budget is 1e-6 a run");
    let nominal = share.sqrt() * attempts as f64;
    println!(
        "  {attempts} statistical tests; {suspicions} suspicions, none confirmed unless listed above \
         (at most {nominal:.1} expected: each attempt spends {:.1e})",
        share.sqrt()
    );
    println!("  {undecided} results undecided for other reasons");
    let count = p_values.len();
    let small = p_values.iter().filter(|p| **p < 1e-3).count();
    let (low, high) = proportion_interval(small as u64, count as u64, 0.025);
    let (d, p) = kolmogorov_smirnov(&mut p_values);
    println!(
        "  {count} p-values of independent levels (fixed N, ε = 0): Kolmogorov–Smirnov D = {d:.5}, p = {p:.3}"
    );
    println!("  of these {small} below 1e-3: {:.2e} ({low:.2e} to {high:.2e})", small as f64 / count as f64);
}
