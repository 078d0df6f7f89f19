//! Where functions are positive and should not be, or the other way round.

use super::counts::{CountTest, PER_LEAF};
use super::explanation::{Claim, DENSITY, VAGUE};
use super::pdf::{counts, follows};
use super::textbook::{EQUAL, Textbook};
use super::view::{Point, Seen, View};
use crate::cause::Cause;

/// Checks that light outside of the support makes fail.
const LEAK: &[&str] =
    &["support", "albedo", "mis", "energy", "white-furnace", "reciprocity", "isotropy", "sensitivity"];

/// Claims about supports.
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let mut claims = Vec::new();
    if view.failed.contains("support") || view.failed.contains("normalization") {
        let exact = book.and_then(|b| beside(view, b));
        claims.extend(exact.map_or_else(|| phantom(view), |claim| vec![claim]));
        claims.extend(below(view));
    }
    if view.failed.contains("support") {
        claims.extend(leaks(view, book));
    }
    claims
}

/// Where points are, in words.
fn place(points: &[(&Seen, &Point)]) -> &'static str {
    let all = |holds: fn(&Seen, &Point) -> bool| points.iter().all(|(s, p)| holds(s, p));
    if all(|s, p| !s.wo.same_side(p.wi)) {
        "on the other side of the surface"
    } else if all(|s, p| s.wo.same_side(p.wi)) {
        "on wo's side of the surface"
    } else {
        "on both sides of the surface"
    }
}

/// pdf() is the textbook's where that is, and positive where it is not.
fn beside(view: &View, book: &Textbook) -> Option<Claim> {
    let counts = counts(view);
    let (mut same, mut more, mut less) = (0, 0, 0);
    let (mut extra, mut mass, mut other_side) = (Vec::new(), 0.0f64, 0);
    for (k, c) in counts {
        let seen = &view.cases[*k];
        let directions = c.directions();
        let mut off = vec![0.0; directions.len()];
        for (j, (wi, p)) in directions.iter().zip(c.density()).enumerate() {
            let p = *p;
            let theirs = book.pdf(seen.wo, *wi);
            if (p - theirs).abs() <= EQUAL * (p + theirs) {
                same += usize::from(p > 0.0);
            } else if p > theirs {
                more += 1;
                extra.push(theirs / p);
                off[j] = p - theirs;
                other_side += usize::from(!seen.wo.same_side(*wi));
            } else {
                less += 1;
            }
        }
        let mut off = off.into_iter();
        mass = mass.max(c.masses(|_| off.next().unwrap_or(0.0)).iter().sum());
    }
    // What is drawn is as the textbook says.
    let drawn = view.cases.iter().flat_map(|s| s.points.iter().map(move |p| (s, p)));
    let (right, all) = drawn.filter(|(_, p)| p.drawn.is_some()).fold((0, 0), |(right, all), (s, p)| {
        let theirs = book.pdf(s.wo, p.wi);
        (right + usize::from((p.pdf - theirs).abs() <= EQUAL * theirs), all + 1)
    });
    extra.sort_by(f64::total_cmp);
    let beside = extra.get(extra.len() / 2).is_some_and(|r| *r < 0.05);
    if same < 24 || more < 8 || less > 0 || !beside || right * 20 < all * 19 {
        return None;
    }
    let test = follows(view, book, counts);
    let side = if other_side == more { ", on the other side of the surface" } else { "" };
    Some(
        Claim::new(
            Cause::Support,
            format!("pdf() is positive where sample() never draws{side}: {:.2} % of its mass", 100.0 * mass),
            "test sides and horizon in pdf() as sample() does, and return 0 there",
        )
        .price(if test.fits() { 1.0 } else { 10.0 })
        .p(test.ln_p())
        .because(format!("elsewhere it is the density of `{}`, at {right} of {all} draws", book.name)),
    )
}

/// pdf() where nothing is drawn, and right elsewhere.
fn phantom(view: &View) -> Vec<Claim> {
    let mut test = CountTest::default();
    let (mut mass, mut other_side) = (0.0f64, 0.0f64);
    let (mut drawn, mut cases) = (0, 0);
    for (k, c) in counts(view) {
        let own = &c.own;
        if own.len() != c.leaves.len() {
            return Vec::new();
        }
        let n = c.draws as f64;
        let directions = c.directions();
        let mut masses = own.to_vec();
        let mut off = 0.0;
        for (leaf, m) in masses.iter_mut().enumerate() {
            // Chance leaves a cell empty that expects 12 with probability 6e-6.
            if c.leaves[leaf] == 0 && n * *m > 12.0 {
                off += *m;
                if !view.cases[*k].wo.same_side(directions[PER_LEAF * leaf]) {
                    other_side += *m;
                }
                *m = 0.0;
            }
        }
        mass = mass.max(off);
        drawn += c.leaves.iter().sum::<u64>();
        cases += 1;
        test = test.and(c.test(&masses, 0));
    }
    if mass < 1e-4 || drawn == 0 || cases == 0 || !test.fits() {
        return Vec::new();
    }
    let side = if other_side > 0.0 { ", on the other side of the surface" } else { "" };
    vec![
        Claim::new(
            Cause::Support,
            format!("pdf() is positive where sample() never draws{side}: {:.2} % of its mass", 100.0 * mass),
            "test sides and horizon in pdf() as sample() does, and return 0 there",
        )
        .covers(DENSITY)
        .price(2.0)
        .likelihood(test.ln_likelihood())
        .p(test.ln_p())
        .because("without the cells that no draw falls in, the counts fit"),
    ]
}

/// Samples on a side to which no light is claimed to go.
fn below(view: &View) -> Vec<Claim> {
    let claims = view.description.claims;
    if claims.transmissive {
        return Vec::new();
    }
    let (mut off, mut all) = (0usize, 0usize);
    let (mut lit, mut dense) = (0usize, 0usize);
    for seen in &view.cases {
        for p in seen.points.iter() {
            let Some(_) = &p.drawn else { continue };
            all += 1;
            if !seen.wo.same_side(p.wi) {
                off += 1;
                lit += usize::from(p.value.iter().any(|f| *f > 0.0));
                dense += usize::from(p.pdf > 0.0);
            }
        }
    }
    let strays = view.cases.iter().any(|s| {
        s.evidence.draws.iter().any(|d| d.zero_pdf.is_broken()) || {
            s.evidence.samples.as_ref().is_some_and(|i| i.zero_pdf.is_broken())
        }
    });
    if off == 0 && !strays {
        return Vec::new();
    }
    let share = 100.0 * off as f64 / all.max(1) as f64;
    let (statement, price) = if off == 0 {
        ("a few samples fall where pdf() is 0, below the horizon".to_string(), 3.0)
    } else if lit == off && dense == off {
        ("all functions are positive below the horizon: they test the facet's side and not n·wi".into(), 1.0)
    } else {
        (format!("sample() returns directions below the horizon, {share:.1} % of its draws"), 1.0)
    };
    vec![
        Claim::new(
            Cause::Support,
            statement,
            "return no sample where n·wi ≤ 0, before the cosine is cut at 0 or made positive",
        )
        .covers(&[
            "goodness-of-fit",
            "normalization",
            "support",
            "albedo",
            "mis",
            "jacobian",
            "reciprocity",
            "energy",
            "sensitivity",
            "discrete-lobes",
            "weight",
            "returned-pdf",
        ])
        .price(price),
    ]
}

/// Light where pdf() is 0.
fn leaks(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let mut bare: Vec<(&Seen, &Point)> = Vec::new();
    let mut told = 0;
    for seen in &view.cases {
        for p in &seen.points {
            if p.pdf == 0.0 && p.value.iter().any(|f| *f > 0.0) {
                bare.push((seen, p));
                told += usize::from(p.drawn.is_some());
            }
        }
    }
    if bare.len() < 8 {
        return Vec::new();
    }
    let place = place(&bare);
    // sample() goes there, and says with which density.
    if told >= 8 {
        let all = view.cases.iter().flat_map(|s| &s.points).filter(|p| p.drawn.is_some() && p.pdf == 0.0);
        let lit = all.clone().filter(|p| p.value.iter().any(|f| *f > 0.0)).count();
        if lit * 20 >= 19 * all.count() {
            return vec![
                Claim::new(
                    Cause::Weight,
                    format!("pdf() returns 0 {place}, where sample() draws and tells a density"),
                    "look for a variable of an inner scope that hides the result of pdf()",
                )
                .covers(DENSITY),
            ];
        }
        return Vec::new();
    }
    let Some(book) = book else {
        return vec![
            Claim::new(
                Cause::Support,
                format!("eval() is positive {place}, where pdf() is 0"),
                "test the same sides and horizon in both functions",
            )
            .covers(LEAK)
            .price(VAGUE),
        ];
    };
    // Is there to be light?
    let lit = |(s, p): &&(&Seen, &Point)| book.eval(s.wo, p.wi, s.transport).iter().any(|f| *f > 0.0);
    let rightly = bare.iter().filter(lit).count();
    let elsewhere = view.cases.iter().flat_map(|s| s.points.iter().map(move |p| (s, p))).filter(|(s, p)| {
        let theirs = book.eval(s.wo, p.wi, s.transport)[0];
        theirs > 0.0 && (p.value[0] - theirs).abs() > EQUAL * theirs
    });
    if rightly == 0 && elsewhere.count() < 4 {
        return vec![
            Claim::new(
                Cause::Support,
                format!("eval() is positive {place}, where pdf() and sample() have nothing"),
                "return 0 where n·wo or n·wi has the wrong sign, before cosines are made positive",
            )
            .covers(LEAK)
            .because("where light is meant to be, all is right"),
        ];
    }
    if rightly == bare.len() && book.agrees.by_value() {
        // What is drawn at all, over what should be.
        let mut ratios: Vec<f64> = view
            .cases
            .iter()
            .flat_map(|s| s.points.iter().map(move |p| (p.pdf, book.pdf(s.wo, p.wi))))
            .filter(|(own, theirs)| *own > 0.0 && *theirs > 0.0)
            .map(|(own, theirs)| own / theirs)
            .collect();
        ratios.sort_by(f64::total_cmp);
        let Some(median) = ratios.get(ratios.len() / 2) else { return Vec::new() };
        let claim = if (median - 1.0).abs() < 1e-4 {
            Claim::new(
                Cause::Support,
                format!("sample() and pdf() leave out what eval() has {place}"),
                "draw there too, or take that lobe out of eval()",
            )
        } else {
            Claim::new(
                Cause::LobeProbability,
                format!(
                    "a lobe of eval(), {place}, has probability 0 in sample() and pdf(): it is never drawn"
                ),
                "give every lobe with f > 0 a probability",
            )
        };
        return vec![claim.covers(&[
            "support",
            "albedo",
            "mis",
            "goodness-of-fit",
            "normalization",
            "white-furnace",
        ])];
    }
    Vec::new()
}
