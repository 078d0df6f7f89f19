//! brdf.rs: yours. Three models, three functions each; handout.md has the formulas, and
//! course.rs says what each function is to return.

use crate::course::*;

impl Brdf for Diffuse {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64 {
        0.0 // TODO
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        0.0 // TODO
    }

    /// Some(Sample { wi, weight, pdf, lobe: Lobe::Diffuse }), or None.
    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample> {
        None // TODO
    }
}

impl Brdf for Metal {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64 {
        0.0 // TODO
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        0.0 // TODO
    }

    /// The lobe of the metal is Lobe::Glossy.
    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample> {
        None // TODO
    }
}

impl Brdf for Plastic {
    fn eval(&self, wo: Vec3, wi: Vec3) -> f64 {
        0.0 // TODO
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        0.0 // TODO
    }

    /// Lobe::Glossy where the coat was drawn from, Lobe::Diffuse where the base was.
    fn sample(&self, wo: Vec3, u1: f64, u2: f64) -> Option<Sample> {
        None // TODO
    }
}
