//! Subjects on the terms of a rubric.

use crate::bsdf::{
    Claims, Description, Direction, Has, NativeCells, Precision, Samples, Subject, SubjectError, Transport,
};
use std::sync::{Arc, Mutex};

/// A subject that is judged by what the rubric says of it, whatever it says itself.
pub struct Held {
    /// As it was submitted.
    pub subject: Arc<dyn Subject>,
    /// What it is held to.
    pub claims: Claims,
    /// The precision that terms are for.
    pub precision: Precision,
    /// Whether eval alone counts, as of a reference that others may sample in their own way.
    pub eval_only: bool,
}

impl Subject for Held {
    fn describe(&self) -> Description {
        let own = self.subject.describe();
        let has = if self.eval_only { Has { pdf: false, sample: false, ..own.has } } else { own.has };
        // Neither is what it says cannot fail.
        Description {
            claims: self.claims,
            precision: self.precision,
            by_construction: Vec::new(),
            has,
            ..own
        }
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.subject.eval(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.subject.pdf(wo, wi, transport, out)
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        self.subject.sample(wo, u, transport, out)
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        self.subject.hints(wo)
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        self.subject.cells(wo)
    }

    fn alone(&self) -> Option<&Mutex<()>> {
        self.subject.alone()
    }
}
