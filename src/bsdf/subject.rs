//! The two interfaces: [`Bsdf`] is what an author writes, [`Subject`] what the
//! harness calls.

use super::{
    Description, Direction, FresnelFunction, NativeCells, NormalDistribution, Sample, Samples, Spectrum,
    Transport,
};
use std::sync::Mutex;

/// What a material author implements. One direction at a time, easy to write.
///
/// `wo` is given, `wi` is sampled; both point away from the surface, z is the
/// normal. Every `Bsdf` is a [`Subject`].
pub trait Bsdf: Send + Sync {
    /// Name, channels, dimensions of u, precision, claims.
    fn describe(&self) -> Description;
    /// The BSDF value f in sr⁻¹ per channel, cosine excluded, without discrete lobes.
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> Spectrum;
    /// Density of `sample` in `wi` given `wo`, in sr⁻¹, without discrete lobes.
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64;
    /// Draws a direction from `u` in [0,1)^d; `None` where there is no sample.
    fn sample(&self, wo: Direction, u: &[f64], transport: Transport) -> Option<Sample>;
    /// Values for each row of `wi` into `out` (row-major, `wi.len()` × channels). A model
    /// that has many at once faster than one by one gives them here; each must be what
    /// [`eval`](Self::eval) gives.
    fn eval_rows(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        each_value(self, wo, wi, transport, out)
    }
    /// Densities for each row of `wi`, likewise.
    fn pdf_rows(&self, wo: Direction, wi: &[Direction], transport: Transport, out: &mut [f64]) {
        each_density(self, wo, wi, transport, out);
    }
    /// Draws for each row of `u` into `out`, which comes cleared. A model that draws many
    /// at once faster than one by one does it here; each must be what
    /// [`sample`](Self::sample) gives.
    fn sample_rows(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        one_by_one(self, wo, u, transport, out)
    }
    /// Directions near which pdf or eval may have a narrow peak that nobody
    /// would guess. Mirror, refracted and retro-reflected directions are
    /// looked at anyway.
    fn hints(&self, _wo: Direction) -> Vec<Direction> {
        Vec::new()
    }
    /// The cells of a table, for directions wi given `wo`; `None` where eval has
    /// no jumps.
    fn cells(&self, _wo: Direction) -> Option<NativeCells> {
        None
    }
}

/// What the harness calls: batches with one `wo`, fallible. A [`Bsdf`] is one
/// for free; plugins implement it directly.
pub trait Subject: Send + Sync {
    /// Name, channels, dimensions of u, precision, claims.
    fn describe(&self) -> Description;
    /// Values for each row of `wi` into `out` (row-major, `wi.len()` × channels).
    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError>;
    /// Densities for each row of `wi` into `out` (`wi.len()` values).
    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError>;
    /// One draw for each row of `u` (row-major, n × dimensions) into `out`,
    /// which comes cleared and with its channels set.
    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError>;
    /// As [`Bsdf::hints`].
    fn hints(&self, _wo: Direction) -> Vec<Direction> {
        Vec::new()
    }
    /// As [`Bsdf::cells`].
    fn cells(&self, _wo: Direction) -> Option<NativeCells> {
        None
    }
    /// Held for the length of a case, where no two may be measured at once.
    fn alone(&self) -> Option<&Mutex<()>> {
        None
    }
    /// The distribution of normals that this is, where its description says so.
    fn distribution(&self) -> Option<&dyn NormalDistribution> {
        None
    }
    /// The Fresnel function that this is, where its description says so.
    fn fresnel(&self) -> Option<&dyn FresnelFunction> {
        None
    }
}

/// Why a subject could not be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SubjectError {
    /// It panicked.
    #[error("{function}() panicked: {message}")]
    Panicked {
        /// Which function.
        function: &'static str,
        /// The panic message with its place.
        message: String,
    },
    /// It returned a spectrum or batch of another length than it described.
    #[error("{function}() returned {got} values where {expected} were described")]
    WrongLength {
        /// Which function.
        function: &'static str,
        /// As described.
        expected: usize,
        /// As returned.
        got: usize,
    },
    /// It did not return in time.
    #[error("took longer than the time limit of {limit_s} s: {state}")]
    TimedOut {
        /// The limit in seconds.
        limit_s: f64,
        /// What it was doing.
        state: String,
    },
    /// It says that it cannot answer this call; others it may.
    #[error("{0}")]
    Refused(String),
    /// It crashed, hung or broke the protocol; the text says how.
    #[error("{0}")]
    Broken(String),
}

/// Values for each row of `wi` by [`Bsdf::eval`].
pub(crate) fn each_value<B: Bsdf + ?Sized>(
    bsdf: &B,
    wo: Direction,
    wi: &[Direction],
    transport: Transport,
    out: &mut [f64],
) -> Result<(), SubjectError> {
    if wi.is_empty() {
        return Ok(());
    }
    let channels = out.len() / wi.len();
    for (wi, row) in wi.iter().zip(out.chunks_exact_mut(channels)) {
        let value = bsdf.eval(wo, *wi, transport);
        if value.len() != channels {
            return Err(SubjectError::WrongLength { function: "eval", expected: channels, got: value.len() });
        }
        row.copy_from_slice(&value);
    }
    Ok(())
}

/// Densities for each row of `wi` by [`Bsdf::pdf`].
pub(crate) fn each_density<B: Bsdf + ?Sized>(
    bsdf: &B,
    wo: Direction,
    wi: &[Direction],
    transport: Transport,
    out: &mut [f64],
) {
    for (wi, p) in wi.iter().zip(out) {
        *p = bsdf.pdf(wo, *wi, transport);
    }
}

/// Draws for each row of `u` by [`Bsdf::sample`].
pub(crate) fn one_by_one<B: Bsdf + ?Sized>(
    bsdf: &B,
    wo: Direction,
    u: &[f64],
    transport: Transport,
    out: &mut Samples,
) -> Result<(), SubjectError> {
    let dimensions = bsdf.describe().dimensions;
    for u in u.chunks_exact(dimensions.max(1)) {
        let sample = bsdf.sample(wo, u, transport);
        if let Some(s) = &sample
            && s.weight.len() != out.channels
        {
            return Err(SubjectError::WrongLength {
                function: "sample",
                expected: out.channels,
                got: s.weight.len(),
            });
        }
        out.push(sample.as_ref());
    }
    Ok(())
}

impl<B: Bsdf> Subject for B {
    fn describe(&self) -> Description {
        Bsdf::describe(self)
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.eval_rows(wo, wi, transport, out)
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        transport: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        self.pdf_rows(wo, wi, transport, out);
        Ok(())
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        self.sample_rows(wo, u, transport, out)
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        Bsdf::hints(self, wo)
    }

    fn cells(&self, wo: Direction) -> Option<NativeCells> {
        Bsdf::cells(self, wo)
    }
}
