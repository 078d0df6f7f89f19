//! What a route costs: the same GGX in every language, in batches of several sizes.
//! `cargo bench --bench plugins` prints million samples, evals and pdfs a second of one
//! thread (its plugin's process runs beside it), and what a call of one row takes.

#[path = "../tests/common/languages.rs"]
mod languages;
#[path = "../tests/common/tools.rs"]
mod tools;

use gonio::bsdf::{Direction, Samples, Subject, Transport};
use gonio::plugins::Limits;
use gonio::registry::Registry;
use std::sync::Arc;
use std::time::Instant;

const BATCHES: [usize; 6] = [64, 512, 4096, 8192, 16_384, 65_536];

/// Rows of each measurement: some tenths of a second.
const ROWS: usize = 1 << 19;

fn main() {
    let in_process = Registry::builtin().limited(&Limits { in_process: true, ..Limits::default() });
    let of = |registry: &Registry, spelling: &str| {
        registry.resolve(&spelling.parse().expect("a spelling")).expect("a subject").subject
    };
    let mut subjects: Vec<(String, Arc<dyn Subject>)> = Vec::new();
    for (language, spelling) in languages::languages().all(0.3) {
        if language == "C" {
            subjects.push(("C, in process".into(), of(&in_process, &spelling)));
        }
        subjects.push((language.into(), of(&Registry::builtin(), &spelling)));
    }
    print!("{:14} {:>9}", "million rows/s", "µs a call");
    for batch in BATCHES {
        print!(" {:>20}", format!("{batch}: s/e/p"));
    }
    println!();
    for (name, subject) in &subjects {
        let mut meter = Meter::new(&**subject, 1);
        print!("{name:14} {:9.2}", 1.0 / rate(ROWS / 256, 1, || meter.pdf()));
        for batch in BATCHES {
            let mut meter = Meter::new(&**subject, batch);
            let sample = rate(ROWS, batch, || meter.sample());
            let eval = rate(ROWS, batch, || meter.eval());
            let pdf = rate(ROWS, batch, || meter.pdf());
            print!(" {:>20}", format!("{sample:.1}/{eval:.1}/{pdf:.1}"));
        }
        println!();
    }
}

/// Million rows a second: the best of three.
fn rate(rows: usize, batch: usize, mut call: impl FnMut()) -> f64 {
    let calls = rows.div_ceil(batch);
    let seconds = (0..3).map(|_| {
        let start = Instant::now();
        (0..calls).for_each(|_| call());
        start.elapsed().as_secs_f64()
    });
    (calls * batch) as f64 / seconds.fold(f64::INFINITY, f64::min) / 1e6
}

/// A subject and a batch to call it with.
struct Meter<'a> {
    subject: &'a dyn Subject,
    wo: Direction,
    u: Vec<f64>,
    wi: Vec<Direction>,
    samples: Samples,
    out: Vec<f64>,
}

impl<'a> Meter<'a> {
    fn new(subject: &'a dyn Subject, batch: usize) -> Self {
        let u: Vec<f64> = (0..2 * batch).map(|k| (0.5 + k as f64 * 0.618_033_988_749_895).fract()).collect();
        let wi = u.chunks(2).map(|u| Direction::from_angles(1.5 * u[0], 6.0 * u[1])).collect();
        let wo = Direction::from_angles(1.0, 0.3);
        Self { subject, wo, u, wi, samples: Samples::default(), out: vec![0.0; batch] }
    }

    fn sample(&mut self) {
        self.samples.clear(1);
        self.subject.sample(self.wo, &self.u, Transport::Radiance, &mut self.samples).expect("samples");
    }

    fn eval(&mut self) {
        self.subject.eval(self.wo, &self.wi, Transport::Radiance, &mut self.out).expect("values");
    }

    fn pdf(&mut self) {
        self.subject.pdf(self.wo, &self.wi, Transport::Radiance, &mut self.out).expect("densities");
    }
}
