//! Without a textbook: what has to be changed in pdf() for the counts to fit.

use super::counts::{CountTest, Counts};
use super::deviation::Free;
use super::explanation::{COUNTED_NUMBER, Claim};
use super::mistakes::{Mistake, PDF};
use super::numbers::least;
use super::parts::{At, Parts};
use super::view::View;
use crate::bsdf::{Direction, SubjectKind, Transport};
use crate::cause::Cause;
use crate::models::microfacet::{Distribution, Roughness};

/// A case's counts, and pdf() where they are compared.
struct Case<'c> {
    counts: &'c Counts,
    wo: Direction,
    transport: Transport,
    directions: Vec<Direction>,
    pdf: &'c [f64],
}

impl Case<'_> {
    /// Mass of pdf(), and the share of draws that gave a continuous sample.
    fn mass_and_drawn(&self) -> (f64, f64) {
        let drawn = self.counts.leaves.iter().sum::<u64>() as f64 / self.counts.draws as f64;
        (self.counts.own.iter().sum(), drawn)
    }

    /// The counts under these values of a density.
    fn test(&self, values: Vec<f64>, fitted: usize) -> CountTest {
        let mut values = values.into_iter();
        let masses = self.counts.masses(|_| values.next().unwrap_or(0.0));
        self.counts.test(&masses, fitted)
    }
}

/// Claims about pdf().
pub fn by_counts(view: &View, counts: &[(usize, Counts)]) -> Vec<Claim> {
    let mut claims = Vec::new();
    let kind = view.description.kind;
    if kind != SubjectKind::Bsdf || counts.len() < 2 || !view.fails_any(&["goodness-of-fit", "normalization"])
    {
        return claims;
    }
    let cases: Vec<Case> = counts
        .iter()
        .map(|(k, counts)| Case {
            counts,
            wo: view.cases[*k].wo,
            transport: view.cases[*k].transport,
            directions: counts.directions(),
            pdf: counts.density(),
        })
        .collect();
    let unchanged =
        cases.iter().map(|c| c.test(c.pdf.to_vec(), 0)).fold(CountTest::default(), CountTest::and);
    if unchanged.fits() {
        return claims;
    }
    let parts = declared(view);
    claims.extend(PDF.iter().filter_map(|m| of_factor(m, &cases, &parts)));
    claims.extend(scaled(&cases));
    claims.extend(exchanged(view, &cases));
    claims
}

/// A factor that pdf() is to be divided by.
fn of_factor(m: &Mistake, cases: &[Case], parts: &Parts) -> Option<Claim> {
    let factors: Vec<Vec<Option<f64>>> = cases
        .iter()
        .map(|c| {
            let of = |wi: &Direction| (m.factor)(&At::new(parts, c.wo, *wi, c.transport));
            c.directions.iter().map(of).collect()
        })
        .collect();
    // A factor that is not known where pdf() is says nothing.
    let (mut known, mut all, mut telling) = (0, 0, 0);
    for (c, factors) in cases.iter().zip(&factors) {
        for (_, f) in c.pdf.iter().zip(factors).filter(|(p, _)| **p > 0.0) {
            all += 1;
            known += usize::from(f.is_some());
            telling += usize::from(f.is_some_and(|f| f.ln().abs() > 0.02));
        }
    }
    let half = m.cause == Cause::RefractionJacobian;
    if telling * 10 < all || (known * 10 < all * 8 && !half) || m.free == Free::Scale {
        return None;
    }
    let test = |power: f64, fitted: usize| {
        let one = |(c, factors): (&Case, &Vec<Option<f64>>)| {
            let repaired = |(p, f): (&f64, &Option<f64>)| match f {
                Some(f) if *p > 0.0 => p / f.powf(power),
                _ => *p,
            };
            c.test(c.pdf.iter().zip(factors).map(repaired).collect(), fitted)
        };
        cases.iter().zip(&factors).map(one).fold(CountTest::default(), CountTest::and)
    };
    let (power, found, cost) = match m.free {
        Free::Power => {
            let whole = [-1.0, 1.0].map(|p| (p, test(p, 0)));
            match whole.into_iter().find(|(_, t)| t.fits()) {
                Some((power, found)) => (power, found, 1.0),
                None => {
                    let power = least(-1.5, 1.5, 20, |p| test(p, 1).x2());
                    (power, test(power, 1), COUNTED_NUMBER)
                }
            }
        }
        _ => (1.0, test(1.0, 0), 0.0),
    };
    let number = if m.free == Free::Power { format!(" (to the power {power:.2})") } else { String::new() };
    found.fits().then(|| {
        Claim::new(m.cause, format!("pdf() {}{number}", m.what), m.repair)
            .likelihood(found.ln_likelihood())
            .price(1.0 + cost)
            .p(found.ln_p())
    })
}

/// Constants: one for all, or one for each wo.
fn scaled(cases: &[Case]) -> Vec<Claim> {
    let scales: Vec<f64> = cases
        .iter()
        .map(|c| {
            let (mass, drawn) = c.mass_and_drawn();
            drawn / mass
        })
        .collect();
    let test = |scale: &dyn Fn(usize) -> f64, fitted: usize| {
        let one = |(k, c): (usize, &Case)| c.test(c.pdf.iter().map(|p| p * scale(k)).collect(), fitted);
        cases.iter().enumerate().map(one).fold(CountTest::default(), CountTest::and)
    };
    let each = test(&|k| scales[k], 1);
    if !each.fits() {
        return Vec::new();
    }
    let mean = scales.iter().sum::<f64>() / scales.len() as f64;
    let one = test(&|_| mean, 0);
    // Of one θo a function of wo is a constant too.
    let several = cases.iter().any(|c| (c.wo.z.abs() - cases[0].wo.z.abs()).abs() > 0.05);
    if several && one.fits() {
        return vec![
            Claim::new(
                Cause::ConstantFactor,
                format!("pdf() is {:.4} times too large, whatever wo and wi", 1.0 / mean),
                "look for a missing or doubled π, 2 or 4, or for a normalisation of something else",
            )
            .likelihood(one.ln_likelihood())
            .price(COUNTED_NUMBER)
            .p(one.ln_p()),
        ];
    }
    let nothing_lost = cases.iter().all(|c| c.mass_and_drawn().1 > 0.995);
    let too_small = scales.iter().all(|s| *s > 1.0);
    if nothing_lost && too_small {
        return vec![
            Claim::new(
                Cause::UnnormalizedRejection,
                "sample() draws again until a direction is above the horizon, and pdf() is not divided by the mass that is left above",
                "return no sample there; or divide pdf() by the mass above the horizon, which depends on wo",
            )
            .likelihood(each.ln_likelihood())
            .price(2.0)
            .p(each.ln_p()),
        ];
    }
    vec![
        Claim::new(
            Cause::NdfVndfMismatch,
            "pdf() is off by a factor that depends on wo alone, as the masking G1(wo)",
            "look for a factor of wo: G1(wo), a probability, or a normalisation of one view",
        )
        .likelihood(each.ln_likelihood())
        .price(COUNTED_NUMBER + 12.0)
        .p(each.ln_p()),
    ]
}

/// Both directions exchanged.
fn exchanged(view: &View, cases: &[Case]) -> Option<Claim> {
    let one = |c: &Case| {
        let of = |(wi, p): (&Direction, &f64)| {
            // Elsewhere nothing is drawn: most directions of the sphere.
            if *p == 0.0 { 0.0 } else { view.pdf(*wi, &[c.wo], c.transport)[0] }
        };
        c.test(c.directions.iter().zip(c.pdf).map(of).collect(), 0)
    };
    let found = cases.iter().map(one).fold(CountTest::default(), CountTest::and);
    found.fits().then(|| {
        Claim::new(
            Cause::SwappedArguments,
            "pdf(wo, wi) is pdf(wi, wo): its arguments are exchanged",
            "exchange them at the call or in the signature: wo is given, wi was drawn",
        )
        .likelihood(found.ln_likelihood())
        .p(found.ln_p())
    })
}

/// Parts from parameters and claims by their names.
fn declared(view: &View) -> Parts {
    let roughness = view.number("alpha").map(|x| {
        let y = view.number("alpha_y").filter(|y| *y > 0.0).unwrap_or(x);
        Roughness { x, y }
    });
    Parts {
        distribution: roughness.map(Distribution::ggx),
        masking: None,
        fresnel: None,
        eta: view.description.claims.eta.or_else(|| view.number("eta")),
    }
}
