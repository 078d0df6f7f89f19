//! What shows at single inputs, in repeated calls, and in parameters without effect.

use super::explanation::{Claim, DENSITY, VAGUE};
use super::textbook::{EQUAL, Textbook};
use super::view::{Seen, View};
use crate::bsdf::{Direction, Precision, Samples};
use crate::cause::Cause;
use crate::evidence::CHANGE;
use crate::models::fresnel;
use crate::statistics::streams::StreamKey;

/// Checks that unsound numbers make fail.
const UNSOUND: &[&str] = &[
    "sanity",
    "goodness-of-fit",
    "normalization",
    "support",
    "albedo",
    "mis",
    "sensitivity",
    "white-furnace",
    "jacobian",
    "energy",
    "discrete-lobes",
];

/// Checks that a number which is none at single inputs makes fail.
const ISOLATED: &[&str] = &["sanity", "sensitivity", "reference"];

/// Claims about inputs.
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let mut claims = Vec::new();
    if view.failed.contains("determinism") {
        claims.push(
            Claim::new(
                Cause::RandomNumberReuse,
                "equal random numbers give different samples: a generator or a state is kept inside",
                "make every choice from u; or claim that random numbers are internal",
            )
            .covers(&[
                "determinism",
                "jacobian",
                "goodness-of-fit",
                "sensitivity",
                "support",
                "mis",
            ]),
        );
    }
    if view.failed.contains("sanity") {
        claims.extend(unsound(view, book));
    }
    claims.extend(nothing_drawn(view));
    claims.extend(without_effect(view));
    claims.extend(few_points(view, book));
    claims.extend(noise(view));
    claims
}

/// Draws as they come, and which of them are unsound.
struct Raw {
    u: Vec<Vec<f64>>,
    samples: Samples,
    broken: Vec<bool>,
}

fn raw(view: &View, seen: &Seen) -> Raw {
    let d = view.description.dimensions.max(1);
    let mut u = vec![0.0; 512 * d];
    StreamKey::new(0).with("stage", "unsound").block(0).fill(false, &mut u);
    let samples = view.sample(seen.wo, &u, seen.transport);
    let broken = (0..samples.len())
        .map(|k| {
            let unit = (samples.wi[k].length() - 1.0).abs() < 1e-7;
            let weight = samples.weight_of(k).iter().all(|w| w.is_finite() && *w >= 0.0);
            let sound = unit && samples.pdf[k].is_finite() && samples.pdf[k] >= 0.0 && weight;
            samples.lobe[k].is_valid() && !sound
        })
        .collect();
    Raw { u: u.chunks_exact(d).map(<[f64]>::to_vec).collect(), samples, broken }
}

/// Numbers that are none.
fn unsound(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let raws: Vec<(&Seen, Raw)> = view
        .cases
        .iter()
        .filter(|s| s.failed.contains("sanity") || !s.evidence.sanity.tallies.is_empty())
        .map(|s| (s, raw(view, s)))
        .collect();
    let broken: usize = raws.iter().map(|(_, r)| r.broken.iter().filter(|b| **b).count()).sum();
    let drawn: usize = raws.iter().map(|(_, r)| r.broken.len()).sum();
    let sentences: Vec<&str> =
        view.cases.iter().flat_map(|s| s.evidence.sanity.tallies.keys()).map(String::as_str).collect();
    if broken == 0 {
        let negative = sentences.iter().any(|s| s.ends_with("≥ 0"));
        let of = sentences.first().copied().unwrap_or("a function returns what it must");
        let statement = if sentences.is_empty() {
            "a call fails at a hostile input".to_string()
        } else if negative {
            format!("a value is negative: `{of}` does not hold")
        } else {
            format!("`{of}` does not hold at single inputs: a limit is not taken")
        };
        return vec![
            Claim::new(
                Cause::Numerics,
                statement,
                "look at the input below: what is divided, rooted or raised to a power there",
            )
            .covers(if negative { UNSOUND } else { ISOLATED })
            .price(3.0)
            .because(input(view)),
        ];
    }
    let mut claims = Vec::new();
    // The values themselves are none, wherever they are asked for.
    let points = || view.cases.iter().flat_map(|s| &s.points);
    let lost = |f: fn(&super::Point) -> bool| points().filter(|p| f(p)).count();
    for (name, off) in [
        ("eval()", lost(|p| p.value.iter().any(|f| !f.is_finite()))),
        ("pdf()", lost(|p| !p.pdf.is_finite())),
    ] {
        if off * 50 > points().count() {
            claims.push(
                Claim::new(
                    Cause::Numerics,
                    format!("{name} is no number in {:.0} % of all directions", 100.0 * off as f64 / points().count() as f64),
                    "look at what is divided, rooted or raised to a power there: 0/0, or the power of a negative number",
                )
                .covers(UNSOUND)
                .price(2.0),
            );
        }
    }
    if !claims.is_empty() {
        return claims;
    }
    // Beyond the critical angle.
    if let Some(eta) = view.description.claims.eta {
        let total = |wo: Direction, h: Direction| {
            let relative = if wo.z > 0.0 { eta } else { 1.0 / eta };
            fresnel::refracted_cosine(wo.dot(h).abs(), relative).is_none()
        };
        let (mut explained, mut all, mut beyond) = (0, 0, 0);
        for (seen, r) in &raws {
            let theirs = book.filter(|b| b.dimensions() == view.description.dimensions);
            for k in 0..r.broken.len() {
                // The facet, from what the textbook draws.
                let h = match theirs.map(|b| b.sample(seen.wo, &r.u[k], seen.transport)) {
                    Some(s) if s.len() == 1 && s.lobe[0].is_valid() && s.wi[0].same_side(seen.wo) => {
                        (seen.wo + s.wi[0]).normalized()
                    }
                    Some(_) => continue,
                    None => Direction::NORMAL,
                };
                if r.broken[k] {
                    all += 1;
                    explained += usize::from(total(seen.wo, h));
                }
                beyond += usize::from(total(seen.wo, h));
            }
        }
        if all > 0 && explained == all && beyond * 10 <= all * 11 {
            claims.push(
                Claim::new(
                    Cause::EtaSide,
                    "sample() fails where all light is reflected: beyond the critical angle there is no refracted direction",
                    "ask whether refraction succeeds, and reflect where it does not",
                )
                .covers(UNSOUND),
            );
        }
    }
    // Every draw is unsound in one way.
    let lengths: Vec<f64> = raws
        .iter()
        .flat_map(|(_, r)| (0..r.broken.len()).filter(|k| r.broken[*k]).map(|k| r.samples.wi[k].length()))
        .collect();
    let halfway = raws.iter().all(|(s, r)| {
        (0..r.broken.len())
            .filter(|k| r.broken[*k])
            .all(|k| ((r.samples.wi[k] + s.wo).length() - 2.0).abs() < 1e-6)
    });
    // Directions of this length are unsound in another way.
    let rounding = if view.description.precision == Precision::F32 { 1e-5 } else { 1e-7 };
    let constant = lengths.iter().all(|l| (l - lengths[0]).abs() < 1e-6 * lengths[0]);
    if halfway && !constant {
        claims.push(
            Claim::new(
                Cause::WrongDensity,
                "wi is 2 h − wo: the reflection lacks the factor wo·h, and wi is not of unit length",
                "wi = 2 (wo·h) h − wo",
            )
            .covers(UNSOUND),
        );
    } else if constant && lengths[0].is_finite() && (lengths[0] - 1.0).abs() > rounding && lengths[0] > 0.0 {
        claims.push(
            Claim::new(
                Cause::Numerics,
                format!("wi is not normalised: |wi| = {:.6}", lengths[0]),
                "normalise the half vector or the direction before it is returned",
            )
            .covers(UNSOUND),
        );
    }
    let share = broken as f64 / drawn as f64;
    let lobes = book.map_or(1, |b| b.lobes.len());
    if claims.is_empty() && share < 0.02 {
        claims.push(
            Claim::new(
                Cause::Numerics,
                "a few draws are no numbers",
                "look at the input below: what is divided, rooted or raised to a power there",
            )
            .covers(UNSOUND)
            .price(3.0)
            .because(input(view)),
        );
    } else if claims.is_empty() {
        // Half of the numbers u are unsound by how a lobe was chosen, or by a wrong map.
        let by_lobe = lobes > 1 && book.is_some_and(|b| split_by_share(b, &raws));
        if by_lobe {
            claims.push(
                Claim::new(
                    Cause::RandomNumberReuse,
                    "the random number that chose a lobe is stretched beyond [0, 1]: by the formula of the other lobe",
                    "stretch it by u/P for the first lobe and by (u − P)/(1 − P) for the second",
                )
                .covers(UNSOUND)
                .price(2.0),
            );
        } else if lobes == 1 {
            claims.push(
                Claim::new(
                    Cause::WrongDensity,
                    format!(
                        "{:.0} % of the draws are no directions: the map from u leaves its domain",
                        100.0 * share
                    ),
                    "look at the inverse of the distribution function: what must lie in [−1, 1] or [0, 1]",
                )
                .covers(UNSOUND)
                .price(VAGUE),
            );
        }
    }
    claims
}

/// The worst input, in words.
fn input(view: &View) -> String {
    let tallies = view.cases.iter().flat_map(|s| &s.evidence.sanity.tallies);
    let Some((sentence, place)) = tallies.filter_map(|(s, t)| Some((s, t.place.as_ref()?))).next() else {
        return view
            .cases
            .iter()
            .flat_map(|s| &s.evidence.halts)
            .next()
            .map_or_else(|| "no input is on record".into(), |(_, halt)| format!("{halt}"));
    };
    let angles = |w: Direction| format!("θ {:.3}°, φ {:.3}°", w.theta().to_degrees(), w.phi().to_degrees());
    let wi = place.wi.filter(|w| w.is_finite()).map_or(String::new(), |w| format!(", wi {}", angles(w)));
    let u = if place.u.is_empty() { String::new() } else { format!(", u = {:?}", place.u) };
    format!("`{sentence}` does not hold at wo {}{wi}{u}", angles(place.wo))
}

/// Whether draws are unsound in one lobe by its choice: those with the first number
/// on one side of the lobes' border, or near it.
fn split_by_share(book: &Textbook, raws: &[(&Seen, Raw)]) -> bool {
    raws.iter().filter(|(s, _)| s.wo.z > 0.0).all(|(seen, r)| {
        let share = (book.lobes[0].share)(seen.wo);
        let (mut below, mut above) = ([0usize; 2], [0usize; 2]);
        for k in 0..r.broken.len() {
            let side = if r.u[k][0] < share { &mut below } else { &mut above };
            side[1] += 1;
            side[0] += usize::from(r.broken[k] || !r.samples.lobe[k].is_valid());
        }
        // One side is broken altogether, and the other one in part or not at all.
        let whole = |[broken, all]: [usize; 2]| all > 8 && broken * 10 >= all * 9;
        let part = |[broken, all]: [usize; 2]| all > 8 && broken * 10 < all * 9;
        let all = whole(below) && whole(above) && book.lobes.len() == 2;
        all || (whole(below) && part(above)) || (part(below) && whole(above))
    })
}

/// sample() gives nothing.
fn nothing_drawn(view: &View) -> Vec<Claim> {
    let fails = view.fails_any(&["goodness-of-fit", "normalization", "albedo", "support", "sanity"]);
    let none = view.cases.iter().all(|s| s.discrete.is_empty() && s.points.iter().all(|p| p.drawn.is_none()));
    // One that fails returns nothing either, and says why.
    let halted = || view.cases.iter().any(|s| !s.evidence.halts.is_empty());
    let unsound = || view.cases.iter().any(|s| raw(view, s).broken.iter().any(|b| *b));
    if !fails || !none || !view.description.has.sample || halted() || unsound() {
        return Vec::new();
    }
    vec![
        Claim::new(
            Cause::Parameter,
            "sample() never returns a direction",
            "look for a condition that is inverted: an early return where sampling should begin",
        )
        .covers(UNSOUND)
        .price(2.0),
    ]
}

/// Parameters that change nothing.
fn without_effect(view: &View) -> Vec<Claim> {
    if !view.failed.contains("sensitivity") {
        return Vec::new();
    }
    let mut idle: Vec<&str> = Vec::new();
    for seen in &view.cases {
        for v in seen.evidence.variations.iter().flatten() {
            if v.limit.is_none() && v.change.0 < CHANGE && !idle.contains(&v.parameter.as_str()) {
                idle.push(&v.parameter);
            }
        }
    }
    // What has an effect somewhere is not idle.
    idle.retain(|name| {
        view.cases
            .iter()
            .flat_map(|s| s.evidence.variations.iter().flatten())
            .all(|v| v.parameter != *name || v.limit.is_some() || v.change.0 < CHANGE)
    });
    if idle.is_empty() {
        return Vec::new();
    }
    vec![
        Claim::new(
            Cause::Parameter,
            format!("{} changes nothing", idle.join(" and ")),
            "follow it from where it is read to where it is used: a default, a slot, a shadowed variable",
        )
        .covers(&["sensitivity", "reference", "energy"])
        .price(2.0),
    ]
}

/// pdf() and eval() are the textbook's but at a few points next to each other.
fn few_points(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let Some(book) = book.filter(|b| b.agrees.by_pdf() || b.agrees.by_value()) else { return Vec::new() };
    if !view.fails_any(&["goodness-of-fit", "normalization", "albedo"]) {
        return Vec::new();
    }
    let (mut off, mut all, mut widest, mut nearest) = (0, 0, 0.0f64, f64::INFINITY);
    for seen in &view.cases {
        for p in &seen.points {
            let theirs = book.pdf(seen.wo, p.wi);
            let sum = seen.wo + p.wi;
            if !seen.wo.same_side(p.wi) || theirs <= 0.0 || sum.length() == 0.0 {
                continue;
            }
            let h = sum.normalized();
            let sin = h.x.hypot(h.y);
            all += 1;
            if (p.pdf - theirs).abs() > EQUAL * theirs {
                off += 1;
                widest = widest.max(sin);
            } else {
                nearest = nearest.min(sin);
            }
        }
    }
    if off < 2 || off * 5 > all || widest > 0.05 || widest > nearest {
        return Vec::new();
    }
    vec![
        Claim::new(
            Cause::Numerics,
            format!("pdf() is wrong where h is within {widest:.3} rad of the normal, and right elsewhere"),
            "look at the limit θh → 0, and at what is tested against a small number",
        )
        .covers(DENSITY)
        .because(format!("{off} of {all} directions")),
    ]
}

/// pdf() is the textbook's but for rounding.
fn noise(view: &View) -> Vec<Claim> {
    if !view.failed.contains("jacobian") || view.fails_any(&["returned-pdf"]) {
        return Vec::new();
    }
    /// Radians between neighbours.
    const STEPS: [f64; 3] = [2e-5, 1e-4, 5e-4];
    // A smooth density does not jitter between neighbours.
    let mut jitter: [Vec<f64>; 3] = Default::default();
    for seen in &view.cases {
        let drawn: Vec<Direction> =
            seen.points.iter().filter(|p| p.drawn.is_some() && p.pdf > 0.0).map(|p| p.wi).take(64).collect();
        for wi in drawn {
            let tangent = wi.cross(Direction::new(0.36, 0.48, 0.8)).normalized();
            let bend = |step: f64| {
                let near: Vec<Direction> =
                    (-2..=2).map(|k| (wi + tangent * (f64::from(k) * step)).normalized()).collect();
                let p = view.pdf(seen.wo, &near, seen.transport);
                (p[0] - 4.0 * p[1] + 6.0 * p[2] - 4.0 * p[3] + p[4]).abs() / p[2]
            };
            // Of a smooth function it is 256 times smaller at a quarter of the step.
            for (step, jitter) in STEPS.iter().zip(&mut jitter) {
                let (wide, narrow) = (bend(*step), bend(step / 4.0));
                if wide.is_finite() && narrow.is_finite() {
                    jitter.push(if narrow > wide / 16.0 { narrow } else { 0.0 });
                }
            }
        }
    }
    let quarter = |jitter: &mut Vec<f64>| {
        jitter.sort_by(f64::total_cmp);
        if jitter.len() < 24 { 0.0 } else { jitter[jitter.len() * 3 / 4] }
    };
    let median = jitter.iter_mut().map(quarter).fold(0.0, f64::max);
    if median < 1e-3 {
        return Vec::new();
    }
    vec![
        Claim::new(
            Cause::Numerics,
            format!("pdf() jitters by {median:.1e} between neighbours: digits cancel"),
            "use a form without 1 − cos² θ or cos² θ (α² − 1) + 1, or more precision",
        )
        .covers(DENSITY)
        .price(2.0),
    ]
}
