//! A distribution of normals is one of a surface.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism};
use crate::bsdf::{Description, Precision, SubjectKind};
use crate::evidence::{Estimate, Evidence, Facets, Measurement, Place};
use std::f64::consts::PI;

/// ∫D cos θm = 1; what G1 leaves of the facets fills the view,
/// ∫G1 max(0, wo·m) D = cos θo; the facets' signed area is the surface's,
/// ∫(wo·m) D = cos θo; the weak white furnace; Smith's Λ; and the told
/// densities (E. Heitz, *Understanding the masking-shadowing function*, JCGT
/// 2014). Draws are tested against densities by the statistical checks.
pub struct Distribution;

/// How far the integrals may be off: a hundred times the cubature's goal, near
/// the horizon still some times its error; or rounding.
fn tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F64 => 1e-4,
        Precision::F32 => 1e-3,
    }
}

/// Factors that are forgotten or counted twice, as a person writes them.
const FACTORS: [(f64, &str); 6] =
    [(PI, "π"), (2.0, "2"), (4.0, "4"), (2.0 * PI, "2π"), (PI * PI, "π²"), (4.0 * PI, "4π")];

/// An integral that must be 1.
struct Law {
    name: &'static str,
    found: Estimate,
    breach: String,
}

impl Law {
    fn off(&self) -> f64 {
        self.found.value - 1.0
    }

    /// Off for certain, were the cubature off by this many times its error.
    fn is_broken(&self, certainty: f64, tolerance: f64) -> bool {
        !(self.off().abs() - certainty * self.found.error <= tolerance)
    }
}

/// Whether `value` is 1 so nearly that it explains why another one is `off`: to
/// a five-hundredth of that, and five times the cubature's goal.
fn explains(value: f64, off: f64) -> bool {
    (value - 1.0).abs() < 0.002 * off.abs() + 5e-6
}

/// Why ∫D cos θm is not 1.
fn why_not_normalised(f: &Facets) -> String {
    let (n, off) = (f.projected.value, f.projected.value - 1.0);
    for (factor, word) in FACTORS {
        if explains(n / factor, off) {
            return format!("{word} times too large: D lacks the factor 1/{word}");
        }
        if explains(n * factor, off) {
            return format!("{word} times too small: D has the factor 1/{word} once too often");
        }
    }
    if explains(f.total.value, off) {
        return "and ∫D = 1: this is the density D cos θm of normals, not D".into();
    }
    if explains(f.twice_projected.value, off) {
        return "and ∫D cos² θm = 1: D was divided by cos θm once too often".into();
    }
    "the facets' projected area is not the surface's".into()
}

/// Why the visible facets do not fill the view.
fn why_not_visible(f: &Facets) -> String {
    let off = f.visible.value - 1.0;
    // Under Smith's masking this is 1/G1.
    let unmasked = f.facing.value;
    if explains(f.projected.value, off) && explains(f.visible.value / unmasked, off) {
        return "G1 hides nothing, though facets turned away hide others".into();
    }
    if explains(f.projected.value, off) && explains(f.visible.value * unmasked, off) {
        return "as where G1 is squared".into();
    }
    let what = if off > 0.0 { "too little" } else { "too much" };
    format!("G1 hides {what}")
}

fn laws(f: &Facets, tolerance: f64) -> Vec<Law> {
    let signed =
        Estimate { value: f.facing.value - f.averted.value, error: f.facing.error + f.averted.error };
    let mut all = vec![
        Law { name: "∫D cos θm", found: f.projected, breach: why_not_normalised(f) },
        Law { name: "∫G1 max(0, wo·m) D / cos θo", found: f.visible, breach: why_not_visible(f) },
    ];
    // Near the horizon the areas of both sides are large beside their difference.
    if signed.error <= 10.0 * tolerance {
        all.push(Law {
            name: "∫(wo·m) D / cos θo",
            found: signed,
            breach: "the facets' mean normal is not the surface's".into(),
        });
    }
    if let Some(lambda) = f.lambda {
        let scale = 1.0 + f.averted.value;
        all.push(Law {
            name: "(1 + Λ)/(1 + ∫max(0, −wo·m) D / cos θo)",
            found: Estimate { value: (1.0 + lambda) / scale, error: f.averted.error / scale },
            breach: "Λ is not the area of facets turned away".into(),
        });
    }
    all
}

impl Check for Distribution {
    fn id(&self) -> &'static str {
        "distribution"
    }

    fn hypothesis(&self) -> &'static str {
        "∫D cos θm = 1; ∫G1 max(0, wo·m) D = cos θo; weak white furnace; Smith's Λ; densities from D and G1"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Facets]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Distribution]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        if evidence.wo.z <= 0.0 {
            return Outcome::skipped("facets are seen from the front side only").into();
        }
        let Some(facets) = &evidence.facets else { return Judgement::Missing };
        let tolerance = tolerance(evidence.description.precision);
        let mut laws = laws(facets, tolerance);
        let sizes = |l: &Law| (l.off().abs(), l.found.error);
        let effect = |l: &Law| {
            let (off, error) = (l.off(), l.found.error);
            Effect::interval(&format!("{} − 1", l.name), (off, off - error, off + error), tolerance)
        };
        if facets.below.is_broken() {
            return Outcome::of_tally(&facets.below, "D = 0 below the horizon", "no normal is there").into();
        }
        if let Ok(certainty) = facets.certainty(tolerance) {
            let mut broken = laws.iter().filter(|l| l.is_broken(certainty, tolerance));
            if let Some(first) = broken.next() {
                let mut message =
                    format!("{} = {:.5} where it must be 1, {}", first.name, first.found.value, first.breach);
                for law in broken {
                    message.push_str(&format!("; {} = {:.5}", law.name, law.found.value));
                }
                return Outcome {
                    effect: Some(effect(first)),
                    worst: Some(Place { wo: evidence.wo, ..Place::default() }),
                    ..Outcome::new(Verdict::Fail, message)
                }
                .into();
            }
        }
        for (tally, identity, breach) in [
            (Some(&facets.masking), "G1 ≤ 1", "more is seen than there is"),
            (facets.smith.as_ref(), "G1 (1 + Λ) = 1", "masking and Λ are not of one surface"),
            (
                Some(&facets.densities),
                "pdf = D cos θm, visible_pdf = G1 max(0, wo·m) D / cos θo",
                "the told density is another one",
            ),
        ] {
            if let Some(tally) = tally.filter(|t| t.is_broken()) {
                return Outcome::of_tally(tally, identity, breach).into();
            }
        }
        laws.sort_by(|a, b| sizes(b).0.total_cmp(&sizes(a).0));
        let widest = laws.iter().max_by(|a, b| sizes(a).1.total_cmp(&sizes(b).1)).unwrap_or(&laws[0]);
        let error = widest.found.error;
        if let Err(reason) = facets.reliable(tolerance) {
            return Outcome::inconclusive(reason).into();
        }
        if !(error <= 10.0 * tolerance) {
            let reason = format!("the cubature's error of {} is {error:.1e}, too large to tell", widest.name);
            return Outcome::inconclusive(reason).into();
        }
        let message = format!(
            "∫D cos θm = {:.6}, G1 leaves {:.6} of the projected area, weak white furnace {:.4} ± {:.0e}{}",
            facets.projected.value,
            facets.visible.value,
            facets.furnace.value,
            facets.furnace.error,
            facets.lambda.map_or(String::new(), |l| format!(", Λ = {l:.6}"))
        );
        Outcome {
            effect: Some(effect(&laws[0])),
            detection_limit: Some(tolerance + error),
            ..Outcome::new(Verdict::Pass, message)
        }
        .into()
    }
}
