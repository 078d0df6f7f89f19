//! Light of many bounces, coats' transmittances, tables, and mixtures: what eval()
//! has wrong where the textbook's own functions of one angle say how.

use super::deviation::{Fit, Function, equals, from_textbook};
use super::explanation::{Claim, EXACT_NUMBER, VALUE};
use super::textbook::Textbook;
use super::value::whole;
use super::view::{Point, Seen, View};
use crate::bsdf::{Bsdf, Direction, Transport};
use crate::cause::Cause;
use crate::models::microfacet::{GgxLoss, GgxMultiscatter, RoughPlastic};
use crate::models::{OrenNayarEon, Plastic};
use crate::registry::{Registry, Value};

const R: Transport = Transport::Radiance;

/// Claims about compensation.
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    if !view.fails_any(VALUE) {
        return Vec::new();
    }
    if view.parameters.0.contains_key("first") {
        return mixed(view);
    }
    let Some(book) = book.filter(|b| !b.agrees.by_value()) else { return Vec::new() };
    match book.name.as_str() {
        "ggx-multiscatter" => {
            GgxMultiscatter::declared(&book.parameters).map_or(Vec::new(), |m| facets(view, book, &m))
        }
        "oren-nayar-eon" => {
            OrenNayarEon::declared(&book.parameters).map_or(Vec::new(), |m| diffuse(view, book, &m))
        }
        "rough-plastic" => {
            RoughPlastic::declared(&book.parameters).map_or(Vec::new(), |m| coat(view, book, &m))
        }
        "plastic" => bare_base(view, book).into_iter().collect(),
        _ => Vec::new(),
    }
}

/// The base of a smooth coat, with nothing over it.
fn bare_base(view: &View, book: &Textbook) -> Option<Claim> {
    let Some(Value::Number(reflectance)) = book.parameters.0.get("reflectance") else { return None };
    let bare = reflectance / std::f64::consts::PI;
    claim(
        whole(view, book, |s, p, _| Some(if lit(s.wo, p.wi) { bare } else { 0.0 })),
        Cause::Normalization,
        "the coat is added to a base that gets all the light: the coat's transmittance is missing",
        "multiply the base by (1 − F) at both angles",
    )
}

fn lit(wo: Direction, wi: Direction) -> bool {
    wo.z > 0.0 && wi.z > 0.0
}

fn claim(fit: Option<Fit>, cause: Cause, statement: &str, repair: &str) -> Option<Claim> {
    let fit = fit?;
    Some(
        Claim::new(cause, statement, repair)
            .covers(VALUE)
            .likelihood(fit.ln_likelihood())
            .because(format!("this {}", fit.words())),
    )
}

/// GGX's light of many bounces is scale·L(μo) L(μi), L being what one bounce loses.
fn facets(view: &View, book: &Textbook, m: &GgxMultiscatter) -> Vec<Claim> {
    let loss = |mu: f64| m.loss.at(mu.min(1.0));
    let of = |losses: &dyn Fn(Direction, Direction) -> f64| {
        whole(view, book, |s, p, c| {
            let single = m.single.eval(s.wo, p.wi, R)[c];
            Some(if lit(s.wo, p.wi) { single + m.scale[c] * losses(s.wo, p.wi) } else { single })
        })
    };
    let both = |wo: Direction, wi: Direction| loss(wo.z) * loss(wi.z);
    let lost = m.loss.average();
    let mut claims = Vec::new();
    claims.extend(claim(
        of(&|wo, wi| {
            let h = (wo + wi).normalized();
            loss(h.dot(wo)).powi(2)
        }),
        Cause::EnergyCompensation,
        "the light of many bounces looks up what is lost at the angle to the half vector",
        "look it up at n·wo and n·wi: it is what is lost by the surface as a whole",
    ));
    claims.extend(claim(
        of(&|_, wi| loss(wi.z).powi(2)),
        Cause::EnergyCompensation,
        "the light of many bounces looks up what is lost at wi twice, where wo and wi are meant",
        "take 1 − E at both directions",
    ));
    claims.extend(claim(
        of(&|wo, _| loss(wo.z).powi(2)),
        Cause::EnergyCompensation,
        "the light of many bounces looks up what is lost at wo twice, where wo and wi are meant",
        "take 1 − E at both directions",
    ));
    claims.extend(claim(
        of(&|wo, wi| both(wo, wi) * lost / (1.0 - lost)),
        Cause::EnergyCompensation,
        "the light of many bounces is divided by E_avg where 1 − E_avg is meant",
        "divide by π (1 − E_avg)",
    ));
    for (key, what) in [(m.loss.alpha().powi(2), "α²"), (m.loss.alpha().sqrt(), "√α")] {
        let another = GgxLoss::of(key);
        claims.extend(claim(
            of(&|wo, wi| both(wo, wi) * lost / another.average()),
            Cause::Table,
            &format!("the average loss is looked up at {what} where α is meant"),
            "look up by the parameter that the table was made with",
        ));
        claims.extend(claim(
            of(&|wo, wi| another.at(wo.z.min(1.0)) * another.at(wi.z.min(1.0))),
            Cause::Table,
            &format!("the loss is looked up at {what} where α is meant"),
            "look up by the parameter that the table was made with",
        ));
    }
    let fresnel = |f: f64| f * f * (1.0 - lost) / (1.0 - f * lost);
    let average = average_fresnel(book);
    if let Some(f) = average {
        claims.extend(claim(
            of(&|wo, wi| both(wo, wi) * f * lost / (1.0 - f * (1.0 - lost)) / fresnel(f)),
            Cause::EnergyCompensation,
            "F of many bounces has E_avg and 1 − E_avg in each other's place",
            "F_ms = F² E_avg/(1 − F (1 − E_avg))",
        ));
    }
    claims.extend(scaled_bounces(view, book));
    claims.extend(table(view, m));
    claims
}

/// Mean of F over cos θ of the half vector, of Schlick's approximation.
fn average_fresnel(book: &Textbook) -> Option<f64> {
    match (book.parameters.0.get("fresnel"), book.parameters.0.get("f0")) {
        (Some(Value::Text(kind)), Some(Value::Number(f0))) if kind == "schlick" => {
            Some(f0 + (1.0 - f0) / 21.0)
        }
        _ => None,
    }
}

/// A constant in the light of many bounces.
fn scaled_bounces(view: &View, book: &Textbook) -> Option<Claim> {
    let regions = from_textbook(view, book, Function::Value);
    let region = regions.iter().find(|r| r.name.contains("many bounces"))?;
    let fit = super::deviation::fit(&region.ratios, |_| Some(1.0), super::deviation::Free::Scale)?;
    let statement = format!("the light of many bounces is off by the constant factor {:.5}", fit.scale);
    Some(
        claim(
            Some(fit),
            Cause::EnergyCompensation,
            &statement,
            "it must make good what one bounce loses: look at its normalisation by 1 − E_avg and at F",
        )?
        .price(EXACT_NUMBER - 4.0),
    )
}

/// Light of many bounces by a wrong function of each angle: how that function looks.
fn table(view: &View, m: &GgxMultiscatter) -> Vec<Claim> {
    const N: usize = 512;
    let Some(seen) = view.cases.iter().find(|s| s.wo.z > 0.1) else { return Vec::new() };
    let phi = seen.wo.phi() + 1.9;
    // L(μi)/L(μ) along one azimuth, up to a factor of wo's.
    let profile = |mu: &[f64]| -> Vec<f64> {
        let directions: Vec<Direction> = mu.iter().map(|mu| Direction::from_angles(mu.acos(), phi)).collect();
        let values = view.eval(seen.wo, &directions, seen.transport);
        let ratio = |(wi, f): (&Direction, &crate::bsdf::Spectrum)| {
            let multiple = f[0] - m.single.eval(seen.wo, *wi, R)[0];
            multiple / (m.scale[0] * m.loss.at(wi.z.min(1.0)))
        };
        directions.iter().zip(&values).map(ratio).collect()
    };
    let step = 1.0 / N as f64;
    let mu: Vec<f64> = (0..N).map(|k| (k as f64 + 0.5) * step).collect();
    let whole = profile(&mu);
    if whole.iter().any(|r| !r.is_finite()) {
        return Vec::new();
    }
    let size = whole.iter().fold(0.0f64, |a, r| a.max(r.abs()));
    // A jump stays as large between nearer neighbours.
    let jumps: Vec<usize> = (0..N - 1)
        .filter(|k| {
            let (mut lo, mut hi) = (mu[*k], mu[*k + 1]);
            let first = (whole[*k + 1] - whole[*k]).abs();
            if first < 1e-3 * size {
                return false;
            }
            for _ in 0..20 {
                let middle = 0.5 * (lo + hi);
                let r = profile(&[lo, middle, hi]);
                if (r[1] - r[0]).abs() > (r[2] - r[1]).abs() { hi = middle } else { lo = middle }
            }
            let r = profile(&[lo, hi]);
            (r[1] - r[0]).abs() > 0.3 * first
        })
        .collect();
    if evenly_spaced(&jumps) {
        return vec![
            Claim::new(
                Cause::Table,
                format!(
                    "eval() jumps at {} even steps of cos θi: a table is read without interpolation, or its neighbour wrongly",
                    jumps.len()
                ),
                "interpolate between t[k] and t[k + 1]",
            )
            .covers(VALUE)
            .price(2.0),
        ];
    }
    // The bend of a kink goes with the step, that of a smooth curve with its square.
    let bend = |at: f64, h: f64| {
        let r = profile(&[at - h, at, at + h]);
        (r[0] - 2.0 * r[1] + r[2]).abs()
    };
    let mut kinks: Vec<usize> = Vec::new();
    for k in 1..N - 1 {
        let wide = (whole[k - 1] - 2.0 * whole[k] + whole[k + 1]).abs();
        if wide < 1e-6 * size || kinks.last().is_some_and(|last| k - last < 3) {
            continue;
        }
        let h = step / 16.0;
        let narrow = (-16..=16).map(|j| bend(mu[k] + f64::from(j) * h, h)).fold(0.0, f64::max);
        if narrow > wide / 48.0 && narrow > 1e-7 * size {
            kinks.push(k);
        }
    }
    if evenly_spaced(&kinks) {
        return vec![
            Claim::new(
                Cause::Table,
                format!(
                    "eval() has kinks at {} even steps of cos θi: a table is read at the wrong place",
                    kinks.len()
                ),
                "check the index: the step is k = ⌊μ n⌋, between t[k] and t[k + 1]",
            )
            .covers(VALUE)
            .price(4.0),
        ];
    }
    Vec::new()
}

/// Whether places are at least five and multiples of one step.
fn evenly_spaced(places: &[usize]) -> bool {
    let mut merged: Vec<usize> = Vec::new();
    for p in places {
        if merged.last().is_none_or(|last| p - last > 3) {
            merged.push(*p);
        }
    }
    if !(5..=64).contains(&merged.len()) {
        return false;
    }
    let mut gaps: Vec<usize> = merged.windows(2).map(|w| w[1] - w[0]).collect();
    gaps.sort_unstable();
    let step = gaps[gaps.len() / 2] as f64;
    let even = gaps.iter().filter(|g| {
        let turns = **g as f64 / step;
        (turns - turns.round()).abs() < 0.08 && turns > 0.5
    });
    even.count() * 10 >= gaps.len() * 9
}

/// The energy-preserving model's light of many bounces.
fn diffuse(view: &View, book: &Textbook, m: &OrenNayarEon) -> Vec<Claim> {
    let bounces = |wo: Direction, wi: Direction| {
        if lit(wo, wi) { m.multiple * m.lost(wo.z.min(1.0)) * m.lost(wi.z.min(1.0)) } else { 0.0 }
    };
    // By least squares, then exactly.
    let (mut top, mut bottom) = (0.0, 0.0);
    for seen in &view.cases {
        for p in &seen.points {
            let (b, f) = (bounces(seen.wo, p.wi), p.value[0] - m.eval(seen.wo, p.wi, R)[0]);
            if f.is_finite() {
                top += b * f;
                bottom += b * b;
            }
        }
    }
    let off = top / bottom;
    if !off.is_finite() || off.abs() < 1e-5 {
        return Vec::new();
    }
    let fit = whole(view, book, |s, p, _| {
        let f = m.eval(s.wo, p.wi, R)[0];
        Some(f + off * bounces(s.wo, p.wi))
    });
    let statement = if (off + 1.0).abs() < 1e-6 {
        "the light of many bounces is left out".to_string()
    } else {
        format!("the light of many bounces is off by the constant factor {:.5}", 1.0 + off)
    };
    claim(
        fit,
        Cause::EnergyCompensation,
        &statement,
        "it must make good what one bounce loses: look at how often it is multiplied by the reflectance",
    )
    .map(|c| c.price(if (off + 1.0).abs() < 1e-6 { 1.0 } else { EXACT_NUMBER - 4.0 }))
    .into_iter()
    .collect()
}

/// The transmittance of a rough coat.
fn coat(view: &View, book: &Textbook, m: &RoughPlastic) -> Vec<Claim> {
    let mut claims = Vec::new();
    let coat = |wo: Direction, wi: Direction| m.coat.eval(wo, wi, R)[0];
    let base = |wo: Direction, wi: Direction| m.eval(wo, wi, R)[0] - coat(wo, wi);
    let passing = |w: Direction| m.lobes(w.z.min(1.0)).1;
    let (Some(Value::Number(eta)), Some(Value::Number(alpha))) =
        (book.parameters.0.get("eta"), book.parameters.0.get("alpha"))
    else {
        return claims;
    };
    let smooth = Plastic::new(m.reflectance, *eta);
    claims.extend(claim(
        whole(view, book, |s, p, _| {
            Some(if lit(s.wo, p.wi) { coat(s.wo, p.wi) + smooth.eval(s.wo, p.wi, R)[0] } else { 0.0 })
        }),
        Cause::EnergyCompensation,
        "the base gets the transmittance of a smooth coat under a rough one",
        "tabulate the transmittance of the rough coat itself",
    ));
    if let Some(other) =
        book.with("alpha", alpha * alpha).and_then(|b| RoughPlastic::declared(&b.parameters).ok())
    {
        claims.extend(claim(
            whole(view, book, |s, p, _| {
                let (wo, wi) = (s.wo, p.wi);
                let base = other.eval(wo, wi, R)[0] - other.coat.eval(wo, wi, R)[0];
                Some(if lit(wo, wi) { coat(wo, wi) + base.max(0.0) } else { 0.0 })
            }),
            Cause::Table,
            "the coat's transmittance is looked up at α² where α is meant",
            "look up by the parameter that the table was made with",
        ));
    }
    claims.extend(claim(
        whole(view, book, |s, p, _| {
            let lit = lit(s.wo, p.wi);
            Some(if lit { coat(s.wo, p.wi) + m.reflectance / std::f64::consts::PI } else { 0.0 })
        }),
        Cause::Normalization,
        "the coat is added to a base that gets all the light: the coat's transmittance is missing",
        "multiply the base by the transmittance of the coat at both angles",
    ));
    type Way = (&'static str, fn(f64, f64) -> f64);
    let ways: [Way; 2] = [
        ("lights the base through the coat, and sees it without", |o, _| o),
        ("sees the base through the coat, and lights it without", |_, i| i),
    ];
    for (what, of) in ways {
        claims.extend(claim(
            whole(view, book, |s, p, _| {
                let (wo, wi) = (s.wo, p.wi);
                Some(if lit(wo, wi) {
                    coat(wo, wi) + base(wo, wi) / of(passing(wo), passing(wi))
                } else {
                    0.0
                })
            }),
            Cause::FresnelArgument,
            &format!("eval() {what}"),
            "multiply the base by the transmittance at both angles",
        ));
    }
    // To a power, by the ratio at the first lit point that is not all coat.
    let mut powers: Vec<f64> = view
        .cases
        .iter()
        .flat_map(|s| s.points.iter().map(move |p| (s.wo, p)))
        .filter(|(wo, p)| lit(*wo, p.wi) && base(*wo, p.wi) > 0.05 * p.value[0])
        .filter_map(|(wo, p)| {
            let ratio = (p.value[0] - coat(wo, p.wi)) / base(wo, p.wi);
            let power = ratio.ln() / (passing(wo) * passing(p.wi)).ln();
            power.is_finite().then_some(power)
        })
        .collect();
    powers.sort_by(f64::total_cmp);
    if let Some(power) = powers.get(powers.len() / 2).copied().filter(|p| p.abs() > 1e-3) {
        let fit = whole(view, book, |s, p, _| {
            let (wo, wi) = (s.wo, p.wi);
            let by = |wo, wi| (passing(wo) * passing(wi)).powf(power);
            Some(if lit(wo, wi) { coat(wo, wi) + base(wo, wi) * by(wo, wi) } else { 0.0 })
        });
        let easy = (power - power.round()).abs() < 1e-5;
        let statement = format!(
            "the coat attenuates the base by its transmittance to the power {:.3} each way",
            1.0 + power
        );
        claims.extend(
            claim(
                fit,
                Cause::Normalization,
                &statement,
                "attenuate once on the way in and once on the way out",
            )
            .map(|c| c.price(if easy { 2.0 } else { EXACT_NUMBER })),
        );
    }
    claims
}

/// A mixture that is one lobe of mixed parameters.
fn mixed(view: &View) -> Vec<Claim> {
    let registry = Registry::builtin();
    let text = |name: &str| match view.parameters.0.get(name) {
        Some(Value::Text(t)) => t.trim_start_matches('(').trim_end_matches(')').parse().ok(),
        _ => None,
    };
    let (Some(first), Some(second), Some(weight)) = (text("first"), text("second"), view.number("weight"))
    else {
        return Vec::new();
    };
    let (Ok(a), Ok(b)) = (registry.resolve(&first), registry.resolve(&second)) else { return Vec::new() };
    if first.name != second.name {
        return Vec::new();
    }
    for weight in [weight, 1.0 - weight] {
        let mut mean = a.parameters.clone();
        for (name, value) in &mut mean.0 {
            if let (Value::Number(x), Some(Value::Number(y))) = (&*value, b.parameters.0.get(name)) {
                *value = Value::Number(x + weight * (y - x));
            }
        }
        let of = |parameters| Textbook::new(&first.name, parameters);
        let (Some(book), Some(one), Some(two)) = (of(&mean), of(&a.parameters), of(&b.parameters)) else {
            continue;
        };
        let right = |s: &Seen, p: &Point| {
            let of = |part: &Textbook| part.eval(s.wo, p.wi, s.transport)[0];
            (1.0 - weight) * of(&one) + weight * of(&two)
        };
        let fit = equals(view, |_, p| p.value[0], right, |s, p| Some(book.eval(s.wo, p.wi, s.transport)[0]));
        if let Some(claim) = claim(
            fit,
            Cause::EnergyCompensation,
            "a mixture of two lobes is one lobe with the mean of their parameters",
            "mix values and densities: f = (1 − w) f₁ + w f₂",
        ) {
            return vec![claim];
        }
    }
    Vec::new()
}
