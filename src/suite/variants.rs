//! The same model with a parameter changed, for the `sensitivity` check.

use crate::evidence::Variant;
use crate::registry::{Kind, Model, Parameter, Parameters, Registry, Role, Value};
use std::sync::Arc;

/// For each parameter that applies: other values, and its limit if it has one.
pub(crate) fn variants(registry: &Registry, model: &Model, parameters: &Parameters) -> Vec<Variant<'static>> {
    let mut all = Vec::new();
    let matters = |p: &&Parameter| p.applies(parameters) && !p.idle;
    for parameter in model.parameters().iter().filter(matters) {
        for value in other_values(parameter, parameters) {
            let mut changed = parameters.clone();
            changed.0.insert(parameter.name.clone(), value);
            all.push(variant(registry, model, parameters, parameter, changed, None));
        }
    }
    all.extend(limits(registry, model, parameters));
    all
}

fn variant(
    registry: &Registry,
    model: &Model,
    parameters: &Parameters,
    parameter: &Parameter,
    changed: Parameters,
    limit: Option<Role>,
) -> Variant<'static> {
    let text = |p: &Parameters| p.0.get(&parameter.name).map(Value::to_string).unwrap_or_default();
    let (from, to) = (text(parameters), text(&changed));
    let (model, registry) = (model.clone(), registry.clone());
    let build = Arc::new(move || model.build(&changed, &registry).ok());
    Variant { parameter: parameter.name.clone(), from, to, limit, build }
}

/// Two numbers away from the nearer end of the range, lest one of them means
/// the same by coincidence (a second roughness equal to the first); every
/// other option of a choice.
fn other_values(parameter: &Parameter, parameters: &Parameters) -> Vec<Value> {
    match (&parameter.kind, parameters.0.get(&parameter.name)) {
        (Kind::Number { min, max, .. }, Some(Value::Number(now))) if max > min => {
            let end = if *now < 0.5 * (min + max) { max } else { min };
            [0.5, 0.37].map(|step| Value::Number(now + step * (end - now))).into()
        }
        (Kind::Choice { options, .. }, Some(Value::Text(now))) => {
            options.iter().filter(|o| *o != now).map(|o| Value::Text(o.clone())).collect()
        }
        _ => Vec::new(),
    }
}

/// Where α → 0, all roughnesses go to their minimum together: one alone leaves
/// the lobe wide. Where η can be 1, it goes there.
fn limits(registry: &Registry, model: &Model, parameters: &Parameters) -> Vec<Variant<'static>> {
    // Where samples gather is a question to what has samples.
    if !model.kind().has_directions() {
        return Vec::new();
    }
    let with_role =
        |role| move |p: &&Parameter| p.role == Some(role) && p.applies(parameters) && min(p).is_some();
    let mut all = Vec::new();
    let rough: Vec<_> = model.parameters().iter().filter(with_role(Role::Roughness)).collect();
    if let Some(first) = rough.first() {
        let mut changed = parameters.clone();
        for p in &rough {
            changed.0.extend(min(p).map(|min| (p.name.clone(), Value::Number(min))));
        }
        all.push(variant(registry, model, parameters, first, changed, Some(Role::Roughness)));
    }
    for p in model.parameters().iter().filter(with_role(Role::Eta)).filter(|p| min(p) == Some(1.0)) {
        let mut changed = parameters.clone();
        changed.0.insert(p.name.clone(), Value::Number(1.0));
        all.push(variant(registry, model, parameters, p, changed, Some(Role::Eta)));
    }
    all
}

fn min(parameter: &Parameter) -> Option<f64> {
    match parameter.kind {
        Kind::Number { min, .. } => Some(min),
        _ => None,
    }
}
