//! What sample() draws, where pdf() is the textbook's.

use super::counts::{CountTest, Counts};
use super::explanation::{COUNTED_NUMBER, Claim, VAGUE};
use super::numbers::{Other, least, others};
use super::parts::At;
use super::pdf::{counts, follows};
use super::textbook::{Textbook, sampling};
use super::view::{Drawn, View};
use crate::bsdf::{Direction, Transport};
use crate::cause::Cause;
use crate::models::fresnel;
use crate::models::microfacet::NormalSampling;
use crate::registry::Value;
use std::f64::consts::FRAC_PI_2;

/// Claims about sample().
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    if !view.fails_any(&["goodness-of-fit", "jacobian", "normalization", "determinism"]) {
        return Vec::new();
    }
    let mut claims = Vec::new();
    if !view.failed.contains("determinism") {
        claims.extend(of_derivatives(view, book));
    }
    let counts = counts(view);
    let Some(book) = book.filter(|b| b.agrees.by_pdf()) else { return claims };
    let drawn: u64 = counts.iter().flat_map(|(_, c)| &c.leaves).sum();
    let draws: u64 = counts.iter().map(|(_, c)| c.draws).sum();
    if drawn * 50 < draws || follows(view, book, counts).fits() {
        return claims;
    }
    let scene = Scene { view, book, counts };
    claims.extend(scene.other_densities());
    claims.extend(scene.other_numbers());
    claims.extend(scene.turned());
    claims.extend(scene.mixed_with_a_mirror_image());
    if claims.is_empty() && !view.failed.contains("determinism") && book.agrees.by_value() {
        claims.extend(scene.something_else());
    }
    claims
}

struct Scene<'s> {
    view: &'s View<'s>,
    book: &'s Textbook,
    counts: &'s [(usize, Counts)],
}

impl Scene<'_> {
    /// The counts under a density of wo and wi; `fitted` numbers were fitted. A draw
    /// whose own pdf is 0 counts as none.
    fn test(&self, fitted: usize, density: impl Fn(Direction, Direction) -> f64) -> CountTest {
        let mut total = CountTest::default();
        for (k, c) in self.counts {
            let wo = self.view.cases[*k].wo;
            let told = !self.view.failed.contains("returned-pdf");
            let masses =
                c.masses(|wi| if told && self.book.pdf(wo, wi) == 0.0 { f64::NAN } else { density(wo, wi) });
            total = total.and(c.test(&masses, fitted));
        }
        total
    }

    fn claim(
        &self,
        test: CountTest,
        cause: Cause,
        statement: impl Into<String>,
        repair: &str,
    ) -> Option<Claim> {
        test.fits()
            .then(|| Claim::new(cause, statement, repair).likelihood(test.ln_likelihood()).p(test.ln_p()))
    }

    /// The density over the horizon, as facets have it.
    fn unclipped(&self, wo: Direction, wi: Direction) -> Option<f64> {
        let d = self.book.parts.distribution.as_ref()?;
        let sum = wo + wi;
        if wo.z <= 0.0 || sum.length() == 0.0 {
            return None;
        }
        let h = sum.normalized();
        let cos = wo.dot(h);
        if h.z <= 0.0 || cos <= 0.0 {
            return Some(0.0);
        }
        Some(match sampling(self.book)? {
            NormalSampling::All => d.density(h) * h.z / (4.0 * cos),
            NormalSampling::Visible => d.visible_density(wo, h) / (4.0 * cos),
        })
    }

    /// Whatever is drawn is kept until it is above the horizon.
    fn redrawn(&self) -> Option<Claim> {
        let (mut test, mut lost, mut all_kept) = (CountTest::default(), 0.0f64, true);
        for (k, c) in self.counts {
            let seen = &self.view.cases[*k];
            let masses = c.masses(|wi| self.book.pdf(seen.wo, wi));
            let total: f64 = masses.iter().filter(|m| m.is_finite()).sum();
            let drawn = c.leaves.iter().sum::<u64>() as f64 / c.draws as f64;
            // What is missing may be a mirror's share; and nobody draws again to have less.
            if !seen.discrete.is_empty() || drawn < total * 0.998 {
                return None;
            }
            lost = lost.max(drawn - total);
            all_kept &= drawn > 0.995;
            test = test.and(c.test(&masses.iter().map(|m| m * drawn / total).collect::<Vec<_>>(), 1));
        }
        if lost < 0.003 {
            return None;
        }
        let claim = self.claim(
            test,
            Cause::UnnormalizedRejection,
            "sample() draws again where a direction falls below the horizon, and pdf() is not divided by the mass that is left above",
            "return no sample there; or divide pdf() by the mass above the horizon, which depends on wo",
        )?;
        // Where some draws are given up, how many is a number for each wo.
        Some(if all_kept { claim } else { claim.price(COUNTED_NUMBER) })
    }

    fn other_densities(&self) -> Vec<Claim> {
        let (book, view) = (self.book, self.view);
        let mut claims = Vec::new();
        claims.extend(self.redrawn());
        let parts = &book.parts;
        let at = |wo, wi| At::new(parts, wo, wi, Transport::Radiance);
        if parts.distribution.is_some() {
            claims.extend(self.claim(
                self.test(0, |wo, wi| {
                    let at = at(wo, wi);
                    let seen = at.g2().zip(at.g1_o()).map_or(0.0, |(g2, g1)| g2 / g1);
                    book.pdf(wo, wi) * seen
                }),
                Cause::UnnormalizedRejection,
                "sample() rejects draws with probability 1 − G2/G1(wo), which pdf() knows nothing of",
                "keep every draw: shadowing belongs to the weight",
            ));
            claims.extend(self.claim(
                self.test(0, |wo, wi| {
                    let d = parts.distribution.as_ref().expect("it is known");
                    if wo.z <= 0.0 || book.pdf(wo, wi) == 0.0 {
                        return 0.0;
                    }
                    match sampling(book) {
                        Some(NormalSampling::All) => d.density(wi) * wi.z.max(0.0),
                        _ => d.visible_density(wo, wi),
                    }
                }),
                Cause::WrongDensity,
                "sample() returns the half vector that it drew, in place of the reflected direction",
                "reflect wo about the half vector: wi = 2 (wo·h) h − wo",
            ));
            claims.extend(self.claim(
                self.test(0, |wo, wi| {
                    let own = book.pdf(wo, wi);
                    let below = self.unclipped(wo, wi.flipped()).unwrap_or(0.0);
                    if wo.z > 0.0 && wi.z > 0.0 { own + below } else { 0.0 }
                }),
                Cause::UnnormalizedRejection,
                "sample() mirrors up what falls below the horizon, which pdf() knows nothing of",
                "return no sample there: mirrored directions have another density",
            ));
        }
        claims.extend(self.claim(
            self.test(0, |wo, wi| book.pdf(wo, wi.flipped())),
            Cause::UnnormalizedRejection,
            "sample() mirrors every direction to the other side",
            "mirror only what is drawn for wo behind the surface",
        ));
        if let (Some(eta), true) = (parts.eta, view.cases.iter().any(|c| c.wo.z < 0.0)) {
            let up = |wo: Direction, w: Direction| if wo.z < 0.0 { w.flipped() } else { w };
            claims.extend(self.claim(
                self.test(0, |wo, wi| book.pdf(up(wo, wo), up(wo, wi))),
                Cause::EtaSide,
                "sample() takes η and not 1/η where wo is inside",
                "invert η where cos θo < 0, before anything is refracted",
            ));
            let half = |at: &At, p: f64| {
                let relative = at.eta.unwrap_or(eta);
                let reflected = at.facet().map_or(0.0, |f| fresnel::dielectric(f.cos_o.min(1.0), relative));
                if at.reflects() { p / reflected } else { p / (1.0 - reflected) }
            };
            let half_below = |at: &At, p: f64| {
                // Where all is reflected there is no choice.
                let relative = at.eta.unwrap_or(eta);
                let all = at.facet().is_some_and(|f| fresnel::refracted_cosine(f.cos_o, relative).is_none());
                if all { 2.0 * p } else { half(at, p) }
            };
            for by in [&half as &dyn Fn(&At, f64) -> f64, &half_below] {
                claims.extend(self.claim(
                    self.test(0, |wo, wi| {
                        let (at, p) = (at(wo, wi), book.pdf(wo, wi));
                        if p > 0.0 { 0.5 * by(&at, p) } else { 0.0 }
                    }),
                    Cause::LobeProbability,
                    "sample() reflects half of the time, pdf() says with probability F",
                    "choose reflection where u < F, or put the ½ into pdf()",
                ));
            }
        }
        claims
    }

    fn other_numbers(&self) -> Vec<Claim> {
        let mut claims = Vec::new();
        let book = self.book;
        let x2 = |book: &Textbook| {
            let mut sum = 0.0;
            for (k, c) in self.counts.iter().take(2) {
                let wo = self.view.cases[*k].wo;
                let masses = c.rough_masses(|wi| book.pdf(wo, wi));
                let n = c.draws as f64;
                for (m, count) in masses.iter().zip(&c.leaves) {
                    let (e, o) = (n * m + 0.5, *count as f64 + 0.5);
                    sum += 2.0 * (o * (o / e).ln() - (o - e));
                }
                let (e, o) = (n * (1.0 - masses.iter().sum::<f64>()).max(0.0) + 0.5, c.others as f64 + 0.5);
                sum += 2.0 * (o * (o / e).ln() - (o - e));
            }
            sum
        };
        for Other { name, declared, found, book: other, .. } in others(book, x2) {
            let test = self.test(1, |wo, wi| other.pdf(wo, wi));
            claims.extend(
                self.claim(
                    test,
                    Cause::WrongDensity,
                    format!("sample() draws with {name} = {found:.4}, pdf() has {name} = {declared}"),
                    "give both functions the same parameters, after the same mapping and clamping",
                )
                .map(|c| c.price(COUNTED_NUMBER)),
            );
        }
        // Both roughnesses at once.
        if let (Some(Value::Number(x)), Some(Value::Number(y))) =
            (book.parameters.0.get("alpha"), book.parameters.0.get("alpha_y"))
            && *y > 0.0
            && x != y
        {
            for (ax, ay, what) in [
                (*x, *x, "draws with αx along both tangents"),
                (*y, *y, "draws with αy along both tangents"),
                (*y, *x, "draws with αx and αy exchanged"),
            ] {
                let other = book.with("alpha", ax).and_then(|b| b.with("alpha_y", ay));
                if let Some(other) = other {
                    claims.extend(self.claim(
                        self.test(0, |wo, wi| other.pdf(wo, wi)),
                        Cause::WrongDensity,
                        format!("sample() {what}, pdf() does not"),
                        "scale the slopes along x by αx and along y by αy, in both functions",
                    ));
                }
            }
        }
        claims
    }

    /// Azimuths by which the draws may be turned.
    fn turned(&self) -> Vec<Claim> {
        let book = self.book;
        let mut claims = Vec::new();
        let turn = |angle: &dyn Fn(Direction) -> f64| {
            let angle = |wo| angle(wo);
            self.test(1, |wo, wi| book.pdf(wo, wi.rotated(-angle(wo))))
        };
        type Angle = (fn(Direction) -> f64, &'static str, &'static str);
        let known: [Angle; 4] = [
            (
                |wo| -wo.phi(),
                "sample() draws in a frame along wo's azimuth and does not turn the direction back",
                "rotate the drawn direction by φo",
            ),
            (
                |wo| wo.phi(),
                "sample() turns the drawn direction by φo once too often",
                "rotate the drawn direction once",
            ),
            (
                |_| std::f64::consts::PI,
                "sample() draws on the opposite azimuth",
                "look for wo where −wo is meant, or the reverse",
            ),
            (
                |_| FRAC_PI_2,
                "sample() exchanges sine and cosine of the azimuth",
                "look at the frame in which the direction is built",
            ),
        ];
        for (angle, statement, repair) in known {
            claims.extend(self.claim(turn(&angle), Cause::Frame, statement, repair));
        }
        let statistic = |angle: f64| turn(&|_| angle).x2();
        // The mean of the draws against that of the textbook's.
        let Some(start) = self.mean_turn() else { return claims };
        let spread = 0.05;
        let angle = least(start - spread, start + spread, 22, statistic);
        if angle.abs() > 1e-4 {
            let statement = format!("sample() turns its directions by {:.4} rad about the normal", angle);
            let repair = "build the tangents once, and use them in sample() and pdf() alike";
            claims.extend(
                self.claim(turn(&|_| angle), Cause::Frame, statement, repair)
                    .map(|c| c.price(COUNTED_NUMBER)),
            );
        }
        claims
    }

    /// The angle between the mean of the draws and that of the textbook's, over cases.
    fn mean_turn(&self) -> Option<f64> {
        let mut sum = (0.0, 0.0);
        for seen in self.view.cases.iter().take(4) {
            let mean = |directions: &mut dyn Iterator<Item = Direction>| {
                let (x, y) = directions.fold((0.0, 0.0), |(x, y), w| (x + w.x, y + w.y));
                (x.hypot(y) > 0.0).then(|| f64::atan2(y, x))
            };
            let drawn: Vec<_> = seen.points.iter().filter_map(|p| Some((p.wi, p.drawn.as_ref()?))).collect();
            let theirs =
                drawn.iter().filter(|(_, d)| d.u.len() == self.book.dimensions()).flat_map(|(_, d)| {
                    let s = self.book.sample(seen.wo, &d.u, seen.transport);
                    (0..s.len()).filter(|k| s.lobe[*k].is_continuous()).map(|k| s.wi[k]).collect::<Vec<_>>()
                });
            let own = mean(&mut drawn.iter().map(|d| d.0));
            let theirs = mean(&mut theirs.collect::<Vec<_>>().into_iter());
            if let Some((a, b)) = own.zip(theirs) {
                sum = (sum.0 + (a - b).cos(), sum.1 + (a - b).sin());
            }
        }
        (sum.0.hypot(sum.1) > 0.0).then(|| f64::atan2(sum.1, sum.0))
    }

    /// A part of the draws is mirrored in y.
    fn mixed_with_a_mirror_image(&self) -> Vec<Claim> {
        let book = self.book;
        let (mut own, mut mirrored) = (Vec::new(), Vec::new());
        for (k, c) in self.counts {
            let wo = self.view.cases[*k].wo;
            own.push(c.rough_masses(|wi| book.pdf(wo, wi)));
            mirrored.push(c.rough_masses(|wi| book.pdf(wo, Direction::new(wi.x, -wi.y, wi.z))));
        }
        // Least squares for the share.
        let (mut top, mut bottom) = (0.0, 0.0);
        for ((a, b), (_, c)) in own.iter().zip(&mirrored).zip(self.counts) {
            let n = c.draws as f64;
            for ((a, b), count) in a.iter().zip(b).zip(&c.leaves) {
                let (change, weight) = (b - a, 1.0 / (a + b + 1.0 / n));
                top += weight * change * (*count as f64 / n - a);
                bottom += weight * change * change;
            }
        }
        let share = top / bottom;
        if !(0.0005..=1.05).contains(&share) {
            return Vec::new();
        }
        let mut test = CountTest::default();
        for ((a, b), (_, c)) in own.iter().zip(&mirrored).zip(self.counts) {
            let masses: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + share * (b - a)).collect();
            test = test.and(c.test(&masses, 1));
        }
        let claim = self.claim(
            test,
            Cause::WrongDensity,
            format!("sample() mirrors {:.2} % of its draws, y → −y", 100.0 * share),
            "mirror nothing: the lobe is symmetric about the plane of wo, not about the x axis",
        );
        claim.map(|c| c.price(COUNTED_NUMBER)).into_iter().collect()
    }

    /// pdf() and eval() are those of the textbook, and the draws are not.
    fn something_else(&self) -> Vec<Claim> {
        let mixture = self.book.lobes.len() > 1;
        let statement = format!(
            "sample() draws from another density than pdf(): pdf() and eval() are those of `{}`, and the draws are not",
            self.book.name
        );
        let repair =
            "look at the map from u to the direction: a missing square root, a wrong angle, a normalisation";
        let price = if mixture { VAGUE + 4.0 } else { VAGUE };
        vec![Claim::new(Cause::WrongDensity, statement, repair).price(price)]
    }
}

/// Step of the differences.
const STEP: f64 = 1e-6;

/// The density of a draw by the derivative of the map that drew it: of the branch
/// that it lies on. `None` where the map is not smooth there.
fn branch_density(
    view: &View,
    wo: Direction,
    transport: Transport,
    draw: (&Direction, &Drawn),
) -> Option<Slopes> {
    let (wi, drawn) = draw;
    let d = drawn.u.len();
    let mut u = Vec::new();
    for j in 0..d {
        for step in [-STEP, STEP] {
            let mut row = drawn.u.clone();
            row[j] += step;
            if !(0.0..1.0).contains(&row[j]) {
                return None;
            }
            u.extend(row);
        }
    }
    let samples = view.sample(wo, &u, transport);
    if samples.len() != 2 * d || (0..2 * d).any(|k| samples.lobe[k] != drawn.lobe) {
        return None;
    }
    let slopes: Vec<Direction> =
        (0..d).map(|j| (samples.wi[2 * j + 1] - samples.wi[2 * j]) * (0.5 / STEP)).collect();
    // A number in steps has no slope, and moves the direction all the same.
    let far: Vec<f64> = (0..d)
        .filter(|j| slopes[*j].length() <= 1e-7)
        .flat_map(|j| {
            let mut row = drawn.u.clone();
            row[j] = (row[j] + 0.37).fract();
            row
        })
        .collect();
    let far = view.sample(wo, &far, transport);
    let in_steps = (0..far.len()).any(|k| far.lobe[k].is_valid() && (far.wi[k] - *wi).length() > 1e-9);
    let mut active: Vec<Direction> = slopes.iter().copied().filter(|s| s.length() > 1e-7).collect();
    active.sort_by(|a, b| b.length().total_cmp(&a.length()));
    if active.iter().any(|s| s.length() > 1e3 || !s.is_finite()) {
        return None;
    }
    let area = match active[..] {
        [a, b] => Some(a.cross(b).dot(*wi).abs()),
        _ => None,
    };
    let flat = active.len() > 1
        && active.iter().all(|s| s.cross(active[0]).length() < 1e-4 * s.length() * active[0].length());
    Some(Slopes {
        density: area.filter(|_| !flat).map(|a| 1.0 / a),
        on_a_curve: flat || (active.len() == 1 && !in_steps),
    })
}

struct Slopes {
    density: Option<f64>,
    on_a_curve: bool,
}

/// What the derivative of the map says.
fn of_derivatives(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    if view.description.precision != crate::bsdf::Precision::F64 {
        return Vec::new();
    }
    let mut curve = [0usize; 2];
    let lobes = book.map_or(0, |b| b.lobes.len());
    let mut ratios: Vec<Vec<(f64, f64, f64)>> = (0..lobes).map(|_| Vec::new()).collect();
    for seen in view.cases.iter().take(4) {
        let drawn = seen.points.iter().filter_map(|p| Some((p, p.drawn.as_ref()?)));
        for (p, drawn) in drawn.take(96) {
            let Some(slopes) = branch_density(view, seen.wo, seen.transport, (&p.wi, drawn)) else {
                continue;
            };
            curve[1] += 1;
            curve[0] += usize::from(slopes.on_a_curve);
            let (Some(book), Some(density)) = (book, slopes.density) else { continue };
            let of = book.lobes.iter().position(|l| l.flags.is_some_and(|f| drawn.lobe.contains(f)));
            if let Some(k) = of.filter(|_| lobes > 1) {
                let own = (book.lobes[k].density)(seen.wo, p.wi);
                let share = (book.lobes[k].share)(seen.wo);
                if own > 0.0 {
                    ratios[k].push((density / own, share, seen.wo.z));
                }
            }
        }
    }
    let mut claims = Vec::new();
    if curve[1] >= 24 && curve[0] * 20 > 19 * curve[1] && view.description.dimensions >= 2 {
        claims.push(Claim::new(
            Cause::RandomNumberReuse,
            "all directions lie on a curve: both coordinates are made from the same random number",
            "use u[0] for one coordinate and u[1] for the other",
        ));
    }
    let Some(book) = book.filter(|b| b.agrees.by_pdf()) else { return claims };
    for (k, found) in ratios.iter().enumerate() {
        if found.len() < 12 {
            continue;
        }
        let at = |target: fn(f64) -> f64| {
            let near = found.iter().filter(|(r, s, _)| (r / target(*s) - 1.0).abs() < 1e-3).count();
            near as f64 >= 0.9 * found.len() as f64
        };
        let telling = found.iter().any(|(_, s, _)| *s < 0.98);
        let name = book.lobes[k].name;
        if telling && at(|_| 1.0) {
            claims.push(Claim::new(
                Cause::RandomNumberReuse,
                format!("the random number that chose {name} is used again for its direction without being stretched to [0, 1)"),
                "stretch it: u/P for the first lobe, (u − P)/(1 − P) for the second",
            ));
        } else if telling && found.iter().any(|(_, s, _)| (s - 0.5).abs() > 0.01) && at(|s| 1.0 - s) {
            claims.push(Claim::new(
                Cause::RandomNumberReuse,
                format!("the random number that chose {name} is stretched by the formula of the other lobe"),
                "stretch it by u/P for the first lobe and by (u − P)/(1 − P) for the second",
            ));
        }
    }
    claims.truncate(1);
    claims
}
