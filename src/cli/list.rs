//! `gonio list`.

use super::error::CliError;
use super::exit::Exit;
use super::output::emit;
use crate::cause::Cause;
use crate::mutants::{self, Mutant};
use crate::registry::{Kind, Model, Parameter, Registry};

/// Arguments of `gonio list`.
#[derive(Debug, clap::Args)]
pub struct ListArgs {
    /// Show the parameters of this subject.
    pub name: Option<String>,
    /// Show the hidden models that gonio is tested on: correct ones with one bug
    /// each, and negative controls, which look wrong and are right.
    #[arg(long, conflicts_with = "name")]
    pub mutants: bool,
}

/// Shows the subjects, or the parameters of one.
pub fn list(args: &ListArgs, registry: &Registry) -> Result<Exit, CliError> {
    let text = match &args.name {
        None if args.mutants => mutants(),
        None => subjects(registry),
        Some(name) => match registry.models_of_plugin(name) {
            Some(models) => {
                let rows = models.into_iter().map(|(name, doc)| vec![name, doc]);
                table(&["name", "what it is"], rows.collect())
            }
            None => parameters(registry.model(name)?.as_ref()),
        },
    };
    emit(&text)?;
    Ok(Exit::Passed)
}

fn subjects(registry: &Registry) -> String {
    let rows = registry
        .models()
        .map(|m| vec![m.name().to_string(), m.kind().word().to_string(), m.doc().to_string()]);
    table(&["name", "kind", "what it is"], rows.collect())
}

fn mutants() -> String {
    let row = |m: Mutant| vec![m.model_name(), m.cause.map_or("none", Cause::slug).into(), m.what.into()];
    let rows = mutants::all().into_iter().chain(mutants::controls()).map(row);
    table(&["name", "cause", "what is wrong, or only looks wrong"], rows.collect())
}

fn parameters(model: &Model) -> String {
    let head = format!("{}: {}\n", model.name(), model.doc());
    if model.parameters().is_empty() {
        return head + "It has no parameters.\n";
    }
    let rows = model.parameters().iter().map(|p| {
        let (kind, range) = kind(p);
        let default = p.default().map_or_else(|| "none".into(), |v| v.to_string());
        vec![p.name.clone(), kind.into(), default, range, format!("{}{}", p.doc, when(p))]
    });
    format!("{head}\n{}", table(&["parameter", "type", "default", "values", "what it is"], rows.collect()))
}

fn kind(parameter: &Parameter) -> (&'static str, String) {
    match &parameter.kind {
        Kind::Number { min, max, .. } => ("number", format!("{min} to {max}")),
        Kind::Choice { options, .. } => ("choice", options.join(", ")),
        Kind::Subject { .. } => ("subject", "NAME or (NAME:KEY=VALUE,…)".into()),
        Kind::File => ("file", "a path".into()),
    }
}

fn when(parameter: &Parameter) -> String {
    let chosen = parameter.only_when.iter().map(|(name, values)| format!("{name} = {}", values.join(" or ")));
    let held = parameter.only_if.iter().map(|condition| condition.words.to_string());
    let all: Vec<_> = chosen.chain(held).collect();
    if all.is_empty() { String::new() } else { format!(" (when {})", all.join(" and ")) }
}

/// Columns as wide as their widest cell; the last one is not padded.
pub(super) fn table(head: &[&str], rows: Vec<Vec<String>>) -> String {
    let mut all = vec![head.iter().map(ToString::to_string).collect::<Vec<_>>()];
    all.extend(rows);
    let width = |k: usize| all.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len() - 1).map(width).collect();
    let mut text = String::new();
    for row in &all {
        for (cell, width) in row.iter().zip(&widths) {
            text.push_str(&format!("{cell:width$}  "));
        }
        text.push_str(&row[head.len() - 1]);
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_show_what_may_be_typed() {
        let model = Model::new("m", "a model", |_| Err::<crate::models::Lambert, _>("never built".into()))
            .choice("f", &["none", "schlick"], "Fresnel")
            .number("f0", 0.04, 0.0..=1.0, "reflectance")
            .only_when("f", &["schlick"])
            .number("tint", 0.0, 0.0..=1.0, "colour")
            .only_if("f0 > 0", |p| p.number("f0") > 0.0);
        let text = parameters(&model);
        let expected = "m: a model\n\n\
            parameter  type    default  values         what it is\n\
            f          choice  none     none, schlick  Fresnel\n\
            f0         number  0.04     0 to 1         reflectance (when f = schlick)\n\
            tint       number  0        0 to 1         colour (when f0 > 0)\n";
        assert_eq!(text, expected);
        assert!(subjects(&Registry::empty().register(model)).ends_with("m     BSDF  a model\n"));
    }
}
