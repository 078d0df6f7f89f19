//! The counts over pdf() around the normal: frames that are turned, azimuths that are
//! mirrored or ignored.

use super::angle_axis::AngleAxis;
use super::axes::{Axes, error_bar, log_ticks, mark};
use super::colours::{INK, LINES, SOFT_INK};
use super::disc::given;
use super::disc_frame::azimuth;
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::numbers::Trim;
use super::ratio_axes::{RatioAxes, even_line};
use crate::evidence::{Densities, Evidence, Stretch, Strip, azimuth_densities, azimuths};

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 640.0;

/// Densities below this part of the largest are drawn at the edge.
const FLOOR: f64 = 1e-5;

/// Fewer strips say nothing of azimuth.
const FEWEST: usize = 6;

/// The picture of a case, beside other cases of its subject with the same θ of wo; as
/// many as colours tell apart. `None` where too little was counted.
pub fn picture(evidence: &Evidence, others: &[&Evidence]) -> Option<String> {
    if !evidence.description.has.pdf {
        return None;
    }
    let own = told(evidence)?;
    let lines: Vec<(String, Vec<Strip>)> = std::iter::once((name(evidence), own.clone()))
        .chain(others.iter().filter_map(|case| Some((name(case), told(case)?))))
        .take(LINES.len())
        .collect();
    let stretch = Stretch::of(own.iter().map(|s| (s.degrees, s.observed + s.expected)));
    let angles = AngleAxis::new(stretch, (-180.0, 180.0), 60.0);

    let title = format!("{}: azimuths", evidence.subject);
    let note = format!("samples by azimuth about the normal, {}", given(evidence));
    let description = "Above, the density of samples and of pdf() by azimuth of wi. Below, samples over what pdf() \
                       predicts, with two standard errors, for each azimuth of wo.";
    let mut figure = Figure::new(WIDTH, HEIGHT, &title, description);
    figure.text((20.0, 26.0), &shortened(&evidence.subject, 72), Type::new(Anchor::Start).size(20.0).bold());
    figure.text((20.0, 54.0), &note, Type::new(Anchor::Start).colour(SOFT_INK));
    densities(&mut figure, &azimuth_densities(evidence, stretch)?, &angles);

    let counted = || lines.iter().flat_map(|(_, strips)| strips.iter().filter_map(Strip::ratio));
    let axes = RatioAxes::new(((96.0, 318.0), (620.0, 570.0)), angles, counted(), std::iter::empty());
    axes.draw(&mut figure, "azimuth of wi, 0 being away from wo");
    for (series, (name, strips)) in lines.iter().enumerate().rev() {
        let colour = LINES[series];
        let ratios = || strips.iter().filter_map(|s| Some((s.degrees, s.ratio()?)));
        let line: Vec<_> = ratios().map(|(x, (ratio, _))| axes.place(x, ratio)).collect();
        figure.line(&line, Pen::new(colour, 1.2));
        for (x, (ratio, error)) in ratios() {
            let ends = [-2.0, 2.0].map(|k| axes.place(x, ratio + k * error));
            error_bar(&mut figure, ends, colour, series == 0);
            mark(&mut figure, axes.place(x, ratio), series, colour);
        }
        let y = 342.0 + 26.0 * series as f64;
        mark(&mut figure, (656.0, y), series, colour);
        figure.text((684.0, y), name, Type::new(Anchor::Start).colour(colour).bold());
    }
    let small = Type::new(Anchor::Start).size(15.0);
    let y = 352.0 + 26.0 * lines.len() as f64;
    figure.text((640.0, y), "± 2 standard errors", small);
    figure.line(&[(640.0, y + 26.0), (674.0, y + 26.0)], even_line());
    figure.text((684.0, y + 26.0), "samples follow pdf()", small);
    Some(figure.finish())
}

fn name(case: &Evidence) -> String {
    format!("φo {:.1}°", Trim(azimuth(case.wo)))
}

/// A case's strips, if there are enough to tell anything.
fn told(case: &Evidence) -> Option<Vec<Strip>> {
    let strips = azimuths(case)?;
    (strips.iter().filter(|s| s.ratio().is_some()).count() >= FEWEST).then_some(strips)
}

/// What was drawn and what pdf() says, per degree of azimuth.
fn densities(figure: &mut Figure, found: &[Densities], angles: &AngleAxis) {
    let percent = |share: f64| 100.0 * share;
    let each = found.iter().flat_map(|d| [percent(d.drawn), percent(d.pdf)]);
    let largest = each.clone().fold(0.0, f64::max);
    let least = each.filter(|d| *d > FLOOR * largest).fold(largest, f64::min);
    let y = (least.log10() - 0.1, largest.log10() + 0.1);
    let axes = Axes { from: (96.0, 80.0), to: (620.0, 290.0), x: angles.ends(), y };
    axes.ticks_y(figure, &log_ticks(y, 6));
    axes.outline(figure, "", "% per degree");
    angles.landmarks(figure, &axes, &[(0.0, "away from wo")]);
    let place = |degrees: f64, d: f64| axes.clamped(angles.place(degrees), d.max(1e-300).log10());
    let line: Vec<_> = found.iter().map(|d| place(d.degrees, percent(d.pdf))).collect();
    figure.line(&line, Pen::new(INK, 2.0));
    for d in found {
        figure.dot(place(d.degrees, percent(d.drawn)), 3.6, LINES[0]);
    }
    let small = Type::new(Anchor::Start).size(15.0);
    mark(figure, (656.0, 96.0), 0, LINES[0]);
    figure.text((684.0, 96.0), "samples", small);
    figure.line(&[(640.0, 122.0), (674.0, 122.0)], Pen::new(INK, 2.0));
    figure.text((684.0, 122.0), "pdf()", small);
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::super::synthetic::{Lobe, evidence, gallery, turned};
    use super::*;

    const BROAD: Lobe = Lobe { width: 0.25, cosine: 0.1, back: 0.0 };

    /// Ratios of a sampler whose lobe lies `turn` degrees beside pdf's.
    fn ratios(turn: f64) -> Vec<(f64, f64, f64)> {
        let case = turned("a", 60.0, 17.0, BROAD, turn);
        let strips = azimuths(&case).unwrap();
        strips.iter().filter_map(|s| s.ratio().map(|(r, e)| (s.degrees, r, e))).collect()
    }

    #[test]
    fn a_turned_frame_is_seen_and_a_right_one_is_flat() {
        let right = ratios(0.0);
        assert!(right.iter().all(|(_, r, e)| (r - 1.0).abs() < 5.0 * e), "{right:?}");
        let turned = ratios(40.0);
        let at = |side: f64| {
            let near = turned.iter().filter(|(x, ..)| (x - side).abs() < 20.0);
            near.clone().map(|(_, r, _)| r).sum::<f64>() / near.count() as f64
        };
        assert!(at(60.0) > 2.0 && at(-40.0) < 0.5, "too many where it was turned to: {turned:?}");
        assert!(ratios(-40.0).iter().any(|(x, r, _)| *x < -40.0 && *r > 2.0));
    }

    #[test]
    fn densities_add_up_to_all_and_peak_where_the_lobe_is() {
        let case = turned("a", 60.0, 17.0, BROAD, 40.0);
        let found = azimuth_densities(&case, Stretch::Even).unwrap();
        let step = 360.0 / found.len() as f64;
        let total = |of: fn(&Densities) -> f64| found.iter().map(|d| of(d) * step).sum::<f64>();
        for sum in [total(|d| d.drawn), total(|d| d.pdf), total(|d| d.flux)] {
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        }
        let peak =
            |of: fn(&Densities) -> f64| found.iter().max_by(|a, b| of(a).total_cmp(&of(b))).unwrap().degrees;
        assert!((peak(|d| d.drawn) - 40.0).abs() < 8.0 && peak(|d| d.pdf).abs() < 8.0);
    }

    #[test]
    fn each_azimuth_of_wo_has_a_line() {
        let cases = [17.0, 137.0, 257.0].map(|phi| evidence("<a> & b", 60.0, phi, BROAD, BROAD));
        let draw = || picture(&cases[1], &[&cases[0], &cases[2], &cases[2]]).unwrap();
        let svg = draw();
        assert_well_formed(&svg);
        assert_eq!(svg, draw());
        assert!(svg.len() < 60_000, "{} bytes", svg.len());
        assert!(["φo 17°", "φo 137°", "φo 257°"].iter().all(|name| svg.contains(name)));
        assert!(!picture(&cases[1], &[]).unwrap().contains("\nφo 17°\n"));
    }

    #[test]
    fn every_kind_of_lobe_is_drawn_small() {
        for (name, evidence) in gallery() {
            let svg = picture(&evidence, &[]).unwrap();
            assert_well_formed(&svg);
            assert!(svg.len() < 60_000, "{name}: {} bytes", svg.len());
        }
    }

    #[test]
    fn nothing_counted_is_no_picture() {
        let (_, mut evidence) = gallery().remove(0);
        let other = evidence.clone();
        evidence.draws.clear();
        assert_eq!(picture(&evidence, &[&other]), None);
    }
}
