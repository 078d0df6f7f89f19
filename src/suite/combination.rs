//! The models of an entry with each combination of its parameters.

use super::file::{Entry, SUBJECT_KEYS};
use super::mistake::Mistake;
use super::pairs::product;
use super::variants::variants;
use crate::bsdf::{Claims, Subject, SubjectKind};
use crate::evidence::{Company, Meter};
use crate::registry::{Kind, Model, Parameters, Registry, Resolved, Spelling, Value, nearest};
use rayon::prelude::*;
use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;

/// More combinations of parameters than this are a slip.
const MOST_COMBINATIONS: usize = 100_000;

/// A model with all its parameters.
#[derive(Clone)]
pub(super) struct Combination {
    pub spelling: String,
    pub parameters: Parameters,
    pub subject: Arc<dyn Subject>,
    pub kind: SubjectKind,
    pub claims: Claims,
    pub company: Company<'static>,
}

/// The combinations of an entry's parameters.
pub(super) struct Combinations {
    /// How many values each listed parameter has.
    pub levels: Vec<usize>,
    /// In the order of [`product`]: `None` where the model refuses, or where the
    /// subject is the same as an earlier one because a parameter does not apply.
    pub all: Vec<Option<Combination>>,
    /// How many the model refused.
    pub refused: usize,
    spellings: HashSet<String>,
}

impl Combinations {
    /// Builds them; what is wrong is noted.
    pub fn of(registry: &Registry, entry: &Entry, mistakes: &mut Vec<Mistake>) -> Option<Self> {
        let before = mistakes.len();
        let reference = reference(registry, entry, mistakes);
        let model = match registry.model(entry.model.get_ref()) {
            Ok(model) => model,
            Err(e) => {
                mistakes.push(Mistake::of_registry(entry.model.span(), &e));
                return None;
            }
        };
        let values = values(&model, entry, mistakes);
        if mistakes.len() > before {
            return None;
        }
        let levels: Vec<usize> = values.iter().map(Vec::len).collect();
        let number = levels.iter().try_fold(1usize, |n, l| n.checked_mul(*l));
        if number.is_none_or(|n| n > MOST_COMBINATIONS) {
            let message = format!("the parameters of `{}` make too many combinations", model.name());
            let help = format!("at most {MOST_COMBINATIONS}: list fewer values");
            mistakes.push(Mistake::new(entry.model.span(), message, "too many").help(help));
            return None;
        }
        let mut found = Self { levels, all: Vec::new(), refused: 0, spellings: HashSet::new() };
        let mut first_error = None;
        let spelled = |row: Vec<usize>| {
            let given = values.iter().zip(&row).map(|(list, k)| list[*k].clone()).collect();
            Spelling { name: model.name().into(), parameters: given }
        };
        let spellings: Vec<Spelling> = product(&found.levels).map(spelled).collect();
        // Some models make tables.
        let all: Vec<_> = spellings.par_iter().map(|spelling| registry.resolve(spelling)).collect();
        for (spelling, resolved) in spellings.iter().zip(all) {
            match resolved {
                Ok(resolved) => found.add(registry, &model, entry, &reference, resolved),
                Err(e) => {
                    found.refused += 1;
                    found.all.push(None);
                    // A file that cannot be read is no combination to leave out.
                    if model.parameters().iter().any(|p| p.kind == Kind::File) {
                        mistakes.push(Mistake::of_registry(place_of(entry, spelling), &e));
                    } else {
                        first_error.get_or_insert(e);
                    }
                }
            }
        }
        if mistakes.len() > before {
            return None;
        }
        if let Some(e) = first_error.filter(|_| found.all.iter().all(Option::is_none)) {
            mistakes.push(Mistake::of_registry(entry.model.span(), &e));
            return None;
        }
        Some(found)
    }

    fn add(
        &mut self,
        registry: &Registry,
        model: &Model,
        entry: &Entry,
        reference: &Option<(String, Arc<dyn Subject>)>,
        Resolved { spelling, parameters, subject }: Resolved,
    ) {
        if !self.spellings.insert(spelling.clone()) {
            self.all.push(None);
            return;
        }
        // A subject that cannot even describe itself is told so when it is run.
        let own = Meter::describe(&*subject).map(|d| d.claims).unwrap_or_default();
        self.all.push(Some(Combination {
            spelling,
            kind: model.kind(),
            claims: entry.claims.over(own),
            company: Company {
                variants: variants(registry, model, &parameters),
                reference: reference.clone(),
                within: None,
            },
            parameters,
            subject,
        }));
    }
}

/// Where the file of a combination is written.
fn place_of(entry: &Entry, spelling: &Spelling) -> Range<usize> {
    let holds = |(name, values): &(Spanned<String>, Vec<Spanned<Value>>)| {
        let given =
            spelling.parameters.iter().find(|(n, v)| n == name.get_ref() && matches!(v, Value::Text(_)))?;
        values.iter().find(|v| name.get_ref() == "file" && v.get_ref() == &given.1).map(Spanned::span)
    };
    entry.parameters.iter().find_map(holds).unwrap_or(entry.model.span())
}

fn values(model: &Model, entry: &Entry, mistakes: &mut Vec<Mistake>) -> Vec<Vec<(String, Value)>> {
    let mut all = Vec::new();
    for (name, values) in &entry.parameters {
        if model.takes_any() {
            all.push(values.iter().map(|v| (name.get_ref().clone(), v.get_ref().clone())).collect());
            continue;
        }
        let Ok(parameter) = model.parameter(name.get_ref()) else {
            mistakes.push(unknown_parameter(model, name));
            continue;
        };
        let mut list = Vec::new();
        for value in values {
            match parameter.check(value.get_ref()) {
                Ok(()) => list.push((name.get_ref().clone(), value.get_ref().clone())),
                Err(e) => mistakes.push(Mistake::of_registry(value.span(), &e)),
            }
        }
        all.push(list);
    }
    all
}

fn unknown_parameter(model: &Model, name: &Spanned<String>) -> Mistake {
    let parameters = model.parameters().iter().map(|p| p.name.as_str());
    let message = format!("`{}` has no parameter `{name}`", model.name());
    let help = match nearest(name.get_ref(), parameters.clone().chain(SUBJECT_KEYS)) {
        Some(n) => format!("did you mean `{n}`?"),
        None if model.parameters().is_empty() => "it has none".into(),
        None => format!("there are {}", parameters.collect::<Vec<_>>().join(", ")),
    };
    Mistake::new(name.span(), message, "no such parameter").help(help)
}

fn reference(
    registry: &Registry,
    entry: &Entry,
    mistakes: &mut Vec<Mistake>,
) -> Option<(String, Arc<dyn Subject>)> {
    let text = entry.reference.as_ref()?;
    let spelled = registry.spelling_of_file(text.get_ref()).unwrap_or_else(|| text.get_ref().clone());
    let found = spelled.parse::<Spelling>().and_then(|spelling| registry.resolve(&spelling));
    let found = found.map(|r| (r.spelling, r.subject));
    found.map_err(|e| mistakes.push(Mistake::of_registry(text.span(), &e))).ok()
}
