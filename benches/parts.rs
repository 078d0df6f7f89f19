//! Times of the parts that a run spends its time in: `cargo bench --bench parts`.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use gonio::bsdf::{Samples, Spectrum, Subject, Transport};
use gonio::measured::{MerlTable, Reading, Resolution, Rgl, read};
use gonio::models::microfacet::{Distribution, Fresnel, Masking, NormalSampling, Roughness, TorranceSparrow};
use gonio::sphere::{Chart, Partition, Point};
use gonio::statistics::noncentral;
use gonio::statistics::streams::StreamKey;

const ROWS: usize = 4096;

fn parts(criterion: &mut Criterion) {
    let distribution = Distribution::ggx(Roughness::isotropic(0.1));
    let ggx = TorranceSparrow::new(distribution, Masking::Smith, Fresnel::None, NormalSampling::Visible)
        .expect("GGX has visible normals");
    let subject: &dyn Subject = &ggx;
    let wo = gonio::bsdf::Direction::from_angles(1.0, 0.3);
    let mut u = vec![0.0; ROWS * subject.describe().dimensions];
    StreamKey::new(1).block(0).fill(false, &mut u);
    let mut samples = Samples::default();
    samples.clear(1);
    subject.sample(wo, &u, Transport::Radiance, &mut samples).expect("it samples");
    let chart = Chart::new(wo.phi());
    let points: Vec<Point> = samples.wi.iter().map(|wi| chart.to_point(*wi)).collect();
    let pilot: Vec<Point> = points.iter().cycle().take(1 << 15).copied().collect();
    let partition = Partition::build(chart, pilot.clone(), 1024);

    let mut group = criterion.benchmark_group("a direction");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.bench_function("sample GGX", |b| {
        b.iter(|| {
            samples.clear(1);
            subject.sample(wo, &u, Transport::Radiance, &mut samples)
        })
    });
    let directions = samples.wi.clone();
    let mut mapped = Vec::new();
    group.bench_function("map to the square", |b| b.iter(|| chart.to_points(&directions, &mut mapped)));
    let mut leaves = Vec::new();
    group.bench_function("find the cell", |b| b.iter(|| partition.locate_all(&points, &mut leaves)));
    group.bench_function("draw u", |b| b.iter(|| StreamKey::new(1).block(0).fill(false, &mut u)));
    group.finish();

    criterion.bench_function("build a partition of 1024 cells", |b| {
        b.iter_batched(|| pilot.clone(), |pilot| Partition::build(chart, pilot, 1024), BatchSize::LargeInput)
    });
    criterion.bench_function("tail of the non-central chi-square, 1023 degrees of freedom", |b| {
        b.iter(|| noncentral::ln_sf(std::hint::black_box(1200.0), 1023.0, 10.0))
    });
}

/// Reading, validating and making ready: a MERL file of 35 MB, and an RGL file.
fn files(criterion: &mut Criterion) {
    let merl = MerlTable::bake(|wo, wi| [0.2, 0.1 + 0.1 * wo.dot(wi).abs(), 0.3]);
    let rgl = Rgl::bake("grey", &[], 0.5, &Resolution::default(), |_, _| Spectrum::uniform(3, 0.2));
    let mut group = criterion.benchmark_group("open");
    group.sample_size(10);
    group.bench_function("MERL", |b| b.iter(|| read(&merl, &Reading::default()).expect("a table")));
    group.bench_function("RGL", |b| b.iter(|| read(&rgl, &Reading::default()).expect("a table")));
    group.finish();
}

criterion_group!(benches, parts, files);
criterion_main!(benches);
