//! Discrete lobes: their directions, probabilities, weights and flags.

use super::explanation::Claim;
use super::textbook::Textbook;
use super::view::{Seen, View};
use crate::bsdf::{Direction, Lobe, Transport};
use crate::cause::Cause;
use crate::evidence::refracted;
use crate::models::fresnel;

/// Checks that a wrong discrete lobe makes fail.
const COVERS: &[&str] = &[
    "discrete-lobes",
    "white-furnace",
    "energy",
    "albedo",
    "mis",
    "reciprocity",
    "goodness-of-fit",
    "normalization",
    "support",
    "sanity",
    "weight",
    "returned-pdf",
    "sensitivity",
    "reference",
    "jacobian",
];

/// A discrete lobe as it was met: its place, and how often.
struct Met {
    wi: Direction,
    lobe: Lobe,
    told: f64,
    weight: f64,
    /// Share of the draws, and its standard deviation.
    share: f64,
    error: f64,
}

fn met(seen: &Seen) -> Vec<Met> {
    let draws: u64 = seen.evidence.draws.iter().map(|d| d.samples).sum();
    let mut all: Vec<Met> = Vec::new();
    for attempt in &seen.evidence.draws {
        for lobe in &attempt.discrete {
            let share = lobe.count as f64 / draws.max(1) as f64;
            match all.iter_mut().find(|m| (m.wi - lobe.wi).length() < 1e-6) {
                Some(m) => m.share += share,
                None => all.push(Met {
                    wi: lobe.wi,
                    lobe: lobe.lobe,
                    told: lobe.probability,
                    weight: lobe.weight.first().copied().unwrap_or(0.0),
                    share,
                    error: 0.0,
                }),
            }
        }
    }
    for m in &mut all {
        m.error = (m.share * (1.0 - m.share) / draws.max(1) as f64).sqrt();
    }
    if all.is_empty() {
        // Where nothing was counted, the draws that were looked at one by one.
        for (wi, d) in &seen.discrete {
            if !all.iter().any(|m| (m.wi - *wi).length() < 1e-6) {
                let (told, weight) = (d.told, d.weight[0]);
                all.push(Met { wi: *wi, lobe: d.lobe, told, weight, share: told, error: 0.02 });
            }
        }
    }
    all
}

/// Claims about discrete lobes.
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let mut claims = Vec::new();
    claims.extend(confounded(view));
    claims.extend(leaking(view));
    let lobes: Vec<(&Seen, Vec<Met>)> = view.cases.iter().map(|s| (s, met(s))).collect();
    if lobes.iter().all(|(_, m)| m.is_empty()) && book.is_none_or(|b| b.name != "plastic") {
        return claims.into_iter().map(|c| c.covers(COVERS)).collect();
    }
    if claims.is_empty() {
        claims.extend(places(view, &lobes));
        claims.extend(probabilities(view, &lobes));
        claims.extend(weights(view, &lobes));
    }
    claims.into_iter().map(|c| c.covers(COVERS)).collect()
}

/// More directions than a model has discrete lobes.
const MOST: usize = 32;

/// Directions nearer than this are one: rounding of f32.
const APART: f64 = 1e-5;

/// A kind of lobe taken for another.
fn confounded(view: &View) -> Option<Claim> {
    let overflow: u64 = view.cases.iter().flat_map(|s| &s.evidence.draws).map(|d| d.discrete_overflow).sum();
    let distinct = view.cases.iter().map(|s| {
        let mut seen: Vec<Direction> = Vec::new();
        for (direction, ..) in &s.discrete {
            if seen.len() <= MOST && seen.iter().all(|d| (*d - *direction).length() >= APART) {
                seen.push(*direction);
            }
        }
        seen.len()
    });
    if overflow > 0 || distinct.max().unwrap_or(0) > MOST {
        return Some(Claim::new(
            Cause::DiscreteLobe,
            "samples of a continuous lobe are flagged discrete: their directions are all different",
            "set the discrete flag only where one direction has a probability of its own",
        ));
    }
    let repeated =
        view.cases.iter().filter_map(|s| s.evidence.samples.as_ref()?.repeated.map(|(_, share)| share));
    if repeated.fold(0.0, f64::max) > 0.05 {
        return Some(Claim::new(
            Cause::DiscreteLobe,
            "samples with one and the same direction are not flagged discrete",
            "flag the sample discrete, and return 0 from pdf() and eval()",
        ));
    }
    let only_discrete = view
        .cases
        .iter()
        .filter(|s| !s.discrete.is_empty())
        .all(|s| s.points.iter().all(|p| p.drawn.is_none()));
    let dense = view.cases.iter().any(|s| s.points.iter().filter(|p| p.pdf > 0.0).count() > 8);
    if only_discrete && dense && view.cases.iter().any(|s| !s.discrete.is_empty()) {
        return Some(Claim::new(
            Cause::DiscreteLobe,
            "pdf() is a density where every sample is discrete",
            "return 0 from pdf(): the chance to hit one direction by another strategy is 0",
        ));
    }
    None
}

/// pdf() or eval() stand out in a discrete lobe's direction.
fn leaking(view: &View) -> Option<Claim> {
    let stands_out = view.cases.iter().any(|s| {
        let samples = s.evidence.samples.as_ref();
        samples.and_then(|i| i.discrete_value.as_ref()).is_some_and(|t| t.is_broken())
    });
    let infinite = view.cases.iter().any(|s| {
        let wi = s.wo.mirrored();
        !s.discrete.is_empty() && view.eval(s.wo, &[wi], s.transport)[0].iter().any(|f| f.is_infinite())
    });
    (stands_out || infinite).then(|| {
        Claim::new(
            Cause::DiscreteLobe,
            "eval() or pdf() contain the discrete lobe in its very direction",
            "leave discrete lobes out of both: they are the business of sample() alone",
        )
    })
}

fn all<'v>(lobes: &'v [(&'v Seen<'v>, Vec<Met>)]) -> impl Iterator<Item = (&'v Seen<'v>, &'v Met)> {
    lobes.iter().flat_map(|(s, m)| m.iter().map(move |m| (*s, m)))
}

/// Directions and flags.
fn places(view: &View, lobes: &[(&Seen, Vec<Met>)]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let eta = view.description.claims.eta;
    let swapped = |s: &Seen, m: &Met| m.lobe.contains(Lobe::REFLECTION) != s.wo.same_side(m.wi);
    if all(lobes).any(|(s, m)| swapped(s, m)) {
        claims.push(Claim::new(
            Cause::Parameter,
            "flags of reflection and transmission say the opposite of where samples go",
            "set the flag from the sides of wo and wi",
        ));
    }
    let mirror = all(lobes).filter(|(s, m)| s.wo.same_side(m.wi));
    let off = mirror.filter(|(s, m)| (m.wi - s.wo.mirrored()).length() > 1e-6).count();
    if off > 0 {
        claims.push(Claim::new(
            Cause::DiscreteLobe,
            "the mirror lobe is not in the mirror direction",
            "wi = (−x, −y, z) in the frame of the normal",
        ));
    }
    if let Some(eta) = eta {
        let through = all(lobes).filter(|(s, m)| !s.wo.same_side(m.wi));
        let bent = |s: &Seen, m: &Met| refracted(s.wo, eta).is_none_or(|t| (t - m.wi).length() > 1e-6);
        if through.filter(|(s, m)| bent(s, m)).count() > 0 {
            claims.push(Claim::new(
                Cause::DiscreteLobe,
                format!("what is refracted does not leave by Snell's law with the claimed index {eta}"),
                "the sines of both angles are as the indices: scale the tangential part, then complete z",
            ));
        }
    }
    claims
}

/// Told probabilities against counts.
fn probabilities(view: &View, lobes: &[(&Seen, Vec<Met>)]) -> Vec<Claim> {
    let counted: Vec<(&Seen, &Met)> = all(lobes).filter(|(s, _)| !s.evidence.draws.is_empty()).collect();
    let off = |m: &Met| (m.share - m.told).abs() > 6.0 * m.error.max(1e-4) + 1e-3 * m.told;
    if !view.failed.contains("discrete-lobes") || !counted.iter().any(|(_, m)| off(m)) {
        return Vec::new();
    }
    let mut claims = Vec::new();
    if counted.iter().filter(|(_, m)| off(m)).all(|(_, m)| m.share == 1.0 && m.told < 1.0) {
        claims.push(Claim::new(
            Cause::Parameter,
            "one lobe is always drawn, whatever its probability: the condition that chooses it is always true",
            "look at the condition: precedence of ?: and comparisons, or a constant in place of the probability",
        ));
        return claims;
    }
    let added = |s: &Seen, m: &Met| {
        let there = view.pdf(s.wo, &[m.wi], s.transport)[0];
        there > 0.0 && (m.told - m.share - there).abs() < 6.0 * m.error.max(1e-4)
    };
    if counted.iter().all(|(s, m)| added(s, m)) {
        claims.push(Claim::new(
            Cause::DiscreteLobe,
            "a discrete draw goes on to add pdf() of the continuous lobe to its probability",
            "return at once: a probability and a density do not add up",
        ));
    }
    claims.push(
        Claim::new(
            Cause::DiscreteLobe,
            "a discrete lobe is drawn with another probability than it tells",
            "return the probability with which the lobe is chosen",
        )
        .price(6.0),
    );
    claims
}

/// Flux that each lobe carries against what Fresnel and the mode ask for.
fn weights(view: &View, lobes: &[(&Seen, Vec<Met>)]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let Some(eta) = view.description.claims.eta.or_else(|| view.number("eta")) else { return claims };
    let through = view.description.claims.transmissive;
    let index = |s: &Seen| if s.wo.z > 0.0 { eta } else { 1.0 / eta };
    type Law = fn(&Seen, f64) -> f64;
    let reflected: Law = |s, eta| fresnel::dielectric(s.wo.z.abs(), eta);
    // What sample() gives of each lobe, over what is right.
    let flux = |reflects: bool, law: &dyn Fn(&Seen) -> f64| -> Option<bool> {
        let (mut n, mut right) = (0, 0);
        for (s, m) in all(lobes).filter(|(s, m)| s.wo.same_side(m.wi) == reflects) {
            n += 1;
            let predicted = law(s);
            right += usize::from((m.told * m.weight - predicted).abs() <= 1e-6 * predicted.abs().max(1e-9));
        }
        (n > 0).then_some(n == right)
    };
    let scale = |s: &Seen| match s.transport {
        Transport::Radiance => 1.0 / index(s).powi(2),
        Transport::Importance => 1.0,
    };
    let r = |s: &Seen| reflected(s, index(s));
    let t = |s: &Seen| 1.0 - r(s);
    let reflection = flux(true, &r);
    let right_t = flux(false, &|s| t(s) * scale(s));
    let mut add = |cause, statement: &str, repair: &str| claims.push(Claim::new(cause, statement, repair));
    if through && right_t == Some(false) && reflection != Some(false) {
        let powers: [(f64, &str); 4] = [
            (1.0, "radiance passes unscaled, as importance does"),
            (-1.0, "radiance is multiplied by η² where it must be divided"),
            (2.0, "radiance is divided by η² twice"),
            (0.5, "radiance is divided by η where η² is meant"),
        ];
        for (k, (power, what)) in powers.iter().enumerate() {
            let law = |s: &Seen| {
                let power = if k == 0 { 0.0 } else { *power };
                t(s) * if s.transport == Transport::Radiance { index(s).powf(-2.0 * power) } else { 1.0 }
            };
            let inverted = |s: &Seen| t(s) / scale(s);
            if flux(false, &law) == Some(true) || (k == 1 && flux(false, &inverted) == Some(true)) {
                add(
                    Cause::TransportMode,
                    &format!("what is refracted has the wrong scale: {what}"),
                    "divide by η² in radiance mode, and only there, η being the index of the far over the near side",
                );
                break;
            }
        }
        let mut shares: Vec<f64> = all(lobes)
            .filter(|(s, m)| !s.wo.same_side(m.wi))
            .map(|(s, m)| m.told * m.weight / (t(s) * scale(s)))
            .collect();
        shares.sort_by(f64::total_cmp);
        if let (Some(least), Some(most)) = (shares.first(), shares.last())
            && most - least < 1e-6
            && (most - 1.0).abs() > 1e-6
        {
            add(
                Cause::Normalization,
                &format!("transmission is multiplied by {most:.5}, whatever the angle"),
                "leave out the tint: it belongs to reflection, or to absorption inside",
            );
        }
    }
    if reflection == Some(false) {
        let outside = |s: &Seen| reflected(s, eta);
        let through_fits = !through || flux(false, &|s| (1.0 - outside(s)) * scale(s)) != Some(false);
        if flux(true, &outside) == Some(true) && through_fits {
            add(
                Cause::EtaSide,
                "from inside, what is reflected is that of the same angle outside",
                "invert η where cos θo < 0, before the Fresnel term is computed",
            );
        }
        let polarised = |s: &Seen, k: usize| fresnel::dielectric_polarised(s.wo.z.abs(), index(s))[k];
        for (k, (name, other)) in [("Rs", "Rp"), ("Rp", "Rs")].iter().enumerate() {
            if flux(true, &|s| polarised(s, k)) == Some(true) {
                add(
                    Cause::FresnelArgument,
                    &format!("what is reflected is {name} alone: {other} is a copy of it"),
                    "unpolarised light reflects (Rs + Rp)/2",
                );
            }
        }
        let undivided = all(lobes)
            .filter(|(s, m)| s.wo.same_side(m.wi))
            .all(|(s, m)| (m.weight - r(s)).abs() <= 1e-6 * r(s) && (m.told - 1.0).abs() > 1e-6);
        // A lossless mirror is chosen with the probability F: both look alike there.
        if !undivided && flux(true, &|s| r(s).powi(2)) == Some(true) {
            add(
                Cause::FresnelArgument,
                "what is reflected has the Fresnel term twice",
                "the probability F and a weight of 1 are all",
            );
        }
        // The weight is the value.
        if undivided {
            add(
                Cause::DiscreteLobe,
                "the weight of the mirror is not divided by its probability",
                "divide the value by the probability with which the lobe is drawn",
            );
        }
    }
    let never =
        view.cases.iter().filter(|s| !s.evidence.draws.is_empty() && s.wo.z > 0.0).all(|s| {
            met(s).iter().all(|m| !s.wo.same_side(m.wi)) && s.evidence.draws.iter().any(|d| d.none > 0)
        });
    if !through && reflection.is_none() && never && view.fails_any(&["white-furnace"]) {
        add(
            Cause::DiscreteLobe,
            "the mirror of the coat is never drawn: what it would carry is missing",
            "draw it with a probability of its own, or look at the mask of lobes",
        );
    }
    claims
}
