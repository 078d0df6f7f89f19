//! A case on the disc: what the sampler drew, what pdf says, and by how much
//! they differ.

use super::colours::{INK, NOTHING, Rgb, SOFT_INK, UNKNOWN, diverging, sequential};
use super::disc_frame::{Disc, Window, azimuth, cross, ring};
use super::disc_leaves::{CLIP, FEWEST, Leaves, SHARE, ZOOM_BELOW, in_sight, is_met, window};
use super::figure::{Anchor, At, Figure, Pen, TEXT, Type, shortened};
use super::numbers::{Trim, count, power_of_ten, three_digits, two_digits};
use crate::bsdf::{Direction, SubjectKind, Transport};
use crate::evidence::Evidence;
use crate::sphere::Partition;

/// Half a disc's side in pixels.
const RADIUS: f64 = 132.0;

/// Middles of the three discs, and the picture's width.
const COLUMNS: [f64; 3] = [184.0, 498.0, 812.0];
const WIDTH: f64 = 968.0;

/// Height of a row of discs, and where the first begins.
const ROW: f64 = 408.0;
const TOP: f64 = 84.0;

/// The colour scale of densities ends at this part of the largest.
const FLOOR: f64 = 1e-4;

/// Steps of the colour scales; few enough that images stay small.
const STEPS: u8 = 64;

/// What a disc's colours and its window hang on, for those who draw it elsewhere.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Scale {
    /// The scale of densities ends at this part of the largest.
    pub floor: f64,
    /// Differences are clipped here, in standard deviations.
    pub clip: f64,
    /// Where fewer are expected, a cell is not judged.
    pub fewest: f64,
    /// A window holds this share of samples and pdf.
    pub share: f64,
    /// A window with a larger half-width is not worth it.
    pub zoom_below: f64,
}

/// The one of every picture.
pub fn scale() -> Scale {
    Scale { floor: FLOOR, clip: CLIP, fewest: FEWEST, share: SHARE, zoom_below: ZOOM_BELOW }
}

/// What is said of a case besides its evidence.
#[derive(Clone, Copy, Debug, Default)]
pub struct Caption {
    /// √D of goodness-of-fit.
    pub root_d: Option<f64>,
}

/// How `wo` and the mode are written.
pub fn given(evidence: &Evidence) -> String {
    let mode = match evidence.transport {
        Transport::Radiance => "",
        Transport::Importance => ", importance",
    };
    let wo = evidence.wo;
    if wo.x == 0.0 && wo.y == 0.0 {
        return format!("θo = {:.4}°{mode}", Trim(wo.theta().to_degrees()));
    }
    format!("θo = {:.4}°, φo = {:.4}°{mode}", Trim(wo.theta().to_degrees()), Trim(azimuth(wo)))
}

/// The picture of a case; `None` where no cells were counted or integrated.
pub fn picture(evidence: &Evidence, caption: Caption) -> Option<String> {
    let partition = evidence.partition.as_ref()?;
    let leaves = Leaves::of(evidence, partition)?;
    let sides: Vec<bool> =
        [true, false].into_iter().filter(|side| is_met(partition, &leaves, *side)).collect();
    if sides.is_empty() {
        return None;
    }
    let densities = leaves.observed.iter().chain(&leaves.expected).flatten();
    let largest = densities.fold(0.0f64, |a, b| a.max(*b));
    let height = TOP + ROW * sides.len() as f64 + 76.0;
    let mut facts = given(evidence);
    if let Some(draws) = evidence.draws.first() {
        facts += &format!(",  N = {}", count(draws.samples));
    }
    if evidence.description.kind == SubjectKind::Distribution {
        facts += ",  directions are normals";
    }
    if let Some(d) = caption.root_d {
        facts += &format!(",  √D = {:.2} %", 100.0 * d);
    }
    let title = format!("{}: samples against pdf", evidence.subject);
    let description = format!(
        "{facts}. Equal-area discs of the hemisphere: observed density of samples, density expected of pdf, \
         and their difference in standard deviations per cell."
    );
    let mut figure = Figure::new(WIDTH, height, &title, &description);
    figure.text((20.0, 26.0), &shortened(&evidence.subject, 84), Type::new(Anchor::Start).size(20.0).bold());
    figure.text((20.0, 54.0), &facts, Type::new(Anchor::Start));
    for (row, front) in sides.iter().enumerate() {
        draw_row(&mut figure, evidence, partition, &leaves, *front, TOP + ROW * row as f64, largest);
    }
    draw_scales(&mut figure, &leaves, height - 68.0, largest);
    Some(figure.finish())
}

fn density_colour(density: f64, largest: f64) -> u8 {
    if density <= 0.0 {
        return 1;
    }
    let t = 1.0 + (density / largest).log10() / -FLOOR.log10();
    2 + (t.clamp(0.0, 1.0) * f64::from(STEPS - 1)).round() as u8
}

fn residual_colour(residual: f64) -> u8 {
    if residual.is_nan() {
        return 1;
    }
    let t = 0.5 + 0.5 * (residual / CLIP).clamp(-1.0, 1.0);
    2 + (t * f64::from(STEPS)).round() as u8
}

fn density_palette() -> Vec<Rgb> {
    let scale = (0..STEPS).map(|k| sequential(f64::from(k) / f64::from(STEPS - 1)));
    [NOTHING].into_iter().chain(scale).collect()
}

fn residual_palette() -> Vec<Rgb> {
    let scale = (0..=STEPS).map(|k| diverging(2.0 * f64::from(k) / f64::from(STEPS) - 1.0));
    [UNKNOWN].into_iter().chain(scale).collect()
}

/// Observed, expected and residual of one hemisphere.
fn draw_row(
    figure: &mut Figure,
    evidence: &Evidence,
    partition: &Partition,
    leaves: &Leaves,
    front: bool,
    top: f64,
    largest: f64,
) {
    let window = window(partition, leaves, front);
    let side = if front { "front" } else { "back" };
    let names = ["samples", "pdf", "difference"];
    let panels = [&leaves.observed, &leaves.expected, &leaves.residual];
    let mut labelled = true;
    for (k, values) in panels.into_iter().enumerate() {
        let at = (COLUMNS[k], top + 38.0 + RADIUS);
        let heading = Type::new(Anchor::Middle).bold();
        figure.text((at.0, top), &format!("{} ({side})", names[k]), heading);
        let Some(values) = values else {
            figure.text(at, "not measured", Type::new(Anchor::Middle).colour(SOFT_INK));
            continue;
        };
        let disc = Disc { chart: *partition.chart(), front, window, at, radius: RADIUS };
        let colour = |d: Direction| {
            let value = values[partition.locate_direction(d)];
            if k < 2 { density_colour(value, largest) } else { residual_colour(value) }
        };
        disc.fill(figure, if k < 2 { density_palette() } else { residual_palette() }, colour);
        disc.graticule(figure, labelled);
        labelled = false;
        disc.mark_ring(figure, evidence.wo);
        disc.mark_cross(figure, evidence.wo.mirrored());
    }
    for (k, text) in notes(partition, leaves, &window, front).iter().enumerate() {
        let y = top + 2.0 * RADIUS + 70.0 + 20.0 * k as f64;
        figure.text((20.0, y), text, Type::new(Anchor::Start).size(15.0));
    }
}

/// What is shown of a hemisphere, and what cannot be seen in its window.
fn notes(partition: &Partition, leaves: &Leaves, window: &Window, front: bool) -> Vec<String> {
    let seen = in_sight(partition, window, front);
    let (mut all, mut shown) = ((0.0, 0.0), (0.0, 0.0));
    let mut worst: [Option<(f64, Direction)>; 2] = [None; 2];
    for leaf in 0..partition.len() {
        let cell = partition.leaf_cell(leaf);
        if cell.is_front() != front {
            continue;
        }
        let (o, e) = leaves.shares[leaf];
        all = (all.0 + o, all.1 + e);
        if seen[leaf] {
            shown = (shown.0 + o, shown.1 + e);
        }
        let z = leaves.residual.as_ref().map_or(f64::NAN, |r| r[leaf]);
        let slot = &mut worst[usize::from(window.is_zoomed() && !seen[leaf])];
        if !z.is_nan() && slot.is_none_or(|(w, _)| z.abs() > w.abs()) {
            *slot = Some((z, partition.chart().to_direction(cell.at(0.5, 0.5))));
        }
    }
    let mut lines = Vec::new();
    if window.is_zoomed() {
        let middle = window.direction(partition.chart(), front);
        let percent = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };
        lines.push(format!(
            "zoom ×{:.3} around θ = {:.2}°, φ = {:.1}°; cells in sight hold {:.1} % of this side's samples, {:.1} % of its pdf",
            Trim(two_digits(1.0 / window.half)),
            middle.theta().to_degrees(),
            azimuth(middle),
            percent(shown.0, all.0),
            percent(shown.1, all.1)
        ));
    }
    for (place, slot) in ["largest difference", "largest outside of the window"].into_iter().zip(worst) {
        if let Some((z, d)) = slot {
            let z = format!("{z:+.1}").replace('-', "−");
            let (theta, phi) = (d.theta().to_degrees(), azimuth(d));
            lines.push(format!("{place}: {z} σ, in the cell around θ = {theta:.1}°, φ = {phi:.0}°"));
        }
    }
    lines
}

/// Both colour bars and the marks' meaning.
fn draw_scales(figure: &mut Figure, leaves: &Leaves, top: f64, largest: f64) {
    let left = COLUMNS[0] - RADIUS;
    if largest > 0.0 {
        let (from, to) = (largest * FLOOR, largest);
        let place = |v: f64| left + 40.0 + 340.0 * (v / from).log10() / (to / from).log10();
        bar(figure, (left + 40.0, top), 340.0, &density_palette()[1..]);
        figure.rectangle((left, top), (left + 22.0, top + 16.0), NOTHING);
        figure.text((left + 11.0, top + 31.0), "0", Type::new(Anchor::Middle).size(15.0));
        let first = from.log10().ceil() as i32;
        for power in first..=to.log10().floor() as i32 {
            tick(figure, (place(10f64.powi(power)), top), &power_of_ten(power));
        }
        let unit = format!("sr⁻¹, at most {}", three_digits(largest));
        figure.text((left + 392.0, top + 8.0), &unit, Type::new(Anchor::Start).size(15.0));
    }
    let left = COLUMNS[2] - RADIUS;
    if leaves.residual.is_some() {
        bar(figure, (left + 60.0, top), 170.0, &residual_palette()[1..]);
        figure.rectangle((left, top), (left + 22.0, top + 16.0), UNKNOWN);
        figure.text((left + 11.0, top + 31.0), "E<5", Type::new(Anchor::Middle).size(14.0));
        for (k, name) in ["≤−5", "0", "≥5"].into_iter().enumerate() {
            tick(figure, (left + 60.0 + 85.0 * k as f64, top), name);
        }
        figure.text((left + 240.0, top + 8.0), "σ", Type::new(Anchor::Start));
    }
    let y = top + 54.0;
    let small = Type::new(Anchor::Start).size(15.0);
    let left = COLUMNS[0] - RADIUS;
    ring(figure, (left + 8.0, y));
    figure.text((left + 22.0, y), "wo", small);
    cross(figure, (left + 68.0, y));
    figure.text((left + 82.0, y), "mirror direction", small);
    figure.text(
        (COLUMNS[2] - RADIUS, y),
        "blue: too few, orange: too many",
        small.size(14.0).colour(SOFT_INK),
    );
}

fn tick(figure: &mut Figure, (x, y): At, name: &str) {
    figure.line(&[(x, y + 16.0), (x, y + 21.0)], Pen::new(INK, 1.4));
    figure.text((x, y + 31.0), name, Type::new(Anchor::Middle).size(15.0));
}

/// A horizontal colour bar, 16 pixels high.
pub fn bar(figure: &mut Figure, (x, y): At, width: f64, colours: &[Rgb]) {
    let step = width / colours.len() as f64;
    for (k, colour) in colours.iter().enumerate() {
        let from = x + step * k as f64;
        // Overlaps the next, or seams show.
        let to = (from + step + 0.6).min(x + width);
        figure.rectangle((from, y), (to, y + 16.0), *colour);
    }
    figure.frame((x, y), (x + width, y + 16.0), Pen::new(INK, 1.0));
}

/// Text is as tall as this in every picture.
const _: () = assert!(TEXT >= 16.0, "legible at half size");

#[cfg(test)]
mod tests {
    use super::super::disc_leaves::residual;
    use super::super::figure::{MOST_BYTES, tests::assert_well_formed};
    use super::super::synthetic::gallery;
    use super::*;

    #[test]
    fn every_kind_of_lobe_is_drawn_small_and_alike() {
        for (name, evidence) in gallery() {
            let draw = || picture(&evidence, Caption { root_d: Some(0.0123) }).unwrap();
            let svg = draw();
            assert_well_formed(&svg);
            assert!(svg.len() < MOST_BYTES, "{name}: {} bytes", svg.len());
            assert_eq!(svg, draw(), "{name}");
            assert_eq!(svg.contains("zoom ×"), !["broad", "wrong"].contains(&name), "{name}");
            assert_eq!(svg.contains("(back)"), name == "glass", "{name}");
        }
    }

    #[test]
    fn an_error_outside_of_the_window_is_told() {
        let (_, hidden) = gallery().into_iter().find(|(name, _)| *name == "hidden").unwrap();
        assert!(picture(&hidden, Caption::default()).unwrap().contains("outside of the window: +"));
    }

    #[test]
    fn nothing_to_draw_is_no_picture() {
        let (_, mut evidence) = gallery().remove(0);
        evidence.integrals = None;
        assert_eq!(picture(&evidence, Caption::default()), None);
    }

    #[test]
    fn few_expected_are_not_judged_unless_many_came() {
        assert!(residual(0.0, 4.9).is_nan() && residual(4.0, 0.0).is_nan());
        assert_eq!(residual(100.0, 0.0), 100.0);
        assert_eq!(residual(110.0, 100.0), 1.0);
        assert!(residual_colour(-9.0) < residual_colour(0.0) && residual_colour(9.0) == 2 + STEPS);
    }
}
