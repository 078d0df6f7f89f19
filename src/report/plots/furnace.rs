//! Flux against angle: what a surface gives back where 1 arrives, as the checks of
//! energy and of the white furnace compute it.

use super::axes::{Axes, error_bar, even_ticks, mark};
use super::by_theta::{self, Point, points};
use super::colours::{INK, LINES, SOFT_INK};
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use crate::evidence::{Evidence, Flux};

const WIDTH: f64 = 800.0;

/// The lower part shows at least this much on either side of its values.
const LEAST: f64 = 1e-3;

/// Errors that a cubature which did not settle may be off by, where it tells nothing.
const UNTOLD: f64 = 10.0;

fn flux(case: &Evidence, channel: usize) -> Option<Flux> {
    let flux = *case.fluxes()?.get(channel)?;
    let certainty = case.integrals.as_ref()?.certainty().unwrap_or(UNTOLD);
    let flux = Flux { error: certainty * flux.error, ..flux };
    (flux.total.is_finite() && flux.error.is_finite()).then_some(flux)
}

/// Which channels are drawn: as many as colours tell apart; of more, the first, the one
/// with the least and the one with the most flux anywhere.
fn chosen(cases: &[&Evidence], count: usize) -> Vec<usize> {
    if count <= LINES.len() {
        return (0..count).collect();
    }
    let fluxes: Vec<Vec<Flux>> = cases.iter().filter_map(|case| case.fluxes()).collect();
    let of = |c: usize| fluxes.iter().filter_map(move |f| Some(f.get(c)?.total));
    let least = |c: &usize| of(*c).fold(f64::INFINITY, f64::min);
    let most = |c: &usize| of(*c).fold(0.0, f64::max);
    let mut chosen = vec![0];
    chosen.extend((1..count).min_by(|a, b| least(a).total_cmp(&least(b))));
    let rest = (1..count).filter(|c| !chosen.contains(c)).max_by(|a, b| most(a).total_cmp(&most(b)));
    chosen.extend(rest);
    chosen.sort_unstable();
    chosen
}

/// Flux against θo of a subject's cases by channel: in all, reflected and transmitted;
/// below it, how far it is from 1. `None` of fewer than three angles.
pub fn furnace(subject: &str, cases: &[&Evidence]) -> Option<String> {
    let count = by_theta::channels(cases)?.1;
    let names = &cases.first()?.description.channels;
    let drawn = chosen(cases, count);
    let channels: Vec<Vec<Point<Flux>>> =
        drawn.iter().map(|c| points(cases, |case| flux(case, *c))).collect();
    let all = || channels.iter().flatten().map(|p| p.found);
    let angles = by_theta::angles(&channels);
    // Two points are no curve.
    if angles.len() < 3 {
        return None;
    }
    let both = angles.iter().any(|a| *a > 90.0);
    let right = if both { 180.0 } else { 90.0 };
    let split = all().any(|f| f.transmitted > 0.0);
    let top = 1.08 * all().map(|f| f.total + f.error).fold(1.0, f64::max);
    let off = all().flat_map(|f| [f.total - f.error - 1.0, f.total + f.error - 1.0]);
    let (low, high) = off.fold((-LEAST, LEAST), |(a, b), v| (a.min(v), b.max(v)));
    let margin = 0.1 * (high - low);

    let title = format!("{subject}: flux against angle");
    let description = "Flux that leaves where 1 arrives, by channel, with what is reflected and transmitted; below, \
                       its difference from 1 with the error of the cubature.";
    let mut figure = Figure::new(WIDTH, 570.0, &title, description);
    figure.text((20.0, 26.0), &shortened(subject, 56), Type::new(Anchor::Start).size(20.0).bold());
    figure.text((20.0, 52.0), "flux that leaves where 1 arrives, against θo", Type::new(Anchor::Start));
    let upper = Axes { from: (96.0, 88.0), to: (590.0, 310.0), x: (0.0, right), y: (0.0, top) };
    let percent = (100.0 * (low - margin), 100.0 * (high + margin));
    let lower = Axes { from: (96.0, 336.0), to: (590.0, 510.0), x: (0.0, right), y: percent };
    upper.ticks_y(&mut figure, &even_ticks(upper.y, 5.0));
    upper.outline(&mut figure, "", "flux");
    let ticks: Vec<f64> = (0..=6).map(|k| f64::from(k) * right / 6.0).collect();
    lower.draw(&mut figure, &ticks, 5.0, "θo in degrees", "flux − 1, %");
    for (axes, one) in [(&upper, 1.0), (&lower, 0.0)] {
        let ends = [0.0, right].map(|x| axes.place(x, one));
        figure.line(&ends, Pen::new(INK, 1.6).dashed());
        if both {
            let ends = [axes.y.0, axes.y.1].map(|y| axes.place(90.0, y));
            figure.line(&ends, Pen::new(SOFT_INK, 1.0).opacity(0.5));
        }
    }
    for (series, points) in channels.iter().enumerate() {
        let colour = LINES[series];
        draw_channel(&mut figure, points, series, (&upper, &lower), split);
        let y = 100.0 + 26.0 * series as f64;
        let name = shortened(&names[drawn[series]], 14);
        mark(&mut figure, (614.0, y), series, colour);
        figure.text((628.0, y), &name, Type::new(Anchor::Start).colour(colour).bold());
    }
    if both {
        for (x, anchor, name) in [(86.0, Anchor::End, "front"), (94.0, Anchor::Start, "back")] {
            let at = upper.place(x, top);
            figure.text((at.0, at.1 - 10.0), name, Type::new(anchor).size(15.0).colour(SOFT_INK));
        }
    }
    let mut notes = vec!["dashed at 1: lossless".to_string()];
    if split {
        notes.push("R reflected,".into());
        notes.push("T transmitted (· η²)".into());
    }
    if by_theta::any_importance(cases) {
        notes.push("dashed: importance".into());
    }
    if count > drawn.len() {
        notes.push(format!("{} of {count} channels", drawn.len()));
    }
    let small = Type::new(Anchor::Start).size(15.0).colour(SOFT_INK);
    let y = 112.0 + 26.0 * channels.len() as f64;
    for (k, text) in notes.iter().enumerate() {
        figure.text((604.0, y + 21.0 * k as f64), text, small);
    }
    for (k, text) in ["above 0: gains energy", "bars: error of", "the integral"].into_iter().enumerate() {
        figure.text((604.0, 352.0 + 21.0 * k as f64), text, small);
    }
    Some(figure.finish())
}

/// Lines and marks of a channel in both parts; in the upper one what is reflected and
/// transmitted too, if `split`.
fn draw_channel(
    figure: &mut Figure,
    points: &[Point<Flux>],
    series: usize,
    (upper, lower): (&Axes, &Axes),
    split: bool,
) {
    let colour = LINES[series];
    let off = |flux: &Flux, errors: f64| 100.0 * (flux.total + errors * flux.error - 1.0);
    // A line from the front to the back would cross what nobody measured.
    let joined =
        |a: &Point<Flux>, b: &Point<Flux>| a.series == b.series && (a.theta > 90.0) == (b.theta > 90.0);
    for run in points.chunk_by(joined) {
        let pen = run[0].series.pen(colour);
        let mut line = |axes: &Axes, of: &dyn Fn(&Flux) -> f64, pen: Pen| {
            let path: Vec<_> = run.iter().map(|p| axes.clamped(p.theta, of(&p.found))).collect();
            figure.line(&path, pen);
        };
        line(upper, &|f| f.total, pen);
        line(lower, &|f| off(f, 0.0), pen);
        if split {
            let thin = Pen { width: 1.0, ..pen };
            line(upper, &|f| f.reflected, thin);
            line(upper, &|f| f.transmitted, thin);
        }
    }
    for Point { theta, found, .. } in points {
        mark(figure, upper.clamped(*theta, found.total), series, colour);
        error_bar(figure, [-1.0, 1.0].map(|k| lower.clamped(*theta, off(found, k))), colour, true);
        mark(figure, lower.clamped(*theta, off(found, 0.0)), series, colour);
        if split {
            let letter = Type::new(Anchor::Middle).size(14.0).colour(colour).bold();
            for (value, name) in [(found.reflected, "R"), (found.transmitted, "T")] {
                let (x, y) = upper.clamped(*theta, value);
                // Beside its line, and within the frame.
                let aside = if y > upper.to.1 - 24.0 { -11.0 } else { 11.0 };
                figure.text((x, y + aside), name, letter);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::super::synthetic::{Lobe, evidence};
    use super::*;

    const GLASS: Lobe = Lobe { width: 0.2, cosine: 0.0, back: 0.7 };

    fn of(lobe: Lobe, angles: &[f64]) -> Vec<Evidence> {
        angles.iter().map(|theta| evidence("<a> & b", *theta, 17.0, lobe, lobe)).collect()
    }

    fn drawn(cases: &[Evidence]) -> Option<String> {
        furnace("<a> & b", &cases.iter().collect::<Vec<_>>())
    }

    #[test]
    fn is_small_well_formed_and_alike() {
        let cases = of(GLASS, &[0.0, 30.0, 60.0, 89.0, 120.0, 180.0]);
        let svg = drawn(&cases).unwrap();
        assert_well_formed(&svg);
        assert!(svg.len() < 60_000, "{} bytes", svg.len());
        assert_eq!(svg, drawn(&cases).unwrap());
        assert!(["front", "back", "R", "T"].iter().all(|word| svg.contains(&format!("\n{word}\n"))));
        let opaque = drawn(&of(Lobe { back: 0.0, ..GLASS }, &[0.0, 30.0, 60.0])).unwrap();
        assert!(["front", "back", "R", "T"].iter().all(|word| !opaque.contains(&format!("\n{word}\n"))));
    }

    #[test]
    fn transmission_counts_by_flux() {
        let mut cases = of(GLASS, &[30.0]);
        // Made-up values that are not reciprocal look as those of importance.
        cases[0].pairs = None;
        let value = |case: &Evidence| flux(case, 0).unwrap();
        let before = value(&cases[0]);
        cases[0].description.claims.eta = Some(1.5);
        let after = value(&cases[0]);
        assert_eq!(before.reflected, after.reflected);
        assert!((after.transmitted / before.transmitted - 2.25).abs() < 1e-12);
    }

    #[test]
    fn an_excess_is_above_the_line_and_a_loss_below() {
        let heights = |scale: f64| {
            let mut cases = of(GLASS, &[0.0, 30.0, 60.0]);
            for case in &mut cases {
                let integrals = case.integrals.as_mut().unwrap();
                integrals.value.iter_mut().for_each(|v| *v *= scale);
            }
            let svg = drawn(&cases).unwrap();
            let note = svg.split("<polyline").filter(|p| p.contains("stroke-dasharray")).count();
            assert_eq!(note, 2, "a dashed line at 1 in both parts");
            cases.iter().map(|c| flux(c, 0).unwrap().total - 1.0).collect::<Vec<_>>()
        };
        assert!(heights(1.3).iter().any(|off| *off > 0.0));
        assert!(heights(0.9).iter().all(|off| *off < 0.0));
    }

    #[test]
    fn of_many_channels_the_extreme_ones_are_drawn() {
        let mut cases = of(GLASS, &[0.0, 30.0, 60.0]);
        for case in &mut cases {
            let names: Vec<String> = (0..5).map(|c| format!("c{c}")).collect();
            case.description.channels = names;
            let integrals = case.integrals.as_mut().unwrap();
            integrals.value_error = vec![1e-6; 5];
            let part = [1.0, 0.9, 0.2, 1.4, 1.0];
            integrals.value = integrals.pdf.iter().flat_map(|p| part.map(|k| k * p)).collect();
        }
        let svg = drawn(&cases).unwrap();
        assert!(["c0", "c2", "c3", "3 of 5 channels"].iter().all(|t| svg.contains(t)), "{svg}");
        assert!(!svg.contains("c1") && !svg.contains("c4"));
    }

    #[test]
    fn two_angles_and_normals_are_no_curve() {
        assert_eq!(drawn(&of(GLASS, &[0.0, 30.0])), None);
        assert_eq!(furnace("a", &[]), None);
        let mut cases = of(GLASS, &[0.0, 30.0, 60.0]);
        cases.iter_mut().for_each(|c| c.integrals.as_mut().unwrap().value.truncate(5));
        assert_eq!(drawn(&cases), None, "evidence that does not fit");
    }
}
