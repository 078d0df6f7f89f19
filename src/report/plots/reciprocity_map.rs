//! Where exchanging wo and wi changes the value, and which way.

use super::colours::{INK, NOTHING, Rgb, diverging};
use super::disc::{bar, given};
use super::disc_frame::{Disc, Window, cross, ring};
use super::figure::{Anchor, Figure, Pen, Type, shortened};
use super::numbers::three_digits;
use crate::bsdf::Direction;
use crate::evidence::Evidence;
use crate::sphere::Chart;

/// More directions than this are thinned to the most asymmetric ones.
const MOST_DOTS: usize = 1400;

const RADIUS: f64 = 150.0;
const LEFT: f64 = 210.0;
const APART: f64 = 350.0;

/// The picture of a case's pairs; `None` where none were tried.
pub fn picture(evidence: &Evidence) -> Option<String> {
    let pairs = evidence.pairs.as_ref()?;
    // Where there is no continuous lobe all pairs are 0 and equal.
    if evidence.integrals.as_ref().is_some_and(|i| (0..i.value_error.len()).all(|c| i.albedo(c).0 == 0.0)) {
        return None;
    }
    let mut dots: Vec<(Direction, f64)> = pairs.map.clone();
    if dots.is_empty() {
        return None;
    }
    // The most asymmetric last, over the others; a value that is no number is
    // among the worst.
    let size = |v: f64| if v.is_nan() { f64::INFINITY } else { v.abs() };
    dots.sort_by(|a, b| size(a.1).total_cmp(&size(b.1)));
    let thinned = dots.len() > MOST_DOTS;
    let dots = &dots[dots.len().saturating_sub(MOST_DOTS)..];
    let sides: Vec<bool> =
        [true, false].into_iter().filter(|front| dots.iter().any(|d| (d.0.z > 0.0) == *front)).collect();
    let largest = dots.iter().map(|d| d.1.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
    // Rounding is not worth a colour.
    let scale = largest.max(pairs.reciprocity.tolerance).max(f64::MIN_POSITIVE);

    let width = LEFT + APART * (sides.len() - 1) as f64 + 250.0;
    let tally = &pairs.reciprocity;
    let verdict = if tally.is_broken() {
        format!("asymmetric at {:.3} % of {} places", 100.0 * tally.share(), tally.checked)
    } else if tally.checked == 0 {
        "no place was looked at".into()
    } else {
        format!("within {:.0e} at all {} places", tally.tolerance, tally.checked).replace('-', "−")
    };
    let facts = given(evidence);
    let title = format!("{}: reciprocity", evidence.subject);
    let description = format!(
        "{facts}; {verdict}. Directions wi by the sign and size of eval(wo, wi) − eval(wi, wo), relative to the larger."
    );
    let mut figure = Figure::new(width, 536.0, &title, &description);
    let bold = Type::new(Anchor::Start).size(20.0).bold();
    figure.text((20.0, 26.0), &shortened(&evidence.subject, (width / 13.0) as usize), bold);
    figure.text((20.0, 52.0), &format!("reciprocity at {facts}"), Type::new(Anchor::Start));
    figure.text((20.0, 76.0), &verdict, Type::new(Anchor::Start).size(15.0));
    let chart = Chart::new(evidence.wo.phi());
    for (k, front) in sides.iter().enumerate() {
        let at = (LEFT + APART * k as f64, 276.0);
        let disc = Disc { chart, front: *front, window: Window::WHOLE, at, radius: RADIUS };
        // Where values are equal, dots are nearly white.
        figure.dot(at, RADIUS, NOTHING);
        for (d, signed) in dots {
            if let Some(place) = disc.direction(*d) {
                let colour = colour(*signed, scale);
                figure.dot(place, if signed.is_nan() { 5.0 } else { 3.6 }, colour);
            }
        }
        // Over the dots, or its numbers are hidden.
        disc.graticule(&mut figure, true);
        disc.mark_ring(&mut figure, evidence.wo);
        disc.mark_cross(&mut figure, evidence.wo.mirrored());
        if sides.len() > 1 {
            let name = if *front { "front" } else { "back" };
            figure.text((at.0 - RADIUS, 112.0), name, Type::new(Anchor::Start).bold());
        }
    }
    let colours: Vec<Rgb> = (0..=40).map(|k| diverging(f64::from(k) / 20.0 - 1.0)).collect();
    let left = 60.0;
    bar(&mut figure, (left, 462.0), 200.0, &colours);
    let ends = [-scale, 0.0, scale];
    for (k, value) in ends.into_iter().enumerate() {
        let x = left + 100.0 * k as f64;
        figure.line(&[(x, 478.0), (x, 483.0)], Pen::new(INK, 1.4));
        let name = if value == 0.0 { "0".into() } else { three_digits(value) };
        figure.text((x, 493.0), &name, Type::new(Anchor::Middle).size(15.0));
    }
    let small = Type::new(Anchor::Start).size(15.0);
    figure.text((left + 216.0, 470.0), "(a − b)/max(a, b)", small);
    ring(&mut figure, (66.0, 520.0));
    figure.text((80.0, 520.0), "wo", small);
    cross(&mut figure, (126.0, 520.0));
    figure.text((140.0, 520.0), "mirror direction", small);
    if thinned {
        let text = format!("the {MOST_DOTS} worst of {}", pairs.map.len());
        figure.text((280.0, 520.0), &text, small);
    }
    Some(figure.finish())
}

fn colour(signed: f64, scale: f64) -> Rgb {
    if signed.is_nan() { INK } else { diverging(signed / scale) }
}

#[cfg(test)]
mod tests {
    use super::super::figure::{MOST_BYTES, tests::assert_well_formed};
    use super::super::synthetic::gallery;
    use super::*;

    #[test]
    fn many_pairs_stay_small_and_alike() {
        let (_, mut evidence) = gallery().remove(0);
        let pairs = evidence.pairs.as_mut().unwrap();
        let back: Vec<_> = pairs.map.iter().map(|(d, v)| (-*d, -*v)).collect();
        pairs.map.extend(back);
        pairs.map[3].1 = f64::NAN;
        let svg = picture(&evidence).unwrap();
        assert_well_formed(&svg);
        assert!(svg.len() < MOST_BYTES, "{} bytes", svg.len());
        assert!(svg.contains("the 1400 worst of 2048") && svg.contains(">\nback\n<"));
        assert_eq!(picture(&evidence).unwrap(), svg);
    }

    #[test]
    fn no_pairs_no_picture() {
        let (_, mut evidence) = gallery().remove(0);
        evidence.pairs.as_mut().unwrap().map.clear();
        assert_eq!(picture(&evidence), None);
    }
}
