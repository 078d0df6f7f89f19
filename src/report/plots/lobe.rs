//! A lobe as a polar diagram in the plane of incidence: what was drawn, what pdf says,
//! and f·|cos θi|.

use super::angle_axis::AngleAxis;
use super::axes::{Axes, log_ticks, mark};
use super::colours::{INK, LINES, Rgb, SOFT_INK};
use super::disc::given;
use super::disc_frame::{cross, nice_step, ring};
use super::figure::{Anchor, At, Figure, Pen, Type, shortened};
use super::numbers::{Trim, power_of_ten, three_digits};
use crate::bsdf::SubjectKind;
use crate::evidence::{Densities, Evidence, Plane, Stretch, plane_densities, refracted};

/// Width of the polar diagram, and of the picture with a closer look beside it.
const WIDTH: f64 = 720.0;
const WIDER: f64 = 1160.0;

/// Radius of the diagram in pixels: of a half circle, of a whole one.
const RADIUS: (f64, f64) = (270.0, 200.0);

/// Where densities differ more than this from an even one, radii are logarithmic, down
/// to this part of the largest.
const EVEN: f64 = 8.0;
const FLOOR: f64 = 1e-4;

/// The same for the closer look.
const CLOSER: f64 = 1e-10;

/// A curve of densities per steradian by θ in degrees.
struct Curve {
    points: Vec<(f64, f64)>,
    colour: Rgb,
    how: How,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum How {
    Marks,
    Solid,
    Dashed,
}

impl Curve {
    fn pen(&self) -> Pen {
        let pen = Pen::new(self.colour, 2.2);
        if self.how == How::Dashed { pen.dashed() } else { pen }
    }
}

/// The curves of a case over one or both sides: pdf, f·|cos θi|, and what was drawn.
fn curves(evidence: &Evidence, densities: &[Densities], whole: bool) -> Vec<Curve> {
    let has = evidence.description.has;
    let seen = densities.iter().filter(|d| whole || d.degrees.abs() < 90.0);
    let points = |of: fn(&Densities) -> f64| seen.clone().map(|d| (d.degrees, of(d))).collect();
    let mut curves = Vec::new();
    if has.pdf {
        curves.push(Curve { points: points(|d| d.pdf), colour: LINES[1], how: How::Solid });
    }
    let integrated = evidence.integrals.as_ref().is_some_and(|i| !i.value.is_empty());
    // What normals have for a value is no light.
    if has.eval && integrated && evidence.description.kind == SubjectKind::Bsdf {
        curves.push(Curve { points: points(|d| d.flux), colour: LINES[2], how: How::Dashed });
    }
    curves.push(Curve { points: points(|d| d.drawn), colour: LINES[0], how: How::Marks });
    curves
}

/// Where densities are in the polar diagram.
struct Polar {
    middle: At,
    radius: f64,
    largest: f64,
    logarithmic: bool,
    /// 1 where wo's side is up, −1 where it is down.
    up: f64,
}

impl Polar {
    fn at(&self, theta: f64, r: f64) -> At {
        let (sin, cos) = theta.to_radians().sin_cos();
        (self.middle.0 + r * sin, self.middle.1 - self.up * r * cos)
    }

    fn r(&self, density: f64) -> f64 {
        let part = density / self.largest;
        let t = if self.logarithmic { 1.0 + part.max(1e-300).log10() / -FLOOR.log10() } else { part };
        t.clamp(0.0, 1.0) * self.radius
    }

    fn place(&self, theta: f64, density: f64) -> At {
        self.at(theta, self.r(density))
    }

    /// An arc or a circle, `up` being its upper half.
    fn arc(&self, figure: &mut Figure, r: f64, whole: bool, pen: Pen) {
        let reach = if whole { 180 } else { 90 };
        let points: Vec<At> = (-reach..=reach).step_by(3).map(|x| self.at(f64::from(x), r)).collect();
        figure.line(&points, pen);
    }

    fn draw(&self, figure: &mut Figure, whole: bool) {
        let faint = Pen::new(SOFT_INK, 0.8).opacity(0.45);
        let reach = if whole { 180 } else { 90 };
        for x in (-reach..=reach).step_by(30) {
            let x = f64::from(x);
            figure.line(&[self.middle, self.at(x, self.radius)], faint);
            if x > -180.0 {
                let far = self.at(x, self.radius + 30.0);
                let name = format!("{x}°").replace('-', "−");
                figure.text(far, &name, Type::new(Anchor::Middle).size(14.0).colour(SOFT_INK));
            }
        }
        for (density, name) in self.rings() {
            let r = self.r(density);
            self.arc(figure, r, whole, faint);
            // Beside the horizon, where no direction is marked.
            let (x, y) = self.at(-90.0, r);
            let at = (x, y + 13.0 * self.up);
            // In the middle there is no room, and at the rim the angle is told.
            if (0.3..0.92).contains(&(r / self.radius)) {
                figure.text(at, &name, Type::new(Anchor::Middle).size(14.0).colour(SOFT_INK).rim());
            }
        }
        self.arc(figure, self.radius, whole, Pen::new(INK, 1.4));
        let ends = [-90.0, 90.0].map(|x| self.at(x, self.radius));
        figure.line(&ends, Pen::new(INK, 1.4));
    }

    fn rings(&self) -> Vec<(f64, String)> {
        if self.logarithmic {
            let powers = (-6..=15).map(|power| (10f64.powi(power), power_of_ten(power)));
            return powers
                .filter(|(d, _)| *d > 3.0 * FLOOR * self.largest && *d < 0.9 * self.largest)
                .collect();
        }
        let step = nice_step(self.largest / 3.5);
        let rings = (1..4).map(|k| (f64::from(k) * step, Trim(f64::from(k) * step).to_string()));
        rings.filter(|(d, _)| *d < 0.95 * self.largest).collect()
    }
}

/// The picture of a case; `None` where nothing was drawn near the plane of incidence.
pub fn picture(evidence: &Evidence) -> Option<String> {
    let (stretch, densities) = plane_densities(evidence)?;
    let discrete = &evidence.draws.first()?.discrete;
    let plane = Plane::of(evidence.wo);
    let transmitted = |x: f64| x.abs() > 90.0;
    let largest = |of: &dyn Fn(&Densities) -> bool| {
        let seen = densities.iter().filter(|d| of(d));
        seen.flat_map(|d| [d.drawn, d.pdf, d.flux]).filter(|v| v.is_finite()).fold(0.0, f64::max)
    };
    let whole =
        largest(&|d| transmitted(d.degrees)) > 0.0 || discrete.iter().any(|d| transmitted(plane.theta(d.wi)));
    let curves = curves(evidence, &densities, whole);
    let largest = largest(&|_| true);
    if largest <= 0.0 && discrete.is_empty() {
        return None;
    }
    let narrow = (stretch != Stretch::Even).then_some(stretch);
    let (width, height) = (if narrow.is_some() { WIDER } else { WIDTH }, if whole { 640.0 } else { 540.0 });
    let title = format!("{}: lobe", evidence.subject);
    let note = format!("densities in the plane of incidence, {}", given(evidence));
    let description = "Polar diagram in the plane of incidence: density of samples, of pdf(), and f cos scaled to \
                       the same total; wo, its mirror direction, and discrete lobes.";
    let mut figure = Figure::new(width, height, &title, description);
    let bold = Type::new(Anchor::Start).size(20.0).bold();
    figure.text((20.0, 26.0), &shortened(&evidence.subject, (width / 13.0) as usize), bold);
    figure.text((20.0, 54.0), &note, Type::new(Anchor::Start).colour(SOFT_INK));

    let back = evidence.wo.z < 0.0;
    let polar = Polar {
        middle: (
            330.0,
            if whole {
                330.0
            } else if back {
                120.0
            } else {
                410.0
            },
        ),
        radius: if whole { RADIUS.1 } else { RADIUS.0 },
        largest: if largest > 0.0 { largest } else { 1.0 },
        logarithmic: largest * std::f64::consts::TAU > EVEN,
        up: if back { -1.0 } else { 1.0 },
    };
    polar.draw(&mut figure, whole);
    if largest > 0.0 {
        for curve in &curves {
            draw_curve(&mut figure, curve, |x, d| polar.place(x, d));
        }
    }
    draw_discrete(&mut figure, evidence, &plane, &polar);
    draw_directions(&mut figure, evidence, &plane, &polar, whole);
    if let Some(stretch) = narrow {
        closer(&mut figure, &curves, evidence, stretch, height);
    }
    legend(&mut figure, &curves, evidence, &polar, height);
    Some(figure.finish())
}

fn draw_curve(figure: &mut Figure, curve: &Curve, place: impl Fn(f64, f64) -> At) {
    if curve.how == How::Marks {
        for (x, d) in curve.points.iter().filter(|p| p.1 > 0.0) {
            figure.dot(place(*x, *d), 3.6, curve.colour);
        }
        return;
    }
    let line: Vec<At> = curve.points.iter().map(|(x, d)| place(*x, *d)).collect();
    figure.line(&line, curve.pen());
}

/// Rays of discrete lobes: as long as they were drawn often, with a stroke where their
/// probability ends.
fn draw_discrete(figure: &mut Figure, evidence: &Evidence, plane: &Plane, polar: &Polar) {
    let Some(draws) = evidence.draws.first() else { return };
    for lobe in &draws.discrete {
        let x = plane.theta(lobe.wi);
        let share = lobe.count as f64 / draws.samples.max(1) as f64;
        let r = |part: f64| part.clamp(0.0, 1.0) * polar.radius;
        figure.line(&[polar.middle, polar.at(x, r(share))], Pen::new(LINES[0], 5.0));
        let told = polar.at(x, r(lobe.probability));
        let (sin, cos) = x.to_radians().sin_cos();
        let ends = [-9.0, 9.0].map(|k| (told.0 + k * cos, told.1 + polar.up * k * sin));
        figure.line(&ends, Pen::new(LINES[1], 3.0));
        let name = format!("{} drawn", three_digits(share));
        let how = Type::new(if x < 0.0 { Anchor::End } else { Anchor::Start }).size(14.0).rim();
        let aside = if x < 0.0 { -14.0 } else { 14.0 };
        let at = polar.at(x, r(0.5 * share.max(0.25)));
        figure.text((at.0 + aside, at.1), &name, how);
    }
}

/// wo and where a smooth surface sends it.
fn draw_directions(figure: &mut Figure, evidence: &Evidence, plane: &Plane, polar: &Polar, whole: bool) {
    let wo = evidence.wo;
    let rim = polar.radius;
    figure.line(&[polar.middle, polar.at(plane.theta(wo), rim)], Pen::new(INK, 1.0).opacity(0.6));
    ring(figure, polar.at(plane.theta(wo), rim));
    if evidence.description.kind != SubjectKind::Bsdf {
        return;
    }
    cross(figure, polar.at(plane.theta(wo.mirrored()), rim));
    let through = evidence.description.claims.eta.and_then(|eta| refracted(wo, eta)).filter(|_| whole);
    if let Some(wi) = through {
        cross(figure, polar.at(plane.theta(wi), rim));
    }
}

/// The same densities over an axis that is spread out at the lobe.
fn closer(figure: &mut Figure, curves: &[Curve], evidence: &Evidence, stretch: Stretch, height: f64) {
    let points = || curves.iter().flat_map(|c| &c.points);
    let reach = if points().any(|p| p.0.abs() > 90.0) { 180.0 } else { 90.0 };
    let angles = AngleAxis::new(stretch, (-reach, reach), 30.0);
    let largest = points().map(|p| p.1).fold(0.0, f64::max);
    let least = points().map(|p| p.1).filter(|d| *d > CLOSER * largest).fold(largest, f64::min);
    let y = (least.log10() - 0.2, largest.log10() + 0.2);
    let axes = Axes { from: (740.0, 90.0), to: (1130.0, height - 130.0), x: angles.ends(), y };
    axes.ticks_x(figure, &angles.ticks(390.0));
    axes.ticks_y(figure, &log_ticks(y, 8));
    axes.outline(figure, &angles.name("θi"), "density, sr⁻¹");
    let mut marks = vec![(-90.0, "horizon"), (90.0, "horizon")];
    if evidence.description.kind == SubjectKind::Bsdf {
        marks.push((Plane::of(evidence.wo).theta(evidence.wo.mirrored()), "mirror"));
    }
    for curve in curves {
        draw_curve(figure, curve, |x, d| axes.clamped(angles.place(x), d.max(1e-300).log10()));
    }
    angles.landmarks(figure, &axes, &marks);
}

fn legend(figure: &mut Figure, curves: &[Curve], evidence: &Evidence, polar: &Polar, height: f64) {
    let small = Type::new(Anchor::Start).size(15.0);
    let soft = small.colour(SOFT_INK);
    let drawn = curves.iter().any(|c| c.points.iter().any(|p| p.1 > 0.0));
    let (mut x, y) = (30.0, height - 62.0);
    for curve in curves.iter().filter(|_| drawn) {
        let name = match curve.how {
            How::Marks => "samples",
            How::Solid => "pdf()",
            How::Dashed => "f·|cos θi|, scaled",
        };
        if curve.how == How::Marks {
            mark(figure, (x + 26.0, y), 0, curve.colour);
        } else {
            figure.line(&[(x, y), (x + 34.0, y)], curve.pen());
        }
        figure.text((x + 42.0, y), name, small);
        x += 66.0 + 7.6 * name.chars().count() as f64;
    }
    ring(figure, (x + 8.0, y));
    figure.text((x + 22.0, y), "wo", small);
    if evidence.description.kind == SubjectKind::Bsdf {
        cross(figure, (x + 68.0, y));
        figure.text((x + 82.0, y), "mirror, refracted", small);
    }
    let radius = if polar.logarithmic { "logarithmic" } else { "linear" };
    let mut notes = Vec::new();
    if drawn {
        notes.push(format!("radius: sr⁻¹, {radius}, {} at the rim", three_digits(polar.largest)));
    }
    if evidence.draws.first().is_some_and(|d| !d.discrete.is_empty()) {
        notes.push("rays: discrete lobes, of share 1 at the rim; stroke: the probability told".into());
    }
    for (k, note) in notes.iter().enumerate() {
        figure.text((30.0, height - 38.0 + 21.0 * k as f64), note, soft);
    }
}

#[cfg(test)]
mod tests {
    use super::super::figure::tests::assert_well_formed;
    use super::super::synthetic::gallery;
    use super::*;

    fn named(which: &str) -> Evidence {
        gallery().into_iter().find(|(name, _)| *name == which).unwrap().1
    }

    fn of(evidence: &Evidence) -> Vec<Curve> {
        curves(evidence, &plane_densities(evidence).unwrap().1, false)
    }

    #[test]
    fn every_kind_of_lobe_is_drawn_small_and_alike() {
        for (name, evidence) in gallery() {
            let draw = || picture(&evidence).unwrap();
            let svg = draw();
            assert_well_formed(&svg);
            assert!(svg.len() < 60_000, "{name}: {} bytes", svg.len());
            assert_eq!(svg, draw(), "{name}");
            let broad = ["broad", "wrong", "glass"].contains(&name);
            assert_eq!(svg.contains("spread out there"), !broad, "{name}");
            assert_eq!(svg.contains("\n150°\n"), name == "glass", "{name}");
        }
    }

    #[test]
    fn samples_lie_on_pdf_where_they_follow_it_and_beside_it_where_not() {
        let off = |evidence: &Evidence| {
            let curves = of(evidence);
            let [pdf, drawn] =
                [How::Solid, How::Marks].map(|how| curves.iter().find(|c| c.how == how).unwrap());
            let largest = pdf.points.iter().map(|p| p.1).fold(0.0, f64::max);
            let near = pdf.points.iter().zip(&drawn.points).filter(|(p, _)| p.1 > 0.2 * largest);
            near.clone().map(|(p, d)| (d.1 / p.1 - 1.0).abs()).sum::<f64>() / near.count() as f64
        };
        let [right, wrong] = ["broad", "wrong"].map(|name| off(&named(name)));
        assert!(right < 0.03 && wrong > 0.06, "{right} {wrong}");
        // f·cos of the synthetic lobes is pdf times the albedo.
        let curves = of(&named("broad"));
        let [pdf, value] = [How::Solid, How::Dashed].map(|how| curves.iter().find(|c| c.how == how).unwrap());
        for (p, v) in pdf.points.iter().zip(&value.points) {
            assert!((v.1 - p.1).abs() < 1e-9 * p.1, "{p:?} {v:?}");
        }
    }

    #[test]
    fn discrete_lobes_are_rays() {
        use crate::bsdf::Lobe;
        use crate::evidence::{DiscreteLobe, Tally};
        let mut evidence = named("broad");
        let mirror = DiscreteLobe {
            wi: evidence.wo.mirrored(),
            lobe: Lobe::DISCRETE,
            probability: 0.5,
            weight: vec![1.0; 3],
            count: evidence.draws[0].samples / 4,
            spread: Tally::default(),
        };
        evidence.draws[0].discrete.push(mirror);
        let svg = picture(&evidence).unwrap();
        assert_well_formed(&svg);
        assert!(svg.contains("0.250 drawn") && svg.contains("rays: discrete lobes"), "{svg}");
    }

    #[test]
    fn nothing_drawn_is_no_picture() {
        let mut evidence = named("broad");
        evidence.draws.clear();
        assert_eq!(picture(&evidence), None);
    }
}
