//! Correct distributions of normals and Fresnel functions with some of their
//! functions changed.

use crate::bsdf::{
    Description, Direction, FresnelFunction, Interface, NormalDistribution, Normals, Spectrum, Subject,
};
use crate::models::microfacet::MaskedDistribution;
use crate::registry::Parameters;
use std::sync::Arc;

type Density = fn(&MaskedDistribution, Direction) -> f64;
type Masking = fn(&MaskedDistribution, Direction, Direction) -> f64;
type Lambda = fn(&MaskedDistribution, Direction) -> f64;
type Draw = fn(&MaskedDistribution, &[f64]) -> Direction;

/// A correct distribution of which a function is changed.
#[derive(Clone)]
pub(super) struct AlteredNormals {
    correct: MaskedDistribution,
    density: Density,
    g1: Masking,
    lambda: Option<Lambda>,
    pdf: Option<Density>,
    draw: Draw,
}

impl AlteredNormals {
    /// Nothing is changed yet.
    pub fn declared(p: &Parameters) -> Result<Self, String> {
        Ok(Self {
            correct: MaskedDistribution::declared(p)?,
            density: MaskedDistribution::density,
            g1: MaskedDistribution::g1,
            lambda: None,
            pdf: None,
            draw: |d, u| d.sample(u),
        })
    }

    /// D is this.
    pub fn density(self, density: Density) -> Self {
        Self { density, ..self }
    }

    /// G1 is this, given the correct distribution, w and m.
    pub fn g1(self, g1: Masking) -> Self {
        Self { g1, ..self }
    }

    /// Λ is this.
    pub fn lambda(self, lambda: Lambda) -> Self {
        Self { lambda: Some(lambda), ..self }
    }

    /// The density of drawn normals is said to be this.
    pub fn pdf(self, pdf: Density) -> Self {
        Self { pdf: Some(pdf), ..self }
    }

    /// Normals are drawn so.
    pub fn draw(self, draw: Draw) -> Self {
        Self { draw, ..self }
    }

    /// As a mutant builds it.
    pub fn made(self, p: &Parameters) -> Result<Arc<dyn Subject>, String> {
        Ok(match p.text("sampling") {
            "visible-normals" => Arc::new(Normals::visible(self)?),
            _ => Arc::new(Normals::all(self)),
        })
    }
}

impl NormalDistribution for AlteredNormals {
    fn describe(&self) -> Description {
        NormalDistribution::describe(&self.correct)
    }

    fn density(&self, m: Direction) -> f64 {
        (self.density)(&self.correct, m)
    }

    fn g1(&self, w: Direction, m: Direction) -> f64 {
        (self.g1)(&self.correct, w, m)
    }

    fn sample(&self, u: &[f64]) -> Direction {
        (self.draw)(&self.correct, u)
    }

    fn pdf(&self, m: Direction) -> f64 {
        match self.pdf {
            Some(pdf) => pdf(&self.correct, m),
            None => (self.density)(&self.correct, m) * m.z.max(0.0),
        }
    }

    fn draws_visible(&self) -> bool {
        self.correct.draws_visible()
    }

    fn sample_visible(&self, wo: Direction, u: &[f64]) -> Option<Direction> {
        self.correct.sample_visible(wo, u)
    }

    fn lambda(&self, w: Direction) -> Option<f64> {
        match self.lambda {
            Some(lambda) => Some(lambda(&self.correct, w)),
            None => self.correct.lambda(w),
        }
    }
}

type Reflectance<F> = fn(&F, f64) -> Spectrum;
type Polarised<F> = fn(&F, f64) -> Option<[Spectrum; 2]>;

/// A correct Fresnel function of which one is changed. What it transmits is as in the
/// correct one, and polarisations are told apart only where they are what is changed.
pub(super) struct AlteredFresnel<F> {
    correct: F,
    reflectance: Reflectance<F>,
    polarised: Polarised<F>,
}

impl<F: FresnelFunction + 'static> AlteredFresnel<F> {
    /// Nothing is changed yet.
    pub fn of(correct: F) -> Self {
        Self { correct, reflectance: F::reflectance, polarised: |_, _| None }
    }

    /// The reflected part is this, given the correct function and the signed cosine.
    pub fn reflectance(self, reflectance: Reflectance<F>) -> Self {
        Self { reflectance, ..self }
    }

    /// The reflectances of both polarisations are these.
    pub fn polarised(self, polarised: Polarised<F>) -> Self {
        Self { polarised, ..self }
    }

    /// As a mutant builds it.
    pub fn made(self) -> Result<Arc<dyn Subject>, String> {
        Ok(Arc::new(Interface(self)))
    }
}

impl<F: FresnelFunction> FresnelFunction for AlteredFresnel<F> {
    fn describe(&self) -> Description {
        self.correct.describe()
    }

    fn reflectance(&self, cos: f64) -> Spectrum {
        (self.reflectance)(&self.correct, cos)
    }

    fn transmittance(&self, cos: f64) -> Option<Spectrum> {
        self.correct.transmittance(cos)
    }

    fn polarised(&self, cos: f64) -> Option<[Spectrum; 2]> {
        (self.polarised)(&self.correct, cos)
    }
}
