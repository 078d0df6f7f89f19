//! The counts over pdf() along the plane of incidence, with what a diagnosis predicts.

use super::angle_axis::AngleAxis;
use super::axes::{error_bar, mark};
use super::colours::{LINES, SOFT_INK};
use super::disc::given;
use super::disc_frame::azimuth;
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::numbers::Trim;
use super::ratio_axes::{RatioAxes, even_line};
use crate::bsdf::{Direction, SubjectKind};
use crate::diagnosis::Profile;
use crate::evidence::Evidence;

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 500.0;

/// The picture of a case, with the prediction of its subject's diagnosis if that is
/// about this case. `None` where too little was counted.
pub fn picture(evidence: &Evidence, diagnosed: Option<&Profile>) -> Option<String> {
    let counted = Profile::counted(evidence)?;
    // A diagnosis has the bins of the one case that it looked at.
    let same = diagnosed.filter(|d| d.wo == counted.wo && d.bins == counted.bins);
    let mirror = (evidence.description.kind == SubjectKind::Bsdf).then_some(evidence.wo);
    Some(draw(&evidence.subject, &given(evidence), mirror, same.unwrap_or(&counted)))
}

/// The picture of a diagnosis.
pub fn of_diagnosis(subject: &str, profile: &Profile) -> String {
    let wo = profile.wo;
    let [theta, phi] =
        [wo.theta().to_degrees(), azimuth(wo)].map(|degrees| Trim((degrees * 100.0).round() / 100.0));
    draw(subject, &format!("θo {theta}° φo {phi}°"), Some(wo), profile)
}

/// Where wo is mirrored to, in degrees from the normal of its side.
fn mirror_angle(wo: Direction) -> f64 {
    let theta = wo.theta().to_degrees();
    if theta > 90.0 { 180.0 - theta } else { theta }
}

fn draw(subject: &str, given: &str, mirror: Option<Direction>, profile: &Profile) -> String {
    let title = format!("{subject}: counted over pdf()");
    let note = format!("counted over pdf() in the plane of incidence, {given}");
    let description = "Marks: samples of sample() over what pdf() predicts, with two standard errors, \
                       in cells near the plane of incidence. Line: the ratio that the diagnosis predicts.";
    let mut figure = Figure::new(WIDTH, HEIGHT, &title, description);
    figure.text((20.0, 26.0), &shortened(subject, 72), Type::new(Anchor::Start).size(20.0).bold());
    figure.text((20.0, 54.0), &note, Type::new(Anchor::Start).colour(SOFT_INK));
    let stretch = profile.stretch();
    let first = profile.bins.first().map_or(0.0, |b| b.theta_deg);
    let last = profile.bins.last().map_or(0.0, |b| b.theta_deg);
    let range = (if first < -90.0 { -180.0 } else { -90.0 }, if last > 90.0 { 180.0 } else { 90.0 });
    let angles = AngleAxis::new(stretch, range, if range.1 - range.0 > 200.0 { 60.0 } else { 30.0 });
    let ratios = profile.bins.iter().map(|b| b.ratio());
    let corners = ((96.0, 80.0), (620.0, 430.0));
    let axes = RatioAxes::new(corners, angles, ratios, profile.predicted.iter().map(|p| p.1));
    axes.draw(&mut figure, "θi in the plane of incidence");
    let mut marks = vec![(-90.0, "horizon"), (90.0, "horizon")];
    if let Some(wo) = mirror {
        marks.push((mirror_angle(wo), "mirror"));
    }
    angles.landmarks(&mut figure, &axes.axes, &marks);
    for bin in &profile.bins {
        let (ratio, error) = bin.ratio();
        let ends = [-2.0, 2.0].map(|k| axes.place(bin.theta_deg, ratio + k * error));
        error_bar(&mut figure, ends, LINES[0], true);
        mark(&mut figure, axes.place(bin.theta_deg, ratio), 0, LINES[0]);
    }
    for run in unbroken(&profile.predicted, |x| angles.place(x)) {
        let line: Vec<_> = run.iter().map(|(theta, ratio)| axes.place(*theta, *ratio)).collect();
        figure.line(&line, Pen::new(LINES[1], 2.2));
    }
    legend(&mut figure, !profile.predicted.is_empty());
    let mut notes = vec!["θi < 0: on wo's side"];
    if range != (-90.0, 90.0) {
        notes.push("beyond 90°: transmitted");
    }
    let soft = Type::new(Anchor::Start).size(15.0).colour(SOFT_INK);
    for (k, text) in notes.into_iter().enumerate() {
        figure.text((640.0, 390.0 + 21.0 * k as f64), text, soft);
    }
    figure.finish()
}

/// The runs of a line whose points are evenly spaced but for gaps.
fn unbroken(points: &[(f64, f64)], place: impl Fn(f64) -> f64) -> Vec<&[(f64, f64)]> {
    let gap = |a: &(f64, f64), b: &(f64, f64)| place(b.0) - place(a.0);
    let step = points.windows(2).map(|w| gap(&w[0], &w[1])).fold(f64::INFINITY, f64::min);
    points.chunk_by(|a, b| gap(a, b) < 1.5 * step).collect()
}

fn legend(figure: &mut Figure, predicted: bool) {
    let small = Type::new(Anchor::Start).size(15.0);
    error_bar(figure, [(656.0, 106.0), (656.0, 86.0)], LINES[0], true);
    mark(figure, (656.0, 96.0), 0, LINES[0]);
    figure.text((684.0, 96.0), "counted,", small);
    figure.text((684.0, 116.0), "± 2 standard errors", small);
    figure.line(&[(640.0, 146.0), (674.0, 146.0)], even_line());
    figure.text((684.0, 146.0), "samples follow pdf()", small);
    if predicted {
        figure.line(&[(640.0, 176.0), (674.0, 176.0)], Pen::new(LINES[1], 2.2));
        figure.text((684.0, 176.0), "what the cause", small);
        figure.text((684.0, 196.0), "predicts", small);
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::super::synthetic::gallery;
    use super::*;
    use crate::diagnosis::Bin;

    fn profile(ratio: fn(f64) -> f64, last: i32) -> Profile {
        let bin = |k: i32| {
            let theta_deg = f64::from(k) * 5.0;
            Bin { theta_deg, observed: 100.0 * ratio(theta_deg), expected: 100.0 }
        };
        let bins: Vec<Bin> = (-17..=last).map(bin).collect();
        let predicted = bins.iter().map(|b| (b.theta_deg, ratio(b.theta_deg))).collect();
        Profile { wo: Direction::from_angles(1.0, 0.3), bins, predicted }
    }

    #[test]
    fn draws_ratios_near_and_far_from_one() {
        let near = of_diagnosis("a", &profile(|_| 1.02, 17));
        let far = of_diagnosis("<b>", &profile(|t| 10f64.powf(t / 45.0), 30));
        for svg in [&near, &far] {
            assert_well_formed(svg);
            assert!(svg.len() < 60_000, "{} bytes", svg.len());
        }
        assert!(far.contains("\n0.1\n") && far.contains("\n180\n") && !near.contains("\n180\n"), "{far}");
    }

    #[test]
    fn every_kind_of_lobe_is_drawn_small_and_alike() {
        for (name, evidence) in gallery() {
            let draw = || picture(&evidence, None).unwrap();
            let svg = draw();
            assert_well_formed(&svg);
            assert!(svg.len() < 60_000, "{name}: {} bytes", svg.len());
            assert_eq!(svg, draw(), "{name}");
            let broad = ["broad", "wrong", "glass"].contains(&name);
            assert_eq!(svg.contains("spread out there"), !broad, "{name}");
            assert_eq!(svg.contains("transmitted"), name == "glass", "{name}");
        }
    }

    #[test]
    fn a_prediction_is_drawn_in_its_own_case_only() {
        let (_, wrong) = gallery().into_iter().find(|(name, _)| *name == "wrong").unwrap();
        let counted = Profile::counted(&wrong).unwrap();
        let predicted = (-80..=80).map(|x| (f64::from(x), 1.2)).collect();
        let told = Profile { predicted, ..counted };
        assert!(picture(&wrong, Some(&told)).unwrap().contains("what the cause"));
        let other = Profile { wo: wrong.wo.rotated(0.1), ..told.clone() };
        let elsewhere = Profile { bins: told.bins[1..].to_vec(), ..told };
        for profile in [other, elsewhere] {
            assert_eq!(picture(&wrong, Some(&profile)), picture(&wrong, None));
        }
    }

    #[test]
    fn samples_off_pdf_are_off_the_line_at_one() {
        // The sampler's bump is a tenth wider than pdf's: too many far from the mirror.
        let (_, wrong) = gallery().into_iter().find(|(name, _)| *name == "wrong").unwrap();
        let bins = Profile::counted(&wrong).unwrap().bins;
        let (sigmas, far): (Vec<f64>, Vec<f64>) = bins
            .iter()
            .map(|b| {
                let (r, e) = b.ratio();
                ((r - 1.0) / e, (b.theta_deg - 60.0).abs())
            })
            .unzip();
        let extreme = |near: bool| {
            let at = |(s, d): (&f64, &f64)| (near == (*d < 15.0)).then_some(*s);
            sigmas.iter().zip(&far).filter_map(at).fold((0.0f64, 0.0f64), |(a, b), s| (a.min(s), b.max(s)))
        };
        assert!(extreme(true).0 < -5.0 && extreme(false).1 > 3.0, "{sigmas:?}");
    }

    #[test]
    fn nothing_counted_is_no_picture() {
        let (_, mut evidence) = gallery().remove(0);
        evidence.draws.clear();
        assert_eq!(picture(&evidence, None), None);
        let (_, mut evidence) = gallery().remove(0);
        evidence.draws[0].counts.pop();
        assert_eq!(picture(&evidence, None), None, "evidence that does not fit");
        let (_, mut evidence) = gallery().remove(0);
        evidence.description.has.pdf = false;
        assert_eq!(picture(&evidence, None), None);
    }
}
