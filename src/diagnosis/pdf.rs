//! What pdf() has wrong, where sample() and eval() say what it must be.

use super::by_counts::by_counts;
use super::counts::{CountTest, Counts};
use super::deviation::{Function, Region, equals, fit, from_textbook};
use super::explanation::{Claim, DENSITY, DENSITY_ALONE, EXACT_NUMBER};
use super::mistakes::{Mistake, PDF};
use super::numbers::{Other, median_error, others};
use super::textbook::Textbook;
use super::view::{Point, Seen, View};
use super::weight::mended_by;
use crate::bsdf::Direction;
use crate::cause::Cause;

/// Cases whose counts are compared: those that fail most come first.
const COUNTED: usize = 4;

/// The counts of some cases, with their places in the view.
pub fn counts<'v>(view: &'v View) -> &'v [(usize, Counts)] {
    let counted = |(k, seen): (usize, &Seen)| {
        let pdf = |wi: &[Direction]| view.pdf(seen.wo, wi, seen.transport);
        Some((k, Counts::of(seen.evidence, pdf)?))
    };
    let all = || view.cases.iter().enumerate().filter_map(counted).take(COUNTED).collect();
    // They take thousands of calls of pdf(), and every theme asks for them.
    view.counted.get_or_init(all)
}

/// Whether the draws follow the textbook's density.
pub fn follows(view: &View, book: &Textbook, counts: &[(usize, Counts)]) -> CountTest {
    let mut total = CountTest::default();
    for (k, c) in counts {
        let wo = view.cases[*k].wo;
        total = total.and(c.test(&c.masses(|wi| book.pdf(wo, wi)), 0));
    }
    total
}

/// Claims about pdf().
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    if !view.fails_any(&[
        "goodness-of-fit",
        "normalization",
        "jacobian",
        "support",
        "returned-pdf",
        "reference",
    ]) {
        return Vec::new();
    }
    let counts = counts(view);
    let Some(book) = book else { return by_counts(view, counts) };
    if book.agrees.by_pdf() {
        return Vec::new();
    }
    let regions = from_textbook(view, book, Function::Pdf);
    if regions.is_empty() {
        return Vec::new();
    }
    let follows = follows(view, book, counts);
    let mut claims: Vec<Claim> =
        regions.iter().flat_map(|region| PDF.iter().filter_map(|m| of_region(m, region, "pdf()"))).collect();
    claims.extend(whole_functions(view, book));
    claims.extend(another_number(view, book));
    let weights = view.fails_any(&["weight", "returned-pdf"]);
    let covers = if weights && !mended_by(view, book) { DENSITY_ALONE } else { DENSITY };
    // Where the draws do not follow the textbook either, something else is wrong too.
    for claim in &mut claims {
        claim.covers = covers;
        claim.ln_p = Some(follows.ln_p());
        if !follows.fits() && claim.cause != Cause::RefractionJacobian {
            claim.price += 10.0;
        }
    }
    claims
}

/// The claim that a factor explains a region, where it does.
pub fn of_region(m: &Mistake, region: &Region, function: &str) -> Option<Claim> {
    use super::deviation::Free;
    let fit = fit(&region.ratios, m.factor, m.free)?;
    let place = if region.name.is_empty() { String::new() } else { format!("{}, ", region.name) };
    let easy = (fit.power - (2.0 * fit.power).round() / 2.0).abs() < 1e-9;
    let fitted = match m.free {
        Free::Nothing => 0.0,
        Free::Power if easy => 1.0,
        Free::Power | Free::Scale => EXACT_NUMBER,
    };
    let number = match m.free {
        Free::Nothing => String::new(),
        Free::Power => format!(" (to the power {:.4})", fit.power),
        Free::Scale => format!(" ({:.6})", fit.scale),
    };
    // A part of the points costs a choice.
    let part = if region.name.is_empty() { 0.0 } else { 2.0 };
    let statement = format!("{place}{function} {}{number}", m.what);
    Some(
        Claim::new(m.cause, statement, m.repair)
            .likelihood(fit.ln_likelihood())
            .price(1.0 + fitted + part)
            .because(format!("this {}", fit.words())),
    )
}

/// pdf() at every point is what `predicted` makes of the textbook.
fn whole(
    view: &View,
    book: &Textbook,
    predicted: impl Fn(&Seen, &Point) -> Option<f64>,
) -> Option<super::deviation::Fit> {
    equals(view, |_, p| p.pdf, |s, p| book.pdf(s.wo, p.wi), predicted)
}

/// Mistakes that are no factor.
fn whole_functions(view: &View, book: &Textbook) -> Vec<Claim> {
    let mut claims = Vec::new();
    let up = |wo: Direction, w: Direction| if wo.z < 0.0 { w.flipped() } else { w };
    let mut add = |fit: Option<super::deviation::Fit>, cause, statement: &str, repair: &str| {
        if let Some(fit) = fit {
            let claim = Claim::new(cause, statement, repair).likelihood(fit.ln_likelihood());
            claims.push(claim.because(format!("this {}", fit.words())));
        }
    };
    add(
        whole(view, book, |seen, p| Some(book.pdf(p.wi, seen.wo))),
        Cause::SwappedArguments,
        "pdf(wo, wi) is pdf(wi, wo): its arguments are exchanged",
        "exchange them at the call or in the signature: wo is given, wi was drawn",
    );
    if book.parts.eta.is_some() && view.cases.iter().any(|c| c.wo.z < 0.0) {
        add(
            whole(view, book, |seen, p| Some(book.pdf(up(seen.wo, seen.wo), up(seen.wo, p.wi)))),
            Cause::EtaSide,
            "pdf() takes η and not 1/η where wo is inside",
            "invert η where cos θo < 0, before the half vector and the Fresnel term",
        );
    }
    if view.cases.iter().any(|c| c.wo.z < 0.0) {
        add(
            whole(view, book, |seen, p| {
                let wo = if seen.wo.z < 0.0 { seen.wo.mirrored() } else { seen.wo };
                Some(book.pdf(wo, p.wi))
            }),
            Cause::Frame,
            "seen from behind, pdf() is turned by 180° about the normal: wo is negated where only its z must change sign",
            "flip z alone, of both directions",
        );
    }
    claims
}

/// The model with another number.
fn another_number(view: &View, book: &Textbook) -> Vec<Claim> {
    let mut claims = Vec::new();
    let loss = |book: &Textbook| median_error(view, 6, |s, p| Some((p.pdf, book.pdf(s.wo, p.wi))));
    for Other { name, declared, found, book: other, .. } in others(book, loss) {
        if let Some(fit) = whole(view, book, |seen, p| Some(other.pdf(seen.wo, p.wi))) {
            claims.push(
                Claim::new(
                    Cause::WrongDensity,
                    format!("pdf() is that of {name} = {found:.6}, where {name} = {declared} is declared"),
                    format!("give pdf() the same {name} as sample(), after the same mapping and clamping"),
                )
                .likelihood(fit.ln_likelihood())
                .price(EXACT_NUMBER)
                .because(format!("this {}", fit.words())),
            );
        }
    }
    claims
}
