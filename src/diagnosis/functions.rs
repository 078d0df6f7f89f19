//! Fresnel functions and distributions of normals as subjects of their own.

use super::counts::Counts;
use super::explanation::Claim;
use super::pdf::counts;
use super::view::View;
use crate::bsdf::{Direction, FresnelFunction, NormalDistribution, SubjectKind};
use crate::cause::Cause;
use crate::models::fresnel;
use crate::models::microfacet::{Distribution, MaskedDistribution, Roughness};
use crate::registry::{Registry, Value};

/// Checks of such subjects.
const FRESNEL: &[&str] = &["fresnel", "energy", "white-furnace", "reciprocity", "sensitivity", "reference"];
const NORMALS: &[&str] = &[
    "distribution",
    "goodness-of-fit",
    "normalization",
    "albedo",
    "white-furnace",
    "jacobian",
    "support",
    "energy",
    "mis",
    "sensitivity",
    "weight",
];

/// Claims about parts of models.
pub fn claims(view: &View, _: Option<&super::Textbook>) -> Vec<Claim> {
    match view.description.kind {
        SubjectKind::Fresnel => {
            let found = view.subject().fresnel().map(|f| of_fresnel(view, f));
            found.unwrap_or_default().into_iter().map(|c| c.covers(FRESNEL)).collect()
        }
        SubjectKind::Distribution => {
            let found = view.subject().distribution().map(|d| of_normals(view, d));
            found.unwrap_or_default().into_iter().map(|c| c.covers(NORMALS)).collect()
        }
        _ => Vec::new(),
    }
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (a.abs() + b.abs()) + 1e-12
}

/// Whether two functions of a cosine agree, and are not the right one.
fn is(
    found: impl Fn(f64) -> f64,
    law: impl Fn(f64) -> f64,
    right: impl Fn(f64) -> f64,
    inside: bool,
) -> bool {
    let cosines = (1..40).map(|k| f64::from(k) / 40.0);
    let cosines: Vec<f64> = cosines.flat_map(|c| if inside { vec![c, -c] } else { vec![c] }).collect();
    let same = cosines.iter().all(|c| close(found(*c), law(*c)));
    same && cosines.iter().any(|c| !close(law(*c), right(*c)))
}

fn of_fresnel(view: &View, f: &dyn FresnelFunction) -> Vec<Claim> {
    let found = |cos: f64| f.reflectance(cos)[0];
    let mut claims = Vec::new();
    let mut add = |cause, statement: String, repair: &str| claims.push(Claim::new(cause, statement, repair));
    let eta = view.description.claims.eta;
    if let Some(eta) = eta {
        let side = |cos: f64| if cos < 0.0 { 1.0 / eta } else { eta };
        let right = |cos: f64| fresnel::dielectric(cos.abs(), side(cos));
        let polarised = |cos: f64, k: usize| fresnel::dielectric_polarised(cos.abs(), side(cos))[k];
        if is(found, |c| polarised(c, 0), right, true) {
            add(
                Cause::FresnelArgument,
                "R is Rs: Rp is a copy of it".into(),
                "unpolarised light reflects (Rs + Rp)/2",
            );
        }
        if is(found, |c| polarised(c, 1), right, true) {
            add(
                Cause::FresnelArgument,
                "R is Rp: Rs is a copy of it".into(),
                "unpolarised light reflects (Rs + Rp)/2",
            );
        }
        if is(found, |c| right(c * c.abs()), right, true) {
            add(Cause::FresnelArgument, "the equations are given cos² θ for cos θ".into(), "give them cos θ");
        }
        if is(found, |c| fresnel::dielectric(c.abs(), eta), right, true) {
            add(
                Cause::EtaSide,
                "light from inside is reflected by η and not by 1/η".into(),
                "invert η where the cosine is negative",
            );
        }
        if is(found, |c| fresnel::dielectric(c.abs(), 1.0 / side(c)), right, true) {
            add(
                Cause::EtaSide,
                "η and 1/η are exchanged on both sides".into(),
                "η is the index of the far over the near side",
            );
        }
        let exchanged = |cos: f64| {
            let told = f.polarised(cos)?;
            Some(close(told[0][0], polarised(cos, 1)) && close(told[1][0], polarised(cos, 0)))
        };
        if [0.2, 0.5, 0.7].iter().all(|c| exchanged(*c) == Some(true)) {
            add(
                Cause::FresnelArgument,
                "Rs and Rp are exchanged".into(),
                "s is perpendicular to the plane of incidence, and never reflects less than p",
            );
        }
        // The function of another index.
        let at = |eta: f64, cos: f64| fresnel::dielectric(cos.abs(), if cos < 0.0 { 1.0 / eta } else { eta });
        let normal = found(1.0).sqrt();
        let other = (1.0 + normal) / (1.0 - normal);
        for other in [other, 1.0 / other] {
            if is(found, |c| at(other, c), right, true) {
                add(
                    Cause::Parameter,
                    format!("the index is {other:.6}, where {eta} is declared"),
                    "follow eta from where it is read to where it is used",
                );
            }
        }
    }
    if let Some(f0) = view.number("f0").filter(|_| eta.is_none()) {
        let right = |cos: f64| fresnel::schlick(cos.abs(), f0);
        if is(found, |c| f0 + (1.0 - f0) * (1.0 + c.abs()).powi(5), right, false)
            || is(found, |c| fresnel::schlick(-c.abs(), f0), right, false)
        {
            add(
                Cause::FresnelArgument,
                "Schlick's formula is given −cos θ".into(),
                "give it the positive cosine of the angle to the normal",
            );
        }
        for n in [1, 2, 3, 4, 6] {
            if is(found, |c| f0 + (1.0 - f0) * (1.0 - c.abs()).powi(n), right, false) {
                add(
                    Cause::FresnelArgument,
                    format!("Schlick's formula has the power {n} in place of 5"),
                    "F = F0 + (1 − F0) (1 − cos θ)⁵",
                );
            }
        }
        if is(found, |c| right(c * c.abs()), right, false) {
            add(Cause::FresnelArgument, "Schlick's formula is given cos² θ".into(), "give it cos θ");
        }
    }
    claims
}

fn of_normals(view: &View, d: &dyn NormalDistribution) -> Vec<Claim> {
    let registry = Registry::builtin();
    let Ok(model) = registry.model("normals") else { return Vec::new() };
    let given: Vec<(String, Value)> = view
        .parameters
        .0
        .iter()
        .filter(|(name, value)| model.parameter(name).is_ok_and(|p| p.check(value).is_ok()))
        .map(|(n, v)| (n.clone(), v.clone()))
        .collect();
    let Some(right) = model.complete(&given).ok().and_then(|p| MaskedDistribution::declared(&p).ok()) else {
        return Vec::new();
    };
    let normals: Vec<Direction> = (1..30)
        .flat_map(|k| {
            (0..3).map(move |j| Direction::from_angles(f64::from(k) * 0.05, f64::from(j) * 2.1 + 0.4))
        })
        .collect();
    let mut claims = Vec::new();
    let every = |law: &dyn Fn(Direction) -> f64| normals.iter().all(|m| close(d.density(*m), law(*m)));
    let mut add = |cause, statement: &str, repair: &str| claims.push(Claim::new(cause, statement, repair));
    if !every(&|m| right.density(m)) {
        if every(&|m| right.density(m) * m.z) {
            add(
                Cause::NdfMeasure,
                "D is D cos θm: the density of drawn normals is returned in place of D",
                "leave out the cosine",
            );
        }
        if every(&|m| right.density(m) / m.z) {
            add(Cause::NdfMeasure, "D is D/cos θm", "multiply by cos θm");
        }
        let off: Vec<&Direction> =
            normals.iter().filter(|m| !close(d.density(**m), right.density(**m))).collect();
        if !off.is_empty() && off.iter().all(|m| m.z > 0.99) && off.len() < normals.len() / 4 {
            add(
                Cause::Numerics,
                "D is wrong near the pole and right elsewhere",
                "look at the limit θm → 0, and at what is tested against a small number",
            );
        }
        let ratios: Vec<f64> =
            normals.iter().map(|m| d.density(*m) / right.density(*m)).filter(|r| r.is_finite()).collect();
        if ratios.len() > 20 && ratios.iter().all(|r| close(*r, ratios[0])) {
            add(Cause::ConstantFactor, "D is off by a constant factor", "∫D cos θm dm must be 1");
        }
    } else {
        // Near the pole the grid above is coarse.
        let near = (1..20).map(|k| Direction::from_angles(f64::from(k) * 5e-4, 0.3));
        if near.into_iter().any(|m| !close(d.density(m), right.density(m))) {
            add(
                Cause::Numerics,
                "D is wrong near the pole and right elsewhere",
                "look at the limit θm → 0, and at what is tested against a small number",
            );
        }
    }
    let masking = |law: &dyn Fn(Direction, Direction) -> f64| {
        let mut pairs = 0;
        for w in normals.iter().filter(|w| w.z > 0.05).step_by(4) {
            for m in normals.iter().filter(|m| w.dot(**m) > 0.1 && m.z > 0.05).step_by(5) {
                pairs += 1;
                if !close(d.g1(*w, *m), law(*w, *m)) {
                    return false;
                }
            }
        }
        pairs > 10
    };
    if !masking(&|w, m| right.g1(w, m)) {
        if masking(&|_, m| right.distribution.g1(m)) {
            add(
                Cause::Masking,
                "G1 has tan θm where tan θ must be: it is that of the facet's normal",
                "G1 depends on the angle of the direction that is masked",
            );
        }
        let sine = |w: Direction| {
            let w = Direction::new(w.x, w.y, 1.0).normalized();
            1.0 / (1.0 + right.distribution.lambda(w))
        };
        if masking(&|w, _| sine(w)) {
            add(Cause::Masking, "Λ has sin θ where tan θ must be", "give Λ the tangent of the angle");
        }
        if masking(&|w, m| right.g1(w, m).powi(2)) {
            add(Cause::Masking, "G1 is squared", "use it once");
        }
        if masking(&|_, _| 1.0) {
            add(Cause::Masking, "G1 is 1: nothing is masked", "use the masking of the distribution");
        }
    }
    if claims.is_empty() {
        claims.extend(drawn(view, &right));
    }
    claims
}

/// The draws of all normals, by their counts.
fn drawn(view: &View, right: &MaskedDistribution) -> Vec<Claim> {
    let counts = counts(view);
    let Roughness { x, y } = right.distribution.alpha();
    let of = |alpha: Roughness| match right.distribution {
        Distribution::Ggx(_) => Distribution::ggx(alpha),
        Distribution::Beckmann(_) => Distribution::beckmann(alpha),
        Distribution::Gaussian(_) => Distribution::gaussian(alpha),
    };
    let visible = matches!(view.parameters.0.get("sampling"), Some(Value::Text(t)) if t == "visible-normals");
    let test = |d: &Distribution| {
        let one = |(k, c): &(usize, Counts)| {
            let wo = view.cases[*k].wo;
            c.test(
                &c.masses(|m| {
                    if m.z <= 0.0 {
                        0.0
                    } else if visible {
                        d.visible_density(wo, m)
                    } else {
                        d.density(m) * m.z
                    }
                }),
                0,
            )
        };
        counts.iter().map(one).fold(super::CountTest::default(), super::CountTest::and)
    };
    let mut claims = Vec::new();
    if counts.is_empty() || x == y || test(&right.distribution).fits() {
        return claims;
    }
    for (alpha, what) in [
        (Roughness { x: y, y: x }, "αx and αy exchanged"),
        (Roughness { x, y: x }, "αx along both tangents"),
        (Roughness { x: y, y }, "αy along both tangents"),
    ] {
        let found = test(&of(alpha));
        if found.fits() {
            claims.push(
                Claim::new(
                    Cause::WrongDensity,
                    format!("normals are drawn with {what}"),
                    "scale the slopes along x by αx and along y by αy",
                )
                .likelihood(found.ln_likelihood())
                .p(found.ln_p()),
            );
        }
    }
    claims
}
