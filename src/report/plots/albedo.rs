//! Albedo against angle: what samples give, and the integral.

use super::axes::{Axes, error_bar, mark};
use super::by_theta::{self, Point, points};
use super::colours::{BAND, LINES, SOFT_INK};
use super::figure::{Anchor, Figure, Type, shortened};
use crate::evidence::Evidence;

pub(super) const WIDTH: f64 = 760.0;

/// A deviation of a mean beyond this is drawn at the edge, in standard errors.
const MOST_DEVIATIONS: f64 = 6.0;

/// One estimate of one case and channel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mean {
    found: f64,
    /// Standard error of `found`.
    error: f64,
    expected: f64,
}

fn mean(case: &Evidence, channel: usize) -> Option<Mean> {
    let integrals = case.integrals.as_ref()?;
    let draws = case.draws.first().filter(|d| d.weight.count > 0)?;
    // Saved evidence may come from anywhere.
    let sums = draws.weight.sum.len().min(draws.weight.square.len());
    if channel >= sums.min(integrals.value_error.len()) {
        return None;
    }
    let (found, variance) = draws.weight.moments(channel);
    let discrete = draws.discrete.iter();
    let discrete: f64 = discrete.map(|d| d.probability * d.weight.get(channel).unwrap_or(&f64::NAN)).sum();
    let mean = Mean {
        found,
        error: (variance / draws.weight.count as f64).sqrt(),
        expected: integrals.albedo(channel).0 + discrete,
    };
    [mean.found, mean.error, mean.expected].iter().all(|v| v.is_finite()).then_some(mean)
}

/// Albedo against θo of a subject's cases: the mean weight of samples with two
/// standard errors, and the integral. Below it their difference, which the
/// curves are too coarse to show. `None` where fewer than two angles have both.
pub fn albedo(subject: &str, cases: &[&Evidence]) -> Option<String> {
    let (names, channel_count) = by_theta::channels(cases)?;
    let channels: Vec<Vec<Point<Mean>>> =
        (0..names.len()).map(|c| points(cases, |case| mean(case, c))).collect();
    let all = || channels.iter().flatten().map(|p| p.found);
    let angles = by_theta::angles(&channels);
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
            let line: Vec<_> = run.iter().map(|p| upper.clamped(p.theta, p.found.expected)).collect();
            figure.line(&line, run[0].series.pen(colour));
        }
        for p in points {
            let Mean { found, error, expected } = p.found;
            let ends = [-2.0, 2.0].map(|k| upper.clamped(p.theta, found + k * error));
            error_bar(&mut figure, ends, colour, true);
            mark(&mut figure, upper.clamped(p.theta, found), c, colour);
            // Without any variance only rounding is left, which has no σ.
            if error > 1e-9 * found.abs() {
                let sigma = ((found - expected) / error).clamp(-edge, edge);
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
    if by_theta::any_importance(cases) {
        lines.push("dashed: importance");
    }
    let hidden = format!("first {} of {} channels", names.len(), channel_count);
    if channel_count > names.len() {
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

#[cfg(test)]
mod tests {
    use super::super::figure::{MOST_BYTES, tests::assert_well_formed};
    use super::super::synthetic::{Lobe, evidence};
    use super::*;
    use crate::bsdf::Transport;

    fn albedo_of_six() -> String {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let cases: Vec<Evidence> = [0.0, 30.0, 60.0, 75.0, 85.0, 89.0]
            .map(|theta| evidence("ggx:alpha=0.5", theta, 17.0, lobe, lobe))
            .into();
        albedo("ggx:alpha=0.5", &cases.iter().collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn curves_are_small_well_formed_and_alike() {
        let svg = albedo_of_six();
        assert_well_formed(&svg);
        assert!(svg.len() < MOST_BYTES / 3, "{} bytes", svg.len());
        assert_eq!(svg, albedo_of_six());
    }

    #[test]
    fn one_angle_is_no_curve() {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let case = evidence("a", 30.0, 0.0, lobe, lobe);
        assert_eq!(albedo("a", &[&case, &case]), None);
        assert_eq!(albedo("a", &[]), None);
    }

    #[test]
    fn modes_are_told_apart() {
        let lobe = Lobe { width: 0.3, cosine: 0.5, back: 0.0 };
        let mut cases: Vec<Evidence> =
            [0.0, 30.0, 60.0].map(|theta| evidence("a", theta, 17.0, lobe, lobe)).into();
        let dashed = |cases: &[Evidence]| {
            let svg = albedo("a", &cases.iter().collect::<Vec<_>>()).unwrap();
            (svg.contains("dashed: importance"), svg.contains("stroke-dasharray"))
        };
        assert_eq!(dashed(&cases), (false, false));
        let importance: Vec<Evidence> =
            cases.iter().map(|c| Evidence { transport: Transport::Importance, ..c.clone() }).collect();
        cases.extend(importance);
        assert_eq!(dashed(&cases), (true, true));
    }
}
