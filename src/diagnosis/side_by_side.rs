//! Textbooks of a diffuse base and facets side by side: what courses call a microfacet
//! model, f = (1 − ks) ρ/π + ks F D G/(4 cos θo cos θi), drawn from with probability ks.

use super::parts::Parts;
use super::textbook::{Lobe, Values, combinations};
use crate::bsdf::{self, Bsdf, Direction, Transport};
use crate::models::Lambert;
use crate::models::microfacet::{Fresnel, TorranceSparrow};
use crate::registry::{Model, Parameters, Registry, Value};

/// The registered model of two subjects.
pub const NAME: &str = "blend";

/// What subjects call the share of their facets.
const SHARES: [&str; 3] = ["ks", "weight", "specular"];

/// Parameters of the blends that a subject may be which declares `given`: none where there
/// is no share among them, or no roughness.
pub fn candidates(registry: &Registry, given: &Parameters) -> Vec<Parameters> {
    let share = SHARES.iter().find_map(|name| match given.0.get(*name) {
        Some(Value::Number(share)) if (0.0..=1.0).contains(share) => Some(*share),
        _ => None,
    });
    let (Some(share), true) = (share, given.0.contains_key("alpha")) else { return Vec::new() };
    let (Ok(base), Ok(facets)) = (registry.model("lambert"), registry.model("torrance-sparrow")) else {
        return Vec::new();
    };
    let Some(base) = combinations(&base, given).into_iter().next().map(|p| base.spell(&p)) else {
        return Vec::new();
    };
    let coats = combinations(&facets, given);
    // A number that is declared is used: `eta` speaks of a dielectric, `f0` of Schlick.
    let most = coats.iter().map(|p| used(&facets, p, given)).max();
    let coats = coats.into_iter().filter(|p| Some(used(&facets, p, given)) == most);
    // Normals of a Gaussian are tabulated.
    coats
        .filter(|p| p.text("distribution") != "gaussian")
        .map(|p| {
            let text = |text: String| Value::Text(text);
            Parameters(
                [
                    ("first".into(), text(base.clone())),
                    ("second".into(), text(facets.spell(&p))),
                    ("weight".into(), Value::Number(share)),
                ]
                .into(),
            )
        })
        .collect()
}

/// How many of the numbers and choices that are given matter for these parameters of a model.
pub fn used(model: &Model, parameters: &Parameters, given: &Parameters) -> usize {
    let matters = |name: &&String| {
        given.0.contains_key(*name) && model.parameter(name).is_ok_and(|p| p.applies(parameters))
    };
    parameters.0.keys().filter(matters).count()
}

/// Parts and lobes of a blend of Lambert's reflector and facets; `None` of another one.
pub fn lobes(registry: &Registry, p: &Parameters) -> Option<(Parts, Vec<Lobe>)> {
    let part = |name: &str, is: &str| {
        let spelling: crate::registry::Spelling = p.text(name).parse().ok()?;
        (spelling.name == is).then(|| registry.resolve(&spelling).ok())?
    };
    let base = Lambert::declared(&part("first", "lambert")?.parameters).ok()?;
    let facets = TorranceSparrow::declared(&part("second", "torrance-sparrow")?.parameters).ok()?;
    let parts = Parts {
        distribution: Some(facets.distribution.clone()),
        masking: Some(facets.masking),
        fresnel: Some(facets.fresnel),
        eta: match facets.fresnel {
            Fresnel::Dielectric(eta) => Some(eta),
            _ => None,
        },
    };
    let share = p.number("weight");
    let lobes = vec![
        lobe("the diffuse lobe", base, 1.0 - share, bsdf::Lobe::DIFFUSE),
        lobe("the lobe of the facets", facets, share, bsdf::Lobe::GLOSSY),
    ];
    Some((parts, lobes))
}

fn lobe(name: &'static str, model: impl Bsdf + Clone + 'static, share: f64, flags: bsdf::Lobe) -> Lobe {
    let drawn = model.clone();
    let value: Values = Box::new(move |wo, wi, transport| model.eval(wo, wi, transport).map(|f| share * f));
    Lobe {
        name,
        share: Box::new(move |_| share),
        density: Box::new(move |wo: Direction, wi: Direction| drawn.pdf(wo, wi, Transport::Radiance)),
        value,
        flags: Some(flags),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::textbook::Textbook;

    fn given(numbers: &[(&str, f64)]) -> Parameters {
        Parameters(numbers.iter().map(|(name, v)| (name.to_string(), Value::Number(*v))).collect())
    }

    #[test]
    fn lobes_add_up_to_the_whole() {
        let registry = Registry::builtin();
        let declared = given(&[("alpha", 0.3), ("eta", 1.7), ("ks", 0.4), ("reflectance", 0.8)]);
        let books = candidates(&registry, &declared);
        // Two distributions, two maskings, two ways to draw; a dielectric, as η is declared.
        assert_eq!(books.len(), 8);
        for p in books {
            assert!(p.text("second").contains("fresnel=dielectric") && p.text("second").contains("eta=1.7"));
            let book = Textbook::new(NAME, &p).unwrap();
            assert_eq!(book.lobes.len(), 2);
            for (to, ti) in [(0.3, 0.5), (1.2, 0.9)] {
                let (wo, wi) = (Direction::from_angles(to, 0.2), Direction::from_angles(ti, 2.9));
                let pdf: f64 = book.lobes.iter().map(|l| (l.share)(wo) * (l.density)(wo, wi)).sum();
                let light = Transport::Radiance;
                let value: f64 = book.lobes.iter().map(|l| (l.value)(wo, wi, light)[0]).sum();
                assert!((pdf / book.pdf(wo, wi) - 1.0).abs() < 1e-12, "{p:?}: {pdf}");
                assert!((value / book.eval(wo, wi, light)[0] - 1.0).abs() < 1e-12, "{p:?}: {value}");
            }
        }
    }

    #[test]
    fn a_share_and_a_roughness_are_needed() {
        let registry = Registry::builtin();
        assert!(candidates(&registry, &given(&[("alpha", 0.3), ("eta", 1.5)])).is_empty());
        assert!(candidates(&registry, &given(&[("ks", 0.3), ("eta", 1.5)])).is_empty());
        assert!(candidates(&registry, &given(&[("ks", 1.5), ("alpha", 0.3)])).is_empty());
        let schlick = candidates(&registry, &given(&[("weight", 0.3), ("alpha", 0.3), ("f0", 0.1)]));
        assert!(schlick.iter().all(|p| p.text("second").contains("fresnel=schlick,f0=0.1")));
        assert_eq!(schlick.len(), 8);
    }
}
