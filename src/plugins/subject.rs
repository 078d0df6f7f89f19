//! A subject that a plugin makes.

use super::conventions::{Conventions, Drawn};
use super::description::ModelDescription;
use super::instance::{Call, Created, Fault, Function};
use super::plugin::{Plugin, Running};
use super::probe;
use crate::bsdf::{Description, Direction, Sample, Samples, Spectrum, Subject, SubjectError, Transport};
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// A subject of a plugin: a model with its parameters.
pub struct Foreign {
    made: Arc<Made>,
    description: Description,
    conventions: Conventions,
}

/// What instances of the plugin make, once each.
struct Made {
    plugin: Arc<Plugin>,
    number: u64,
    model: String,
    parameters: String,
}

impl Made {
    fn create_on(&self, running: &mut Running) -> Result<Created, Fault> {
        let created = running.instance.create(&self.model, &self.parameters)?;
        running.handles.insert(self.number, created.handle);
        Ok(created)
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        self.plugin.forget(self.number);
    }
}

/// Numbers on their way to a plugin and back.
#[derive(Default)]
struct Buffers {
    input: Vec<f64>,
    answer: Vec<f64>,
}

thread_local! {
    static BUFFERS: RefCell<Buffers> = RefCell::default();
}

impl Foreign {
    /// Makes a subject of `model` with `parameters` (JSON). Its conventions are `probed`, or
    /// held to be those that it declares.
    pub fn create(
        plugin: &Arc<Plugin>,
        model: &ModelDescription,
        parameters: String,
        probed: bool,
    ) -> Result<Self, SubjectError> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let made = Arc::new(Made {
            plugin: plugin.clone(),
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            model: model.name.clone(),
            parameters,
        });
        let (description, declared) = plugin.with(made.number, |running| {
            let created = made.create_on(running)?;
            model.describe(&plugin.name, created.describe.as_deref())
        })?;
        let mut subject = Self { made, description, conventions: declared };
        let (found, contradictions) =
            if probed { probe::conventions(&subject, declared) } else { (declared, Vec::new()) };
        // What ended under the probe is met again by the measurement, which tells it.
        plugin.forgive(subject.made.number);
        subject.conventions = found;
        subject.description.contradictions = contradictions;
        subject.description.key = Some(format!("{}:{}", subject.made.model, subject.made.parameters));
        Ok(subject)
    }

    /// As this one, in other conventions.
    pub(super) fn under(&self, conventions: Conventions) -> Self {
        Self { made: self.made.clone(), description: self.description.clone(), conventions }
    }

    /// Asks for the rows of `fill`, and reads the answer.
    fn ask<T>(
        &self,
        function: Function,
        wo: Direction,
        transport: Transport,
        rows: usize,
        fill: impl FnOnce(&mut Vec<f64>),
        read: impl FnOnce(&Call, &[f64]) -> Result<T, SubjectError>,
    ) -> Result<T, SubjectError> {
        BUFFERS.with_borrow_mut(|Buffers { input, answer }| {
            input.clear();
            fill(input);
            let mut call = Call {
                function,
                handle: 0,
                transport,
                wo: self.conventions.wo(wo),
                rows,
                channels: self.description.channels.len(),
                input,
            };
            // What an answer leaves out is no number.
            answer.clear();
            answer.resize(call.answer(), f64::NAN);
            let made = &self.made;
            made.plugin.with(made.number, |running| {
                call.handle = match running.handles.get(&made.number) {
                    Some(handle) => *handle,
                    None => made.create_on(running)?.handle,
                };
                running.instance.call(&call, answer)
            })?;
            read(&call, answer)
        })
    }

    fn values(
        &self,
        function: Function,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        if wi.is_empty() {
            return Ok(());
        }
        let fill =
            |input: &mut Vec<f64>| input.extend(wi.iter().flat_map(|d| self.conventions.direction(*d)));
        self.ask(function, wo, transport, wi.len(), fill, |_, answer| {
            out.copy_from_slice(answer);
            Ok(())
        })
    }
}

impl Subject for Foreign {
    fn describe(&self) -> Description {
        self.description.clone()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.values(Function::Eval, wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.values(Function::Pdf, wo, wi, transport, out)
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        let dimensions = self.description.dimensions;
        let rows = u.len() / dimensions.max(1);
        if rows == 0 {
            return Ok(());
        }
        let fill = |input: &mut Vec<f64>| input.extend_from_slice(if dimensions == 0 { &[] } else { u });
        self.ask(Function::Sample, wo, transport, rows, fill, |call, answer| {
            let drawn = Drawn::of(call, answer);
            let weights = drawn.weight.chunks_exact(call.channels);
            let rest = drawn.wi.as_chunks::<3>().0.iter().zip(weights).zip(drawn.pdf).zip(drawn.flags);
            for (((wi, weight), pdf), flags) in rest {
                let lobe = self.conventions.lobe(*flags, *pdf, weight).map_err(SubjectError::Broken)?;
                if !lobe.is_valid() {
                    out.push(None);
                    continue;
                }
                let wi = self.conventions.from_plugin(*wi);
                let factor = self.conventions.weight.factor(wi.abs_cos_theta(), *pdf);
                let weight = Spectrum::from(weight) * factor;
                out.push(Some(&Sample { wi, weight, pdf: *pdf, lobe }));
            }
            Ok(())
        })
    }

    fn alone(&self) -> Option<&Mutex<()>> {
        self.made.plugin.alone.as_ref()
    }
}

/// A subject whose plugin does not work: it tells why wherever it is measured.
pub struct Broken {
    /// What it would have been called.
    pub name: String,
    /// Why.
    pub why: SubjectError,
}

impl Subject for Broken {
    fn describe(&self) -> Description {
        Description::new(&self.name)
    }

    fn eval(&self, _: Direction, _: &[Direction], _: Transport, _: &mut [f64]) -> Result<(), SubjectError> {
        Err(self.why.clone())
    }

    fn pdf(&self, _: Direction, _: &[Direction], _: Transport, _: &mut [f64]) -> Result<(), SubjectError> {
        Err(self.why.clone())
    }

    fn sample(&self, _: Direction, _: &[f64], _: Transport, _: &mut Samples) -> Result<(), SubjectError> {
        Err(self.why.clone())
    }
}
