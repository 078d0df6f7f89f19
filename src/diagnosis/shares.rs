//! With which probabilities lobes are mixed.

use super::counts::{CountTest, Counts};
use super::explanation::{COUNTED_NUMBER, Claim};
use super::pdf::counts;
use super::textbook::Textbook;
use super::view::View;
use crate::bsdf::Direction;
use crate::cause::Cause;

/// Coefficients of the lobes' densities, of one case.
struct Mixed {
    /// The shares that the textbook has.
    shares: Vec<f64>,
    /// Those that were found.
    found: Vec<f64>,
}

impl Mixed {
    /// Found over right.
    fn ratios(&self) -> Vec<f64> {
        self.found.iter().zip(&self.shares).map(|(f, s)| f / s).collect()
    }
}

/// Relative error of an exact coefficient.
const EXACT: f64 = 1e-5;

/// Claims about shares, in pdf() and in sample().
pub fn claims(view: &View, book: Option<&Textbook>) -> Vec<Claim> {
    let Some(book) = book else { return Vec::new() };
    let mixture = book.lobes.len() > 1 || book.lobes.first().is_some_and(|l| !l.name.is_empty());
    if !mixture || book.name == "rough-dielectric" || book.name == "oren-nayar-eon" {
        return Vec::new();
    }
    if !view.fails_any(&["goodness-of-fit", "normalization", "jacobian"]) {
        return Vec::new();
    }
    let mut claims = if book.agrees.by_pdf() { Vec::new() } else { in_pdf(view, book) };
    if claims.is_empty() && book.agrees.by_pdf() {
        claims.extend(in_sampler(view, book));
    }
    claims
}

/// Least squares of `target` by the columns, rows weighted; the residual's largest
/// relative size is the second value.
fn solve(rows: &[(Vec<f64>, f64, f64)]) -> Option<Vec<f64>> {
    let n = rows.first()?.0.len();
    let mut a = vec![vec![0.0; n + 1]; n];
    for (columns, target, weight) in rows {
        for i in 0..n {
            for j in 0..n {
                a[i][j] += weight * columns[i] * columns[j];
            }
            a[i][n] += weight * columns[i] * target;
        }
    }
    for i in 0..n {
        let pivot = (i..n).max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs()))?;
        a.swap(i, pivot);
        let row = a[i].clone();
        if row[i].abs() < 1e-300 {
            return None;
        }
        for (_, other) in a.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = other[i] / row[i];
            other.iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
        }
    }
    Some((0..n).map(|i| a[i][n] / a[i][i]).collect())
}

/// pdf() as a mixture of the textbook's lobes, exactly.
fn in_pdf(view: &View, book: &Textbook) -> Vec<Claim> {
    let mut all = Vec::new();
    for seen in view.cases.iter().filter(|s| s.wo.z > 0.0) {
        let row =
            |wi: Direction| -> Vec<f64> { book.lobes.iter().map(|l| (l.density)(seen.wo, wi)).collect() };
        let rows: Vec<(Vec<f64>, f64, f64)> = seen
            .points
            .iter()
            .filter(|p| p.wi.z > 0.0 && p.pdf.is_finite())
            .map(|p| (row(p.wi), p.pdf, 1.0))
            .filter(|(columns, ..)| columns.iter().sum::<f64>() > 0.0)
            .map(|(columns, p, _)| {
                let scale: f64 = columns.iter().sum();
                (columns.iter().map(|c| c / scale).collect(), p / scale, 1.0)
            })
            .collect();
        let Some(found) = solve(&rows) else { return Vec::new() };
        let fits = |(columns, target, _): &&(Vec<f64>, f64, f64)| {
            let predicted: f64 = columns.iter().zip(&found).map(|(c, f)| c * f).sum();
            // What is negative may be cut at 0.
            (predicted.max(0.0) - target).abs() <= EXACT * (predicted.abs() + target.abs())
                || (predicted - target).abs() <= EXACT * (predicted.abs() + target.abs())
        };
        let matched = rows.iter().filter(fits).count();
        if (matched as f64) < 0.97 * rows.len() as f64 || rows.len() < 24 {
            return Vec::new();
        }
        let shares = book.lobes.iter().map(|l| (l.share)(seen.wo)).collect();
        all.push(Mixed { shares, found });
    }
    if all.is_empty() { Vec::new() } else { judged(&all, book, "pdf()") }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * (a.abs() + b.abs())
}

/// What shares that are exactly known say.
fn judged(all: &[Mixed], book: &Textbook, function: &str) -> Vec<Claim> {
    let lobes = book.lobes.len();
    let name = |k: usize| book.lobes[k].name;
    let each = |k: usize| all.iter().map(move |m| (m.shares[k], m.found[k]));
    let is_right = |k: usize| each(k).all(|(s, f)| close(s, f));
    let is_alone = |k: usize| each(k).all(|(s, f)| close(f, 1.0) && !close(s, 1.0));
    let wrong: Vec<usize> = (0..lobes).filter(|k| !is_right(*k)).collect();
    if wrong.is_empty() {
        return Vec::new();
    }
    let mut claims = Vec::new();
    let told = |m: &Mixed| {
        let parts: Vec<String> =
            (0..lobes).map(|k| format!("{} {:.4} for {:.4}", name(k), m.found[k], m.shares[k])).collect();
        format!("probabilities found in {function}: {}", parts.join(", "))
    };
    if all.iter().any(|m| m.found.iter().any(|f| *f < -EXACT)) {
        claims.push(
            Claim::new(
                Cause::Numerics,
                format!("{function} mixes its lobes with a negative probability"),
                "probabilities of lobes are weights over their sum, each at least 0",
            )
            .because(told(&all[0])),
        );
        return claims;
    }
    let forgotten: Vec<&str> = wrong.iter().filter(|k| is_alone(**k)).map(|k| name(*k)).collect();
    if forgotten.len() == wrong.len() {
        claims.push(
            Claim::new(
                Cause::LobeProbability,
                format!(
                    "{function} adds {} without the probability that it is drawn from",
                    forgotten.join(" and ")
                ),
                "multiply the density of each lobe by the probability with which sample() chooses it",
            )
            .because(told(&all[0])),
        );
        return claims;
    }
    let sums_to_one = |m: &Mixed| {
        let (right, found) = (m.shares.iter().sum::<f64>(), m.found.iter().sum::<f64>());
        close(right, found)
    };
    if lobes > 1 && wrong.len() > 1 && all.iter().all(sums_to_one) {
        claims.push(
            Claim::new(
                Cause::LobeProbability,
                format!("{function} chooses its lobes with other probabilities than sample()"),
                "compute the probabilities in one function that both call, from wo alone",
            )
            .price(2.0)
            .because(told(&all[0])),
        );
        return claims;
    }
    let common = |m: &Mixed| {
        let ratios = m.ratios();
        ratios.iter().all(|r| close(*r, ratios[0]))
    };
    let ratio = |m: &Mixed| m.ratios()[wrong[0]];
    let varies = all.iter().any(|m| !close(ratio(m), ratio(&all[0])));
    if lobes > 1 && all.iter().all(common) && varies {
        claims.push(
            Claim::new(
                Cause::LobeProbability,
                format!("the probabilities of the lobes in {function} do not add up to 1"),
                "divide each weight by the sum of all",
            )
            .price(2.0)
            .because(told(&all[0])),
        );
        return claims;
    }
    // A constant in one lobe, or several of one kind.
    let constant = |k: &usize| {
        let first = all[0].found[*k] / all[0].shares[*k];
        all.iter().all(|m| close(m.found[*k] / m.shares[*k], first))
    };
    if all.len() > 1 && wrong.iter().all(constant) && wrong.len() < lobes {
        let k = wrong[0];
        let factor = all[0].found[k] / all[0].shares[k];
        claims.push(
            Claim::new(
                Cause::ConstantFactor,
                format!("in {function} {} is {factor:.5} times too large, whatever wo and wi", name(k)),
                "look for a missing or doubled π, 2 or 4 in the density of that lobe",
            )
            .price(2.0)
            .because(told(&all[0])),
        );
    }
    if wrong.len() > 1 && !forgotten.is_empty() && claims.is_empty() {
        let others: Vec<&usize> = wrong.iter().filter(|k| !is_alone(**k)).collect();
        if others.iter().all(|k| constant(k)) {
            let k = *others[0];
            let factor = all[0].found[k] / all[0].shares[k];
            claims.push(
                Claim::new(
                    Cause::ConstantFactor,
                    format!(
                        "in {function} {} is {factor:.5} times too large, and {} is added without its probability",
                        name(k),
                        forgotten.join(" and ")
                    ),
                    "normalise the density of each lobe, then multiply it by its probability",
                )
                .price(3.0)
                .because(told(&all[0])),
            );
        }
    }
    claims
}

/// The draws as another mixture of the lobes, by their counts.
fn in_sampler(view: &View, book: &Textbook) -> Vec<Claim> {
    let mut all = Vec::new();
    let mut test = CountTest::default();
    for (k, c) in counts(view).iter().filter(|(k, _)| view.cases[*k].wo.z > 0.0) {
        let wo = view.cases[*k].wo;
        let Some((mixed, found)) = mixture(wo, book, c) else { return Vec::new() };
        test = test.and(found);
        all.push(mixed);
    }
    if all.is_empty() || !test.fits() {
        return Vec::new();
    }
    let lobes = book.lobes.len();
    // Shares that counts cannot tell from the right ones are right.
    let off = |m: &Mixed, k: usize| (m.found[k] - m.shares[k]).abs() > 0.01 * m.shares[k].max(0.05);
    let wrong: Vec<usize> = (0..lobes).filter(|k| all.iter().any(|m| off(m, *k))).collect();
    let told = |m: &Mixed| {
        let of = |k: usize| format!("{} {:.4} for {:.4}", book.lobes[k].name, m.found[k], m.shares[k]);
        format!("probabilities found in the draws: {}", (0..lobes).map(of).collect::<Vec<_>>().join(", "))
    };
    let claim = |cause, statement: &str, repair: &str, price: f64| {
        Claim::new(cause, statement, repair)
            .likelihood(test.ln_likelihood())
            .price(price)
            .p(test.ln_p())
            .because(told(&all[0]))
    };
    let sums = all.iter().all(|m| {
        let (right, found): (f64, f64) = (m.shares.iter().sum(), m.found.iter().sum());
        (right - found).abs() < 0.01
    });
    let discrete = view.cases.iter().any(|s| !s.discrete.is_empty());
    if lobes == 1 && wrong.len() == 1 && discrete {
        return vec![claim(
            Cause::LobeProbability,
            "sample() chooses its discrete lobe with another probability than pdf() leaves to it",
            "compute the probability in one function that both call, from wo alone",
            COUNTED_NUMBER,
        )];
    }
    if wrong.len() > 1 && sums {
        return vec![claim(
            Cause::LobeProbability,
            "sample() chooses its lobes with other probabilities than pdf()",
            "compute the probabilities in one function that both call, from wo alone",
            COUNTED_NUMBER,
        )];
    }
    // One lobe is drawn from more often than it may: what falls off it is redrawn.
    let redrawn = |k: usize| {
        all.iter().all(|m| m.found[k] >= m.shares[k] * 0.995)
            && (0..lobes).all(|j| j == k || all.iter().all(|m| !off(m, j)))
    };
    if let Some(k) = wrong.first().filter(|k| wrong.len() == 1 && redrawn(**k)) {
        let statement =
            format!("sample() draws {} again where it falls below the horizon", book.lobes[*k].name);
        return vec![claim(
            Cause::UnnormalizedRejection,
            &statement,
            "return no sample there, or divide pdf() by the part of the lobe that is above",
            COUNTED_NUMBER + 1.0,
        )];
    }
    Vec::new()
}

/// The mixture of the lobes that fits the counts best.
fn mixture(wo: Direction, book: &Textbook, c: &Counts) -> Option<(Mixed, CountTest)> {
    let masses: Vec<Vec<f64>> = book.lobes.iter().map(|l| c.rough_masses(|wi| (l.density)(wo, wi))).collect();
    let n = c.draws as f64;
    let rows: Vec<(Vec<f64>, f64, f64)> = (0..c.leaves.len())
        .map(|leaf| {
            let columns: Vec<f64> = masses.iter().map(|m| m[leaf]).collect();
            let observed = c.leaves[leaf] as f64 / n;
            // Variances by what the right shares expect.
            let expected: f64 = columns.iter().zip(&book.lobes).map(|(m, l)| m * (l.share)(wo)).sum();
            (columns, observed, 1.0 / (expected + 1.0 / n))
        })
        .collect();
    let found = solve(&rows)?;
    if found.iter().any(|f| !(-0.01..=1.5).contains(f)) {
        return None;
    }
    let all: Vec<f64> = rows.iter().map(|(m, ..)| m.iter().zip(&found).map(|(m, f)| m * f).sum()).collect();
    let shares = book.lobes.iter().map(|l| (l.share)(wo)).collect();
    Some((Mixed { shares, found }, c.test(&all, book.lobes.len())))
}
