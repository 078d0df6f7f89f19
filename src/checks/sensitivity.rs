//! Parameters do something, and reach their limits.

use super::outcome::{Check, Effect, Judgement, Outcome, Terms, Verdict, needs_determinism};
use crate::bsdf::{Description, SubjectKind};
use crate::evidence::{CHANGE, Evidence, Limit, Measurement};
use std::collections::BTreeMap;

/// Every declared parameter changes something; η → 1 reflects nothing and
/// α → 0 gathers samples around mirror and refracted directions; front and back
/// agree where two-sided.
pub struct Sensitivity;

/// Median angle off the mirror, in units of the roughness: GGX's is about 2 at
/// normal incidence.
const NARROW: f64 = 10.0;

/// Roughness below which a lobe need not narrow any further: renderers hold α above
/// 1e-3 (pbrt-v3) or 1e-4 (Mitsuba), lest D exceed the range of f32.
const FLOOR: f64 = 1e-3;

/// Flux that an interface with equal indices may reflect.
const TRANSPARENT: f64 = 1e-9;

/// Where samples gather, in words; `median` is infinite where none came.
fn narrowed(parameter: &str, value: &str, median: f64, kind: SubjectKind) -> String {
    let centre = match kind {
        SubjectKind::Distribution => "normal",
        _ => "mirror",
    };
    if median.is_infinite() {
        return format!("`{parameter}` = {value}: no sample came, so that none is near the {centre}");
    }
    let degrees = median.to_degrees();
    format!("`{parameter}` = {value}: the median sample is {degrees:.3}° off the {centre}")
}

impl Check for Sensitivity {
    fn id(&self) -> &'static str {
        "sensitivity"
    }

    fn hypothesis(&self) -> &'static str {
        "every parameter changes something; limits are reached; front and back agree where two-sided"
    }

    fn needs(&self) -> &'static [Measurement] {
        &[Measurement::Samples, Measurement::Variations, Measurement::Integrals, Measurement::Draws]
    }

    fn kinds(&self) -> &'static [SubjectKind] {
        &[SubjectKind::Bsdf, SubjectKind::Distribution, SubjectKind::Fresnel]
    }

    fn applies(&self, description: &Description) -> Result<(), String> {
        needs_determinism(description)
    }

    fn judge(&self, evidence: &Evidence, _: &Terms) -> Judgement {
        let Some(variations) = &evidence.variations else { return Judgement::Missing };
        if let Some(tally) = evidence.two_sided.as_ref().filter(|t| t.is_broken()) {
            let breach = "front and back differ although two_sided is claimed";
            return Outcome::of_tally(tally, "equality under wo.z, wi.z → −wo.z, −wi.z", breach).into();
        }
        if variations.is_empty() && evidence.two_sided.is_none() {
            return Outcome::skipped("the subject declares no parameter and no second side").into();
        }
        if evidence.is_black() {
            return Outcome::skipped("no light leaves here: nothing could change").into();
        }
        let mut largest: BTreeMap<&str, (f64, String)> = BTreeMap::new();
        for v in variations {
            let entry = largest.entry(&v.parameter).or_default();
            entry.0 = entry.0.max(v.change.0);
            entry.1 = format!("{} → {}", v.from, v.to);
        }
        if let Some((name, (change, step))) = largest.iter().find(|(_, (change, _))| !(*change > CHANGE)) {
            let message = format!("parameter `{name}` changes nothing ({step})");
            let effect = Effect::exact("largest relative change", *change, CHANGE);
            return Outcome { effect: Some(effect), ..Outcome::new(Verdict::Fail, message) }.into();
        }
        for v in variations {
            let (message, found, tolerance) = match &v.limit {
                Some(Limit::Narrow { median, roughness }) => (
                    narrowed(&v.parameter, &v.to, median.0, evidence.description.kind),
                    median.0,
                    NARROW * roughness.max(FLOOR),
                ),
                Some(Limit::Transparent { reflected }) => (
                    format!("`{}` = {}: {:.2e} of the light is reflected", v.parameter, v.to, reflected.0),
                    reflected.0,
                    TRANSPARENT,
                ),
                None => continue,
            };
            if !(found <= tolerance) {
                let effect = Effect::exact("at the limit", found, tolerance);
                return Outcome { effect: Some(effect), ..Outcome::new(Verdict::Fail, message) }.into();
            }
        }
        let limits = variations.iter().filter(|v| v.limit.is_some()).count();
        let mut message =
            format!("{} parameters change something, {limits} limits are reached", largest.len());
        if evidence.two_sided.is_some() {
            message.push_str(", front and back agree");
        }
        Outcome::new(Verdict::Pass, message).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_do_not_come_have_no_angle() {
        let told = |median| narrowed("alpha", "0.001", median, SubjectKind::Bsdf);
        assert_eq!(told(f64::INFINITY), "`alpha` = 0.001: no sample came, so that none is near the mirror");
        assert_eq!(told(0.1), "`alpha` = 0.001: the median sample is 5.730° off the mirror");
    }
}
