//! What eval() has wrong, where the textbook says what it must be.

use super::deviation::{Fit, Function, equals, from_textbook};
use super::explanation::{Claim, EXACT_NUMBER, VALUE};
use super::mistakes::VALUE as MISTAKES;
use super::numbers::{Other, median_error, others};
use super::pdf::of_region;
use super::textbook::Textbook;
use super::view::{Point, Seen, View};
use crate::bsdf::Direction;
use crate::cause::Cause;

/// Claims about eval().
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let mut claims = frames(view);
    let Some(book) = book.filter(|b| !b.agrees.by_value()) else { return claims };
    if !view.fails_any(VALUE) {
        return claims;
    }
    for region in from_textbook(view, book, Function::Value) {
        claims
            .extend(MISTAKES.iter().filter_map(|m| of_region(m, &region, "eval()")).map(|c| c.covers(VALUE)));
    }
    claims.extend(whole_functions(view, book));
    claims.extend(another_number(view, book));
    claims
}

/// eval() at every point is what `predicted` makes of the textbook.
pub fn whole(
    view: &View,
    book: &Textbook,
    predicted: impl Fn(&Seen, &Point, usize) -> Option<f64>,
) -> Option<Fit> {
    let of = |c: usize| {
        let right = |s: &Seen, p: &Point| book.eval(s.wo, p.wi, s.transport)[c];
        equals(view, |_, p| p.value[c], right, |s, p| predicted(s, p, c))
    };
    // A channel in which nothing is wrong says nothing.
    let fits: Vec<Fit> = (0..view.channels()).filter_map(of).collect();
    fits.into_iter().min_by(|a, b| a.ln_likelihood().total_cmp(&b.ln_likelihood()))
}

fn whole_functions(view: &View, book: &Textbook) -> Vec<Claim> {
    let mut claims = Vec::new();
    let mut add = |fit: Option<Fit>, cause, statement: &str, repair: &str| {
        if let Some(fit) = fit {
            let claim = Claim::new(cause, statement, repair).covers(VALUE).likelihood(fit.ln_likelihood());
            claims.push(claim.because(format!("this {}", fit.words())));
        }
    };
    let up = |wo: Direction, w: Direction| if wo.z < 0.0 { w.flipped() } else { w };
    let behind = view.cases.iter().any(|c| c.wo.z < 0.0);
    add(
        whole(view, book, |s, p, c| Some(book.eval(p.wi, s.wo, s.transport)[c])),
        Cause::SwappedArguments,
        "eval(wo, wi) is eval(wi, wo): its arguments are exchanged",
        "exchange them at the call or in the signature: light arrives along wi and leaves along wo",
    );
    add(
        whole(view, book, |s, p, c| {
            Some(book.eval(s.wo, Direction::new(p.wi.x, -p.wi.y, p.wi.z), s.transport)[c])
        }),
        Cause::Frame,
        "eval() has cos(φi + φo) where cos(φi − φo) must be",
        "the azimuth that matters is the difference of both: cos φi cos φo + sin φi sin φo",
    );
    if behind && book.parts.eta.is_some() {
        add(
            whole(view, book, |s, p, c| Some(book.eval(up(s.wo, s.wo), up(s.wo, p.wi), s.transport)[c])),
            Cause::EtaSide,
            "eval() takes η and not 1/η where wo is inside",
            "invert η where cos θo < 0, before the half vector and the Fresnel term",
        );
    }
    if behind {
        add(
            whole(view, book, |s, p, c| {
                let wo = if s.wo.z < 0.0 { s.wo.mirrored() } else { s.wo };
                Some(book.eval(wo, p.wi, s.transport)[c])
            }),
            Cause::Frame,
            "seen from behind, eval() is turned by 180° about the normal: wo is negated where only its z must change sign",
            "flip z alone, of both directions",
        );
    }
    claims
}

fn another_number(view: &View, book: &Textbook) -> Vec<Claim> {
    let mut claims = Vec::new();
    let loss = |book: &Textbook| {
        median_error(view, 6, |s, p| Some((p.value[0], book.eval(s.wo, p.wi, s.transport)[0])))
    };
    for Other { name, declared, found, book: other, .. } in others(book, loss) {
        if let Some(fit) = whole(view, book, |s, p, c| Some(other.eval(s.wo, p.wi, s.transport)[c])) {
            let degrees = (found / declared * 180.0 / std::f64::consts::PI - 1.0).abs() < 1e-4;
            let why = if degrees { ": it is converted from degrees to radians twice" } else { "" };
            claims.push(
                Claim::new(
                    Cause::Parameter,
                    format!(
                        "eval() is that of {name} = {found:.6}, where {name} = {declared} is declared{why}"
                    ),
                    format!(
                        "follow {name} from where it is read to where it is used: units, order, defaults"
                    ),
                )
                .covers(VALUE)
                .likelihood(fit.ln_likelihood())
                .price(if degrees { 2.0 } else { EXACT_NUMBER })
                .because(format!("this {}", fit.words())),
            );
        }
    }
    claims
}

/// What turning both directions about the normal says, without any textbook.
fn frames(view: &View) -> Vec<Claim> {
    let mut claims = Vec::new();
    if view.failed.contains("isotropy") {
        claims.push(
            Claim::new(
                Cause::Frame,
                "turning wo and wi together about the normal changes what the functions return, though isotropy is claimed",
                "look for a direction in another frame, or for an azimuth where only the difference of both may stand",
            )
            .covers(&["isotropy", "reciprocity", "goodness-of-fit", "albedo", "mis", "jacobian", "energy", "white-furnace"])
            .price(6.0),
        );
    }
    let (x, y) = (view.number("alpha"), view.number("alpha_y").filter(|y| *y > 0.0));
    let anisotropic = x.zip(y).is_some_and(|(x, y)| (x / y - 1.0).abs() > 1e-3);
    if anisotropic && !view.description.claims.isotropic && view.failed.contains("reciprocity") {
        let mut same = [0usize; 2];
        for seen in &view.cases {
            let turned: Vec<Direction> = seen.points.iter().map(|p| p.wi.rotated(0.7)).collect();
            let values = view.eval(seen.wo.rotated(0.7), &turned, seen.transport);
            for (p, v) in seen.points.iter().zip(&values) {
                if p.value[0] > 0.0 {
                    same[1] += 1;
                    same[0] += usize::from((v[0] / p.value[0] - 1.0).abs() < 1e-6);
                }
            }
        }
        if same[1] >= 24 && same[0] * 50 >= 49 * same[1] {
            claims.push(
                Claim::new(
                    Cause::Frame,
                    "the tangents turn with wo: nothing changes when wo and wi are turned together, though αx ≠ αy",
                    "take the tangents from the surface, not from wo",
                )
                .covers(VALUE),
            );
        }
    }
    claims
}
