//! Other ways to draw the directions of a subject: what factored sampling is
//! compared with.

use crate::bsdf::{
    Description, Direction, Has, Lobe, OffSupport, Sample, Samples, Spectrum, Subject, SubjectError,
    Transport,
};
use crate::models::factored::Factored;
use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

/// A density of wi given wo that knows little of the subject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Proposal {
    /// Even over the hemisphere.
    Uniform,
    /// cos θi/π.
    Cosine,
    /// A cosine with the rest of `share`, and with `share` a lobe about the mirror
    /// direction, (n + 1)/2π cosⁿ: one of Lafortune's generalised cosine lobes (E.
    /// Lafortune et al., *Non-linear approximation of reflectance functions*, 1997)
    /// and his diffuse term.
    Lobe {
        /// n.
        exponent: f64,
        /// In [0, 1].
        share: f64,
    },
}

impl Proposal {
    /// The density of `wi` in sr⁻¹.
    pub fn pdf(self, wo: Direction, wi: Direction) -> f64 {
        if !(wo.z > 0.0 && wi.z > 0.0) {
            return 0.0;
        }
        match self {
            Self::Uniform => 1.0 / TAU,
            Self::Cosine => wi.z * FRAC_1_PI,
            Self::Lobe { exponent, share } => {
                let lobe = (exponent + 1.0) / TAU * wi.dot(wo.mirrored()).max(0.0).powf(exponent);
                (1.0 - share) * wi.z * FRAC_1_PI + share * lobe
            }
        }
    }

    /// Draws wi; `None` where it falls below the surface.
    pub fn sample(self, wo: Direction, u: &[f64]) -> Option<Direction> {
        let around = |cos: f64| {
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let (s, c) = (TAU * u[2]).sin_cos();
            Direction::new(sin * c, sin * s, cos)
        };
        let wi = match self {
            Self::Uniform => around(1.0 - u[1]),
            Self::Lobe { exponent, share } if u[0] < share => {
                let local = around((1.0 - u[1]).powf(1.0 / (exponent + 1.0)));
                let axis = wo.mirrored();
                let across = if axis.z < 0.9 { Direction::NORMAL } else { Direction::new(1.0, 0.0, 0.0) };
                let x = across.cross(axis).normalized();
                x * local.x + axis.cross(x) * local.y + axis * local.z
            }
            _ => around((1.0 - u[1]).sqrt()),
        };
        (wo.z > 0.0 && wi.z > 0.0).then_some(wi)
    }

    /// The lobe with the smallest mean of ∫(f cos)²/p over (∫f cos)² at directions
    /// `given`: no other lobe of its kind samples the subject with less variance.
    pub fn best_lobe(subject: &Factored, given: &[Direction]) -> Self {
        // Weighted directions, drawn by the factored sampler.
        const DRAWS: u32 = 2048;
        let drawn: Vec<Vec<(Direction, f64)>> =
            given.iter().map(|wo| weighted(subject, *wo, DRAWS)).collect();
        let cost = |lobe: Self| -> f64 {
            let relative = |(wo, rows): (&Direction, &Vec<(Direction, f64)>)| {
                let second: f64 = rows.iter().map(|(wi, square)| square / lobe.pdf(*wo, *wi)).sum();
                second.ln()
            };
            given.iter().zip(&drawn).map(relative).sum()
        };
        let exponents = (0..48).map(|k| 2f64.powf(f64::from(k) / 4.0));
        let lobes = exponents
            .flat_map(|exponent| (0..20).map(move |k| Self::Lobe { exponent, share: f64::from(k) / 20.0 }));
        lobes.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).expect("there are lobes")
    }
}

/// wi and (f cos)²/p of `draws` well spread draws.
fn weighted(subject: &Factored, wo: Direction, draws: u32) -> Vec<(Direction, f64)> {
    let density = subject.density().given(wo);
    let spread = |k: u32| [0, 1, 2].map(|d| f64::from(sobol_burley::sample(k, d, 1)));
    let wi: Vec<Direction> = (0..draws).filter_map(|k| density.sample(spread(k))).collect();
    let channels = Subject::describe(subject).channels.len();
    let mut value = vec![0.0; wi.len() * channels];
    subject.eval(wo, &wi, Transport::Radiance, &mut value).expect("built-in subjects have values");
    let mean = |rows: &[f64]| rows.iter().sum::<f64>() / channels as f64;
    let square = |(wi, rows): (&Direction, &[f64])| (*wi, (mean(rows) * wi.z).powi(2) / density.pdf(*wi));
    wi.iter().zip(value.chunks_exact(channels)).map(square).collect()
}

/// A subject whose directions are drawn by a proposal.
pub struct Proposed {
    /// Whose values.
    pub subject: Arc<dyn Subject>,
    /// By what.
    pub proposal: Proposal,
}

impl Subject for Proposed {
    fn describe(&self) -> Description {
        let own = self.subject.describe();
        Description { dimensions: 3, has: Has::default(), ..own }
            .claims(|c| c.off_support = OffSupport::NoSample)
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
        _: Transport,
        out: &mut [f64],
    ) -> Result<(), SubjectError> {
        wi.iter().zip(out).for_each(|(wi, p)| *p = self.proposal.pdf(wo, *wi));
        Ok(())
    }

    fn sample(
        &self,
        wo: Direction,
        u: &[f64],
        transport: Transport,
        out: &mut Samples,
    ) -> Result<(), SubjectError> {
        for u in u.chunks_exact(3) {
            let Some(wi) = self.proposal.sample(wo, u) else {
                out.push(None);
                continue;
            };
            let mut value = vec![0.0; out.channels];
            self.subject.eval(wo, &[wi], transport, &mut value)?;
            let pdf = self.proposal.pdf(wo, wi);
            let weight = Spectrum::from(&value[..]) * (wi.z / pdf);
            out.push(Some(&Sample { wi, weight, pdf, lobe: Lobe::GLOSSY_REFLECTION }));
        }
        Ok(())
    }

    fn hints(&self, wo: Direction) -> Vec<Direction> {
        self.subject.hints(wo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::Registry;

    #[test]
    fn proposals_are_themselves_right() {
        let subject = Registry::builtin().resolve(&"oren-nayar".parse().unwrap()).unwrap().subject;
        let lobe = Proposal::Lobe { exponent: 12.0, share: 0.6 };
        for proposal in [Proposal::Uniform, Proposal::Cosine, lobe] {
            crate::assert_valid(&Proposed { subject: subject.clone(), proposal });
        }
    }
}
