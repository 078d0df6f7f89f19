//! A correct model with some of its functions changed.

use crate::bsdf::{Bsdf, Description, Direction, Lobe, NativeCells, Sample, Spectrum, Subject, Transport};
use crate::models::microfacet::Distribution;
use std::sync::Arc;

/// The mode in which densities are asked for: no built-in pdf depends on it.
pub(super) const R: Transport = Transport::Radiance;

type Value<M> = Box<dyn Fn(&M, Direction, Direction, Transport) -> Spectrum + Send + Sync>;
type Density<M> = Box<dyn Fn(&M, Direction, Direction) -> f64 + Send + Sync>;
type Draw<M> = Box<dyn Fn(&M, Direction, &[f64]) -> Option<(Direction, Lobe)> + Send + Sync>;
type Whole<M> = Box<dyn Fn(&M, Direction, &[f64], Transport) -> Option<Sample> + Send + Sync>;
type Finish<M> = Box<dyn Fn(&M, Direction, &[f64], Sample) -> Option<Sample> + Send + Sync>;

/// A correct model of which `eval`, `pdf` or `sample` is changed.
///
/// As in most renderers, `sample` draws a direction and gets its pdf and weight
/// from the other two functions, so that a bug in one of these goes on into
/// both; discrete lobes come as the correct model draws them. What is changed
/// [last](Self::finish) is the finished sample, where a bug is only there.
pub(super) struct Altered<M> {
    correct: M,
    description: Description,
    value: Option<Value<M>>,
    density: Option<Density<M>>,
    draw: Option<Draw<M>>,
    sample: Option<Whole<M>>,
    finish: Option<Finish<M>>,
}

impl<M: Bsdf + 'static> Altered<M> {
    /// Nothing is changed yet.
    pub fn of(correct: M) -> Self {
        let description = Bsdf::describe(&correct);
        Self { correct, description, value: None, density: None, draw: None, sample: None, finish: None }
    }

    /// `eval` is this, given the correct model, wo, wi and the mode.
    pub fn eval(
        mut self,
        value: impl Fn(&M, Direction, Direction, Transport) -> Spectrum + Send + Sync + 'static,
    ) -> Self {
        self.value = Some(Box::new(value));
        self
    }

    /// `pdf` is this, given the correct model, wo and wi.
    pub fn pdf(mut self, density: impl Fn(&M, Direction, Direction) -> f64 + Send + Sync + 'static) -> Self {
        self.density = Some(Box::new(density));
        self
    }

    /// `eval` is the correct one times this, where that is not 0.
    pub fn eval_times(
        self,
        factor: impl Fn(&M, Direction, Direction) -> f64 + Send + Sync + 'static,
    ) -> Self {
        self.eval(move |m, wo, wi, transport| {
            let f = m.eval(wo, wi, transport);
            if f.iter().all(|v| *v == 0.0) { f } else { f * factor(m, wo, wi) }
        })
    }

    /// `pdf` is the correct one times this, where that is not 0.
    pub fn pdf_times(self, factor: impl Fn(&M, Direction, Direction) -> f64 + Send + Sync + 'static) -> Self {
        self.pdf(move |m, wo, wi| {
            let pdf = m.pdf(wo, wi, R);
            if pdf == 0.0 { pdf } else { pdf * factor(m, wo, wi) }
        })
    }

    /// `pdf` is that of another model.
    pub fn pdf_of(self, other: impl Bsdf + 'static) -> Self {
        self.pdf(move |_, wo, wi| other.pdf(wo, wi, R))
    }

    /// `sample` draws this direction of a continuous lobe, given the correct model,
    /// wo and u. Where the lobe is discrete, it is as the correct model draws it.
    pub fn draw(
        mut self,
        draw: impl Fn(&M, Direction, &[f64]) -> Option<(Direction, Lobe)> + Send + Sync + 'static,
    ) -> Self {
        self.draw = Some(Box::new(draw));
        self
    }

    /// `sample` is this, given the correct model, wo, u and the mode: nothing is
    /// taken from the other two functions.
    pub fn sample(
        mut self,
        sample: impl Fn(&M, Direction, &[f64], Transport) -> Option<Sample> + Send + Sync + 'static,
    ) -> Self {
        self.sample = Some(Box::new(sample));
        self
    }

    /// `sample` returns this, given the correct model, wo, u and the finished sample.
    pub fn finish(
        mut self,
        finish: impl Fn(&M, Direction, &[f64], Sample) -> Option<Sample> + Send + Sync + 'static,
    ) -> Self {
        self.finish = Some(Box::new(finish));
        self
    }

    /// It says this of itself.
    pub fn described(mut self, change: impl FnOnce(Description) -> Description) -> Self {
        self.description = change(self.description);
        self
    }

    /// As a mutant builds it.
    pub fn made(self) -> Result<Arc<dyn Subject>, String> {
        Ok(Arc::new(self))
    }

    /// The direction that is drawn, with the pdf and weight of the (changed)
    /// functions.
    fn drawn(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        if let Some(sample) = &self.sample {
            return sample(&self.correct, wo, u, transport);
        }
        let (wi, lobe) = match &self.draw {
            Some(draw) => draw(&self.correct, wo, u)?,
            None => {
                let own = self.correct.sample(wo, u, transport)?;
                if self.value.is_none() && self.density.is_none() {
                    return Some(own);
                }
                (own.wi, own.lobe)
            }
        };
        if lobe.is_discrete() {
            return self.correct.sample(wo, u, transport);
        }
        let pdf = Bsdf::pdf(self, wo, wi, transport);
        let weight = Bsdf::eval(self, wo, wi, transport) * (wi.z.abs() / pdf);
        (pdf != 0.0).then_some(Sample { wi, weight, pdf, lobe })
    }
}

impl<M: Bsdf + 'static> Bsdf for Altered<M> {
    fn describe(&self) -> Description {
        self.description.clone()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum {
        match &self.value {
            Some(value) => value(&self.correct, wo, wi, transport),
            None => self.correct.eval(wo, wi, transport),
        }
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        match &self.density {
            Some(density) => density(&self.correct, wo, wi),
            None => self.correct.pdf(wo, wi, transport),
        }
    }

    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample> {
        let sample = self.drawn(wo, u, transport)?;
        match &self.finish {
            Some(finish) => finish(&self.correct, wo, u, sample),
            None => Some(sample),
        }
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        Bsdf::hints(&self.correct, wo)
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        Bsdf::cells(&self.correct, wo)
    }
}

/// The half vector of reflection; the normal where the two are opposite.
pub(super) fn half(wo: Direction, wi: Direction) -> Direction {
    let sum = wo + wi;
    if sum.length() > 0.0 { sum.normalized() } else { Direction::NORMAL }
}

/// Smith's masking and shadowing of reflection, correlated by height (Heitz 2014,
/// eq. 99).
pub(super) fn g2(d: &Distribution, wo: Direction, wi: Direction) -> f64 {
    let (o, i) = (d.backfacing_area(wo), d.backfacing_area(wi));
    wo.z * wi.z / (wo.z * wi.z + o * wi.z + i * wo.z)
}
