//! What the weight, or the pdf that comes with a sample, has wrong.

use super::deviation::{Ratio, Region, deviates};
use super::explanation::{Claim, VAGUE, WEIGHT};
use super::mistakes::WEIGHT as MISTAKES;
use super::numbers::{Other, median_error, others};
use super::parts::{At, Parts};
use super::pdf::of_region;
use super::textbook::{EQUAL, Textbook};
use super::view::{Drawn, Point, Seen, View};
use crate::cause::Cause;

/// Claims about weights.
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    if !view.fails_any(&["weight", "returned-pdf"]) {
        return Vec::new();
    }
    let none = Parts::default();
    let parts = book.map_or(&none, |b| &b.parts);
    let mut claims = Vec::new();
    let told = ratios(view, parts, |_, p, d| (d.told, p.pdf));
    let weight = ratios(view, parts, |_, p, d| {
        let channel = 0;
        (d.weight[channel] * p.pdf, p.value[channel] * p.wi.abs_cos_theta())
    });
    // A wrong pdf() that sample() does not use shows in the weight too.
    if deviates(&told) {
        claims.extend(of_told(view, book, &told));
    } else if deviates(&weight) {
        claims.extend(of_weight(view, book, weight));
    }
    claims
}

/// Each continuous draw: what was told, beside what it must be.
fn ratios<'p>(
    view: &View,
    parts: &'p Parts,
    of: impl Fn(&Seen, &Point, &Drawn) -> (f64, f64),
) -> Vec<Ratio<'p>> {
    let mut ratios = Vec::new();
    for seen in &view.cases {
        for p in &seen.points {
            let Some(drawn) = &p.drawn else { continue };
            let (observed, expected) = of(seen, p, drawn);
            if observed.is_finite() && expected.is_finite() && expected > 0.0 {
                let at = At::new(parts, seen.wo, p.wi, seen.transport);
                ratios.push(Ratio { at, observed, expected, error: 3.0 * EQUAL });
            }
        }
    }
    ratios
}

/// sample.pdf is not pdf().
fn of_told(view: &View, book: Option<&Textbook>, told: &[Ratio]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let covers = DRIFT;
    let sizes: Vec<f64> = told.iter().map(|r| (r.observed / r.expected).ln()).collect();
    let (least, most) =
        sizes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let all = Region { name: String::new(), ratios: told.to_vec() };
    let constant = MISTAKES.iter().rfind(|m| m.free == super::deviation::Free::Scale);
    if let Some(claim) = constant.and_then(|m| of_region(m, &all, "the pdf that comes with a sample")) {
        claims.push(Claim { repair: "return pdf(wo, wi) with the sample".into(), ..claim }.covers(WEIGHT));
    }
    if let Some(book) = book {
        if book.lobes.len() > 1 && every(view, |s, p, d| Some((d.told, chosen_density(book, s, p, d)?))) {
            claims.push(
                Claim::new(
                    Cause::LobeProbability,
                    "sample() returns the density of the lobe that it chose, not that of the mixture",
                    "add the densities of all lobes, each times its probability, as pdf() does",
                )
                .covers(WEIGHT),
            );
        }
        let loss = |book: &Textbook| {
            median_error(view, 6, |s, p| Some((p.drawn.as_ref()?.told, book.pdf(s.wo, p.wi))))
        };
        let others = others(book, loss).into_iter().filter(|o| (o.found / o.declared - 1.0).abs() > 1e-5);
        for Other { name, declared, found, book: other, .. } in others {
            if every(view, |s, p, d| Some((d.told, other.pdf(s.wo, p.wi)))) {
                claims.push(
                    Claim::new(
                        Cause::ImplementationDrift,
                        format!("sample() is that of {name} = {found:.6} in all it returns, pdf() and eval() of {name} = {declared}"),
                        "let all three functions read the same parameters, and compute them once",
                    )
                    .covers(covers)
                    .price(3.0),
                );
            }
        }
        // The subject's pdf() is what is wrong, and sample() does not use it.
        if claims.is_empty() && every(view, |s, p, d| Some((d.told, book.pdf(s.wo, p.wi)))) {
            let noise = most - least;
            if noise < 0.05 && least < 0.0 && most > 0.0 {
                claims.push(
                    Claim::new(
                        Cause::ImplementationDrift,
                        format!(
                            "pdf() and the pdf of samples differ without a rule by up to {:.1e}: one of them is evaluated in less precision, or by a form that cancels",
                            least.abs().max(most)
                        ),
                        "use one function, and a form of D without 1 − cos² θ",
                    )
                    .covers(covers)
                    .price(2.0),
                );
            }
        }
    }
    if claims.is_empty() && !view.fails_any(&["goodness-of-fit", "normalization"]) {
        claims.push(
            Claim::new(
                Cause::Weight,
                "the pdf that comes with a sample is not pdf()",
                "return pdf(wo, wi) with the sample",
            )
            .covers(WEIGHT)
            .price(VAGUE),
        );
    }
    claims
}

/// Checks that fail where sample() is of another model.
const DRIFT: &[&str] = &[
    "weight",
    "returned-pdf",
    "albedo",
    "mis",
    "goodness-of-fit",
    "normalization",
    "jacobian",
    "support",
    "sensitivity",
];

fn chosen_density(book: &Textbook, s: &Seen, p: &Point, d: &Drawn) -> Option<f64> {
    let lobe = book.lobes.iter().find(|l| l.flags.is_some_and(|f| d.lobe.contains(f)))?;
    Some((lobe.density)(s.wo, p.wi))
}

/// Whether weights and densities of the draws are right with the textbook's pdf: what
/// is wrong with them goes when pdf() is mended.
pub fn mended_by(view: &View, book: &Textbook) -> bool {
    let weight = |s: &Seen, p: &Point, d: &Drawn| {
        Some((d.weight[0] * book.pdf(s.wo, p.wi), p.value[0] * p.wi.abs_cos_theta()))
    };
    every(view, weight) && every(view, |s, p, d| Some((d.told, book.pdf(s.wo, p.wi))))
}

/// Whether two values are equal at every draw.
fn every(view: &View, of: impl Fn(&Seen, &Point, &Drawn) -> Option<(f64, f64)>) -> bool {
    let (mut same, mut all) = (0usize, 0usize);
    for seen in &view.cases {
        for p in &seen.points {
            let Some(drawn) = &p.drawn else { continue };
            let Some((a, b)) = of(seen, p, drawn) else { continue };
            all += 1;
            same += usize::from((a - b).abs() <= 10.0 * EQUAL * (a.abs() + b.abs()));
        }
    }
    all >= 24 && same as f64 >= 0.97 * all as f64
}

/// weight·pdf is not f·|cos θi|.
fn of_weight(view: &View, book: Option<&Textbook>, ratios: Vec<Ratio>) -> Vec<Claim> {
    let mut claims = Vec::new();
    let above_one = view.cases.iter().flat_map(|s| &s.points).filter_map(|p| {
        let right = p.value[0] * p.wi.abs_cos_theta() / p.pdf;
        Some((right, p.drawn.as_ref()?.weight[0]))
    });
    let mut most = 0.0f64;
    let mut cut = (0usize, 0usize, 0usize);
    for (right, told) in above_one {
        most = most.max(told);
        cut.0 += 1;
        if told < right * (1.0 - 1e-6) {
            cut.1 += 1;
        } else if told <= right * (1.0 + 1e-6) {
            cut.2 += 1;
        }
    }
    let at_most = view
        .cases
        .iter()
        .flat_map(|s| &s.points)
        .filter_map(|p| p.drawn.as_ref())
        .filter(|d| (d.weight[0] - most).abs() < 1e-9 * most);
    if cut.1 >= 4 && cut.1 + cut.2 == cut.0 && at_most.count() == cut.1 {
        claims.push(
            Claim::new(
                Cause::Weight,
                format!("weights above {most} are cut off"),
                "leave them: a cut loses energy; clamp the radiance of a path, or sample better",
            )
            .covers(WEIGHT),
        );
    }
    if let Some(book) = book.filter(|b| b.lobes.len() > 1) {
        let share = |s: &Seen, d: &Drawn| {
            let lobe = book.lobes.iter().find(|l| l.flags.is_some_and(|f| d.lobe.contains(f)))?;
            Some((lobe.share)(s.wo))
        };
        let right = |p: &Point| p.value[0] * p.wi.abs_cos_theta() / p.pdf;
        if every(view, |s, p, d| Some((d.weight[0], right(p) * share(s, d)?))) {
            claims.push(
                Claim::new(
                    Cause::Weight,
                    "the weight is not divided by the probability of the chosen lobe",
                    "divide by the density of the mixture, which holds that probability",
                )
                .covers(WEIGHT),
            );
        }
        let chosen = |s: &Seen, p: &Point, d: &Drawn| {
            let lobe = book.lobes.iter().find(|l| l.flags.is_some_and(|f| d.lobe.contains(f)))?;
            Some((lobe.value)(s.wo, p.wi, s.transport)[0] * p.wi.abs_cos_theta() / p.pdf)
        };
        if every(view, |s, p, d| Some((d.weight[0], chosen(s, p, d)?))) {
            claims.push(
                Claim::new(
                    Cause::Weight,
                    "the weight has f of the chosen lobe only, over the density of all",
                    "use f of all lobes, or f and density of one",
                )
                .covers(WEIGHT),
            );
        }
    }
    let region = Region { name: String::new(), ratios };
    claims.extend(
        MISTAKES.iter().filter_map(|m| of_region(m, &region, "the weight")).map(|c| c.covers(WEIGHT)),
    );
    if claims.is_empty() {
        claims.push(
            Claim::new(
                Cause::Weight,
                "the weight of samples is not f·|cos θi|/pdf",
                "compute it from the three functions themselves",
            )
            .covers(WEIGHT)
            .price(VAGUE),
        );
    }
    claims
}
