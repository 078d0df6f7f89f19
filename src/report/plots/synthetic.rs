//! Evidence of made-up lobes, for tests of pictures.

use crate::bsdf::{Description, Direction, Transport};
use crate::evidence::{Draws, Evaluations, Evidence, Integrals, Pairs, Place, Sanity, Tally};
use crate::sphere::{Cell, Chart, Partition, Point};
use crate::statistics::streams::{Stream, StreamKey};
use std::f64::consts::TAU;

/// A mixture on the disc: a round bump, and the cosine.
#[derive(Clone, Copy)]
pub struct Lobe {
    /// Standard deviation of the bump.
    pub width: f64,
    /// Share of the cosine.
    pub cosine: f64,
    /// Share of the bump that goes to the back.
    pub back: f64,
}

impl Lobe {
    fn draw(&self, middle: Point, chart: &Chart, stream: &mut Stream) -> Direction {
        if stream.next_f64() < self.cosine {
            let (r, turn) = (stream.next_f64().sqrt(), TAU * stream.next_f64());
            return Direction::new(r * turn.cos(), r * turn.sin(), (1.0 - r * r).sqrt());
        }
        let front = stream.next_f64() >= self.back;
        loop {
            let r = self.width * (-2.0 * (1.0 - stream.next_f64()).ln()).sqrt();
            let turn = TAU * stream.next_f64();
            let at = [middle[0] + r * turn.cos(), middle[1] + r * turn.sin()];
            if let Some(d) = chart.from_disc(at, front) {
                return d;
            }
        }
    }

    /// Relative to the bump's and the cosine's own totals.
    fn densities(&self, middle: Point, chart: &Chart, d: Direction) -> (f64, f64) {
        let [x, y] = chart.to_disc(d);
        let square = ((x - middle[0]).powi(2) + (y - middle[1]).powi(2)) / (self.width * self.width);
        let share = if d.z > 0.0 { 1.0 - self.back } else { self.back };
        (share * (-0.5 * square).exp(), d.z.max(0.0))
    }
}

/// Integrals of both parts over a cell, cut until it is small beside the bump.
fn integrate(lobe: &Lobe, middle: Point, chart: &Chart, cell: Cell, depth: u32) -> (f64, f64) {
    let at = |s: f64, t: f64| chart.to_disc(chart.to_direction(cell.at(s, t)));
    let [a, b, c] = [at(0.5, 0.5), at(0.01, 0.01), at(0.99, 0.99)];
    let gap = |p: Point, q: Point| (p[0] - q[0]).hypot(p[1] - q[1]);
    let extent = gap(a, b).max(gap(a, c));
    let near = gap(a, middle) < 6.0 * lobe.width + 1.5 * extent;
    if depth < 16 && (extent > 0.2 || near && extent > 0.4 * lobe.width) {
        let axis = usize::from(cell.hi[1] - cell.lo[1] > cell.hi[0] - cell.lo[0]);
        let parts = cell.split(axis, cell.middle(axis));
        let [l, r] = parts.map(|part| integrate(lobe, middle, chart, part, depth + 1));
        return (l.0 + r.0, l.1 + r.1);
    }
    let node = 0.5 - 0.5 / 3f64.sqrt();
    let (mut bump, mut cosine) = (0.0, 0.0);
    for (s, t) in [(node, node), (node, 1.0 - node), (1.0 - node, node), (1.0 - node, 1.0 - node)] {
        let (x, y) = lobe.densities(middle, chart, chart.to_direction(cell.at(s, t)));
        bump += 0.25 * x * cell.area();
        cosine += 0.25 * y * cell.area();
    }
    (bump, cosine)
}

fn masses(lobe: &Lobe, middle: Point, partition: &Partition) -> Vec<f64> {
    let parts: Vec<(f64, f64)> = (0..partition.len())
        .map(|leaf| integrate(lobe, middle, partition.chart(), partition.leaf_cell(leaf), 0))
        .collect();
    let (a, b) = parts.iter().fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
    parts.iter().map(|(x, y)| (1.0 - lobe.cosine) * x / a + lobe.cosine * y / b).collect()
}

/// Evidence at θo, φo (degrees) of a sampler that draws `sampled` and a pdf
/// that says `claimed`.
pub fn evidence(subject: &str, theta: f64, phi: f64, claimed: Lobe, sampled: Lobe) -> Evidence {
    measured(subject, (theta, phi), claimed, sampled, 0.0)
}

/// Evidence of a sampler whose lobe lies `turn` degrees of azimuth beside the one that
/// pdf says.
pub fn turned(subject: &str, theta: f64, phi: f64, lobe: Lobe, turn: f64) -> Evidence {
    measured(subject, (theta, phi), lobe, lobe, turn)
}

fn measured(subject: &str, (theta, phi): (f64, f64), claimed: Lobe, sampled: Lobe, turn: f64) -> Evidence {
    let wo = Direction::from_angles(theta.to_radians(), phi.to_radians());
    let chart = Chart::new(wo.phi());
    let middle = chart.to_disc(wo.mirrored());
    let beside = chart.to_disc(wo.mirrored().rotated(turn.to_radians()));
    let key = StreamKey::new(7).with("subject", subject);
    let draw = |lobe: &Lobe, n: usize, block: u64| -> Vec<Point> {
        let mut stream = key.block(block);
        (0..n).map(|_| chart.to_point(lobe.draw(beside, &chart, &mut stream))).collect()
    };
    let partition = Partition::build(chart, draw(&sampled, 1 << 15, 0), 1024);
    let pdf = masses(&claimed, middle, &partition);
    let n = 1 << 18;
    let mut draws = Draws::new(0, partition.len(), 3);
    draws.samples = n as u64;
    for point in draw(&sampled, n, 1) {
        draws.counts[partition.locate(point)] += 1;
    }
    let albedo = |c: usize| 0.9 - 0.2 * c as f64 - 0.002 * theta;
    draws.weight.count = n as u64;
    for c in 0..3 {
        let noise = 1.0 + 1e-3 * (c as f64 - 1.0) * (theta / 10.0).sin();
        draws.weight.sum[c] = albedo(c) * n as f64 * noise;
        draws.weight.square[c] = albedo(c) * albedo(c) * n as f64 * 1.1;
    }
    let integrals = Integrals {
        pdf_error: vec![0.0; pdf.len()],
        value: pdf.iter().flat_map(|p| [0, 1, 2].map(|c| p * albedo(c))).collect(),
        value_error: vec![1e-6; 3],
        second: vec![1.0; 3],
        second_error: vec![1e-6; 3],
        lost: 0.0,
        largest_weight: 1.0,
        largest_balanced: 1.0,
        converged: true,
        values_converged: true,
        cross_check: (1.0, 1e-4),
        evaluations: 1 << 17,
        pdf,
    };
    let mut stream = key.block(2);
    let map: Vec<(Direction, f64)> = (0..1024)
        .map(|_| {
            let d = Direction::from_angles((1.0 - stream.next_f64()).acos(), TAU * stream.next_f64());
            (d, 0.3 * (d.z - wo.z))
        })
        .collect();
    let mut reciprocity = Tally::new(1e-9);
    for (_, signed) in &map {
        reciprocity.look(signed.abs(), Place::default);
    }
    Evidence {
        subject: subject.into(),
        description: Description::new(subject).channels(["red", "green", "blue"]),
        wo,
        transport: Transport::Radiance,
        cosine_found: None,
        sanity: Sanity::default(),
        samples: None,
        pairs: Some(Pairs { map, reciprocity, ..Pairs::default() }),
        repeats: None,
        rotations: None,
        jacobian: None,
        variations: None,
        two_sided: None,
        given: None,
        partition: Some(partition),
        integrals: Some(integrals),
        draws: vec![draws],
        reference: None,
        facets: None,
        fresnel: None,
        evaluations: Evaluations::default(),
        halts: Vec::new(),
        corners: None,
    }
}

/// A broad, a narrow, a two-sided and two wrong ones, by name.
pub fn gallery() -> Vec<(&'static str, Evidence)> {
    let broad = Lobe { width: 0.3, cosine: 0.4, back: 0.0 };
    let narrow = Lobe { width: 0.007, cosine: 0.0, back: 0.0 };
    let glass = Lobe { width: 0.06, cosine: 0.0, back: 0.7 };
    let hidden = Lobe { cosine: 0.01, ..narrow };
    let grazing = Lobe { width: 0.02, cosine: 0.0, back: 0.0 };
    let wide = Lobe { width: 0.33, ..broad };
    let name = "ggx-conductor:alpha=0.5,eta=0.2 + 3.9i,tint=<a & b>";
    vec![
        ("broad", evidence(name, 30.0, 17.0, broad, broad)),
        ("narrow", evidence("ggx:alpha=0.01", 45.0, 137.0, narrow, narrow)),
        ("glass", evidence("rough-glass:alpha=0.1", 30.0, 257.0, glass, glass)),
        ("wrong", evidence("ggx:alpha=0.5", 60.0, 17.0, broad, wide)),
        ("hidden", evidence("ggx:alpha=0.01,coat=0.01", 45.0, 17.0, narrow, hidden)),
        ("grazing", evidence("ggx:alpha=0.02", 88.0, 17.0, grazing, Lobe { width: 0.024, ..grazing })),
        ("normal", evidence("ggx:alpha=0.01", 0.0, 0.0, narrow, narrow)),
    ]
}
