//! The published model that a subject is meant to be.

use super::lobes::{known, share_of_one};
use super::parts::Parts;
use super::side_by_side::{self, used};
use super::view::View;
use crate::bsdf::{self, Direction, Spectrum, Subject, SubjectKind, Transport};
use crate::models::microfacet::NormalSampling;
use crate::registry::{Kind, Model, Parameters, Registry, Value};
use std::sync::{Arc, OnceLock};

/// Of wo.
pub type Share = Box<dyn Fn(Direction) -> f64 + Send + Sync>;
/// Of wo and wi.
pub type Density = Box<dyn Fn(Direction, Direction) -> f64 + Send + Sync>;
/// Of wo, wi and the mode.
pub type Values = Box<dyn Fn(Direction, Direction, Transport) -> Spectrum + Send + Sync>;

/// A lobe of a model.
pub struct Lobe {
    /// As statements call it.
    pub name: &'static str,
    /// With which probability it is drawn from, given wo; 1 where lobes are not
    /// chosen before a facet is.
    pub share: Share,
    /// Its density by itself.
    pub density: Density,
    /// Its part of f.
    pub value: Values,
    /// Its flags, where they tell it from the others.
    pub flags: Option<bsdf::Lobe>,
}

/// A published model with numbers of its own.
pub struct Textbook {
    /// Its name in the registry.
    pub name: String,
    /// Its parameters.
    pub parameters: Parameters,
    /// What it is made of.
    pub parts: Parts,
    /// Its continuous lobes; one, called "", where it is not known to have several.
    pub lobes: Vec<Lobe>,
    subject: Arc<dyn Subject>,
    channels: usize,
    dimensions: usize,
    /// Whether pdf() and eval() of the subject agree with it at every point.
    pub agrees: Agreement,
}

/// Where functions agree.
#[derive(Clone, Copy, Debug, Default)]
pub struct Agreement {
    /// The share of cases in which pdf() does.
    pub pdf: f64,
    /// The share of cases in which eval() does.
    pub value: f64,
}

/// Values this close are equal: rounding, magnified by narrow lobes.
pub const EQUAL: f64 = 1e-6;

/// Where this share of a case's points agrees, the function does: at some points a
/// value may be lost to cancellation.
const AGREES: f64 = 0.95;

impl Agreement {
    /// Whether pdf() agrees everywhere.
    pub fn by_pdf(&self) -> bool {
        self.pdf == 1.0
    }

    /// Whether eval() agrees everywhere.
    pub fn by_value(&self) -> bool {
        self.value == 1.0
    }
}

impl Textbook {
    /// The models that the functions of a subject agree with best, with the parameters
    /// that both declare: none where none agrees with any function, and two where one
    /// has the subject's pdf() and its sibling the density of the draws.
    pub fn of(view: &View) -> Vec<Self> {
        let mut all: Vec<(f64, Self)> = Vec::new();
        let mut consider = |mut book: Self| {
            book.agrees = book.agreement(view);
            // A name that stands for nothing in a model does not speak for it.
            let known =
                registry().model(&book.name).map_or(0, |m| used(&m, &book.parameters, &view.parameters));
            let known = known as f64 / view.parameters.0.len().max(1) as f64;
            // Which function agrees says more than names do; names decide among
            // models that agree alike.
            let agrees = book.agrees;
            let whole = f64::from(u8::from(agrees.by_pdf())) + f64::from(u8::from(agrees.by_value()));
            let score = 4.0 * whole + 2.0 * known + agrees.pdf + agrees.value;
            // One side or one mode may be what is wrong.
            if agrees.pdf.max(agrees.value) > 0.24 {
                all.push((score, book));
            }
        };
        for model in registry().models().filter(|m| m.kind() == view.description.kind) {
            if model.kind() != SubjectKind::Fresnel {
                let books = combinations(model, &view.parameters);
                books.iter().filter_map(|p| Self::new(model.name(), p)).for_each(&mut consider);
            }
        }
        if view.description.kind == SubjectKind::Bsdf {
            let blends = side_by_side::candidates(registry(), &view.parameters);
            blends.iter().filter_map(|p| Self::new(side_by_side::NAME, p)).for_each(&mut consider);
        }
        // Where nothing is declared, numbers are those that fit.
        if !view.declares_numbers {
            super::fitting::fitted(view).into_iter().for_each(&mut consider);
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut all = all.into_iter().map(|(_, book)| book);
        let Some(best) = all.next() else { return Vec::new() };
        let sibling = best.sibling_of_the_draws(view, all);
        std::iter::once(best).chain(sibling).collect()
    }

    /// Of the models that differ in nothing but their sampler, the one that draws as
    /// the subject does, where this one does not.
    fn sibling_of_the_draws(&self, view: &View, others: impl Iterator<Item = Self>) -> Option<Self> {
        let drawn = ["goodness-of-fit", "normalization", "jacobian"];
        if !view.fails_any(&drawn) || view.parameters.0.contains_key("sampling") {
            return None;
        }
        let mut siblings = others.filter(|b| b.name == self.name && b.agrees.by_value()).peekable();
        siblings.peek()?;
        let counts = super::pdf::counts(view);
        let follows = |book: &Self| super::pdf::follows(view, book, counts).fits();
        if follows(self) { None } else { siblings.find(follows) }
    }

    /// The model called `name`.
    pub fn new(name: &str, p: &Parameters) -> Option<Self> {
        let registry = registry();
        let model = registry.model(name).ok()?;
        let subject = model.build(p, registry).ok()?;
        let description = subject.describe();
        let (channels, dimensions) = (description.channels.len().max(1), description.dimensions.max(1));
        let (parts, lobes) = taken_apart(name, p, &subject, channels);
        Some(Self {
            name: name.into(),
            parameters: p.clone(),
            parts,
            lobes,
            subject,
            channels,
            dimensions,
            agrees: Agreement::default(),
        })
    }

    /// Its number called `name`.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.parameters.0.get(name)? {
            Value::Number(v) => Some(*v),
            Value::Text(_) => None,
        }
    }

    /// The same model with another number; `None` where that is out of range.
    pub fn with(&self, parameter: &str, value: f64) -> Option<Self> {
        let registry = registry();
        registry.model(&self.name).ok()?.parameter(parameter).ok()?.check(&Value::Number(value)).ok()?;
        let mut parameters = self.parameters.clone();
        parameters.0.insert(parameter.into(), Value::Number(value));
        Self::new(&self.name, &parameters)
    }

    /// Its numeric parameters.
    pub fn numbers(&self) -> Vec<(String, f64)> {
        let number = |(name, value): (&String, &Value)| match value {
            Value::Number(v) => Some((name.clone(), *v)),
            Value::Text(_) => None,
        };
        self.parameters.0.iter().filter_map(number).collect()
    }

    /// Its density.
    pub fn pdf(&self, wo: Direction, wi: Direction) -> f64 {
        let mut out = [0.0];
        let called = self.subject.pdf(wo, &[wi], Transport::Radiance, &mut out);
        called.map_or(f64::NAN, |()| out[0])
    }

    /// Its f, cosine excluded.
    pub fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        value_of(&*self.subject, self.channels, wo, wi, transport)
    }

    /// Its draws.
    pub fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> bsdf::Samples {
        let mut samples = bsdf::Samples::default();
        samples.clear(self.channels());
        let _ = self.subject.sample(wo, u, transport, &mut samples);
        samples
    }

    /// Random numbers a draw takes.
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// Channels of its values.
    pub fn channels(&self) -> usize {
        self.channels
    }

    fn agreement(&self, view: &View) -> Agreement {
        if self.channels() != view.channels() {
            return Agreement::default();
        }
        let (mut pdf, mut value) = ([0usize; 2], [0usize; 2]);
        for seen in &view.cases {
            let (mut of_pdf, mut of_value) = ([0usize; 2], [0usize; 2]);
            for p in seen.points.iter().step_by(5) {
                let theirs = self.pdf(seen.wo, p.wi);
                if p.pdf != 0.0 || theirs != 0.0 {
                    of_pdf[1] += 1;
                    of_pdf[0] += usize::from((p.pdf - theirs).abs() <= EQUAL * theirs.abs());
                }
                let theirs = self.eval(seen.wo, p.wi, seen.transport);
                let dark = |f: &Spectrum| f.iter().all(|f| *f == 0.0);
                if !dark(&p.value) || !dark(&theirs) {
                    of_value[1] += 1;
                    let same = |(a, b): (&f64, &f64)| (a - b).abs() <= EQUAL * b.abs();
                    of_value[0] += usize::from(p.value.iter().zip(theirs.iter()).all(same));
                }
            }
            for (case, all) in [(of_pdf, &mut pdf), (of_value, &mut value)] {
                // Nothing anywhere says nothing.
                if case[1] >= 12 {
                    all[1] += 1;
                    all[0] += usize::from(case[0] as f64 >= AGREES * case[1] as f64);
                }
            }
        }
        let share = |[same, all]: [usize; 2]| if all == 0 { 0.0 } else { same as f64 / all as f64 };
        Agreement { pdf: share(pdf), value: share(value) }
    }
}

/// The models that come with gonio, made once.
fn registry() -> &'static Registry {
    static REGISTRY: OnceLock<Registry> = OnceLock::new();
    REGISTRY.get_or_init(Registry::builtin)
}

fn value_of(
    subject: &dyn Subject,
    channels: usize,
    wo: Direction,
    wi: Direction,
    transport: Transport,
) -> Spectrum {
    let mut out = [0.0; bsdf::MAX_CHANNELS];
    let called = subject.eval(wo, &[wi], transport, &mut out[..channels]);
    match called {
        Ok(()) => Spectrum::from(&out[..channels]),
        Err(_) => Spectrum::uniform(channels, f64::NAN),
    }
}

/// Parameters of `model`: those given where it declares them, else every choice and
/// the default numbers. None where it needs what is not given.
pub fn combinations(model: &Model, given: &Parameters) -> Vec<Parameters> {
    let shared: Vec<(String, Value)> = given
        .0
        .iter()
        .filter(|(name, value)| model.parameter(name).is_ok_and(|p| p.check(value).is_ok()))
        .map(|(name, value)| (name.clone(), value.clone()))
        .collect();
    let composed = |p: &crate::registry::Parameter| matches!(p.kind, Kind::Subject { .. } | Kind::File);
    if model.parameters().iter().any(composed) {
        return Vec::new();
    }
    let Ok(complete) = model.complete(&shared) else { return Vec::new() };
    let mut all = vec![complete];
    for p in model.parameters() {
        let Kind::Choice { options, .. } = &p.kind else { continue };
        if given.0.contains_key(&p.name) {
            continue;
        }
        let each = |with: Parameters| -> Vec<Parameters> {
            if !p.applies(&with) {
                return vec![with];
            }
            let option = |o: &String| {
                let mut with = with.clone();
                with.0.insert(p.name.clone(), Value::Text(o.clone()));
                with
            };
            options.iter().map(option).collect()
        };
        all = all.into_iter().flat_map(each).collect();
    }
    all
}

/// Parts and lobes of a model; one lobe, called "", where it is not known to have
/// several.
fn taken_apart(
    name: &str,
    p: &Parameters,
    subject: &Arc<dyn Subject>,
    channels: usize,
) -> (Parts, Vec<Lobe>) {
    let (parts, lobes) = match name {
        side_by_side::NAME => side_by_side::lobes(registry(), p).unwrap_or_default(),
        _ => known(name, p),
    };
    if !lobes.is_empty() {
        return (parts, lobes);
    }
    let (a, b) = (subject.clone(), subject.clone());
    let density = move |wo: Direction, wi: Direction| {
        let mut out = [0.0];
        a.pdf(wo, &[wi], Transport::Radiance, &mut out).map_or(f64::NAN, |()| out[0])
    };
    let value = move |wo: Direction, wi: Direction, t: Transport| value_of(&*b, channels, wo, wi, t);
    let whole = Lobe {
        name: "",
        share: share_of_one(),
        density: Box::new(density),
        value: Box::new(value),
        flags: None,
    };
    (parts, vec![whole])
}

/// Which normals a model of facets draws.
pub fn sampling(book: &Textbook) -> Option<NormalSampling> {
    match book.parameters.0.get("sampling")? {
        Value::Text(t) if t == "normals" => Some(NormalSampling::All),
        Value::Text(t) if t == "visible-normals" => Some(NormalSampling::Visible),
        _ => None,
    }
}
