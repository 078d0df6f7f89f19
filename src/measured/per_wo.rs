//! Tables do part of their work once for all wi of one wo.

use crate::bsdf::{Description, Direction, Sample, Samples, Subject, SubjectError, Transport};

/// A reflector on the front side, two random numbers a sample, which prepares for
/// a given wo.
pub trait Reflector: Send + Sync {
    /// What it prepares.
    type Given<'a>
    where
        Self: 'a;

    /// Name, channels, claims; `dimensions` must be 2.
    fn describe(&self) -> Description;
    /// For a wo with z > 0, whose density so many `calls` will ask for.
    fn given(&self, wo: Direction, calls: usize) -> Self::Given<'_>;
    /// f in sr⁻¹ per channel into `out`, for a wi with z > 0.
    fn eval(&self, given: &Self::Given<'_>, wi: Direction, out: &mut [f64]);
    /// Density of `sample` in sr⁻¹, for a wi with z > 0.
    fn pdf(&self, given: &Self::Given<'_>, wi: Direction) -> f64;
    /// Draws a direction from `u` in [0, 1)².
    fn sample(&self, given: &Self::Given<'_>, u: [f64; 2]) -> Option<Sample>;
}

/// A [`Reflector`] as a subject: black from behind.
#[derive(Clone, Debug)]
pub struct PerWo<T>(pub T);

impl<T: Reflector> Subject for PerWo<T> {
    fn describe(&self) -> Description {
        self.0.describe()
    }

    fn eval(
        &self,
        wo: Direction,
        wi: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        out.fill(0.0);
        if wo.z > 0.0 && !wi.is_empty() {
            let given = self.0.given(wo, 0);
            let channels = out.len() / wi.len();
            for (wi, row) in wi.iter().zip(out.chunks_exact_mut(channels)).filter(|(wi, _)| wi.z > 0.0) {
                self.0.eval(&given, *wi, row);
            }
        }
        Ok(())
    }

    fn pdf(
        &self,
        wo: Direction,
        wi: &[Direction],
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        out.fill(0.0);
        if wo.z > 0.0 {
            let given = self.0.given(wo, wi.len());
            for (wi, p) in wi.iter().zip(out).filter(|(wi, _)| wi.z > 0.0) {
                *p = self.0.pdf(&given, *wi);
            }
        }
        Ok(())
    }

    fn sample(&self, wo: Direction, u: &[f64], _: Transport, out: &mut Samples) -> Result<(), SubjectError> {
        let rows = u.chunks_exact(2);
        if wo.z > 0.0 {
            let given = self.0.given(wo, rows.len());
            rows.for_each(|u| out.push(self.0.sample(&given, [u[0], u[1]]).as_ref()));
        } else {
            rows.for_each(|_| out.push(None));
        }
        Ok(())
    }
}
