//! The counts over pdf() along the plane of incidence, with what a diagnosis predicts.

use super::axes::{Axes, mark};
use super::colours::{INK, LINES, SOFT_INK};
use super::curves::error_bar;
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::numbers::{Trim, power_of_ten};
use crate::diagnosis::Profile;

const WIDTH: f64 = 860.0;
const HEIGHT: f64 = 500.0;

/// Ratios beyond these are drawn at the edge.
const MOST: f64 = 1e3;

/// Ratios that span more than this are on a logarithmic axis.
const LINEAR: f64 = 2.5;

/// Axes of ratios, linear where they are all near 1.
struct Scale {
    axes: Axes,
    logarithmic: bool,
}

impl Scale {
    fn of(profile: &Profile) -> Self {
        let predicted = profile.predicted.iter().map(|p| p.1);
        // The error bars of well counted bins, and not those of the tails.
        let counted = profile.bins.iter().flat_map(|b| {
            let (r, e) = b.ratio();
            let wide = 2.0 * e > 0.5 * r;
            if wide { vec![r] } else { vec![r - 2.0 * e, r + 2.0 * e] }
        });
        let ends = |(a, b): (f64, f64), r: f64| (a.min(r), b.max(r));
        let bounded = |r: f64| r.clamp(1.0 / MOST, MOST);
        let seen = counted.chain(predicted).filter(|r| *r > 0.0).map(bounded);
        let (low, high) = seen.fold((0.97, 1.03), ends);
        let logarithmic = high / low > LINEAR;
        let y = if logarithmic {
            (low.log10() - 0.06, high.log10() + 0.06)
        } else {
            let margin = 0.06 * (high - low);
            (low - margin, high + margin)
        };
        let first = profile.bins.first().map_or(0.0, |b| b.theta_deg);
        let last = profile.bins.last().map_or(0.0, |b| b.theta_deg);
        let x = (if first < -90.0 { -180.0 } else { -90.0 }, if last > 90.0 { 180.0 } else { 90.0 });
        Self { axes: Axes { from: (96.0, 80.0), to: (620.0, 430.0), x, y }, logarithmic }
    }

    fn place(&self, theta: f64, ratio: f64) -> (f64, f64) {
        let y = if self.logarithmic { ratio.max(1e-300).log10() } else { ratio };
        self.axes.clamped(theta, y)
    }

    fn draw(&self, figure: &mut Figure) {
        let step = if self.axes.x.1 - self.axes.x.0 > 200.0 { 60 } else { 30 };
        let (first, last) = (self.axes.x.0 as i32, self.axes.x.1 as i32);
        let ticks: Vec<f64> = (first..=last).filter(|x| x % step == 0).map(f64::from).collect();
        let (name_x, name_y) = ("θi in the plane of incidence, degrees", "counted / pdf()");
        if !self.logarithmic {
            return self.axes.draw(figure, &ticks, 6.0, name_x, name_y);
        }
        // No linear tick falls into so narrow a range: the frame and names alone.
        let bare = Axes { y: (0.1, 0.2), ..self.axes };
        bare.draw(figure, &ticks, 0.01, name_x, name_y);
        let (low, high) = self.axes.y;
        let digits: &[f64] = match high - low {
            span if span < 0.8 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0],
            span if span < 2.2 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        for power in (low.floor() as i32)..=(high.ceil() as i32) {
            for digit in digits {
                let y = f64::from(power) + digit.log10();
                if y < low || y > high {
                    continue;
                }
                let (x, at) = self.axes.place(self.axes.x.0, y);
                let text = match *digit {
                    1.0 => power_of_ten(power),
                    digit => Trim(10f64.powi(power) * digit).to_string(),
                };
                figure.line(&[(x - 6.0, at), (x, at)], Pen::new(INK, 1.4));
                figure.line(&[(x, at), (self.axes.to.0, at)], Pen::new(SOFT_INK, 0.6).opacity(0.3));
                figure.text((x - 10.0, at), &text, Type::new(Anchor::End).size(15.0));
            }
        }
    }
}

/// The picture of a diagnosis.
pub fn ratio(subject: &str, profile: &Profile) -> String {
    let wo = profile.wo;
    let title = format!("{subject}: counted over pdf()");
    let note = format!(
        "counted over pdf() in the plane of incidence, θo {}° φo {}°",
        Trim((wo.theta().to_degrees() * 100.0).round() / 100.0),
        Trim((wo.phi().to_degrees().rem_euclid(360.0) * 100.0).round() / 100.0)
    );
    let description = "Marks: samples of sample() over what pdf() predicts, with two standard errors, \
                       in cells near the plane of incidence. Line: the ratio that the diagnosis predicts.";
    let mut figure = Figure::new(WIDTH, HEIGHT, &title, description);
    figure.text((20.0, 26.0), &shortened(subject, 72), Type::new(Anchor::Start).size(20.0).bold());
    figure.text((20.0, 54.0), &note, Type::new(Anchor::Start).colour(SOFT_INK));
    let scale = Scale::of(profile);
    scale.draw(&mut figure);
    let dashed = Pen::new(SOFT_INK, 1.6).dashed();
    figure.line(&[scale.place(scale.axes.x.0, 1.0), scale.place(scale.axes.x.1, 1.0)], dashed);
    // Where wo is mirrored to.
    let mirror = wo.theta().to_degrees();
    let mirror = if mirror > 90.0 { 180.0 - mirror } else { mirror };
    let (x, bottom) = (scale.axes.place(mirror, scale.axes.y.0).0, scale.axes.to.1);
    figure.line(&[(x, scale.axes.from.1), (x, bottom)], Pen::new(SOFT_INK, 1.0).opacity(0.5));
    figure.text((x, bottom - 12.0), "mirror", Type::new(Anchor::Middle).size(15.0).colour(SOFT_INK).rim());
    for bin in &profile.bins {
        let (ratio, error) = bin.ratio();
        let ends = [-2.0, 2.0].map(|k| scale.place(bin.theta_deg, ratio + k * error));
        error_bar(&mut figure, ends, LINES[0]);
        mark(&mut figure, scale.place(bin.theta_deg, ratio), 0, LINES[0]);
    }
    for run in profile.predicted.chunk_by(|a, b| b.0 - a.0 < 1.5) {
        let line: Vec<_> = run.iter().map(|(theta, ratio)| scale.place(*theta, *ratio)).collect();
        figure.line(&line, Pen::new(LINES[1], 2.2));
    }
    legend(&mut figure, !profile.predicted.is_empty(), dashed);
    let mut notes = vec!["θi < 0: on wo's side"];
    if scale.axes.x != (-90.0, 90.0) {
        notes.push("beyond 90°: transmitted");
    }
    let soft = Type::new(Anchor::Start).size(15.0).colour(SOFT_INK);
    for (k, text) in notes.into_iter().enumerate() {
        figure.text((640.0, 390.0 + 21.0 * k as f64), text, soft);
    }
    figure.finish()
}

fn legend(figure: &mut Figure, predicted: bool, dashed: Pen) {
    let small = Type::new(Anchor::Start).size(15.0);
    error_bar(figure, [(656.0, 106.0), (656.0, 86.0)], LINES[0]);
    mark(figure, (656.0, 96.0), 0, LINES[0]);
    figure.text((684.0, 96.0), "counted,", small);
    figure.text((684.0, 116.0), "± 2 standard errors", small);
    figure.line(&[(640.0, 146.0), (674.0, 146.0)], dashed);
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
    use super::*;
    use crate::bsdf::Direction;
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
        let near = ratio("a", &profile(|_| 1.02, 17));
        let far = ratio("<b>", &profile(|t| 10f64.powf(t / 45.0), 30));
        for svg in [&near, &far] {
            assert_well_formed(svg);
            assert!(svg.len() < 60_000, "{} bytes", svg.len());
        }
        assert!(far.contains("\n0.1\n") && far.contains("\n180\n") && !near.contains("\n180\n"), "{far}");
    }
}
