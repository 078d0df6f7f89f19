//! Curves: albedo against angle, and the p-values of a run.

use super::axes::{Axes, mark};
use super::colours::{BAND, LINES, Rgb, SOFT_INK};
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::histogram::Histogram;
use crate::bsdf::{SubjectKind, Transport};
use crate::evidence::Evidence;
use crate::statistics::uniformity::kolmogorov_smirnov;

pub(super) const WIDTH: f64 = 760.0;

/// A deviation of a mean beyond this is drawn at the edge, in standard errors.
const MOST_DEVIATIONS: f64 = 6.0;

/// Bins of the histogram of p-values.
const BINS: usize = 20;

/// One estimate of one case and channel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    theta: f64,
    found: f64,
    /// Standard error of `found`.
    error: f64,
    expected: f64,
    /// What is joined by a line: one azimuth, one mode.
    series: (i64, bool),
}

fn points(cases: &[&Evidence], channel: usize) -> Vec<Point> {
    let mut points: Vec<Point> = cases
        .iter()
        .filter_map(|case| {
            let integrals = case.integrals.as_ref()?;
            let draws = case.draws.first().filter(|d| d.weight.count > 0)?;
            // Saved evidence may come from anywhere.
            let sums = draws.weight.sum.len().min(draws.weight.square.len());
            if channel >= sums.min(integrals.value_error.len()) {
                return None;
            }
            let (found, variance) = draws.weight.moments(channel);
            let discrete: f64 = draws
                .discrete
                .iter()
                .map(|d| d.probability * d.weight.get(channel).unwrap_or(&f64::NAN))
                .sum();
            let degrees = case.wo.phi().to_degrees();
            Some(Point {
                theta: case.wo.theta().to_degrees(),
                found,
                error: (variance / draws.weight.count as f64).sqrt(),
                expected: integrals.albedo(channel).0 + discrete,
                series: ((degrees * 1e6).round() as i64, case.transport == Transport::Importance),
            })
        })
        .filter(|p| p.found.is_finite() && p.error.is_finite() && p.expected.is_finite())
        .collect();
    // Azimuth means nothing on the normal: such a case belongs to the first line.
    let on_normal = |p: &Point| p.theta < 1e-6 || p.theta > 180.0 - 1e-6;
    let first = points.iter().filter(|p| !on_normal(p)).map(|p| p.series).min();
    for point in points.iter_mut().filter(|p| on_normal(p)) {
        let azimuth = first.map_or(point.series.0, |series| series.0);
        point.series.0 = azimuth;
    }
    points.sort_by(|a, b| a.series.cmp(&b.series).then(a.theta.total_cmp(&b.theta)));
    points
}

/// Albedo against θo of a subject's cases: the mean weight of samples with two
/// standard errors, and the integral. Below it their difference, which the
/// curves are too coarse to show. `None` where fewer than two angles have both.
pub fn albedo(subject: &str, cases: &[&Evidence]) -> Option<String> {
    let first = cases.first()?;
    // The area of normals is 1 from everywhere, and no albedo.
    if first.description.kind != SubjectKind::Bsdf {
        return None;
    }
    if !(first.description.has.eval && first.description.has.sample) {
        return None;
    }
    let names: Vec<&String> = first.description.channels.iter().take(LINES.len()).collect();
    let channels: Vec<Vec<Point>> = (0..names.len()).map(|c| points(cases, c)).collect();
    let all = || channels.iter().flatten();
    let mut angles: Vec<f64> = all().map(|p| p.theta).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    // Two points are no curve.
    if angles.len() < 3 {
        return None;
    }
    let right = if angles.iter().any(|a| *a > 90.0) { 180.0 } else { 90.0 };
    let top = all().map(|p| p.expected.max(p.found + 2.0 * p.error)).fold(0.0, f64::max);
    let top = if top <= 1.0 { 1.05 } else { 1.08 * top };

    let title = format!("{subject}: albedo against angle");
    let description = "Mean weight of samples with two standard errors, and the integral of f cos, by channel; \
                       below, their difference in standard errors.";
    let mut figure = Figure::new(WIDTH, 570.0, &title, description);
    figure.text((20.0, 26.0), &shortened(subject, 64), Type::new(Anchor::Start).size(20.0).bold());
    figure.text((20.0, 52.0), "albedo against θo", Type::new(Anchor::Start));
    let ticks: Vec<f64> = (0..=6).map(|k| f64::from(k) * right / 6.0).collect();
    let upper = Axes { from: (96.0, 76.0), to: (590.0, 330.0), x: (0.0, right), y: (0.0, top) };
    let edge = MOST_DEVIATIONS;
    let lower = Axes { from: (96.0, 356.0), to: (590.0, 510.0), x: (0.0, right), y: (-edge, edge) };
    lower.band(&mut figure, -2.0, 2.0, BAND);
    upper.draw(&mut figure, &[], 5.0, "", "albedo");
    lower.draw(&mut figure, &ticks, 6.0, "θo in degrees", "found − ∫, σ");
    for (c, points) in channels.iter().enumerate() {
        let colour = LINES[c];
        for run in points.chunk_by(|a, b| a.series == b.series) {
            let line: Vec<_> = run.iter().map(|p| upper.clamped(p.theta, p.expected)).collect();
            figure.line(&line, Pen { dashed: c == 1, ..Pen::new(colour, 2.0) });
        }
        for p in points {
            let ends = [-2.0, 2.0].map(|k| upper.clamped(p.theta, p.found + k * p.error));
            error_bar(&mut figure, ends, colour);
            mark(&mut figure, upper.clamped(p.theta, p.found), c, colour);
            // Without any variance only rounding is left, which has no σ.
            if p.error > 1e-9 * p.found.abs() {
                let sigma = ((p.found - p.expected) / p.error).clamp(-edge, edge);
                mark(&mut figure, lower.place(p.theta, sigma), c, colour);
            }
        }
        let y = 100.0 + 26.0 * c as f64;
        mark(&mut figure, (614.0, y), c, colour);
        figure.text((628.0, y), &shortened(names[c], 14), Type::new(Anchor::Start).colour(colour).bold());
    }
    let y = 112.0 + 26.0 * channels.len() as f64;
    let small = Type::new(Anchor::Start).size(15.0).colour(SOFT_INK);
    let mut lines = vec!["marks: samples,", "± 2 standard errors", "lines: integral"];
    let hidden = format!("first {} of {} channels", names.len(), first.description.channels.len());
    if first.description.channels.len() > names.len() {
        lines.push(&hidden);
    }
    for (k, text) in lines.into_iter().enumerate() {
        figure.text((604.0, y + 21.0 * k as f64), text, small);
    }
    for (k, text) in ["band: 2 σ", "beyond 6 σ:", "at the edge"].into_iter().enumerate() {
        figure.text((604.0, 372.0 + 21.0 * k as f64), text, small);
    }
    Some(figure.finish())
}

pub(super) fn error_bar(figure: &mut Figure, ends: [(f64, f64); 2], colour: Rgb) {
    figure.line(&ends, Pen::new(colour, 1.6));
    for (x, y) in ends {
        figure.line(&[(x - 5.0, y), (x + 5.0, y)], Pen::new(colour, 1.6));
    }
}

/// Histogram of p-values, which are uniform where every subject is right.
/// `None` where there is none.
pub fn p_values(values: &[f64]) -> Option<String> {
    let mut values: Vec<f64> = values.iter().copied().filter(|p| (0.0..=1.0).contains(p)).collect();
    if values.is_empty() {
        return None;
    }
    let mut counts = vec![0u64; BINS];
    for p in &values {
        counts[((p * BINS as f64) as usize).min(BINS - 1)] += 1;
    }
    let (distance, p) = kolmogorov_smirnov(&mut values);
    let histogram = Histogram {
        title: "p-values of the run".into(),
        name_y: "cases".into(),
        distance,
        p,
        counts,
        deviations: 2.0,
        band: "± 2 σ".into(),
    };
    Some(histogram.svg())
}

#[cfg(test)]
mod tests {
    use super::super::figure::{MOST_BYTES, tests::assert_well_formed};
    use super::super::synthetic::{Lobe, evidence};
    use super::*;
    use crate::statistics::streams::StreamKey;

    fn albedo_of_eight() -> String {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let cases: Vec<Evidence> = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0]
            .map(|theta| evidence("ggx:alpha=0.5", theta, 17.0, lobe, lobe))
            .into();
        albedo("ggx:alpha=0.5", &cases.iter().collect::<Vec<_>>()).unwrap()
    }

    fn uniform() -> String {
        let mut stream = StreamKey::new(5).block(0);
        p_values(&(0..600).map(|_| stream.next_f64()).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn curves_are_small_well_formed_and_alike() {
        for draw in [albedo_of_eight, uniform] {
            let svg = draw();
            assert_well_formed(&svg);
            assert!(svg.len() < MOST_BYTES / 3, "{} bytes", svg.len());
            assert_eq!(svg, draw());
        }
    }

    #[test]
    fn one_angle_is_no_curve_and_no_value_no_histogram() {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let case = evidence("a", 30.0, 0.0, lobe, lobe);
        assert_eq!(albedo("a", &[&case, &case]), None);
        assert_eq!(albedo("a", &[]), None);
        assert_eq!(p_values(&[f64::NAN]), None);
        assert!(p_values(&[0.0, 1.0]).is_some());
    }
}
