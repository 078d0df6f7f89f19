//! A case on the disc: what the sampler drew, what pdf says, and by how much
//! they differ.

use super::colours::{INK, NOTHING, Rgb, SOFT_INK, UNKNOWN, diverging, sequential};
use super::disc_frame::{Disc, Window, azimuth, cross, ring};
use super::figure::{Anchor, At, Figure, Pen, TEXT, Type, shortened};
use crate::bsdf::{Direction, Transport};
use crate::evidence::Evidence;
use crate::sphere::{Partition, Point, STERADIANS};

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

/// Residuals are clipped here, in standard deviations.
const CLIP: f64 = 5.0;

/// A leaf with fewer expected counts is not judged by its residual.
const FEWEST: f64 = 5.0;

/// A window holds this share of the mass, and is drawn if its half-width is
/// below [`ZOOM_BELOW`].
const SHARE: f64 = 0.98;
const ZOOM_BELOW: f64 = 0.25;

/// Per leaf, what is drawn.
struct Leaves {
    /// Samples per steradian and draw.
    observed: Option<Vec<f64>>,
    /// Mass per steradian.
    expected: Option<Vec<f64>>,
    /// (O − E)/√E; NaN where too little is expected.
    residual: Option<Vec<f64>>,
    /// Share of samples and of pdf.
    shares: Vec<(f64, f64)>,
}

impl Leaves {
    fn of(evidence: &Evidence, partition: &Partition) -> Option<Self> {
        let integrals = evidence.integrals.as_ref()?;
        let draws = evidence.draws.first().filter(|d| d.samples > 0);
        let fits =
            integrals.pdf.len() == partition.len() && draws.is_none_or(|d| d.counts.len() == partition.len());
        if !fits {
            return None;
        }
        let steradians = |leaf: usize| STERADIANS * partition.leaf_cell(leaf).area();
        let per_leaf = |of: &dyn Fn(usize) -> f64| (0..partition.len()).map(of).collect::<Vec<f64>>();
        let n = draws.map_or(0.0, |d| d.samples as f64);
        let share = |leaf: usize| draws.map_or(0.0, |d| d.counts[leaf] as f64 / n);
        let has_pdf = evidence.description.has.pdf;
        let mass = |leaf: usize| if has_pdf { integrals.pdf[leaf].max(0.0) } else { 0.0 };
        Some(Self {
            observed: draws.map(|_| per_leaf(&|leaf| share(leaf) / steradians(leaf))),
            expected: has_pdf.then(|| per_leaf(&|leaf| mass(leaf) / steradians(leaf))),
            residual: (has_pdf && n > 0.0)
                .then(|| per_leaf(&|leaf| residual(n * share(leaf), n * mass(leaf)))),
            shares: (0..partition.len()).map(|leaf| (share(leaf), mass(leaf))).collect(),
        })
    }
}

/// Pearson's residual. Where fewer than [`FEWEST`] are expected it is NaN,
/// unless so many came that no such expectation explains them.
fn residual(observed: f64, expected: f64) -> f64 {
    if expected >= FEWEST {
        return (observed - expected) / expected.sqrt();
    }
    let surplus = (observed - expected) / expected.max(1.0).sqrt();
    if surplus >= CLIP { surplus } else { f64::NAN }
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
    format!("θo = {:.4}°, φo = {:.4}°{mode}", Trim(wo.theta().to_degrees()), Trim(azimuth(wo)))
}

/// A number without the zeros after its last decimal.
struct Trim(f64);

impl std::fmt::Display for Trim {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = format!("{:.*}", f.precision().unwrap_or(6), self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// A count with its thousands set apart.
pub fn count(n: u64) -> String {
    let digits = n.to_string();
    let head = digits.len() % 3;
    let mut text = digits[..head].to_string();
    for k in (head..digits.len()).step_by(3) {
        if !text.is_empty() {
            text.push('\u{2009}');
        }
        text.push_str(&digits[k..k + 3]);
    }
    text
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

/// Whether a hemisphere has any count or mass.
fn is_met(partition: &Partition, leaves: &Leaves, front: bool) -> bool {
    let side = (0..partition.len()).filter(|leaf| partition.leaf_cell(*leaf).is_front() == front);
    side.map(|leaf| leaves.shares[leaf]).any(|(observed, expected)| observed > 0.0 || expected > 0.0)
}

/// The square that holds [`SHARE`] of a hemisphere's samples and pdf, if it is
/// small; else the whole disc. A cell's mass is taken to lie where the cell is
/// nearest to the middle: the outer cells of a lobe are large, and nearly empty
/// but for their inner edge.
fn window(partition: &Partition, leaves: &Leaves, front: bool) -> Window {
    const PARTS: usize = 8;
    let chart = partition.chart();
    let mut cells: Vec<(Vec<Point>, f64)> = Vec::new();
    for leaf in 0..partition.len() {
        let cell = partition.leaf_cell(leaf);
        let weight = leaves.shares[leaf].0 + leaves.shares[leaf].1;
        if cell.is_front() == front && weight > 0.0 {
            let part = |i: usize| i as f64 / PARTS as f64;
            let grid = (0..(PARTS + 1) * (PARTS + 1)).map(|k| (k % (PARTS + 1), k / (PARTS + 1)));
            let place = |(i, j)| {
                // The corner of a front cell at the squares' seam is a back direction.
                let [u, v] = cell.at(part(i), part(j));
                let u = if front { u.min(1.0 - f64::EPSILON) } else { u };
                chart.to_disc(chart.to_direction([u, v]))
            };
            cells.push((grid.map(place).collect(), weight));
        }
    }
    let total: f64 = cells.iter().map(|c| c.1).sum();
    let quantile = |share: f64, key: &dyn Fn(&[Point]) -> f64| {
        let mut keys: Vec<(f64, f64)> = cells.iter().map(|(p, weight)| (key(p), *weight)).collect();
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sum = 0.0;
        let reached = keys.iter().find(|(_, weight)| {
            sum += weight;
            sum >= share * total
        });
        reached.map_or(1.0, |k| k.0)
    };
    let middle = PARTS / 2 * (PARTS + 2);
    let centre = [0, 1].map(|k| quantile(0.5, &|p| p[middle][k]));
    let distance = |p: &Point| (p[0] - centre[0]).abs().max((p[1] - centre[1]).abs());
    let half = 1.2 * quantile(SHARE, &|p| p.iter().map(distance).fold(f64::INFINITY, f64::min));
    if half > 0.0 && half < ZOOM_BELOW { Window { centre, half } } else { Window::WHOLE }
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

/// Leaves of which a part can be seen.
fn in_sight(partition: &Partition, window: &Window, front: bool) -> Vec<bool> {
    const GRID: usize = 128;
    let chart = partition.chart();
    let mut seen: Vec<bool> = (0..partition.len())
        .map(|leaf| {
            let middle = chart.to_direction(partition.leaf_cell(leaf).at(0.5, 0.5));
            (middle.z > 0.0) == front && window.holds(chart.to_disc(middle))
        })
        .collect();
    for k in 0..GRID * GRID {
        let part = |i: usize| window.half * (2.0 * (i as f64 + 0.5) / GRID as f64 - 1.0);
        let at = [window.centre[0] + part(k % GRID), window.centre[1] + part(k / GRID)];
        if let Some(d) = chart.from_disc(at, front) {
            seen[partition.locate_direction(d)] = true;
        }
    }
    seen
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

/// Two digits of a factor.
fn two_digits(factor: f64) -> f64 {
    let unit = 10f64.powf(factor.log10().floor() - 1.0);
    (factor / unit).round() * unit
}

/// Three digits, or all before the decimal point.
pub fn three_digits(value: f64) -> String {
    if !(1e-3..1e6).contains(&value.abs()) && value != 0.0 {
        return format!("{value:.2e}").replace('-', "−");
    }
    let digits = (2.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}").replace('-', "−")
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

/// 10ⁿ, or the number itself near 1.
pub fn power_of_ten(power: i32) -> String {
    match power {
        -2 => "0.01".into(),
        -1 => "0.1".into(),
        0 => "1".into(),
        1 => "10".into(),
        2 => "100".into(),
        _ => {
            let superscript = |c: char| match c {
                '-' => '⁻',
                '1' => '¹',
                '2' => '²',
                '3' => '³',
                digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
            };
            format!("10{}", power.to_string().chars().map(superscript).collect::<String>())
        }
    }
}

/// Text is as tall as this in every picture.
const _: () = assert!(TEXT >= 16.0, "legible at half size");

#[cfg(test)]
mod tests {
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

    #[test]
    fn numbers_read_well() {
        assert_eq!([7, 262_144, 1_000_000].map(count), ["7", "262\u{2009}144", "1\u{2009}000\u{2009}000"]);
        assert_eq!([-3, 2, 14].map(power_of_ten), ["10⁻³", "100", "10¹⁴"]);
        assert_eq!(format!("{:.4} {:.4} {:.4}", Trim(30.0), Trim(0.25), Trim(0.0)), "30 0.25 0");
    }

    /// Writes the gallery to the folder that GONIO_GALLERY names, to be looked at.
    #[test]
    #[ignore = "for the eyes"]
    fn gallery_to_look_at() {
        let folder = std::env::var("GONIO_GALLERY").expect("GONIO_GALLERY names a folder");
        for (name, evidence) in gallery() {
            let svg = picture(&evidence, Caption { root_d: Some(0.0123) }).unwrap();
            std::fs::write(format!("{folder}/{name}.svg"), svg).unwrap();
        }
    }
}
