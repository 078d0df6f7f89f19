//! Tables looked up wrongly.

use super::altered::Altered;
use super::energy_compensation::with_losses;
use super::mutant::Mutant;
use crate::bsdf::{self, Bsdf, Spectrum};
use crate::models::microfacet::{Distribution, GgxLoss, GgxMultiscatter, RoughPlastic, Roughness};
use crate::registry::Parameters;
use std::sync::Arc;

/// Steps of the table.
const STEPS: usize = 16;

/// GGX whose loss 1 − E(μ) is off by what `look` makes of a table by equal steps of
/// μ where linear interpolation is meant, given the table, the step, and the place in
/// it in [0, 1].
fn tabulated(p: &Parameters, look: fn(&[f64], usize, f64) -> f64) -> Result<Arc<dyn bsdf::Subject>, String> {
    let loss = GgxMultiscatter::declared(p)?.loss;
    let right = loss.clone();
    let table: Vec<f64> = (0..=STEPS).map(|k| loss.at(k as f64 / STEPS as f64)).collect();
    let at = move |mu: f64| {
        let mu = mu.min(1.0);
        let place = mu * STEPS as f64;
        let step = (place as usize).min(STEPS - 1);
        let x = place - step as f64;
        right.at(mu) + look(&table, step, x) - mixed(table[step], table[step + 1], x)
    };
    with_losses(p, move |_, wo, wi| at(wo.z) * at(wi.z))
}

fn mixed(a: f64, b: f64, x: f64) -> f64 {
    a + x * (b - a)
}

pub(super) fn mutants() -> Vec<Mutant> {
    vec![
        Mutant::new(
            "table-off-by-one",
            "ggx-multiscatter:alpha=0.8",
            "the step of the table is one too far",
            |p, _| tabulated(p, |t, k, x| mixed(t[(k + 1).min(STEPS)], t[(k + 2).min(STEPS)], x)),
        )
        .source("index off by one")
        .varied(&[("alpha", 0.5, 1.0)])
        .must_fail(&["energy", "white-furnace"]),
        Mutant::new(
            "table-value-plus-one",
            "ggx-multiscatter:alpha=0.8",
            "between t[k] and t[k] + 1 in place of t[k + 1]",
            |p, _| tabulated(p, |t, k, x| mixed(t[k], t[k] + 1.0, x)),
        )
        .source("Mitsuba 3 roughplastic 396cd83df: `data + 1`")
        .varied(&[("alpha", 0.5, 1.0)])
        // By so much that it shows though no cubature gets over that many jumps.
        .must_fail(&["reference", "energy", "white-furnace"])
        .compared(),
        Mutant::new(
            "table-staircase",
            "ggx-multiscatter:alpha=0.8",
            "the table is read in steps where it should be interpolated",
            |p, _| tabulated(p, |t, k, _| t[k]),
        )
        .source("nearest for linear")
        .varied(&[("alpha", 0.5, 1.0)])
        .must_fail(&["white-furnace"]),
        // Less is lost at α² than at α: the division makes too much of the rest.
        Mutant::new(
            "average-of-another-key",
            "ggx-multiscatter:alpha=0.8",
            "the average loss is looked up at α²",
            |p, _| {
                let another = GgxLoss::of(p.number("alpha").powi(2)).average();
                with_losses(p, move |m, wo, wi| {
                    m.loss.at(wo.z.min(1.0)) * m.loss.at(wi.z.min(1.0)) * m.loss.average() / another
                })
            },
        )
        .source("OSPRay 616f94dce: E_avg of another key")
        .varied(&[("alpha", 0.3, 0.9)])
        .must_fail(&["energy", "white-furnace"]),
        Mutant::new(
            "transmittance-of-another-key",
            "rough-plastic:reflectance=1,alpha=0.6",
            "the coat's transmittance is looked up at α²",
            |p, _| {
                let alpha = Roughness::isotropic(p.number("alpha").powi(2));
                let other =
                    RoughPlastic::new(Distribution::ggx(alpha), p.number("eta"), p.number("reflectance"))?;
                Altered::of(RoughPlastic::declared(p)?)
                    .eval(move |m, wo, wi, t| {
                        let base = other.eval(wo, wi, t)[0] - other.coat.eval(wo, wi, t)[0];
                        Spectrum::from(m.coat.eval(wo, wi, t)[0] + base.max(0.0))
                    })
                    .made()
            },
        )
        .source("OSPRay 616f94dce, of a coat")
        .shows_at(&[75.0])
        .varied(&[("alpha", 0.3, 0.8)])
        .must_fail(&["white-furnace"]),
    ]
}
